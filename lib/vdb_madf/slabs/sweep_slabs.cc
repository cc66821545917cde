// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/sweep_slabs.h"

#include <set>
#include <string>
#include <utility>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/detail/sweep_rows.h"
#include "vdb_madf/slabs/steps/slab_flaws.h"
#include "vdb_madf/slabs/steps/slab_options.h"
#include "vdb_madf/slabs/steps/slab_remerge.h"

namespace vdb_madf {

namespace {

/// The pieces of one row, upon those that all rows have.
class RowScratch : public Scratch {
 public:
  explicit RowScratch(Scratch& all) : all_(all) {}
  ~RowScratch() override {
    for (const std::string& name : own_) all_.remove(prefixed(name));
  }

  void writeBytes(const std::string& name, const char* bytes, size_t size) override {
    own_.insert(name);
    all_.writeBytes(prefixed(name), bytes, size);
  }
  void readBytes(const std::string& name, const Allocate& allocate) const override {
    all_.readBytes(own_.count(name) ? prefixed(name) : name, allocate);
  }
  bool has(const std::string& name) const override {
    return own_.count(name) > 0 || all_.has(name);
  }
  /// What all rows have stays.
  void remove(const std::string& name) override {
    if (own_.erase(name) > 0) all_.remove(prefixed(name));
  }

 private:
  static std::string prefixed(const std::string& name) { return "row-" + name; }

  Scratch& all_;
  std::set<std::string> own_;
};

}  // namespace

std::vector<SweepRow> mergingSweep(const LabelSlabs& manifolds, const SweepOptions& options,
                                   Scratch& scratch, Interrupter* interrupter) {
  detail::checkSweep(options);
  SegmentOptions how;
  how.tidy = options.tidy;
  const SlabObject object = detail::manifoldObject(manifolds, scratch);
  detail::checkSlabOptions(object, how);
  Team alone;
  {
    detail::SlabWork work(object, how, scratch, alone, interrupter);
    detail::SlabRemerge(manifolds, work).read();
  }
  const auto merged = [&](const MergeOptions& merge) {
    how.merge = merge;
    RowScratch row(scratch);
    detail::SlabWork work(object, how, row, alone, interrupter);
    detail::SlabRemerge remerge(manifolds, work);
    remerge.read();  // it is done
    SlabSegmentation result;
    std::optional<detail::SlabFlaws> flaws;
    remerge.merge(result, [&](size_t, const detail::SlabBody& body, VoxelArray<uint32_t> labels) {
      if (!flaws)
        flaws.emplace(size_t(result.counts.grains), object.cuts, storedDomain(*manifolds.about));
      flaws->add(body.index, std::move(labels), interrupter);
    });
    const LabelFlaws found = flaws ? flaws->finish(result.grainVoxels, interrupter) : LabelFlaws();
    return detail::SweptGrains{std::move(result.grainVoxels), found};
  };
  std::vector<SweepRow> rows;
  detail::addSweepRows(options, options.gammas.front(), merged, rows);
  return rows;
}

}  // namespace vdb_madf
