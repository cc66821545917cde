# Configures and generates a project that has this one in it, in two ways; builds and runs a program
# of the second. Variables: SOURCE_DIR, PROJECT_DIR, WORK_DIR, GENERATOR, BUILD_TYPE.
include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)

foreach(fetch OFF ON)
  set(build ${WORK_DIR}/fetch_${fetch})
  file(REMOVE_RECURSE ${build})
  file(MAKE_DIRECTORY ${build})
  step(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${build} -G ${GENERATOR}
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
    -DPROJECT_DIR=${PROJECT_DIR} -DFETCH=${fetch})
endforeach()
step(${CMAKE_COMMAND} --build ${build} --target consumer)
step(${build}/consumer)
