# The bytes of a file as a C++ source:
#   cmake -D INPUT=FILE -D OUTPUT=FILE.cc -D NAME=kName -P EmbedFile.cmake
# defines `const unsigned char kName[]` and `const size_t kNameSize` in the namespace
# vdb_madf::detail.
file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUTPUT} "#include <cstddef>
namespace vdb_madf::detail {
extern const unsigned char ${NAME}[];
extern const size_t ${NAME}Size;
const unsigned char ${NAME}[] = {
${bytes}};
const size_t ${NAME}Size = sizeof ${NAME};
}  // namespace vdb_madf::detail
")
