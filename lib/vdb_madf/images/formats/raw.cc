// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/stored_samples.h"

namespace vdb_madf::detail {

namespace {

/// The file has to hold `skip` bytes, the samples, and nothing else.
void checkBytes(const InputFile& file, const ImageInfo& info, uint64_t skip) {
  const uint64_t needed = imageBytes(info), size = file.size();
  if (skip <= size && size - skip == needed) return;
  std::string what = file.path() + ": has " + std::to_string(size) + " bytes";
  if (skip > 0) what += ", of which " + std::to_string(skip) + " are to be skipped";
  what += ", but " + describe(info) + " takes " + std::to_string(needed) + ": ";
  for (const SampleType other :
       {SampleType::uint8, SampleType::uint16, SampleType::int32, SampleType::float64})
    if (skip <= size && size - skip == needed / sampleSize(info.type) * sampleSize(other))
      throw IoError(what + "the size fits samples of " + std::to_string(sampleSize(other)) +
                    " bytes: give another type");
  what += "check the size and the sample type";
  if (size > needed) what += ", or skip a header of " + std::to_string(size - needed) + " bytes";
  throw IoError(what, Hint::rawLayout);
}

}  // namespace

std::unique_ptr<ImageReader> openRaw(std::unique_ptr<InputFile> file, const RawLayout& layout) {
  const std::string path = file->path();
  ImageInfo info;
  info.size = checkedSize(path, {layout.size.x, layout.size.y, layout.size.z});
  info.type = layout.type;
  info.format = "raw";
  SampleLayout samples;
  samples.bigEndian = layout.bigEndian;
  samples.offset = layout.skip;
  checkBytes(*file, info, layout.skip);
  return openSamples(path, info, std::move(file), samples);
}

std::unique_ptr<ImageWriter> createRaw(const std::string& path, const ImageInfo& info) {
  return createSamples(path, info, "");
}

}  // namespace vdb_madf::detail
