# Debian packages by CPack, one for each component of the installation: the command, the library
# and, if it is built, the Python package. tools/release makes them.
get_cmake_property(CPACK_COMPONENTS_ALL COMPONENTS)
list(REMOVE_ITEM CPACK_COMPONENTS_ALL documents shared Unspecified)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME vdb-madf)
set(CPACK_PACKAGE_CONTACT "The vdb_madf authors <vdb_madf@invalid.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(VDB_MADF_PACKAGE_RELEASE 1 CACHE STRING
  "The part of a package's version that names the release it is made for")
set(CPACK_DEBIAN_PACKAGE_RELEASE ${VDB_MADF_PACKAGE_RELEASE})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)  # xz takes a minute for the library

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME vdb-madf)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_COMMAND_DESCRIPTION "separate the grains of granular microstructures
The command vdb_madf takes a scan of snow, sintered balls or other touching
grains from micro-tomography, gray or segmented, and cuts it into grains at
their necks. It measures grains and bonds, and exports labels, meshes and
networks. Labels are sparse OpenVDB grids.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libvdb-madf-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
string(JOIN ", " CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS libopenvdb-dev libtbb-dev libtiff-dev
  libpng-dev libcairo2-dev libfmt-dev
  libblosc-dev libzstd-dev libboost-iostreams-dev libqhull-dev zlib1g-dev)
if(TARGET SerialHDF5::hdf5)
  string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", libhdf5-dev")
endif()
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "separate grains: static library and headers
What the command vdb_madf does, for C++ programs: the medial-axis digital flow
on sparse OpenVDB grids, measures, meshes and files. With CMake:
find_package(vdb_madf).")

set(package_components command library)
if(TARGET vdb_madf_python)
  list(APPEND package_components python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-vdb-madf)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  get_property(minor GLOBAL PROPERTY vdb_madf_interpreter_minor)  # a module is made for one version
  math(EXPR next_minor "${minor} + 1")
  string(JOIN ", " CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${minor})"
    "python3 (<< 3.${next_minor})" python3-numpy)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-pandas, python3-tqdm")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "separate grains: Python package
What the command vdb_madf does, for numpy arrays and for files: sparse masks
and labels that are read like arrays, grains, bonds, meshes.")
endif()

# What each package has to say of its origin. (EXCLUDE_FROM_ALL: other installations have LICENSE.)
string(TIMESTAMP release_date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # or SOURCE_DATE_EPOCH
foreach(component IN LISTS package_components)
  string(TOUPPER ${component} name)
  set(package ${CPACK_DEBIAN_${name}_PACKAGE_NAME})
  set(folder ${PROJECT_BINARY_DIR}/packages/${package})
  configure_file(cmake/debian_changelog.in ${folder}/changelog.Debian @ONLY)
  configure_file(CHANGELOG.md ${folder}/changelog COPYONLY)
  execute_process(COMMAND gzip -9nf changelog changelog.Debian WORKING_DIRECTORY ${folder}
    COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${folder}/changelog.gz ${folder}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES cmake/debian_copyright RENAME copyright
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
install(FILES README.md CITATION.cff
  DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/vdb-madf COMPONENT command EXCLUDE_FROM_ALL)

include(CPack)
