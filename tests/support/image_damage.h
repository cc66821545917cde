// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <ctime>
#include <filesystem>
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
/// @param content gets what was read, if anything was: size, type and samples
inline std::string complaint(const std::string& path, uint64_t fileBytes, uint64_t expansion,
                             const std::string& dataset = "", std::string* content = nullptr) {
  if (content) content->clear();
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
    std::string samples;
    for (int z = 0; z < info.size.z; z += step) {
      const int count = std::min(step, info.size.z - z);
      image->read(z, count, slab.data());
      if (content) samples.append(slab.data(), size_t(slice) * size_t(count));
    }
    if (content)
      *content = sampleTypeName(info.type) + " " + std::to_string(info.size.x) + " " +
                 std::to_string(info.size.y) + " " + std::to_string(info.size.z) + " " + samples;
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

/// Cuts a file of a volume at every byte of its header and of its last 4 KiB, or at every
/// `step`-th. Empty if the volume is then refused, or read with all its samples. Else what is
/// wrong. The file is gone afterwards.
inline std::string complaintOfCuts(const std::string& path, const std::string& file,
                                   size_t headerBytes, uint64_t expansion, size_t step = 1,
                                   const std::string& dataset = "") {
  constexpr size_t kEnd = 4096;
  const size_t bytes = std::filesystem::file_size(file);
  std::string whole, content;
  std::string wrong = complaint(path, bytes, expansion, dataset, &whole);
  if (whole.empty()) return "cannot be read when it is whole: " + wrong;
  for (size_t length = bytes; length-- > 0;) {
    if ((length >= headerBytes && length + kEnd < bytes) || length % step != 0) continue;
    std::filesystem::resize_file(file, length);
    wrong = complaint(path, bytes, expansion, dataset, &content);
    if (!content.empty() && content != whole) wrong = "reads as something else";
    if (!wrong.empty()) return "cut to " + std::to_string(length) + " bytes: " + wrong;
  }
  std::filesystem::remove(file);
  return {};
}

}  // namespace vdb_madf::test
