// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/measure_necks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/detail/grains_in_scan.h"
#include "vdb_madf/intensity/detail/near_squares.h"
#include "vdb_madf/intensity/detail/scan_around.h"
#include "vdb_madf/intensity/detail/section_fit.h"
#include "vdb_madf/labels/detail/label_blocks.h"

namespace vdb_madf {

namespace {

using detail::SectionFit;
using openvdb::Vec3d;
using FloatTree = FloatGrid::TreeType;

constexpr size_t kBondsTogether = 8;
constexpr double kFlank = 3;          // voxels around a bond that tell its normal
constexpr double kMaxReach = 64;      // of a section, along it
constexpr double kBlursOfRim = 3;     // from a surface on all is inside or outside
constexpr double kRim = 0.7;          // voxels, and that many blurs
constexpr int kEnoughVoxels = 100;    // for a mean of their own
constexpr size_t kLeastUnknown = 27;  // voxels far from all labels that make a grain without one
constexpr double kLeastArea = 7;      // voxel faces of a confirmed neck
// A neck is not known by an error of so many voxel faces and so much of the bond's area, and if its
// area is so many times that of the bond: blur makes bonds larger, not smaller.
constexpr double kMostError = 21, kMostErrorShare = 0.35, kMostGrowth = 3;
// As many of the labeled voxels have to be on the grains' side of the scan's middle gray, and of
// the others on the other side, in the mean; of a scan of something else it is a half.
constexpr double kLeastAgreement = 0.65;
constexpr double kMostShift = 0.7;   // voxels between labels and scan, along an axis
constexpr size_t kSomeLeaves = 256;  // that tell it where no bond does

/// Height of the last voxels that count in a section.
const double kHeight = SectionFit::kReach + 4 * SectionFit::kThickness;

/// The values of a box, z fastest.
template <typename T>
struct Block {
  CoordBBox box;
  std::vector<T> values;

  explicit Block(const CoordBBox& whole) : box(whole), values(whole.volume(), T(0)) {}
  size_t at(const Coord& p) const {
    const Coord from = p - box.min(), size = box.dim();
    return (size_t(from.x()) * size_t(size.y()) + size_t(from.y())) * size_t(size.z()) +
           size_t(from.z());
  }
};

/// valueAt(leaf, offset) of the voxels of the tree's leaf nodes within the box; 0 elsewhere.
template <typename T, typename Tree, typename ValueAt>
Block<T> copyOf(const Tree& tree, const CoordBBox& box, const ValueAt& valueAt) {
  Block<T> block(box);
  detail::forEachLeafOrigin(box, [&](const Coord& origin) {
    const auto* leaf = tree.probeConstLeaf(origin);
    if (!leaf) return;
    CoordBBox part = leaf->getNodeBoundingBox();
    part.intersect(box);
    for (auto p = part.begin(); p; ++p)
      block.values[block.at(*p)] = valueAt(*leaf, leaf->coordToOffset(*p));
  });
  return block;
}

Block<int32_t> labelsIn(const Int32Tree& tree, const CoordBBox& box) {
  return copyOf<int32_t>(tree, box, [](const Int32Tree::LeafNodeType& leaf, openvdb::Index i) {
    return detail::labelAt(leaf, leaf.buffer().data(), i);
  });
}

/// Calls take(q), which may add to the voxels, for all face neighbors of voxels within the box.
template <typename Take>
void spread(std::vector<Coord>& voxels, const CoordBBox& box, const Take& take) {
  for (size_t next = 0; next < voxels.size(); ++next)
    for (int side = 0; side < 6; ++side) {
      Coord q = voxels[next];
      q[side / 2] += side % 2 ? 1 : -1;
      if (box.isInside(q)) take(q);
    }
}

CoordBBox around(const Vec3d& center, const Vec3d& halves) {
  return {Coord::floor(center - halves), Coord::ceil(center + halves)};
}

/// A bond with what its sections need.
struct Section {
  Vec3d center, normal;
  double radius = 0;  // of the bond, as measured
  double reach = 0;   // of the sections, from the center
  CoordBBox box;      // of what is within reach of the planes
};

/// The line between the means of the voxels of either side; from the first to the second.
Vec3d normalOf(const Int32Tree& labels, const BondMeasures& bond) {
  const double radius = std::min(bond.equivalentRadius, kMaxReach) + kFlank;
  const Vec3d center = bond.centroid;
  const Block<int32_t> block = labelsIn(labels, around(center, Vec3d(radius)));
  std::vector<Vec3d> places;
  for (auto p = block.box.begin(); p; ++p) {
    const int32_t label = block.values[block.at(*p)];
    const Vec3d from = (*p).asVec3d() - center;
    if ((label == bond.first || label == bond.second) && from.lengthSqr() < radius * radius)
      places.push_back(from);
  }
  Vec3d normal = bond.normal;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    Vec3d sums[2] = {Vec3d(0), Vec3d(0)};
    double counts[2] = {0, 0};
    for (const Vec3d& from : places) {
      const bool above = from.dot(normal) > 0;
      sums[above] += from;
      ++counts[above];
    }
    if (counts[0] == 0 || counts[1] == 0) return normal;
    Vec3d across = sums[1] / counts[1] - sums[0] / counts[0];
    if (!across.normalize()) return normal;
    normal = across;
  }
  return normal;
}

class NeckMeter {
 public:
  NeckMeter(const Int32Tree& labels, const FloatTree& gray, const ScanBlur& blur)
      : labels_(labels),
        gray_(gray),
        blur_(blur),
        fit_(blur.sigma),
        rim_(kBlursOfRim * blur.sigma + kRim + 0.5) {}

