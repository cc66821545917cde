// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

#include "support/damage.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"

namespace vdb_madf::test {

/// Opens a volume and reads all of it, eight slices at a time. Empty if it reads or is properly
/// refused: soon, with one line that names the path. Else what is wrong.
/// @param fileBytes of all its files
/// @param expansion how many bytes of samples a byte of the file may stand for
inline std::string complaint(const std::string& path, uint64_t fileBytes, uint64_t expansion,
                             const std::string& dataset = "") {
  std::string message;
  const std::clock_t start = std::clock();
  const auto isSlow = [&] {
    return double(std::clock() - start) > kMaxSeconds * double(CLOCKS_PER_SEC);
  };
  try {
    const auto image = openImage(path, {}, dataset);
    const ImageInfo& info = image->info();
    const uint64_t slice = uint64_t(info.size.x) * uint64_t(info.size.y) * sampleSize(info.type);
    if (slice > expansion * fileBytes) return "claims too much: " + std::to_string(slice);
    const int step = std::min(8, info.size.z);
    std::vector<char> slab(size_t(slice) * size_t(step));
    for (int z = 0; z < info.size.z; z += step)
      image->read(z, std::min(step, info.size.z - z), slab.data());
    return isSlow() ? "takes long" : "";
  } catch (const IoError& error) {
    message = error.what();
  } catch (const InvalidInput& error) {
    message = error.what();
  } catch (const std::exception& error) {
    return std::string("another exception: ") + error.what();
  }
  if (isSlow()) return "is refused late: " + message;
  if (message.find(path) == std::string::npos) return "does not name the file: " + message;
  if (message.find('\n') != std::string::npos) return "more than one line: " + message;
  if (message.size() > 2 * path.size() + 400) return "a long message: " + message;
  return {};
}

}  // namespace vdb_madf::test
