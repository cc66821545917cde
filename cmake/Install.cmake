include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vdb_madf)
install(TARGETS vdb_madf EXPORT vdb_madfTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY lib/vdb_madf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h" PATTERN detail EXCLUDE)
install(EXPORT vdb_madfTargets NAMESPACE vdb_madf:: DESTINATION ${package_dir})
configure_package_config_file(cmake/vdb_madfConfig.cmake.in
  ${PROJECT_BINARY_DIR}/vdb_madfConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vdb_madfConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vdb_madfConfig.cmake
  ${PROJECT_BINARY_DIR}/vdb_madfConfigVersion.cmake DESTINATION ${package_dir})
if(VDB_MADF_BUILD_TOOLS)
  install(TARGETS vdb_madf_tool DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
