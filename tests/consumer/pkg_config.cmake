# Installs the built library, moves the tree, and compiles and runs a consumer with what pkg-config
# says of it. Variables: BUILD_DIR, SOURCE_DIR, WORK_DIR, COMPILER.
find_program(PKG_CONFIG NAMES pkg-config pkgconf)
if(NOT PKG_CONFIG)
  message("SKIPPED: the consumer with pkg-config: there is no pkg-config")
  return()
endif()

include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)

file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
step(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/first)
file(RENAME ${WORK_DIR}/first ${WORK_DIR}/moved)
foreach(document LICENSE README.md)
  if(NOT EXISTS ${WORK_DIR}/moved/share/doc/vdb_madf/${document})
    message(FATAL_ERROR "${document} is not installed")
  endif()
endforeach()
file(GLOB_RECURSE files ${WORK_DIR}/moved/*/vdb_madf.pc)
get_filename_component(folder "${files}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${folder})
step(${PKG_CONFIG} --cflags --libs vdb_madf)
separate_arguments(flags UNIX_COMMAND "${output}")
file(WRITE ${WORK_DIR}/all_headers.h "")
step(${COMPILER} -std=c++17 -I${WORK_DIR} ${SOURCE_DIR}/main.cc ${SOURCE_DIR}/array.cc -o consumer
  ${flags})
step(${WORK_DIR}/consumer)
