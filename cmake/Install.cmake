# One export set a room, so that find_package(vdb_madf COMPONENTS core) asks for nothing that the
# other rooms need.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# All that is installed: what to build before `cmake --install`, without the tests.
add_custom_target(vdb_madf_product)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vdb_madf)
set(room_table "")
get_property(rooms GLOBAL PROPERTY vdb_madf_rooms)
foreach(room IN LISTS rooms)
  install(TARGETS vdb_madf_${room} EXPORT vdb_madf_${room}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT vdb_madf_${room} NAMESPACE vdb_madf:: DESTINATION ${package_dir}
    COMPONENT library)
  add_dependencies(vdb_madf_product vdb_madf_${room})
  get_property(uses GLOBAL PROPERTY vdb_madf_${room}_uses)
  get_property(packages GLOBAL PROPERTY vdb_madf_${room}_packages)
  string(APPEND room_table
    "set(_vdb_madf_${room}_uses ${uses})\nset(_vdb_madf_${room}_packages ${packages})\n")
endforeach()
add_dependencies(vdb_madf_product vdb_madf_checked_decompression)
install(TARGETS vdb_madf_checked_decompression EXPORT vdb_madf_checked_decompression
  OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/vdb_madf COMPONENT library)
install(EXPORT vdb_madf_checked_decompression NAMESPACE vdb_madf:: DESTINATION ${package_dir}
  COMPONENT library)

# (A component of its own, so that it is installed on demand where it is not asked for.)
if(VDB_MADF_SHARED)
  set(shared_component library)
  add_dependencies(vdb_madf_product vdb_madf_shared)
else()
  set(shared_component shared EXCLUDE_FROM_ALL)
endif()
install(TARGETS vdb_madf_shared EXPORT vdb_madf_shared
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${shared_component})
install(EXPORT vdb_madf_shared NAMESPACE vdb_madf:: DESTINATION ${package_dir}
  COMPONENT ${shared_component})

configure_package_config_file(cmake/vdb_madfConfig.cmake.in
  ${PROJECT_BINARY_DIR}/vdb_madfConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vdb_madfConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vdb_madfConfig.cmake
  ${PROJECT_BINARY_DIR}/vdb_madfConfigVersion.cmake cmake/FindSerialHDF5.cmake cmake/FindCairo.cmake
  cmake/OpenVDBModule.cmake
  DESTINATION ${package_dir} COMPONENT library)

# For pkg-config: all rooms, each before those that it uses, as static libraries want it. OpenVDB
# has no such file of its own.
set(pkgconfig_rooms "")
foreach(room IN LISTS rooms)
  string(PREPEND pkgconfig_rooms " -lvdb_madf_${room}")
endforeach()
set(pkgconfig_requires "tbb zlib libtiff-4 libpng cairo freetype2 fmt blosc libzstd qhull_r")
if(TARGET Imath::Imath)  # OpenVDB's headers call it
  string(APPEND pkgconfig_requires " Imath")
endif()
if(TARGET SerialHDF5::hdf5)
  string(APPEND pkgconfig_requires " hdf5-serial")
endif()
file(RELATIVE_PATH pkgconfig_prefix
  ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})  # relocatable
# What OpenVDB's headers were compiled with decides how its grids lie in memory.
get_target_property(pkgconfig_definitions OpenVDB::openvdb INTERFACE_COMPILE_DEFINITIONS)
list(TRANSFORM pkgconfig_definitions PREPEND -D)
list(JOIN pkgconfig_definitions " " pkgconfig_definitions)
configure_file(cmake/vdb_madf.pc.in ${PROJECT_BINARY_DIR}/vdb_madf.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/vdb_madf.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT library)

if(TARGET vdb_madf_python)
  add_dependencies(vdb_madf_product vdb_madf_python)
endif()
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR}
  COMPONENT documents)
if(VDB_MADF_BUILD_TOOLS)
  install(TARGETS vdb_madf_tool DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT command)
  add_dependencies(vdb_madf_product vdb_madf_tool vdb_madf_completion)
  if(TARGET vdb_madf_mpi_tool)
    install(TARGETS vdb_madf_mpi_tool DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT mpi)
    add_dependencies(vdb_madf_product vdb_madf_mpi_tool)
  endif()
  set(made ${PROJECT_BINARY_DIR}/tools)
  if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
    set(zsh_functions zsh/vendor-completions)  # Debian's place for what is no part of zsh
  else()
    set(zsh_functions zsh/site-functions)
  endif()
  install(FILES ${made}/completion.bash RENAME vdb_madf COMPONENT command OPTIONAL
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${made}/completion.zsh RENAME _vdb_madf COMPONENT command OPTIONAL
    DESTINATION ${CMAKE_INSTALL_DATADIR}/${zsh_functions})
  install(FILES ${made}/completion.fish RENAME vdb_madf.fish COMPONENT command OPTIONAL
    DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
  if(TARGET vdb_madf_man_pages)
    add_dependencies(vdb_madf_product vdb_madf_man_pages)
  endif()
  install(DIRECTORY ${made}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT command OPTIONAL)
endif()
