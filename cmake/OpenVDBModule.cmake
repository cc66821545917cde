# OpenVDB comes with a find module, not with a package config, in cmake/OpenVDB of its library
# folder. Adds that folder to CMAKE_MODULE_PATH: the first one below OpenVDB_ROOT, CMAKE_PREFIX_PATH
# (both may be in the environment) and the places of the system. A FindOpenVDB.cmake in
# CMAKE_MODULE_PATH goes first.
set(_openvdb_prefixes ${OpenVDB_ROOT} $ENV{OpenVDB_ROOT} ${CMAKE_PREFIX_PATH})
file(TO_CMAKE_PATH "$ENV{CMAKE_PREFIX_PATH}" _openvdb_environment)
find_path(_openvdb_module FindOpenVDB.cmake
  PATHS ${_openvdb_prefixes} ${_openvdb_environment} ${CMAKE_SYSTEM_PREFIX_PATH}
  PATH_SUFFIXES lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB lib/cmake/OpenVDB
    lib64/cmake/OpenVDB
  NO_DEFAULT_PATH NO_CACHE)
if(_openvdb_module)
  list(APPEND CMAKE_MODULE_PATH ${_openvdb_module})
endif()
unset(_openvdb_module)
