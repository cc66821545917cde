# The page of `report` as a source file: the modules in lib/vdb_madf/report/page with three.js,
# jQuery and DataTables, bundled by esbuild. Debian's packages have all four; without them there is
# no page.
option(VDB_MADF_REPORT "Write reports if esbuild, three.js, jQuery and DataTables are found" ON)
find_program(VDB_MADF_ESBUILD esbuild)
set(javascript /usr/share/javascript)
find_file(VDB_MADF_THREE three/build/three.module.js PATHS ${javascript} NO_DEFAULT_PATH)
find_file(VDB_MADF_JQUERY jquery/jquery.js PATHS ${javascript} NO_DEFAULT_PATH)
find_file(VDB_MADF_DATATABLES jquery-datatables/jquery.dataTables.mjs PATHS ${javascript}
  NO_DEFAULT_PATH)
mark_as_advanced(VDB_MADF_ESBUILD VDB_MADF_THREE VDB_MADF_JQUERY VDB_MADF_DATATABLES)

# Sets `result` to the source file with pageSources().
function(vdb_madf_report_page result)
  set(folder ${CMAKE_CURRENT_SOURCE_DIR}/vdb_madf/report)
  if(NOT (VDB_MADF_REPORT AND VDB_MADF_ESBUILD AND VDB_MADF_THREE AND VDB_MADF_JQUERY
      AND VDB_MADF_DATATABLES))
    message(STATUS
      "Reports will not be written: no esbuild, libjs-three or libjs-jquery-datatables, "
      "or VDB_MADF_REPORT is off")
    set(${result} ${folder}/detail/no_page_sources.cc PARENT_SCOPE)
    return()
  endif()
  file(GLOB modules CONFIGURE_DEPENDS ${folder}/page/*)
  set(made ${CMAKE_CURRENT_BINARY_DIR}/report)
  add_custom_command(OUTPUT ${made}/page_sources.cc VERBATIM
    DEPENDS ${modules} ${PROJECT_SOURCE_DIR}/cmake/EmbedPage.cmake
    COMMAND ${VDB_MADF_ESBUILD} ${folder}/page/main.js ${folder}/page/page.css --outdir=${made}
      --bundle --minify --target=es2020 --format=iife --legal-comments=none --log-level=warning
      --alias:three=${VDB_MADF_THREE} --alias:jquery=${VDB_MADF_JQUERY}
      --alias:datatables=${VDB_MADF_DATATABLES}
    COMMAND ${CMAKE_COMMAND} -DHTML=${folder}/page/page.html -DSTYLE=${made}/page.css
      -DSCRIPT=${made}/main.js -DOUT=${made}/page_sources.cc
      -P ${PROJECT_SOURCE_DIR}/cmake/EmbedPage.cmake)
  set(${result} ${made}/page_sources.cc PARENT_SCOPE)
endfunction()