  Neck measure(const BondMeasures& bond, const Section& section) const {
    const Block<int32_t> labels = labelsIn(labels_, section.box);
    const Block<float> gray = copyOf<float>(
        gray_, section.box,
        [](const FloatTree::LeafNodeType& leaf, openvdb::Index i) { return leaf.getValue(i); });
    const std::vector<Part> parts = partsOf(labels, connected(bond, section, labels), gray);
    const auto [sections, variance] = areasOf(section, gray, parts);
    const auto area = fit_.leastArea(sections, variance);
    Neck neck;
    neck.normal = section.normal;
    neck.error = area.error;
    if (!(area.error <= std::max(kMostError, kMostErrorShare * bond.area)) ||
        !(area.value <= kMostGrowth * bond.area + kLeastArea)) {
      neck.area = neck.radius = neck.gap = std::numeric_limits<double>::quiet_NaN();
      return neck;
    }
    neck.area = std::max(0.0, area.value);
    neck.radius = std::sqrt(neck.area / M_PI);
    neck.confirmed = area.value >= std::max(kLeastArea, area.error);
    neck.gap = neck.confirmed ? 0 : std::max(0.0, fit_.gap(sections, variance));
    return neck;
  }

 private:
  /// The voxels of both grains that are connected to the bond within the sections.
  static std::vector<uint8_t> connected(const BondMeasures& bond, const Section& section,
                                        const Block<int32_t>& labels) {
    std::vector<uint8_t> own(labels.values.size(), 0);
    std::vector<Coord> open;
    const auto tryAt = [&](const Coord& p, double height, double radius) {
      const size_t i = labels.at(p);
      if (own[i] || (labels.values[i] != bond.first && labels.values[i] != bond.second)) return;
      const Vec3d from = p.asVec3d() - section.center;
      const double z = from.dot(section.normal);
      if (std::abs(z) > height || from.lengthSqr() - z * z > radius * radius) return;
      own[i] = 1;
      open.push_back(p);
    };
    constexpr double kSeed = 1.5;
    CoordBBox seeds = around(section.center, Vec3d(section.radius + 2 * kSeed));
    seeds.intersect(labels.box);
    for (auto p = seeds.begin(); p; ++p) tryAt(*p, kSeed, section.radius + kSeed);
    spread(open, labels.box, [&](const Coord& q) { tryAt(q, kHeight, section.reach); });
    return own;
  }

  /// How a voxel counts in a section.
  enum Part : uint8_t {
    none,
    rim,    ///< of a surface of the two grains: by its gray value
    whole,  ///< inside
    empty   ///< pore, far from all grains
  };

