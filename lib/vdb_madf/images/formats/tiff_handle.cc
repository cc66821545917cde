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

// These are called from C, too: libtiff gets to know that they failed, and fail() throws what they
// caught.

tmsize_t TiffHandle::read(thandle_t handle, void* to, tmsize_t count) {
  Client& client = *static_cast<Client*>(handle);
  try {
    const size_t got = client.input ? client.input->readSome(client.position, to, size_t(count))
                                    : client.output->readAt(client.position, to, size_t(count));
    client.position += got;
    return tmsize_t(got);
  } catch (const std::exception&) {
    client.failure = std::current_exception();
    return -1;
  }
}

tmsize_t TiffHandle::write(thandle_t handle, void* from, tmsize_t count) {
  Client& client = *static_cast<Client*>(handle);
  if (!client.output) return -1;
  try {
    client.output->writeAt(client.position, from, size_t(count));
    client.position += uint64_t(count);
    return count;
  } catch (const std::exception&) {
    client.failure = std::current_exception();
    return -1;
  }
}

toff_t TiffHandle::seek(thandle_t handle, toff_t offset, int from) {
  Client& client = *static_cast<Client*>(handle);
  const toff_t origin = from == SEEK_CUR ? client.position : from == SEEK_END ? size(handle) : 0;
  return client.position = origin + offset;
}

toff_t TiffHandle::size(thandle_t handle) {
  const Client& client = *static_cast<Client*>(handle);
  return client.input ? client.input->size() : client.output->size();
}

TiffHandle::TiffHandle(const InputFile& file, int64_t maxAllocation)
    : path_(file.name()), client_(std::make_unique<Client>()) {
  client_->input = &file;
  // No memory mapping: a file that shrinks meanwhile would be a SIGBUS.
  open("rm", maxAllocation);
}

TiffHandle::TiffHandle(OutputStream& file, bool bigTiff)
    : path_(file.path()), client_(std::make_unique<Client>()) {
  client_->output = &file;
  open(bigTiff ? "w8" : "w", 0);
}

void TiffHandle::open(const char* mode, int64_t maxAllocation) {
  client_->error.reserve(200);
  client_->warning.reserve(200);
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                             TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), collect, &client_->error);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), collect, &client_->warning);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), tmsize_t(maxAllocation));
  const auto leaveOpen = [](thandle_t) { return 0; };
  tiff_ = TIFFClientOpenExt(path_.c_str(), mode, client_.get(), read, write, seek, leaveOpen, size,
                            nullptr, nullptr, options.get());
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
  if (client_->failure) std::rethrow_exception(client_->failure);
  throw IoError(path_ + ": " + what +
                (client_->error.empty() ? std::string() : " (" + client_->error + ")"));
}

void TiffHandle::forgetMessages() {
  client_->error.clear();
  client_->warning.clear();
}

}  // namespace vdb_madf::detail
