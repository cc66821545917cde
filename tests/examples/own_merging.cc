// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// A rule of one's own for what is one grain: the slow part is done and stored once, then any rule
// cuts the same object anew in little time.

#include <algorithm>
#include <iostream>
#include <numeric>

#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/segmentation/remerge.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"

int main() {
  vdb_madf::initialize();
  vdb_madf::SinteredOptions sample;
  sample.size = {96, 96, 96};
  sample.count = 16;

  // Today: the pieces that grains are made of, and the graph of how they touch, are kept in a file.
  vdb_madf::SegmentOptions options;
  options.keepManifold = true;
  const auto cut = vdb_madf::segment(*vdb_madf::generateSintered(sample).object, options);
  vdb_madf::writeVdb("pieces.vdb", {cut.manifold});

  // Tomorrow: they are read, and need no scan any more.
  const auto pieces =
      openvdb::gridPtrCast<vdb_madf::Int32Grid>(vdb_madf::readVdb("pieces.vdb").front());
  const vdb_madf::ManifoldGraph graph = vdb_madf::requiredGraph(*pieces);

  // The rule: two pieces are one grain if they share more voxel faces than half the great circle of
  // the smaller one's largest ball has. Each class of pieces is named by one of them.
  std::vector<uint32_t> classes(graph.nodes.size());
  std::iota(classes.begin(), classes.end(), 0u);
  for (const auto& edge : graph.edges) {
    const double squaredRadius =
        std::min(graph.nodes[edge.first].squaredRadius, graph.nodes[edge.second].squaredRadius);
    if (double(edge.contactFaces) > 3.14159 * squaredRadius / 2)
      std::replace(classes.begin(), classes.end(), uint32_t(classes[edge.second]),
                   uint32_t(classes[edge.first]));
  }

  // From classes to labels, which are those of all pieces again.
  const vdb_madf::Merging merging = vdb_madf::mergeClasses(graph, classes);
  const auto grain = vdb_madf::applyMerging(*pieces, merging);
  std::cout << graph.nodes.size() << " pieces; " << cut.counts.grains
            << " grains by angle and neck, " << merging.representative.size()
            << " by the contact alone\n";
  return grain->activeVoxelCount() == cut.grain->activeVoxelCount() ? 0 : 1;
}