  /// Rims are on both sides of the surface of what is `own`; where another grain is nearer, a pore
  /// voxel is none. Others are also those that have no label, but are in the scan.
  std::vector<Part> partsOf(const Block<int32_t>& labels, const std::vector<uint8_t>& own,
                            const Block<float>& gray) const {
    const Coord dim = labels.box.dim();
    const std::array<size_t, 3> sizes{size_t(dim.x()), size_t(dim.y()), size_t(dim.z())};
    const int reach = int(rim_), square = int(rim_ * rim_);
    std::vector<uint8_t> isPore(own.size()), isObject(own.size());
    for (size_t i = 0; i < own.size(); ++i) {
      isPore[i] = labels.values[i] == 0;
      isObject[i] = !isPore[i];
    }
    auto toObject = detail::nearSquares(sizes, isObject, reach);
    const std::vector<size_t> unknown = withoutLabel(sizes, gray, isPore, toObject);
    for (const size_t i : unknown) {
      isPore[i] = 0;
      isObject[i] = 1;
    }
    if (!unknown.empty()) toObject = detail::nearSquares(sizes, isObject, reach);
    const auto toPore = detail::nearSquares(sizes, isPore, reach);
    const auto toOwn = detail::nearSquares(sizes, own, reach);
    std::vector<Part> parts(own.size(), none);
    for (size_t i = 0; i < own.size(); ++i)
      if (own[i])
        parts[i] = toPore[i] <= square ? rim : whole;
      else if (isPore[i] && toObject[i] > square)
        parts[i] = empty;
      else if (isPore[i] && toOwn[i] <= toObject[i])
        parts[i] = rim;
    return parts;
  }

  /// Voxels of grains that the scan shows and that have no label: those on the grains' side of the
  /// middle gray that are far from all labels, in pieces that are large enough, and what is within
  /// a rim of these. (Also grains that have a label may have a skin beyond it.)
  std::vector<size_t> withoutLabel(const std::array<size_t, 3>& sizes, const Block<float>& gray,
                                   const std::vector<uint8_t>& isPore,
                                   const std::vector<int16_t>& toObject) const {
    const int reach = int(rim_), square = int(rim_ * rim_);
    const float middle = float((blur_.inside + blur_.outside) / 2);
    const bool areBright = blur_.inside > blur_.outside;
    std::vector<uint8_t> isGrain(isPore.size()), isOpen(isPore.size());  // open: not met yet
    for (size_t i = 0; i < isPore.size(); ++i) {
      isGrain[i] = isPore[i] && (areBright ? gray.values[i] > middle : gray.values[i] < middle);
      isOpen[i] = isGrain[i] && toObject[i] > square;
    }
    if (size_t(std::count(isOpen.begin(), isOpen.end(), 1)) < kLeastUnknown) return {};
    std::vector<uint8_t> isFar(isPore.size());
    bool anyFar = false;
    std::vector<Coord> piece;
    for (auto p = gray.box.begin(); p; ++p) {
      if (!isOpen[gray.at(*p)]) continue;
      piece.clear();
      const auto take = [&](const Coord& q) {
        if (std::exchange(isOpen[gray.at(q)], uint8_t(0))) piece.push_back(q);
      };
      take(*p);
      spread(piece, gray.box, take);
      if (piece.size() < kLeastUnknown) continue;
      anyFar = true;
      for (const Coord& q : piece) isFar[gray.at(q)] = 1;
    }
    if (!anyFar) return {};
    const auto toFar = detail::nearSquares(sizes, isFar, reach);
    std::vector<size_t> result;
    for (size_t i = 0; i < isGrain.size(); ++i)
      if (isGrain[i] && toFar[i] <= square) result.push_back(i);
    return result;
  }

