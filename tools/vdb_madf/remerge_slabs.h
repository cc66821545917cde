// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "command.h"
#include "input_options.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/slabs/folder_scratch.h"
#include "vdb_madf/vdb/read_vdb.h"

namespace vdb_madf::tools {

constexpr char kManifoldGrid[] = "manifold";

/// Reads the manifolds alone, and the region that is their domain; voxels of any shape.
VdbReadOptions manifoldsAlone();
/// The manifolds among the grids of a file; null if there are none.
Int32Grid::Ptr manifoldsAmong(const std::vector<openvdb::GridBase::Ptr>& grids);
/// The manifolds among the grids of the file `path`. @throw InvalidInput if there are none
Int32Grid::Ptr requiredManifolds(const std::vector<openvdb::GridBase::Ptr>& grids,
                                 const std::string& path);
/// Opens the manifolds in a folder of slabs. @throw InvalidInput if it has none
LabelSlabs openManifoldSlabs(const InputOptions& input, Progress* progress);
/// The graph of the kept manifolds, in one file, of which no voxels are read unless the domain is a
/// region, or in slabs.
/// @throw InvalidInput if there are none
ManifoldGraph keptGraph(const InputOptions& input, Progress* progress);

/// What `remerge` does from a folder of slabs to another one, slab by slab; OUT.slabs appears
/// whole.
void remergeInSlabs(const InputOptions& input, const std::string& out, const MergeOptions& merge,
                    int tidy, const Common& common);

/// Scratch data in a folder, which goes again. What a killed run left in it is no use, and goes
/// first.
class ScratchFolder {
 public:
  /// @throw as FolderScratch
  explicit ScratchFolder(const std::string& path);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  Scratch& scratch() { return scratch_; }

 private:
  FolderScratch scratch_;
};

}  // namespace vdb_madf::tools
