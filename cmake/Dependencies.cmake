# The libraries of the core. Debian ships OpenVDB as a find module outside CMake's own search path.
list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)

find_package(OpenVDB 10.0 REQUIRED)
unset(BUILD_SHARED_LIBS)  # set by FindOpenVDB in this scope; our library says STATIC itself
find_package(TBB REQUIRED)
find_package(Eigen3 3.3 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(TIFF REQUIRED)
find_package(PNG REQUIRED)
find_package(Blosc REQUIRED)  # with OpenVDB's own find module
find_package(nlohmann_json REQUIRED)

# HDF5 volumes are read if its library is there. (CMake's own module wants a C compiler.)
option(VDB_MADF_HDF5 "Read HDF5 if libhdf5 is found" ON)
if(VDB_MADF_HDF5)
  find_path(VDB_MADF_HDF5_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial)
  find_library(VDB_MADF_HDF5_LIBRARY NAMES hdf5_serial hdf5)
endif()
if(NOT VDB_MADF_HDF5 OR NOT VDB_MADF_HDF5_INCLUDE_DIR OR NOT VDB_MADF_HDF5_LIBRARY)
  set(VDB_MADF_HDF5_LIBRARY "")
  message(STATUS "HDF5 volumes will not be read: no libhdf5, or VDB_MADF_HDF5 is off")
endif()
