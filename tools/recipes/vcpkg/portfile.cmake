# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
#
# A port for vcpkg. What OWNER and the zeros stand for is known once there is a release:
# tools/manual/packages.md.
string(REPEAT 0 128 no_release)
vcpkg_check_linkage(ONLY_STATIC_LIBRARY)
vcpkg_download_distfile(ARCHIVE
  URLS "https://OWNER.invalid/vdb_madf-${VERSION}.tar.gz"
  FILENAME "vdb_madf-${VERSION}.tar.gz"
  SHA512 ${no_release}
)
vcpkg_download_distfile(FONT
  URLS "https://OWNER.invalid/OpenSans-Regular.ttf"
  FILENAME "OpenSans-Regular.ttf"
  SHA512 ${no_release}
)
vcpkg_extract_source_archive(SOURCE_PATH ARCHIVE "${ARCHIVE}")
vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS FEATURES hdf5 VDB_MADF_HDF5)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${FEATURE_OPTIONS}
    -DVDB_MADF_BUILD_TESTS=OFF
    -DVDB_MADF_MPI=OFF
    "-DVDB_MADF_FONT=${FONT}"
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME vdb_madf CONFIG_PATH lib/cmake/vdb_madf)
vcpkg_fixup_pkgconfig()
vcpkg_copy_tools(TOOL_NAMES vdb_madf AUTO_CLEAN)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
