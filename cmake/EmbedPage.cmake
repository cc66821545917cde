# Writes the parts of a page, HTML, STYLE and SCRIPT, into the C++ source OUT. A literal is limited
# by some compilers, so each part is several that follow one another.
set(text
  "// Made by cmake/EmbedPage.cmake.\n#include \"vdb_madf/report/detail/page_sources.h\"\n\n")
string(APPEND text "namespace vdb_madf::detail {\n\nnamespace {\n\n")
foreach(part HTML STYLE SCRIPT)
  file(READ ${${part}} content)
  string(LENGTH "${content}" length)
  string(TOLOWER ${part} name)
  string(APPEND text "const char ${name}[] =")
  foreach(begin RANGE 0 ${length} 8000)
    string(SUBSTRING "${content}" ${begin} 8000 piece)
    string(APPEND text "\nR\"page~(${piece})page~\"")
  endforeach()
  string(APPEND text ";\n\n")
endforeach()
string(APPEND text "const PageSources kSources{html, style, script};\n\n}  // namespace\n\n")
string(APPEND text
  "const PageSources* pageSources() {\n  return &kSources;\n}\n\n"
  "}  // namespace vdb_madf::detail\n")
file(WRITE ${OUT} "${text}")
