// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/detail/chosen_part.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/grids/detail/size_and_place.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/scans/detail/cylinder_axis.h"
#include "vdb_madf/scans/detail/field_of_view.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/volumes/choose_grid.h"
#include "vdb_madf/volumes/detail/volume_notes.h"
#include "vdb_madf/volumes/load_object.h"

namespace vdb_madf::detail {

namespace {

/// What is known of a scan before its region is chosen.
struct ScanExtent {
  std::optional<Domain> domain;
  CoordBBox box;  ///< where the domain is unknown: of its voxels
  std::optional<VoxelSize> voxelSize;
  /// As farthestFromAxis().
  std::function<double(const CylinderAxis&)> farthestFromAxis;
  /// Of a gray scan: the smallest circle across an axis that holds its field of view.
  std::function<std::optional<Circle>(int axis)> circle = [](int) { return std::nullopt; };
};

constexpr char kAxes[] = "xyz";

MaskGrid::ConstPtr readRegion(const VolumeOptions& options, Interrupter* interrupter) {
  const std::string& file = options.region.mask;
  VolumeOptions reading;
  reading.outputs = options.outputs;
  reading.note = options.note;
  if (!isVdbFile(file)) {  // so that the mask may have several values
    reading.selection = Selection::phase(0);
    reading.selection->invert = true;
  }
  try {
    return loadObject(file, reading, interrupter);
  } catch (const AmbiguousGrid& error) {
    throw InvalidInput(file + ": holds several grids, of which none is called object: " +
                       error.grids() + ": give a file with one mask");
  }
}

/// The region in a mask, which has to cover the scan as far as both say how large they are.
/// @param voxels of the scan
Domain maskRegion(const std::string& path, const VolumeOptions& options,
                  const std::optional<Domain>& scan, const std::optional<VoxelSize>& voxels,
                  Interrupter* interrupter) {
  const RegionOptions& region = options.region;
  const MaskGrid::ConstPtr mask = region.grid ? region.grid : readRegion(options, interrupter);
  const std::string name = region.grid ? "the region" : region.mask;
  if (mask->activeVoxelCount() == 0)
    throw InvalidInput(name + ": all is 0, and a region is what is not: give one with voxels");
  const auto known = storedDomain(*mask);
  if (known && scan && !known->box().isInside(scan->box()))
    throw InvalidInput(fmt::format(
        "{}: has {} and does not cover {}, which has {}: give a region of the same voxels", name,
        sizeAndPlace(known->box()), path, sizeAndPlace(scan->box())));
  if (known && scan && known->box() != scan->box() && !region.crop && options.note)
    options.note(name + ": is larger than " + path + "; voxels of equal index belong together",
                 NoteAbout::file);
  const auto own = storedVoxelSize(*mask);
  if (own && voxels && haveOtherEdges(*own, *voxels) && options.note)
    options.note(fmt::format("{}: has voxels of {}, and {} of {}: voxels of equal index belong "
                             "together",
                             name, voxelText(*own), path, voxelText(*voxels)),
                 NoteAbout::file);
  return Domain(mask->tree());
}

constexpr double kDigits = 100;  // so that it can be typed

double fittedRadius(const std::string& path, const CoordBBox& box, const CylinderAxis& axis,
                    const ScanExtent& extent) {
  const double most = largestRadius(box, axis.axis, axis.center);
  if (most <= 0)
    throw InvalidInput(path +
                       ": the axis of the cylinder lies outside of the scan, so that no "
                       "radius can be fitted: give one");
  const double squared = extent.farthestFromAxis(axis);
  if (squared < 0)
    throw InvalidInput(path +
                       ": all voxels are outside of a field of view, so that no radius can "
                       "be fitted: give one");
  return std::min(std::ceil(std::sqrt(squared) * kDigits) / kDigits, most);
}

/// The least cylinder that holds the field of view of a gray scan. None if it would not fit in the
/// box anywhere: then its rim is not to be seen.
std::optional<Cylinder> fittedCylinder(const CoordBBox& box, const CylinderAxis& middle,
                                       const ScanExtent& extent) {
  const auto circle = extent.circle(middle.axis);
  if (!circle) return std::nullopt;
  CylinderAxis axis = middle;
  for (size_t i = 0; i < 2; ++i) axis.center[i] = std::round(circle->center[i] * kDigits) / kDigits;
  const double radius = std::ceil(std::sqrt(extent.farthestFromAxis(axis)) * kDigits) / kDigits;
  if (radius > largestRadius(box, axis.axis, middle.center)) return std::nullopt;
  return Cylinder{axis.axis, axis.center, radius};
}

Cylinder wholeCylinder(const std::string& path, const VolumeOptions& options, const CoordBBox& box,
                       const ScanExtent& extent) {
  const CylinderOptions& given = *options.region.cylinder;
  CylinderAxis axis{given.axis, {}};
  const openvdb::Vec3d middle = box.getCenter();
  axis.center = given.center.value_or(std::array<double, 2>{middle[axis.u()], middle[axis.v()]});
  if (given.radius) return {axis.axis, axis.center, *given.radius};
  const auto fitted = given.center ? std::nullopt : fittedCylinder(box, axis, extent);
  const Cylinder cylinder =
      fitted ? *fitted : Cylinder{axis.axis, axis.center, fittedRadius(path, box, axis, extent)};
  if (options.note)
    options.note(
        fmt::format("{}: the region is a cylinder along {} around {} {}, {} {}, {} {} voxels {}",
                    path, kAxes[axis.axis], kAxes[axis.u()], shortestDecimal(cylinder.center[0]),
                    kAxes[axis.v()], shortestDecimal(cylinder.center[1]),
                    fitted ? "which with a radius of" : "to which a radius of",
                    shortestDecimal(cylinder.radius), fitted ? "were fitted" : "was fitted"),
        NoteAbout::file);
  return cylinder;
}

ScanPart chosenPart(const std::string& path, const VolumeOptions& options, const ScanExtent& extent,
                    Interrupter* interrupter) {
  ScanPart part;
  std::optional<Domain> domain = extent.domain;
  const auto narrow = [&](const Domain& to) { domain = domain ? domain->within(to) : to; };
  if (const auto& crop = options.region.crop) {
    part.box = *crop;
    if (domain && crop->hasOverlap(domain->box()))  // else it is said that there is no voxel
      noteBeyond(path, "crop", *crop, domain->box(), "is left out", options);
    narrow(*crop);
  }
  if (!options.region.mask.empty() || options.region.grid)
    narrow(maskRegion(path, options, domain,
                      options.voxelSize ? options.voxelSize : extent.voxelSize, interrupter));
  if (options.region.cylinder) {
    const CoordBBox whole = extent.domain ? extent.domain->box() : extent.box;
    if (whole.empty()) throw InvalidInput(path + ": holds no voxel to put a cylinder around");
    const Cylinder cylinder = wholeCylinder(path, options, whole, extent);
    narrow(cylinderIn(domain ? domain->box() : whole, cylinder));
  }
  part.domain = *domain;
  return part;
}

}  // namespace

std::optional<ScanPart> partOf(openvdb::GridBase& grid, const std::string& path,
                               const VolumeOptions& options, Interrupter* interrupter) {
  if (!options.region.any()) return std::nullopt;
  ScanExtent extent;
  extent.domain = storedDomain(grid);
  extent.voxelSize = storedVoxelSize(grid);
  const auto& cylinder = options.region.cylinder;
  if (cylinder && !(cylinder->radius && extent.domain)) {  // else nothing depends on its voxels
    const MaskGrid::Ptr voxels = objectMask(grid);
    extent.box = voxels->evalActiveVoxelBoundingBox();
    extent.farthestFromAxis = [voxels](const CylinderAxis& axis) {
      return farthestFromAxis(voxels->tree(), axis);
    };
  }
  const ScanPart part = chosenPart(path, options, extent, interrupter);
  if (storedBoundary(grid) == Boundary::closed && extent.domain && *extent.domain != part.domain &&
      options.note)
    options.note(path +
                     ": is closed, and so is the part of it, whose faces cut grains: say that "
                     "its boundary is open if these go on there",
                 NoteAbout::file);
  setDomain(grid, part.domain);
  return part;
}

std::optional<ScanPart> partOfImage(const ImageOpener& open, const VolumeOptions& options,
                                    Interrupter* interrupter) {
  if (!options.region.any()) return std::nullopt;
  const auto image = open();
  const CoordBBox box = imageBox(image->info().size);
  CountedImage counted(*image, middleRows(image->info().size));
  std::optional<std::vector<PlanePoint>> rim;  // of the one axis that is asked for
  const auto rimAlong = [&](int axis) -> const std::vector<PlanePoint>& {
    if (!rim) rim = rimOfView(counted, axis, interrupter);
    return *rim;
  };
  ScanExtent extent;
  if (options.domain)
    noteBeyond(image->path(), "domain", *options.domain, box, "counts as scanned", options);
  extent.domain = Domain(options.domain.value_or(box));
  extent.box = box;
  extent.voxelSize = image->info().voxelSize;
  extent.farthestFromAxis = [&](const CylinderAxis& axis) {
    return farthestFromAxis(rimAlong(axis.axis), axis);
  };
  extent.circle = [&](int axis) -> std::optional<Circle> {
    const std::vector<PlanePoint>& points = rimAlong(axis);
    if (points.empty() || kindOf(counted.histogram()) != ImageKind::gray) return std::nullopt;
    return smallestCircle(points);
  };
  return chosenPart(image->path(), options, extent, interrupter);
}

}  // namespace vdb_madf::detail
