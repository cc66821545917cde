# One export set a room, so that find_package(vdb_madf COMPONENTS core) asks for nothing that the
# other rooms need.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vdb_madf)
set(room_table "")
get_property(rooms GLOBAL PROPERTY vdb_madf_rooms)
foreach(room IN LISTS rooms)
  install(TARGETS vdb_madf_${room} EXPORT vdb_madf_${room}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT vdb_madf_${room} NAMESPACE vdb_madf:: DESTINATION ${package_dir})
  get_property(uses GLOBAL PROPERTY vdb_madf_${room}_uses)
  get_property(packages GLOBAL PROPERTY vdb_madf_${room}_packages)
  string(APPEND room_table
    "set(_vdb_madf_${room}_uses ${uses})\nset(_vdb_madf_${room}_packages ${packages})\n")
endforeach()
install(TARGETS vdb_madf_checked_decompression EXPORT vdb_madf_checked_decompression
  OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/vdb_madf)
install(EXPORT vdb_madf_checked_decompression NAMESPACE vdb_madf:: DESTINATION ${package_dir})

configure_package_config_file(cmake/vdb_madfConfig.cmake.in
  ${PROJECT_BINARY_DIR}/vdb_madfConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vdb_madfConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vdb_madfConfig.cmake
  ${PROJECT_BINARY_DIR}/vdb_madfConfigVersion.cmake cmake/FindSerialHDF5.cmake
  DESTINATION ${package_dir})
if(VDB_MADF_BUILD_TOOLS)
  install(TARGETS vdb_madf_tool DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
