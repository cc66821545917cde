// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/evolve.h"

#include <openvdb/Metadata.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tree/ValueAccessor.h>

#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/portable_math.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/detail/ball_steps.h"
#include "vdb_madf/grids/detail/cut_to_domain.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/matching/detail/grain_set.h"
#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/detail/sample_options.h"

namespace vdb_madf {

namespace {

using openvdb::Mat3d;
using openvdb::Vec3d;
using LabelLeaf = Int32Tree::LeafNodeType;

constexpr int kMostSteps = 1000;
/// Streams of noise are three a step, those of grains lie above, and above these those of bonds.
constexpr uint64_t kGrainStreams = uint64_t(1) << 32, kBondStreams = uint64_t(1) << 63;
constexpr int kMostGap = 8, kMostGrowth = 8;
/// WhiteNoise is bounded: so many standard deviations.
constexpr double kFarthestNoise = 6;

/// A grain that moves.
struct MovedGrain {
  int32_t label = 0;
  Mat3d gradient, inverse;
  Vec3d before, after;  ///< where a point of it was, and is; of a rigid grain its center
  double volume = 1;

  Coord sourceOf(const Vec3d& x) const {
    return Coord::floor(inverse * (x - after) + before + Vec3d(0.5));
  }
  /// Grows with the distance from there in radii.
  double distance(const Vec3d& x) const {
    const double squared = (x - after).lengthSqr();
    return squared * squared * squared / (volume * volume);
  }
  /// Bounds where the voxels of a box go, with a margin.
  CoordBBox boundsOf(const CoordBBox& box, double margin) const {
    const Vec3d half = box.dim().asVec3d() / 2;
    const Vec3d middle = gradient * (box.getCenter() - before) + after;
    Vec3d reach(margin + 1);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        reach[row] += std::abs(gradient(row, column)) * half[column];
    return {Coord::floor(middle - reach), Coord::ceil(middle + reach)};
  }
};

using MovedGrains = std::map<int32_t, MovedGrain>;
using BondSet = std::set<std::pair<int32_t, int32_t>>;

/// A rotation about an axis through the origin.
Mat3d turnAbout(const Vec3d& axis, double degrees) {
  const Vec3d a = axis.unit();
  const auto [sine, cosine] = detail::sineAndCosine(degrees * M_PI / 180);
  const Mat3d cross(0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0);
  return Mat3d::identity() + cross * sine + cross * cross * (1 - cosine);
}

std::string vectorText(const Vec3d& v) {
  return detail::shortestDecimal(v.x()) + "," + detail::shortestDecimal(v.y()) + "," +
         detail::shortestDecimal(v.z());
}

std::string sourceText(const EvolveOptions& options, int step) {
  detail::SourceText source("evolve");
  source.add("steps", std::to_string(options.steps))
      .add("strain", options.strain)
      .add("shear", options.shear)
      .add("turn", options.degrees)
      .add("axis", vectorText(options.axis))
      .add("drift", vectorText(options.drift))
      .add("vanish", options.vanish)
      .add("noise", options.noise)
      .add("seed", std::to_string(options.seed));
  if (options.enter != 0) source.add("enter", options.enter);
  if (options.breaks != 0)
    source.add("break", options.breaks).add("break-gap", std::to_string(options.gap));
  if (options.growth != 0) source.add("grow", options.growth);
  return source.str() + (options.rigidGrains ? " --rigid-grains" : "") + ", step " +
         std::to_string(step);
}

/// Where a voxel looks for its label, without the motion.
class Shaking {
 public:
  Shaking(const EvolveOptions& options, int step) : deviation_(step == 0 ? 0 : options.noise) {
    for (uint64_t axis = 0; axis < 3; ++axis)
      noise_.emplace_back(options.seed, 3 * uint64_t(step) + axis);
  }

  double farthest() const { return kFarthestNoise * deviation_; }

  Vec3d operator()(const Coord& p) const {
    Vec3d x = p.asVec3d();
    if (deviation_ > 0)
      for (int axis = 0; axis < 3; ++axis) {
        const detail::WhiteNoise& noise = noise_[size_t(axis)];
        x[axis] += deviation_ * double(noise.value(noise.row(p.x(), p.y()), p.z()));
      }
    return x;
  }

