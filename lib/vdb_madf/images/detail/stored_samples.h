// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/images/detail/slice_counter.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// The place of the samples in a file, and how they are coded.
struct SampleLayout {
  uint64_t offset = 0;
  bool atEnd = false;     ///< the last bytes of the file, whatever comes before (not if deflated)
  bool deflated = false;  ///< zlib or gzip from `offset` to the end of the file
  uint64_t skip = 0;      ///< decompressed bytes before the first sample
  bool bigEndian = false;
  uint64_t maxPadding = 0;  ///< at most so many bytes may follow the samples
  bool is64Bit = false;     ///< integers of 64 bits, read as the int32 or uint32 of the info
};

/// Samples of a binary file, for any header that describes them so. The file has to hold exactly
/// what is asked for: a wrong size or type is an error, never a sheared picture.
/// @param path the file the user named: info().path and the messages about the header
/// @param otherFiles files that were read for the header, besides the path and the data
std::unique_ptr<ImageReader> openSamples(const std::string& path, const ImageInfo& info,
                                         std::unique_ptr<InputFile> data,
                                         const SampleLayout& layout,
                                         const std::vector<std::string>& otherFiles = {});

/// Writes one file: a header, then the samples, little-endian.
std::unique_ptr<ImageWriter> createSamples(const std::string& path, const ImageInfo& info,
                                           const std::string& header);

/// ImageWriter::share() of a file that has so many bytes of header, and samples behind them.
std::optional<SharedImage> shareSamples(SliceCounter& counter, OutputStream& out, uint64_t header);

/// "5 x 6 x 7 uint8", for messages.
std::string describe(const ImageInfo& info);

}  // namespace vdb_madf::detail
