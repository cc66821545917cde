// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/write_vdb.h"

#include <cstring>
#include <ios>
#include <ostream>
#include <sstream>

#include "vdb_madf/files/detail/file_buffer.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/detail/parallel_archive.h"
#include "vdb_madf/vdb/detail/region_grid.h"
#include "vdb_madf/vdb/detail/uuid_digest.h"

namespace vdb_madf {

void writeVdb(const std::string& path, const std::vector<openvdb::GridBase::ConstPtr>& grids,
              Interrupter* interrupter) {
  initialize();
  const auto all = detail::withRegionGrid(path, grids);
  detail::OutputStream output(path);
  detail::OutputBuffer buffer(output, interrupter);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
  detail::ParallelArchive().writeAll(stream, all, interrupter);
  buffer.flush();
  detail::VdbSum sum(int64_t(output.size()));
  sum.addRest(
      [&](uint64_t position, char* to, size_t count) { output.readAt(position, to, count); },
      interrupter);
  output.writeAt(detail::kUuidStart, detail::uuidOf(sum).data(), detail::kUuidLength);
  output.commit();
}

std::string vdbBytes(const std::string& name, const std::vector<openvdb::GridBase::ConstPtr>& grids,
                     Interrupter* interrupter) {
  initialize();
  std::ostringstream stream;
  stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
  detail::ParallelArchive().writeAll(stream, detail::withRegionGrid(name, grids), interrupter);
  std::string bytes = stream.str();
  detail::VdbSum sum(int64_t(bytes.size()));
  sum.addRest([&](uint64_t position, char* to,
                  size_t count) { std::memcpy(to, bytes.data() + position, count); },
              interrupter);
  return bytes.replace(detail::kUuidStart, detail::kUuidLength, detail::uuidOf(sum));
}

}  // namespace vdb_madf