  /// The areas of the sections, and the variance of each.
  std::pair<SectionFit::Sections, double> areasOf(const Section& section, const Block<float>& gray,
                                                  const std::vector<Part>& parts) const {
    double sums[2] = {0, 0}, counts[2] = {0, 0};  // outside, inside
    CoordBBox known = gray.box;                   // beyond it there may be surfaces
    known.expand(-int(rim_));
    size_t at = 0;
    for (auto p = gray.box.begin(); p; ++p, ++at)
      if ((parts[at] == whole || parts[at] == empty) && known.isInside(*p) &&
          std::isfinite(gray.values[at])) {
        sums[size_t(parts[at] == whole)] += double(gray.values[at]);
        ++counts[size_t(parts[at] == whole)];
      }
    const double outside = counts[0] < kEnoughVoxels ? blur_.outside : sums[0] / counts[0];
    const double inside = counts[1] < kEnoughVoxels ? blur_.inside : sums[1] / counts[1];
    const double contrast = inside - outside;
    // Voxels by their height, in steps that a section's weight does not tell from one another.
    constexpr int kFine = 16;
    const int slices = int(std::ceil(2 * kHeight * kFine));
    std::vector<double> byHeight(size_t(slices) + 1, 0);
    double blurred = 0;  // voxels with noise, within the middle of the sections
    constexpr double kMiddle = 3;
    size_t i = 0;
    for (auto p = gray.box.begin(); p; ++p, ++i) {
      if (parts[i] != rim && parts[i] != whole) continue;
      const bool inRim = parts[i] == rim;
      const Vec3d from = (*p).asVec3d() - section.center;
      const double z = from.dot(section.normal);
      if (std::abs(z) > kHeight || from.lengthSqr() - z * z > section.reach * section.reach)
        continue;
      const double f = inRim ? (double(gray.values[i]) - outside) / contrast : 1;
      if (!std::isfinite(f)) continue;
      byHeight[size_t((z + kHeight) * kFine)] += f;
      blurred += inRim && std::abs(z) < kMiddle;
    }
    SectionFit::Sections sections;
    constexpr double kThickness = SectionFit::kThickness;
    for (int k = 0; k < SectionFit::kSections; ++k) {
      double sum = 0;
      for (size_t s = 0; s < byHeight.size(); ++s) {
        const double z = (double(s) + 0.5) / kFine - kHeight;
        const double d = (z - SectionFit::height(k)) / kThickness;
        if (std::abs(d) < 4) sum += byHeight[s] * std::exp(-0.5 * d * d);
      }
      sections[k] = sum / (kThickness * std::sqrt(2 * M_PI));
    }
    const double noise = blur_.noise * (blur_.inside - blur_.outside) / contrast;
    const double variance =
        noise * noise * blurred / (2 * kMiddle) / (2 * kThickness * std::sqrt(M_PI));
    return {sections, variance};
  }

  const Int32Tree& labels_;
  const FloatTree& gray_;
  const ScanBlur blur_;
  const SectionFit fit_;
  const double rim_;  // distance of voxel centers
};

/// The blur with the grains inside, which a scan may show darker than what is around them; none if
/// the voxels that were read are all of grains, or all of what is around them.
/// @throw InvalidInput, one line that names the scan, if it does not show the labels' grains, or
///   somewhere else
std::optional<ScanBlur> withGrainsInside(const ScanBlur& blur, const Int32Tree& labels,
                                         const FloatTree& gray, const CoordBBox& known,
                                         const std::string& path) {
  const detail::GrainsInScan grains =
      detail::grainsInScan(labels, gray, known, (blur.inside + blur.outside) / 2);
  if (!grains.brighter) return std::nullopt;
  if (std::abs(*grains.brighter) < 2 * kLeastAgreement - 1)
    throw InvalidInput(path +
                       ": its grains are not where the labels have them: give the scan that they "
                       "were made of, with axes and slices in the same order");
  std::string axes;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(grains.shift[axis]) > kMostShift)
      axes += std::string(axes.empty() ? "" : ", ") + "xyz"[axis];
  if (!axes.empty())
    throw InvalidInput(path +
                       ": its grains lie about a voxel or more from where the labels have "
                       "them (along " +
                       axes +
                       "): give the scan that they were made of, "
                       "whole or cropped as they were");
  ScanBlur turned = blur;
  if (*grains.brighter < 0) std::swap(turned.inside, turned.outside);
  return turned;
}

