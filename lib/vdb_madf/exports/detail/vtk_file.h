// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf::detail {

/// A VTK XML file with its arrays appended, raw (little-endian, UInt64 lengths):
/// text and arrays in the order of the file, then the values.
class VtkFile {
 public:
  using Writer = std::function<void(OutputStream&)>;

  /// \p type: "PolyData", "UnstructuredGrid" ...
  explicit VtkFile(std::string type) : type_(std::move(type)) {}

  void xml(const std::string& text) { xml_ += text; }
  /// \p vtkType: "Int32" ...; \p write puts `bytes` bytes when the file is written.
  void array(const std::string& vtkType, const std::string& name, int components, uint64_t bytes,
             Writer write);
  /// Deflated (zlib) pieces of an array, each of `wholeBytes` before, the last of `lastBytes`. Then
  /// all arrays of the file must be deflated.
  struct Blocks {
    uint64_t wholeBytes = 0, lastBytes = 0;
    std::vector<std::string> data;
  };
  void compressedArray(const std::string& vtkType, const std::string& name, int components,
                       Blocks blocks);
  /// @throw IoError; Interrupted
  void write(const std::string& path, Interrupter* interrupter) const;

 private:
  void addArray(const std::string& vtkType, const std::string& name, int components,
                uint64_t bytesInFile, Writer write);

  bool isCompressed_ = false;
  std::string type_, xml_;
  std::vector<Writer> arrays_;
  uint64_t offset_ = 0;
};

/// Text that XML may hold between quotes.
std::string xmlEscaped(std::string text);

}  // namespace vdb_madf::detail
