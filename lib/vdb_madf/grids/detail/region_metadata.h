// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/MetaMap.h>
#include <openvdb/Metadata.h>

#include <memory>
#include <utility>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Key of a domain that is a region, and the name of the grid that holds its voxels in a file.
inline constexpr char kRegionKey[] = "madf_region";
inline constexpr char kRegionGrid[] = "region";

/// The region of a grid's domain. A file gets the name of the grid with its voxels, as text, and
/// that grid beside it: readVdb() puts them together again.
class RegionMetadata : public openvdb::StringMetadata {
 public:
  explicit RegionMetadata(std::shared_ptr<const MaskTree> region)
      : openvdb::StringMetadata(kRegionGrid), region_(std::move(region)) {}
  openvdb::Metadata::Ptr copy() const override { return std::make_shared<RegionMetadata>(region_); }
  const std::shared_ptr<const MaskTree>& region() const { return region_; }

 private:
  std::shared_ptr<const MaskTree> region_;
};

/// The region among the metadata; null if there is none, or its voxels were not read with it.
inline std::shared_ptr<const MaskTree> regionOf(const openvdb::MetaMap& metadata) {
  const openvdb::Metadata::ConstPtr named = metadata[kRegionKey];
  const auto* region = dynamic_cast<const RegionMetadata*>(named.get());
  return region ? region->region() : nullptr;
}

}  // namespace vdb_madf::detail
