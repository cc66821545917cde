// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/png_file.h"

#include <stdexcept>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/pictures/detail/png_bytes.h"

namespace vdb_madf {

namespace {

std::string encoded(const std::string& path, const Picture& picture) {
  try {
    return detail::pngBytes(picture);
  } catch (const std::runtime_error& error) {
    throw IoError(path + ": cannot be written: " + error.what());
  }
}

}  // namespace

void writePng(const std::string& path, const Picture& picture) {
  detail::OutputStream file(path);
  file.text(encoded(path, picture));
  file.close();
  file.commit();
}

}  // namespace vdb_madf
