# The libraries of the rooms.
if(NOT PROJECT_IS_TOP_LEVEL)
  # What is found here is linked where the project around this one is.
  set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
endif()
set(VDB_MADF_SHARED ${BUILD_SHARED_LIBS})
include(OpenVDBModule)
find_package(OpenVDB 10.0 REQUIRED)
if(OpenVDB_VERSION VERSION_GREATER_EQUAL 14)
  message(STATUS "OpenVDB ${OpenVDB_VERSION} is newer than 13, up to which .vdb files are compressed by all "
    "threads: they are written more slowly")
endif()
unset(BUILD_SHARED_LIBS)  # set by FindOpenVDB in this scope; our rooms say STATIC themselves
find_package(TBB REQUIRED)
find_package(Eigen3 REQUIRED)  # 3.3 or newer: 5 says that it is not compatible with 3
if(Eigen3_VERSION VERSION_LESS 3.3)
  message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is too old: 3.3 or newer is wanted")
endif()
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
find_package(fmt REQUIRED)

option(VDB_MADF_HDF5 "Read and write HDF5 if libhdf5 is found" ON)
if(VDB_MADF_HDF5)
  find_package(SerialHDF5 QUIET)
endif()
if(NOT TARGET SerialHDF5::hdf5)
  message(STATUS "HDF5 will not be read or written: no libhdf5, or VDB_MADF_HDF5 is off")
endif()

option(VDB_MADF_MPI "Build vdb_madf_mpi if MPI is found" ON)
unset(VDB_MADF_HAS_MPI CACHE)  # it may have been installed since
if(VDB_MADF_MPI)
  set(MPI_CXX_SKIP_MPICXX ON)
  find_package(MPI QUIET COMPONENTS CXX)
  # Without a compiler of its own, CMake takes any for one that knows MPI.
  include(CheckIncludeFileCXX)
  set(CMAKE_REQUIRED_LIBRARIES ${MPI_CXX_LIBRARIES})
  set(CMAKE_REQUIRED_INCLUDES ${MPI_CXX_INCLUDE_DIRS})
  check_include_file_cxx(mpi.h VDB_MADF_HAS_MPI)
  unset(CMAKE_REQUIRED_LIBRARIES)
  unset(CMAKE_REQUIRED_INCLUDES)
endif()
if(NOT VDB_MADF_HAS_MPI)
  message(STATUS "vdb_madf_mpi will not be built: no MPI, or VDB_MADF_MPI is off")
endif()
