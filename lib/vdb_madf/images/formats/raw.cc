// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/raw.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/stored_samples.h"

namespace vdb_madf::detail {

std::unique_ptr<ImageReader> openRaw(std::unique_ptr<InputFile> file, const RawLayout& layout) {
  const std::string path = file->path();
  ImageInfo info;
  info.size = checkedSize(path, {layout.size.x, layout.size.y, layout.size.z});
  info.type = layout.type;
  info.format = "raw";
  SampleLayout samples;
  samples.bigEndian = layout.bigEndian;
  const uint64_t needed = imageBytes(info);
  for (const SampleType other :
       {SampleType::uint8, SampleType::uint16, SampleType::int32, SampleType::float64})
    if (file->size() != needed &&
        file->size() == needed / sampleSize(info.type) * sampleSize(other))
      throw IoError(path + ": has " + std::to_string(file->size()) + " bytes, but " +
                    describe(info) + " takes " + std::to_string(needed) +
                    ": the size fits samples of " + std::to_string(sampleSize(other)) +
                    " bytes: give another type");
  return openSamples(path, info, std::move(file), samples);
}

std::unique_ptr<ImageWriter> createRaw(const std::string& path, const ImageInfo& info) {
  return createSamples(path, info, "");
}

}  // namespace vdb_madf::detail
