// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/tiff_handle.h"

#include <cstdarg>
#include <cstdio>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

int TiffHandle::collect(TIFF*, void* text, const char*, const char* format, va_list arguments) {
  // Called from C: nothing may be thrown, so the strings are reserved in advance.
  std::string& message = *static_cast<std::string*>(text);
  char line[160];
  if (message.empty() && std::vsnprintf(line, sizeof line, format, arguments) > 0) {
    for (char* c = line; *c; ++c)
      if (static_cast<unsigned char>(*c) < ' ' || *c == 127) *c = ' ';
    message = line;
  }
  return 1;  // handled: libtiff's global handler, which prints, is not called
}

TiffHandle::TiffHandle(const std::string& path, const std::string& shownPath, const char* mode,
                       int64_t mostAllocation)
    : path_(shownPath), messages_(std::make_unique<Messages>()) {
  messages_->error.reserve(200);
  messages_->warning.reserve(200);
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                             TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), collect, &messages_->error);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), collect, &messages_->warning);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), tmsize_t(mostAllocation));
  tiff_ = TIFFOpenExt(path.c_str(), mode, options.get());
  if (!tiff_) fail("cannot be opened as TIFF");
}

TiffHandle::~TiffHandle() {
  close();
}

void TiffHandle::close() {
  if (tiff_) TIFFClose(tiff_);
  tiff_ = nullptr;
}

void TiffHandle::fail(const std::string& what) const {
  throw IoError(path_ + ": " + what +
                (messages_->error.empty() ? std::string() : " (" + messages_->error + ")"));
}

void TiffHandle::forgetMessages() {
  messages_->error.clear();
  messages_->warning.clear();
}

}  // namespace vdb_madf::detail
