// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <tiffio.h>

#include <exception>
#include <memory>
#include <string>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf::detail {

/// libtiff on a file that is open already; it collects what libtiff has to say instead of printing
/// it. The file has to outlive it.
class TiffHandle {
 public:
  /// @param maxAllocation what libtiff may allocate in one piece, in bytes
  /// @throw IoError
  TiffHandle(const InputFile& file, int64_t maxAllocation);
  /// @throw IoError
  TiffHandle(OutputStream& file, bool bigTiff);
  ~TiffHandle();
  TiffHandle(const TiffHandle&) = delete;
  TiffHandle& operator=(const TiffHandle&) = delete;

  TIFF* get() const { return tiff_; }
  const std::string& path() const { return path_; }
  void close();

  /// @throw IoError with the path, what went wrong, and libtiff's first error; or the one that
  ///   reading or writing ended with
  [[noreturn]] void fail(const std::string& what) const;
  bool warned() const { return !client_->warning.empty(); }
  void forgetMessages();

  template <typename T>
  T field(uint32_t tag, T otherwise) const {
    T value{};
    return TIFFGetField(tiff_, tag, &value) ? value : otherwise;
  }

 private:
  /// What libtiff calls back with: it keeps the address.
  struct Client {
    const InputFile* input = nullptr;
    OutputStream* output = nullptr;
    uint64_t position = 0;
    std::string error, warning;
    std::exception_ptr failure;
  };
  void open(const char* mode, int64_t maxAllocation);
  static tmsize_t read(thandle_t client, void* to, tmsize_t count);
  static tmsize_t write(thandle_t client, void* from, tmsize_t count);
  static toff_t seek(thandle_t client, toff_t offset, int from);
  static toff_t size(thandle_t client);
  static int collect(TIFF*, void* text, const char* module, const char* format, va_list arguments);

  std::string path_;
  std::unique_ptr<Client> client_;
  TIFF* tiff_ = nullptr;
};

}  // namespace vdb_madf::detail
