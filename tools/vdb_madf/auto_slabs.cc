// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "auto_slabs.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "grid_image.h"
#include "outputs.h"
#include "slab_output.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/files/standard_streams.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

std::string slabsOf(const SegmentArguments& o) {
  return o.out + ".slabs";
}

void joinSlabs(const SegmentArguments& o, const Common& common) {
  if (hasVdbEnding(o.out)) {
    const auto grids = readVdb(slabsOf(o), {}, common.progress);
    writeVdb(o.out, {grids.begin(), grids.end()}, common.progress);
    return;
  }
  Common silent = common;
  silent.quiet = true;
  InputOptions slabs;
  slabs.path = slabsOf(o);
  writeSlabsAsImage(o.out, openLabelSlabs(slabs, "--grid", common.progress), std::nullopt,
                    o.input.path, silent);
}

}  // namespace

bool couldBeInSlabs(const SegmentArguments& o) {
  return !o.segment.keepDistance && !o.segment.keepPower && !o.segment.keepBalls &&
         o.tables.empty() && !o.dryRun && !isOnStandardOutput(o.out);
}

bool isSurelyForSlabs(const SegmentArguments& o) {
  if (isVdb(o.input) || isStandardInput(o.input.path)) return false;
  VolumeOptions options = o.input.volume(nullptr);
  options.note = nullptr;
  const ImageSize size = openVolumeImage(o.input.path, options)->info().size;
  if (std::max({size.x, size.y, size.z}) > kMaxExtent) return true;
  const int64_t memory = o.maxMemory.empty() ? availableMemory() : o.segment.maxMemory;
  return memory > 0 && double(size.x) * size.y * size.z / 8 > double(memory) / 2;
}

InvalidInput withSlabsAdvice(const SegmentArguments& o, const InvalidInput& error) {
  return InvalidInput(fmt::format(
      "{} (--max-memory), or work in slabs, which need not fit together: {}.slabs, or --auto-slabs "
      "for one file",
      error.what(), o.out.empty() ? "OUT" : o.out));
}

void runAutoSlabs(const SegmentArguments& o, const Common& common) {
  SegmentArguments inSlabs = o;
  inSlabs.out = slabsOf(o);
  inSlabs.fileOfSlabs = o.out;
  std::error_code ignored;
  checkWritable(o.out);
  if (std::filesystem::exists(inSlabs.out, ignored))
    throw IoError(inSlabs.out + ": is there, and slabs are to be made there: convert or remove it");
  common.progress->note(o.input.path + ": does not fit in memory as a whole: works in slabs");
  runInSlabs(inSlabs, common);
  try {
    joinSlabs(o, common);
  } catch (...) {
    common.progress->end();
    common.progress->note("the labels are kept in slabs: " + inSlabs.out);
    throw;
  }
  common.progress->end();
  std::filesystem::remove_all(inSlabs.out, ignored);
}

}  // namespace vdb_madf::tools
