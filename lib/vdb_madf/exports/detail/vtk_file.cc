// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/vtk_file.h"

#include <fmt/core.h>

#include <utility>

#include "vdb_madf/base/detail/text.h"

namespace vdb_madf::detail {

void VtkFile::addArray(const std::string& vtkType, const std::string& name, int components,
                       uint64_t bytesInFile, Writer write) {
  xml_ += fmt::format(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
      "offset=\"{}\"/>\n",
      vtkType, xmlEscaped(name), components, offset_);
  arrays_.push_back(std::move(write));
  offset_ += bytesInFile;
}

void VtkFile::array(const std::string& vtkType, const std::string& name, int components,
                    uint64_t bytes, Writer write) {
  addArray(vtkType, name, components, sizeof(uint64_t) + bytes,
           [bytes, values = std::move(write)](OutputStream& out) {
             out.value(bytes);
             values(out);
           });
}

void VtkFile::compressedArray(const std::string& vtkType, const std::string& name, int components,
                              Blocks blocks) {
  isCompressed_ = true;
  uint64_t bytes = (3 + blocks.data.size()) * sizeof(uint64_t);
  for (const std::string& block : blocks.data) bytes += block.size();
  addArray(vtkType, name, components, bytes, [blocks = std::move(blocks)](OutputStream& out) {
    out.value(uint64_t(blocks.data.size()));
    out.value(blocks.wholeBytes);
    out.value(blocks.lastBytes == blocks.wholeBytes ? uint64_t(0) : blocks.lastBytes);
    for (const std::string& block : blocks.data) out.value(uint64_t(block.size()));
    for (const std::string& block : blocks.data) out.text(block);
  });
}

void VtkFile::write(const std::string& path, Interrupter* interrupter) const {
  OutputStream out(path, interrupter);
  out.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type_ +
           "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"" +
           (isCompressed_ ? " compressor=\"vtkZLibDataCompressor\"" : "") + ">\n" + xml_ +
           "<AppendedData encoding=\"raw\">\n_");
  for (const Writer& array : arrays_) array(out);
  out.text("\n</AppendedData>\n</VTKFile>\n");
  out.commit();
}

std::string xmlEscaped(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return markupEscaped(text);
}

}  // namespace vdb_madf::detail
