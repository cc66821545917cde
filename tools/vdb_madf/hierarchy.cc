// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/hierarchy.h"

#include <cstdio>
#include <memory>
#include <sstream>
#include <vector>

#include "command.h"
#include "input_options.h"
#include "outputs.h"
#include "remerge_slabs.h"
#include "text_file.h"
#include "vdb_madf/base/counted.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"

namespace vdb_madf::tools {

namespace {

struct HierarchyArguments {
  InputOptions input;
  std::string out;
};

/// The graph of the kept manifolds. The voxels of one file are not read.
ManifoldGraph keptGraph(const InputOptions& input, Progress* progress) {
  if (isInSlabs(input)) {
    const LabelSlabs manifolds = openManifoldSlabs(input, progress);
    std::vector<GraphPart> parts;
    for (size_t slab = 0; slab < manifolds.slabCount(); ++slab)
      if (auto part = storedGraphPart(*manifolds.read(slab, progress)))
        parts.push_back(std::move(*part));
    return joinedGraph(parts);
  }
  return requiredGraph(*requiredManifolds(readVdbHeaders(input.path, progress), input.path));
}

std::string table(const ManifoldGraph& graph, const std::vector<JoinedGrains>& joins) {
  std::ostringstream csv;
  csv.precision(12);
  csv << "join,score,strictness,grains,first,first_x,first_y,first_z,first_voxels,second,second_x,"
         "second_y,second_z,second_voxels\n";
  const auto side = [&](uint32_t node, int64_t voxels) {
    const Coord& at = graph.nodes[node].position;
    csv << ',' << node + 1 << ',' << at.x() << ',' << at.y() << ',' << at.z() << ',' << voxels;
  };
  for (size_t i = 0; i < joins.size(); ++i) {
    const JoinedGrains& join = joins[i];
    csv << i + 1 << ',' << join.score << ',' << join.strictness << ',' << join.grains;
    side(join.first, join.firstVoxels);
    side(join.second, join.secondVoxels);
    csv << '\n';
  }
  return csv.str();
}

void runHierarchy(const HierarchyArguments& o, const Common& common) {
  TextFile csv(o.out);
  common.progress->start("read");
  const ManifoldGraph graph =
      withFileName(o.input.path, [&] { return keptGraph(o.input, common.progress); });
  common.progress->start("join");
  const std::vector<JoinedGrains> joins = joinedGrains(mergeHierarchy(graph));
  csv.write(table(graph, joins));
  common.progress->end();
  if (!common.quiet)
    std::printf("%s: %s of %s\n", o.out.c_str(), counted(int64_t(joins.size()), "join").c_str(),
                counted(int64_t(graph.nodes.size()), "manifold").c_str());
}

}  // namespace

void addHierarchy(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<HierarchyArguments>();
  Verb verb = addVerb(command, common, "hierarchy",
                      "the sequence of joins that --merge score cuts: what, at which score",
                      "vdb_madf hierarchy grains.vdb joins.csv");
  verb.option("SEG.vdb", o->input.path, "made by segment with --keep manifold").required();
  verb.option("OUT.csv", o->out, "a line per join, the best first").required();
  verb.onParsed([o, &common, &action] {
    o->input.outputs = {o->out};
    o->input.parse();
    checkTableEnding(o->out);
    action = [o, &common] { runHierarchy(*o, besideOutput(common, o->out)); };
  });
}

}  // namespace vdb_madf::tools
