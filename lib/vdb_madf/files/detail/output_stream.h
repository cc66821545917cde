// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/files/output_file.h"

namespace vdb_madf::detail {

/// Bytes in order into an OutputFile; every write is checked, so that a full disk is noticed.
class OutputStream {
 public:
  explicit OutputStream(const std::string& path);
  ~OutputStream();
  OutputStream(const OutputStream&) = delete;
  OutputStream& operator=(const OutputStream&) = delete;

  void write(const void* bytes, size_t count);
  void close();
  /// After close().
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  int descriptor_ = -1;
};

}  // namespace vdb_madf::detail
