// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <tiffio.h>

#include <memory>
#include <string>

namespace vdb_madf::detail {

/// An open libtiff file that collects what libtiff has to say instead of printing it.
class TiffHandle {
 public:
  /// @param shownPath the name in messages: not a temporary one
  /// @param mostAllocation what libtiff may allocate in one piece; 0: no limit
  /// @throw IoError
  TiffHandle(const std::string& path, const std::string& shownPath, const char* mode,
             int64_t mostAllocation);
  ~TiffHandle();
  TiffHandle(const TiffHandle&) = delete;
  TiffHandle& operator=(const TiffHandle&) = delete;

  TIFF* get() const { return tiff_; }
  const std::string& path() const { return path_; }
  void close();

  /// @throw IoError with the path, what went wrong, and libtiff's first error.
  [[noreturn]] void fail(const std::string& what) const;
  bool warned() const { return !messages_->warning.empty(); }
  void forgetMessages();

  template <typename T>
  T field(uint32_t tag, T otherwise) const {
    T value{};
    return TIFFGetField(tiff_, tag, &value) ? value : otherwise;
  }

 private:
  struct Messages {  // libtiff keeps its address
    std::string error, warning;
  };
  static int collect(TIFF*, void* text, const char* module, const char* format, va_list arguments);

  std::string path_;
  std::unique_ptr<Messages> messages_;
  TIFF* tiff_ = nullptr;
};

}  // namespace vdb_madf::detail
