// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/remerge.h"

#include <iostream>
#include <memory>

#include "command.h"
#include "grid_image.h"
#include "input_options.h"
#include "merge_options.h"
#include "outputs.h"
#include "remerge_slabs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

struct RemergeArguments {
  InputOptions input;
  std::string out;
  MergeArguments merge;
  std::string tidy;
};

/// Finds and tells the strictness of largest stability.
double stableStrictnessOf(const RemergeArguments& o, const Common& common) {
  common.progress->start("strictness");
  const StableStrictness stable = withFileName(o.input.path, [&] {
    return stableStrictness(mergeHierarchy(keptGraph(o.input, common.progress)));
  });
  common.progress->end();
  if (!common.quiet) std::cout << "strictness " << textOf(stable, "  ") << "\n";
  return stable.strictness;
}

void runRemerge(const RemergeArguments& o, const Common& common) {
  MergeOptions merge = o.merge.parse();
  const int tidy = parseTidy(o.tidy);
  if (hasSlabsEnding(o.out)) {
    if (!isInSlabs(o.input))
      throw InvalidInput(o.input.path + ": is no folder of slabs, so none is made of it: choose " +
                         "an output like OUT.vdb, or segment into slabs");
    if (o.merge.isAutomatic()) merge.strictness = stableStrictnessOf(o, common);
    return remergeInSlabs(o.input, o.out, merge, tidy, common);
  }
  checkWritable(o.out);
  if (o.merge.isAutomatic()) merge.strictness = stableStrictnessOf(o, common);
  const auto grids = readVdb(o.input.path, {}, common.progress);
  const Int32Grid::Ptr manifold = requiredManifolds(grids, o.input.path);

  const Int32Grid::Ptr grain =
      withFileName(o.input.path, [&] { return remerge(*manifold, merge, tidy, common.progress); });
  const int64_t grains = *grainCount(*grain);
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o.out, *grain, std::nullopt, o.input.path, common);
    if (!common.quiet) std::cout << o.out << ": " << counted(grains, "grain") << "\n";
    return;
  }
  // Every other grid of the segmentation goes along, told of the new merging.
  std::vector<openvdb::GridBase::ConstPtr> out{grain};
  for (const auto& grid : grids) {
    if (grid->getName() == "grain") continue;
    if (grainCount(*grid)) describeMerging(*grid, merge, tidy, grains);
    out.push_back(grid);
  }
  writeVdb(o.out, out, common.progress);
  common.progress->end();
  if (!common.quiet) std::cout << o.out << ": " << counted(grains, "grain") << "\n";
}

}  // namespace

void addRemerge(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<RemergeArguments>();
  Verb verb = addVerb(command, common, "remerge",
                      "merge stored manifolds anew, without distances and power map",
                      "vdb_madf remerge grains.vdb coarser.vdb --strictness 10");
  verb.option("SEG.vdb", o->input.path, "made by segment with --keep manifold").required();
  verb.option("OUT", o->out,
              "gets the new labels; a .vdb all other grids too; of slabs .slabs, slab by slab")
      .required();
  o->merge.add(verb);
  addTidy(verb, o->tidy);
  verb.onParsed([o, &common, &action] {
    o->merge.parse();
    parseTidy(o->tidy);
    o->input.outputs = {o->out};
    o->input.parse();
    if (!hasSlabsEnding(o->out)) checkVolumeEnding(o->out);
    action = [o, &common] { runRemerge(*o, besideOutput(common, o->out)); };
  });
}

}  // namespace vdb_madf::tools
