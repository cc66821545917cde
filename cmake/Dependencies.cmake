# The libraries of the rooms.
include(OpenVDBModule)
find_package(OpenVDB 10.0 REQUIRED)
unset(BUILD_SHARED_LIBS)  # set by FindOpenVDB in this scope; our library says STATIC itself
find_package(TBB REQUIRED)
find_package(Eigen3 3.3 REQUIRED)
find_package(Qhull 8.0 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(TIFF REQUIRED)
find_package(PNG REQUIRED)
find_package(Cairo REQUIRED)
find_file(VDB_MADF_FONT OpenSans-Regular.ttf DOC "Font of the pictures: Open Sans (Apache-2.0)"
  PATHS /usr/share/fonts PATH_SUFFIXES truetype/open-sans open-sans TTF)
if(NOT VDB_MADF_FONT)
  message(FATAL_ERROR "The font of the pictures is missing: apt-get install fonts-open-sans")
endif()
find_package(Blosc REQUIRED)  # with OpenVDB's own find module
find_package(zstd REQUIRED)
find_package(nlohmann_json REQUIRED)

option(VDB_MADF_HDF5 "Read and write HDF5 if libhdf5 is found" ON)
if(VDB_MADF_HDF5)
  find_package(SerialHDF5 QUIET)
endif()
if(NOT TARGET SerialHDF5::hdf5)
  message(STATUS "HDF5 will not be read or written: no libhdf5, or VDB_MADF_HDF5 is off")
endif()
