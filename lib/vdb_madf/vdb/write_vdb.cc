// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/write_vdb.h"

#include <array>
#include <cstdio>
#include <ios>
#include <ostream>

#include "vdb_madf/files/detail/file_buffer.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/detail/parallel_archive.h"
#include "vdb_madf/vdb/detail/region_grid.h"
#include "vdb_madf/vdb/detail/uuid_place.h"

namespace vdb_madf {

namespace {

/// In the form of a UUID of version 8 (RFC 9562: contents defined by the application).
std::string uuidFrom(const std::array<uint64_t, 2>& hash) {
  const uint64_t high = (hash[0] & ~uint64_t(0xf000)) | 0x8000;
  const uint64_t low = (hash[1] & ~(uint64_t(3) << 62)) | uint64_t(1) << 63;
  char text[detail::kUuidLength + 1];
  std::snprintf(text, sizeof(text), "%08x-%04x-%04x-%04x-%012llx", unsigned(high >> 32),
                unsigned(high >> 16 & 0xffff), unsigned(high & 0xffff), unsigned(low >> 48),
                static_cast<unsigned long long>(low & 0xffffffffffffu));
  return text;
}

}  // namespace

void writeVdb(const std::string& path, const std::vector<openvdb::GridBase::ConstPtr>& grids,
              Interrupter* interrupter) {
  initialize();
  const auto all = detail::withRegionGrid(path, grids);
  detail::OutputStream output(path);
  detail::OutputBuffer buffer(output, interrupter, detail::kUuidStart, detail::kUuidLength);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
  detail::ParallelArchive().writeAll(stream, all, interrupter);
  buffer.flush();
  buffer.replace(detail::kUuidStart, uuidFrom(buffer.hash()));
  output.commit();
}

}  // namespace vdb_madf
