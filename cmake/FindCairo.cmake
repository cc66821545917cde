# Cairo with its fonts of FreeType: Cairo::cairo. (CMake has no module of its own.)
find_package(Freetype QUIET)
find_path(Cairo_INCLUDE_DIR cairo-ft.h PATH_SUFFIXES cairo)
find_library(Cairo_LIBRARY NAMES cairo)
mark_as_advanced(Cairo_INCLUDE_DIR Cairo_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Cairo
  REQUIRED_VARS Cairo_LIBRARY Cairo_INCLUDE_DIR Freetype_FOUND)
if(Cairo_FOUND AND NOT TARGET Cairo::cairo)
  add_library(Cairo::cairo UNKNOWN IMPORTED)
  set_target_properties(Cairo::cairo PROPERTIES
    IMPORTED_LOCATION ${Cairo_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${Cairo_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES Freetype::Freetype)
endif()