/// The bonds' sections, by the labels alone.
std::vector<Section> sectionsOf(const Int32Tree& labels, const Measurements& measured,
                                const CoordBBox& known, double blur, Interrupter* interrupter) {
  const auto radiusOf = [&](int32_t label) {
    const auto& grains = measured.grains;
    const size_t row = rowOf(grains, label);
    if (row == grains.size() || grains[row].id != label)
      throw InvalidInput("these are not the labels that were measured");
    return grains[row].equivalentDiameter / 2;
  };
  std::vector<Section> sections(measured.bonds.size());
  detail::parallelForEach(sections.size(), kBondsTogether, interrupter, [&](size_t i) {
    const BondMeasures& bond = measured.bonds[i];
    Section& section = sections[i];
    section.center = bond.centroid;
    section.normal = normalOf(labels, bond);
    section.radius = std::min(bond.equivalentRadius, kMaxReach);
    // Balls of that size have sections within this reach, and a rim around them.
    const double ball = std::max(radiusOf(bond.first), radiusOf(bond.second));
    section.reach =
        std::min(kMaxReach, std::sqrt(section.radius * section.radius + 2 * ball * kHeight)) +
        kBlursOfRim * blur + kRim + 1;
    Vec3d halves;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = section.normal[axis];
      halves[axis] =
          section.reach * std::sqrt(std::max(0.0, 1 - along * along)) + kHeight * std::abs(along);
    }
    section.box = around(section.center, halves);
    section.box.intersect(known);
  });
  return sections;
}

std::vector<CoordBBox> boxesOf(const std::vector<Section>& sections) {
  std::vector<CoordBBox> boxes;
  for (const Section& section : sections) boxes.push_back(section.box);
  return boxes;
}

/// Of up to kSomeLeaves leaf nodes of the labels, with a voxel around each.
std::vector<CoordBBox> boxesOfSome(const Int32Tree& labels, const CoordBBox& known) {
  std::vector<CoordBBox> boxes;
  const size_t step = size_t(labels.leafCount()) / kSomeLeaves + 1;
  size_t at = 0;
  for (auto leaf = labels.cbeginLeaf(); leaf; ++leaf) {
    if (at++ % step != 0) continue;
    boxes.push_back(leaf->getNodeBoundingBox());
    boxes.back().expand(1);
    boxes.back().intersect(known);
  }
  return boxes;
}

}  // namespace

void measureNecks(const Int32Grid& labels, GrayScan& scan, const ScanBlur& blur,
                  Measurements& measured, Interrupter* interrupter) {
  placeScan(scan, measured.sample);
  if (measured.edges != Vec3d(1))
    throw InvalidInput(scan.image->path() +
                       ": necks are measured in a scan of cubic voxels: resample it "
                       "(vdb_madf convert --resample) and segment that");
  if (const Coord size = scan.box().dim(); size[size.minIndex()] == 1)
    throw InvalidInput(scan.image->path() + ": is a slice, and necks are measured in a volume");
  const Int32Tree::ConstPtr tree = detail::withoutTiles(labels);
  detail::WorkPart framing(interrupter, 0, 20), reading(interrupter, 20, 45),
      readingMore(interrupter, 45, 50), fitting(interrupter, 50, 100);
  // What a larger scan shows beyond the labels' domain belongs to grains that nobody knows.
  CoordBBox known = scan.box();
  known.intersect(measured.sample.box);
  const std::vector<Section> sections = sectionsOf(*tree, measured, known, blur.sigma, &framing);
  const auto domain = storedDomain(labels);
  const auto grayIn = [&](const std::vector<CoordBBox>& boxes, Interrupter* part) {
    FloatTree::Ptr gray = detail::readAround(boxes, scan, part);
    if (domain && !domain->isBox()) detail::forgetOutside(*domain->region(), *gray);
    return gray;
  };
  const auto insideBy = [&](const FloatTree& gray) {
    return withGrainsInside(blur, *tree, gray, known, scan.image->path());
  };
  const FloatTree::Ptr gray = grayIn(boxesOf(sections), &reading);
  std::optional<ScanBlur> inside = insideBy(*gray);
  if (!inside) inside = insideBy(*grayIn(boxesOfSome(*tree, known), &readingMore));
  measured.scan = inside.value_or(blur);
  const NeckMeter meter(*tree, *gray, *measured.scan);
  detail::parallelForEach(sections.size(), kBondsTogether, &fitting, [&](size_t i) {
    measured.bonds[i].neck = meter.measure(measured.bonds[i], sections[i]);
  });
  measured.extra.necks = true;
}

}  // namespace vdb_madf
