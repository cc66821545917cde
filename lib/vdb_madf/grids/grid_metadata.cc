// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/grid_metadata.h"

#include <openvdb/Metadata.h>

#include <algorithm>
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
  const openvdb::Metadata::ConstPtr named = metadata[detail::kRegionKey];
  if (!named) return box;
  const auto* region = dynamic_cast<const detail::RegionMetadata*>(named.get());
  if (!region)
    throw InvalidInput("the domain is the region in grid '" + named->str() +
                       "', which was not read with it: keep them in one file");
  return Domain(region->region(), box);
}

void setDomain(openvdb::MetaMap& metadata, const Domain& domain) {
  metadata.insertMeta(kDomainMin, openvdb::Vec3IMetadata(domain.box().min().asVec3i()));
  metadata.insertMeta(kDomainMax, openvdb::Vec3IMetadata(domain.box().max().asVec3i()));
  metadata.removeMeta(detail::kRegionKey);
  if (!domain.isBox())
    metadata.insertMeta(detail::kRegionKey, detail::RegionMetadata(domain.region()));
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
  const auto metres = metadata.getMetadata<openvdb::DoubleMetadata>(kVoxelSizeKey);
  if (!metres || !(metres->value() > 0)) return std::nullopt;
  return VoxelSize{metres->value()};
}

void setVoxelSize(openvdb::GridBase& grid, const std::optional<VoxelSize>& size) {
  grid.removeMeta(kVoxelSizeKey);
  grid.removeMeta(kLengthUnit);
  if (size) {
    grid.insertMeta(kVoxelSizeKey, openvdb::DoubleMetadata(size->metres));
    grid.insertMeta(kLengthUnit, openvdb::StringMetadata(size->unit()));
  }
  grid.setTransform(openvdb::math::Transform::createLinearTransform(size ? size->inUnit() : 1.0));
}

bool hasCubicVoxels(const openvdb::GridBase& grid) {
  const auto edges = detail::edgesAlongAxes(grid.transform());
  return edges && detail::areEdgesOfCube(*edges);
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

void copyProvenance(const openvdb::GridBase& from, openvdb::GridBase& to) {
  for (const char* key : {kDomainMin, kDomainMax, detail::kRegionKey, kVoxelSizeKey, kLengthUnit,
                          kSourceKey, kBoundaryKey, kObjectKey, kThresholdKey, kThresholdLowKey})
    if (const auto value = from[key]) to.insertMeta(key, *value);
  to.setTransform(from.transform().copy());
}

}  // namespace vdb_madf
