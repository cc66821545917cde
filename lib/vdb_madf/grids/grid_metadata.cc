// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/grid_metadata.h"

#include <openvdb/Metadata.h>
#include <openvdb/math/Maps.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/detail/region_metadata.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/object_keys.h"

namespace vdb_madf {

namespace {

constexpr char kDomainMin[] = "madf_domain_min";
constexpr char kDomainMax[] = "madf_domain_max";
constexpr char kLengthUnit[] = "madf_length_unit";

}  // namespace

std::optional<Domain> storedDomain(const openvdb::MetaMap& metadata) {
  const auto lower = metadata.getMetadata<openvdb::Vec3IMetadata>(kDomainMin);
  const auto upper = metadata.getMetadata<openvdb::Vec3IMetadata>(kDomainMax);
  if (!lower && !upper) return std::nullopt;
  if (!lower || !upper)
    throw InvalidInput("metadata has only one of madf_domain_min and madf_domain_max");
  const CoordBBox box{Coord(lower->value()), Coord(upper->value())};
  if (box.empty()) throw InvalidInput("metadata madf_domain_min exceeds madf_domain_max");
  for (int axis = 0; axis < 3; ++axis)
    if (box.min()[axis] < -kMaxCoordinate || box.max()[axis] > kMaxCoordinate)
      throw InvalidInput("metadata madf_domain_min or madf_domain_max lies beyond +-" +
                         std::to_string(kMaxCoordinate));
  const std::string name = regionName(metadata);
  if (name.empty()) return box;
  const auto region = detail::regionOf(metadata);
  if (!region)
    throw InvalidInput("the domain is the region in grid '" + name +
                       "', which was not read with it: keep them in one file");
  return Domain(region, box);
}

void setDomain(openvdb::MetaMap& metadata, const Domain& domain) {
  metadata.insertMeta(kDomainMin, openvdb::Vec3IMetadata(domain.box().min().asVec3i()));
  metadata.insertMeta(kDomainMax, openvdb::Vec3IMetadata(domain.box().max().asVec3i()));
  metadata.removeMeta(detail::kRegionKey);
  if (!domain.isBox())
    metadata.insertMeta(detail::kRegionKey, detail::RegionMetadata(domain.region()));
}

CoordBBox boxOf(const openvdb::GridBase& grid) {
  const auto domain = storedDomain(grid);
  return domain ? domain->box() : grid.evalActiveVoxelBoundingBox();
}

std::string regionName(const openvdb::MetaMap& metadata) {
  const openvdb::Metadata::ConstPtr named = metadata[detail::kRegionKey];
  return named ? named->str() : std::string();
}

bool isRegion(const openvdb::GridBase& grid, const std::vector<openvdb::GridBase::Ptr>& grids) {
  return std::any_of(grids.begin(), grids.end(), [&](const openvdb::GridBase::Ptr& other) {
    const std::string name = regionName(*other);
    return other.get() != &grid && !name.empty() && name == grid.getName();
  });
}

std::optional<VoxelSize> storedVoxelSize(const openvdb::MetaMap& metadata) {
  const auto isLength = [](double meters) { return meters > 0; };
  if (const auto cube = metadata.getMetadata<openvdb::DoubleMetadata>(kVoxelSizeKey))
    return isLength(cube->value()) ? std::optional(VoxelSize(cube->value())) : std::nullopt;
  const auto meters = metadata.getMetadata<openvdb::Vec3DMetadata>(kVoxelEdgesKey);
  if (!meters) return std::nullopt;
  const std::array<double, 3> edges{meters->value().x(), meters->value().y(), meters->value().z()};
  if (!std::all_of(edges.begin(), edges.end(), isLength)) return std::nullopt;
  return VoxelSize(edges);
}

void setStoredVoxelSize(openvdb::MetaMap& metadata, const std::optional<VoxelSize>& size) {
  metadata.removeMeta(kVoxelSizeKey);
  metadata.removeMeta(kVoxelEdgesKey);
  metadata.removeMeta(kLengthUnit);
  if (!size) return;
  metadata.insertMeta(kLengthUnit, openvdb::StringMetadata(size->unit()));
  const auto& [x, y, z] = size->edges();
  if (size->isCube())
    metadata.insertMeta(kVoxelSizeKey, openvdb::DoubleMetadata(x));
  else
    metadata.insertMeta(kVoxelEdgesKey, openvdb::Vec3DMetadata(openvdb::Vec3d(x, y, z)));
}

void setVoxelSize(openvdb::GridBase& grid, const std::optional<VoxelSize>& size) {
  setStoredVoxelSize(grid, size);
  if (!size || size->isCube()) {
    grid.setTransform(openvdb::math::Transform::createLinearTransform(size ? size->inUnit() : 1.0));
    return;
  }
  setProportions(grid, size->edgesInUnit());
}

void setProportions(openvdb::GridBase& grid, const std::array<double, 3>& edges) {
  // OpenVDB refuses voxel volumes below 3e-15; a thousandth of an unknown unit is as good as the
  // unit.
  constexpr double kMinEdge = 1.9e-5, kStep = 1e3;
  openvdb::Vec3d scale(edges[0], edges[1], edges[2]);
  while (std::min({scale[0], scale[1], scale[2]}) < kMinEdge) scale *= kStep;
  const openvdb::math::MapBase::Ptr map = std::make_shared<openvdb::math::ScaleMap>(scale);
  grid.setTransform(std::make_shared<openvdb::math::Transform>(map));
}

bool hasCubicVoxels(const openvdb::GridBase& grid) {
  const auto edges = detail::edgesAlongAxes(grid.transform());
  return edges && detail::areEdgesOfCube(*edges);
}

void requireCubicVoxels(const openvdb::GridBase& grid, const std::string& what) {
  const auto edges = detail::edgesAlongAxes(grid.transform());
  if (edges && !detail::areEdgesOfCube(*edges))
    throw InvalidInput(what + " needs cubic voxels, and these are " + detail::timesText(*edges) +
                       ": resample the grid to cubes first");
}

bool hasVoxelsAlongAxes(const openvdb::GridBase& grid) {
  return detail::edgesAlongAxes(grid.transform()).has_value();
}

std::optional<MetadataValue> plainValue(const openvdb::Metadata& metadata) {
  const std::string type = metadata.typeName();
  if (type == "bool") return static_cast<const openvdb::BoolMetadata&>(metadata).value();
  if (type == "int32") return int64_t{static_cast<const openvdb::Int32Metadata&>(metadata).value()};
  if (type == "int64") return int64_t{static_cast<const openvdb::Int64Metadata&>(metadata).value()};
  if (type == "float") return double{static_cast<const openvdb::FloatMetadata&>(metadata).value()};
  if (type == "double") return static_cast<const openvdb::DoubleMetadata&>(metadata).value();
  if (type == "string") return static_cast<const openvdb::StringMetadata&>(metadata).value();
  return {};
}

void copyMetadata(const openvdb::GridBase& from, openvdb::GridBase& to) {
  for (auto meta = from.beginMeta(); meta != from.endMeta(); ++meta)
    if (meta->first != openvdb::GridBase::META_GRID_NAME) to.insertMeta(meta->first, *meta->second);
  to.setTransform(from.transform().copy());
}

void copyProvenance(const openvdb::GridBase& from, openvdb::GridBase& to) {
  for (const char* key :
       {kDomainMin, kDomainMax, detail::kRegionKey, kVoxelSizeKey, kVoxelEdgesKey, kLengthUnit,
        kSourceKey, kBoundaryKey, kObjectKey, kThresholdKey, kThresholdLowKey})
    if (const auto value = from[key]) to.insertMeta(key, *value);
  if (to.isType<Int32Grid>())
    for (const char* key : {kTrackKey, kLastTrackKey})
      if (const auto value = from[key]) to.insertMeta(key, *value);
  to.setTransform(from.transform().copy());
}

}  // namespace vdb_madf