 private:
  double deviation_;
  std::vector<detail::WhiteNoise> noise_;
};

using LabelReader = openvdb::tree::ValueAccessor<const Int32Tree>;

/// 0: there is none.
int32_t labelAt(const LabelReader& labels, const Coord& p) {
  int32_t label = 0;
  return labels.probeValue(p, label) && label > 0 ? label : 0;
}

/// A tree of the leaves with these origins; label(reader of the old tree, voxel, old label) is what
/// a voxel of it has.
template <typename Label>
Int32Tree::Ptr mappedTree(const Int32Tree& tree, const std::set<Coord>& origins,
                          Interrupter* interrupter, const Label& label) {
  const std::vector<Coord> order(origins.begin(), origins.end());
  auto mapped = std::make_shared<Int32Tree>(0);
  detail::addLeaves(*mapped, order.size(), detail::kLeafGrain, interrupter, [&](size_t n) {
    const LabelReader labels(tree);
    auto leaf = std::make_unique<LabelLeaf>(order[n], 0);
    for (openvdb::Index offset = 0; offset < LabelLeaf::SIZE; ++offset) {
      const Coord p = leaf->offsetToGlobalCoord(offset);
      const int32_t own = label(labels, p, labelAt(labels, p));
      if (own > 0) leaf->setValueOn(offset, own);
    }
    return leaf->isEmpty() ? nullptr : std::move(leaf);
  });
  return mapped;
}

/// Of a tree, and of those next to them as well.
std::set<Coord> leafOrigins(const Int32Tree& tree, bool andNeighbors) {
  std::set<Coord> origins;
  const Coord reach(andNeighbors ? 1 : 0);
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
    for (auto step = CoordBBox(-reach, reach).begin(); step; ++step)
      origins.insert(leaf->origin() + Coord((*step).x() * 8, (*step).y() * 8, (*step).z() * 8));
  return origins;
}

/// Labels that have grown by a length into what is empty; below 0: that lost what is so near to it.
/// What lies beyond the domain gets no label, and is empty only beyond closed faces.
Int32Tree::ConstPtr grownTree(const Int32Tree::ConstPtr& tree, double length,
                              const std::optional<Domain>& domain, bool isClosed,
                              Interrupter* interrupter) {
  const auto steps = detail::ballSteps(std::abs(length));
  if (steps.size() == 1) return tree;
  const auto isSeen = [&](const Coord& p) { return !domain || domain->isInside(p); };
  return mappedTree(*tree, leafOrigins(*tree, length > 0), interrupter,
                    [&](const LabelReader& labels, const Coord& p, int32_t own) {
                      if ((own > 0) == (length > 0) || !isSeen(p)) return own;
                      for (const auto& [squared, step] : steps) {
                        const int32_t label = labelAt(labels, p + step);
                        if (length > 0 ? label > 0 : label == 0 && (isClosed || isSeen(p + step)))
                          return label;
                      }
                      return own;
                    });
}

/// Labels that have lost what lies within a gap of a grain to which their bond is broken.
Int32Tree::Ptr brokenTree(const Int32Tree::Ptr& tree, const BondSet& broken, int gap,
                          Interrupter* interrupter) {
  if (broken.empty()) return tree;
  std::set<int32_t> ends;
  for (const auto& [first, second] : broken) ends.insert({first, second});
  const auto steps = detail::ballSteps(gap);
  return mappedTree(*tree, leafOrigins(*tree, false), interrupter,
                    [&](const LabelReader& labels, const Coord& p, int32_t own) {
                      if (!ends.count(own)) return own;
                      for (const auto& [squared, step] : steps)
                        if (const int32_t other = labelAt(labels, p + step);
                            other > 0 && broken.count(std::minmax(own, other)))
                          return 0;
                      return own;
                    });
}

/// A leaf of the result, by its origin, and the label of a grain that may lie in it.
using Target = std::pair<Coord, int32_t>;

std::vector<Target> targetsOf(const std::vector<const LabelLeaf*>& leaves,
                              const MovedGrains& grains, double margin) {
  std::vector<Target> targets;
  for (const LabelLeaf* leaf : leaves) {
    std::set<int32_t> labels;
    int32_t before = 0;
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
      if (*voxel != before) labels.insert(before = *voxel);
    for (const int32_t label : labels) {
      const auto grain = grains.find(label);
      if (grain == grains.end()) continue;
      const CoordBBox bounds = grain->second.boundsOf(leaf->getNodeBoundingBox(), margin);
      detail::forEachLeafOrigin(bounds,
                                [&](const Coord& origin) { targets.emplace_back(origin, label); });
    }
  }
  detail::sortUnique(targets);
  return targets;
}

Int32Tree::Ptr movedTree(const Int32Tree& tree, const MovedGrains& grains, const Shaking& shaken,
                         Interrupter* interrupter) {
  const std::vector<Target> targets = targetsOf(detail::leavesOf(tree), grains, shaken.farthest());
  std::vector<size_t> firsts;  // of each leaf
  for (size_t n = 0; n < targets.size(); ++n)
    if (n == 0 || targets[n].first != targets[n - 1].first) firsts.push_back(n);
  firsts.push_back(targets.size());
  auto moved = std::make_shared<Int32Tree>(0);
  detail::addLeaves(*moved, firsts.size() - 1, detail::kLeafGrain, interrupter, [&](size_t n) {
    const LabelReader values(tree);
    std::vector<const MovedGrain*> near;
    for (size_t at = firsts[n]; at < firsts[n + 1]; ++at)
      near.push_back(&grains.at(targets[at].second));
    auto leaf = std::make_unique<LabelLeaf>(targets[firsts[n]].first, 0);
    for (openvdb::Index offset = 0; offset < LabelLeaf::SIZE; ++offset) {
      const Vec3d x = shaken(leaf->offsetToGlobalCoord(offset));
      const MovedGrain* owner = nullptr;
      for (const MovedGrain* grain : near) {
        int32_t label = 0;
        if (values.probeValue(grain->sourceOf(x), label) && label == grain->label &&
            (!owner || grain->distance(x) < owner->distance(x)))
          owner = grain;
      }
      if (owner) leaf->setValueOn(offset, owner->label);
    }
    return leaf->isEmpty() ? nullptr : std::move(leaf);
  });
  return moved;
}

}  // namespace

const char* toString(EvolvedFate fate) {
  constexpr const char* kNames[] = {"kept", "left", "vanished", "absent"};
  return kNames[size_t(fate)];
}

const char* toString(EvolvedBondFate fate) {
  constexpr const char* kNames[] = {"kept", "broken", "parted", "gone", "new"};
  return kNames[size_t(fate)];
}

void checkEvolve(const EvolveOptions& options) {
  detail::checkRange("number of steps", options.steps, 1, kMostSteps);
  detail::checkRange("strain", options.strain, -0.9, 0.9);
  detail::checkRange("shear", options.shear, -2, 2);
  detail::checkRange("turn", options.degrees, -180, 180);
  for (int axis = 0; axis < 3; ++axis) {
    detail::checkRange("axis of the turn", options.axis[axis], -1e6, 1e6);
    detail::checkRange("drift", options.drift[axis], -kMaxExtent, kMaxExtent);
  }
  if (!(options.axis.length() > 1e-6)) throw InvalidInput("the axis of the turn has no direction");
  detail::checkRange("share that vanishes", options.vanish, 0, 1);
  detail::checkRange("share that enters", options.enter, 0, 1);
  detail::checkRange("share of bonds that break", options.breaks, 0, 1);
  detail::checkRange("gap of a broken bond", options.gap, 1, kMostGap);
  detail::checkRange("growth", options.growth, -kMostGrowth, kMostGrowth);
  detail::checkRange("noise", options.noise, 0, 4);
}

Evolution::Evolution(const Int32Grid& labels, const EvolveOptions& options,
                     Interrupter* interrupter)
    : options_(options),
      tree_(detail::withoutTiles(labels)),
      domain_(storedDomain(labels)),
      boundary_(storedBoundary(labels)),
      voxelSize_(storedVoxelSize(labels)),
      transform_(labels.transform().copy()),
      center_(boxOf(labels).getCenter()) {
  checkEvolve(options);
  requireCubicVoxels(labels, "moving grains");
  detail::ScanLabels scan(labels);
  before_ = detail::scanSums(scan, std::nullopt, interrupter).set;
}

EvolvedStep Evolution::after(int step, Interrupter* interrupter) const {
  detail::checkRange("step", step, 0, options_.steps);
  const double share = double(step) / options_.steps;
  const Mat3d turn = turnAbout(options_.axis, share * options_.degrees);
  Mat3d stretch = Mat3d::identity();
  stretch(2, 2) = 1 - share * options_.strain;
  stretch(0, 2) = share * options_.shear;
  EvolvedStep result;
  result.motion.linear = turn * stretch;
  result.motion.shift = center_ + options_.drift * share - result.motion.linear * center_;

  MovedGrains grains;
  for (const GrainFeatures& grain : before_.grains) {
    detail::RandomSequence random(options_.seed, kGrainStreams + uint64_t(grain.grain));
    const bool isGone = random.uniform() < share * options_.vanish;
    const bool isAbsent = !isGone && random.uniform() < (1 - share) * options_.enter;
    const Mat3d& gradient = options_.rigidGrains ? turn : result.motion.linear;
    // The whole has one center, so that its grains agree also where rounding decides.
    const Vec3d before = options_.rigidGrains ? grain.center : center_;
    if (!isGone && !isAbsent)
      grains[grain.grain] = {grain.grain,           gradient,    gradient.inverse(), before,
                             result.motion(before), grain.volume};
    result.grains.push_back({grain.grain,
                             isGone     ? EvolvedFate::vanished
                             : isAbsent ? EvolvedFate::absent
                                        : EvolvedFate::kept,
                             0, result.motion(grain.center)});
  }
  BondSet broken;
  for (const auto& bond : before_.contacts) {
    const uint64_t stream = kBondStreams + (uint64_t(bond.first) << 32) + uint64_t(bond.second);
    if (detail::RandomSequence(options_.seed, stream).uniform() < share * options_.breaks)
      broken.insert(bond);
  }
  const Int32Tree::ConstPtr grown = grownTree(tree_, share * options_.growth, domain_,
                                              boundary_ == Boundary::closed, interrupter);
  result.labels =
      Int32Grid::create(brokenTree(movedTree(*grown, grains, Shaking(options_, step), interrupter),
                                   broken, options_.gap, interrupter));
  const auto whole = labelSizes(*result.labels, interrupter);
  if (domain_) {
    detail::cutToDomain(*domain_, *result.labels);
    for (auto value = result.labels->beginValueOff(); value; ++value) value.setValue(0);
    openvdb::tools::pruneInactive(result.labels->tree());
  }
  auto within = labelSizes(*result.labels, interrupter);
  for (EvolvedGrain& grain : result.grains) {
    grain.voxels = within[grain.grain];
    const auto all = whole.find(grain.grain);
    if (all != whole.end() && all->second > grain.voxels) grain.fate = EvolvedFate::left;
  }
  result.bonds = bondsOf(result, broken, interrupter);
  result.labels->setName("grain");
  setBoundary(*result.labels, boundary_);
  setStoredVoxelSize(*result.labels, voxelSize_);
  result.labels->setTransform(transform_->copy());
  result.labels->insertMeta(kSourceKey, openvdb::StringMetadata(sourceText(options_, step)));
  return result;
}

std::vector<EvolvedBond> Evolution::bondsOf(const EvolvedStep& step, const BondSet& broken,
                                            Interrupter* interrupter) const {
  std::map<int32_t, EvolvedFate> fates;
  for (const EvolvedGrain& grain : step.grains) fates[grain.grain] = grain.fate;
  const BondSet before(before_.contacts.begin(), before_.contacts.end());
  std::map<std::pair<int32_t, int32_t>, int64_t> faces;  // of all
  for (const auto& bond : before) faces[bond] = 0;
  for (const detail::LabelContact& contact : detail::labelContacts(*step.labels, interrupter))
    faces[{contact.first, contact.second}] = contact.faces;
  std::vector<EvolvedBond> bonds;
  for (const auto& [bond, count] : faces) {
    EvolvedBondFate fate = count > 0 ? EvolvedBondFate::kept : EvolvedBondFate::parted;
    if (!before.count(bond))
      fate = EvolvedBondFate::created;
    else if (fates.at(bond.first) != EvolvedFate::kept ||
             fates.at(bond.second) != EvolvedFate::kept)
      fate = EvolvedBondFate::gone;
    else if (broken.count(bond))
      fate = EvolvedBondFate::broken;
    bonds.push_back({bond.first, bond.second, fate, count});
  }
  return bonds;
}

}  // namespace vdb_madf
