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
