# A room of the library: folders of lib/vdb_madf that make one target, vdb_madf::NAME.
#
#   vdb_madf_room(NAME
#     [FOLDERS folder...]   from bottom to top; default: NAME
#     HEADERS file...       public: installed; seen from lib/vdb_madf
#     SOURCES file...       private headers are not listed
#     [OBJECTS target...]   object libraries that become part of it
#     [USES room...]        the rooms it may include and link, with all that these use
#     [LINKS target...]     libraries that its headers need
#     [PRIVATE target...]   libraries that only its sources need
#     [PACKAGES name...]    what find_package(vdb_madf COMPONENTS NAME) has to find
#     [OPTIMIZE level]      Og or O2, where its loops wait for others or for files; default: that
#                           of the build type
#     [GRIDS]               its sources see OpenVDB's grids, by a precompiled header
#     [SANITIZE]            with the tests, also built with sanitizers, as vdb_madf_NAME_sanitized
#     [SANITIZABLE])        the same, if VDB_MADF_SANITIZE_ALL is on
#
# USES is the one list of arrows between rooms. It is written to rooms.txt in the build folder,
# where tests/rooms compares every #include with it.
option(VDB_MADF_SANITIZE_ALL "Sanitizers also for rooms that compute with what others read" OFF)
function(vdb_madf_room name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "GRIDS;SANITIZE;SANITIZABLE" "OPTIMIZE"
    "FOLDERS;HEADERS;SOURCES;OBJECTS;USES;LINKS;PRIVATE;PACKAGES")
  if(NOT arg_FOLDERS)
    set(arg_FOLDERS ${name})
  endif()
  list(TRANSFORM arg_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/vdb_madf/)
  list(TRANSFORM arg_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/vdb_madf/)
  set(target vdb_madf_${name})
  vdb_madf_room_library("")
  add_library(vdb_madf::${name} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS
    BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR} FILES ${arg_HEADERS})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  if(arg_SANITIZABLE AND VDB_MADF_SANITIZE_ALL)
    set(arg_SANITIZE ON)
  endif()
  if(arg_SANITIZE AND VDB_MADF_BUILD_TESTS)
    vdb_madf_room_library(_sanitized)
    target_include_directories(${target}_sanitized PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
    set_target_properties(${target}_sanitized PROPERTIES EXCLUDE_FROM_ALL ON)
    vdb_madf_sanitize(${target}_sanitized)
  endif()

  set_property(GLOBAL APPEND PROPERTY vdb_madf_rooms ${name})
  set_property(GLOBAL PROPERTY vdb_madf_${name}_uses ${arg_USES})
  set_property(GLOBAL PROPERTY vdb_madf_${name}_packages ${arg_PACKAGES})
  # Folders of one room see those before them.
  set(below "")
  foreach(folder IN LISTS arg_FOLDERS)
    set_property(GLOBAL APPEND_STRING PROPERTY vdb_madf_arrows
      "${folder} ${name}: ${below} ${arg_USES}\n")
    list(APPEND below ${folder})
  endforeach()
endfunction()

# Lets `target` see OpenVDB's grids by a precompiled header. GCC wants that compiled with the same
# options, so there is one for each level of optimization, and one with the sanitizers (the suffix
# _sanitized).
function(vdb_madf_share_header target level suffix)
  set(owner vdb_madf_grids_header${level}${suffix})
  if(NOT TARGET ${owner})
    set(source ${PROJECT_BINARY_DIR}/grids_header.cc)
    file(CONFIGURE OUTPUT ${source} CONTENT "")
    add_library(${owner} OBJECT EXCLUDE_FROM_ALL ${source})
    vdb_madf_compiler_options(${owner})
    vdb_madf_optimize(${owner} "${level}")
    if(suffix)
      vdb_madf_sanitize(${owner})
    endif()
    set_target_properties(${owner} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${owner} PRIVATE ${PROJECT_SOURCE_DIR}/lib)
    target_link_libraries(${owner} PRIVATE OpenVDB::openvdb TBB::tbb)
    vdb_madf_map_classes(${owner})
    target_precompile_headers(${owner} PRIVATE
      <vdb_madf/grids/grid_types.h> <vdb_madf/grids/detail/grid_instances.h>)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${owner})
endfunction()

# Leaves OpenVDB's map classes (ScaleMap and others) to one object, vdb_madf_grid_instances. They
# are not templates, but their virtual functions are inline, and GCC compiles all of them wherever
# the header is seen: two seconds a file. '#pragma interface' in the header would say that they are
# compiled elsewhere; as it looks at the name of the file alone, '#line' puts it there. Where
# '#pragma implementation' comes first (the option HERE), all their functions are compiled.
function(vdb_madf_map_classes target)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    return()
  endif()
  set(header ${PROJECT_BINARY_DIR}/map_classes.h)
  file(CONFIGURE OUTPUT ${header} CONTENT "#line 1 \"${OpenVDB_INCLUDE_DIR}/openvdb/math/Maps.h\"
#pragma interface
#line 4 \"${header}\"
")
  if("${ARGN}" STREQUAL "HERE")
    set(here ${PROJECT_BINARY_DIR}/map_classes_here.h)
    file(CONFIGURE OUTPUT ${here} CONTENT "#pragma implementation \"Maps.h\"
#include \"map_classes.h\"
")
    target_compile_options(${target} PRIVATE "SHELL:-include ${here}")
  else()
    target_precompile_headers(${target} PRIVATE ${header})
  endif()
endfunction()

# The level is "" or as OPTIMIZE of vdb_madf_room().
function(vdb_madf_optimize target level)
  if(level)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-${level}>)
  endif()
endfunction()

# Part of vdb_madf_room(): the library, or with the suffix _sanitized its instrumented twin.
macro(vdb_madf_room_library suffix)
  add_library(${target}${suffix} STATIC ${arg_SOURCES})
  foreach(objects IN LISTS arg_OBJECTS)
    target_sources(${target}${suffix} PRIVATE $<TARGET_OBJECTS:${objects}>)
  endforeach()
  vdb_madf_compiler_options(${target}${suffix})
  set(level "${arg_OPTIMIZE}")
  if(NOT "${suffix}" STREQUAL "")
    set(level "")  # all at that of the sanitizers
  endif()
  vdb_madf_optimize(${target}${suffix} "${level}")
  set_target_properties(${target}${suffix} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  foreach(room IN LISTS arg_USES)
    target_link_libraries(${target}${suffix} PUBLIC vdb_madf_${room}${suffix})
  endforeach()
  target_link_libraries(${target}${suffix} PUBLIC ${arg_LINKS} PRIVATE ${arg_PRIVATE})
  if(arg_GRIDS)
    vdb_madf_share_header(${target}${suffix} "${level}" "${suffix}")
  endif()
endmacro()

# After the last room.
function(vdb_madf_write_rooms file)
  get_property(arrows GLOBAL PROPERTY vdb_madf_arrows)
  string(REPLACE ";" " " arrows "${arrows}")
  file(WRITE ${file} "${arrows}")
endfunction()
