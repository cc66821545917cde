// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/random_case.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf::test {

namespace {

constexpr std::array<int64_t, 6> kGammas = {0, 1, 2, 5, 20, 100};
constexpr std::array<int64_t, 6> kFillHoles = {0, 2, 5, 27, 100, 100000};
constexpr std::array<int, 6> kDeltas = {0, 1, 2, 4, 20, 80};
constexpr std::array<int, 4> kTidies = {0, 1, 2, 5};
constexpr std::array<double, 8> kThetas = {-1, -0.95, -0.9, -0.8, -0.5, 0, 0.5, 1};
constexpr std::array<const char*, 3> kBoundaryNames = {"automatic", "open", "closed"};
constexpr std::array<double, 7> kStrictnesses = {11, -200, 4, 8, 10, 13.5, 20};
constexpr std::array<int64_t, 6> kMinGrains = {0, 27, 0, 4, 0, 300};
constexpr std::array<const char*, 4> kModeNames = {"both", "angle", "neck", "score"};

void setRegion(RandomCase& c, const ObjectVolume& region) {
  const CoordBBox box = objectBox(region);
  if (box.empty()) {
    c.region.reset();
    return;
  }
  c.domain = box;
  c.region = withBox(region, box);
}

/// A round or ragged part of a box.
ObjectVolume randomRegion(const CoordBBox& box, Rng& rng) {
  ObjectVolume region(box);
  const int kind = rng.below(6), axis = rng.below(3);
  const openvdb::Vec3d center = box.getCenter(), half = box.dim().asVec3d() / 2;
  const double inner = rng.unit() * 0.8, share = 0.3 + 0.7 * rng.unit();
  for (int i = 0; i < region.size(); ++i) {
    const Coord p = region.coord(i);
    openvdb::Vec3d d = (p.asVec3d() - center) / half;
    bool inside = false;
    if (kind == 0) d[axis] = 0;                                        // a cylinder
    if (kind <= 1) inside = d.length() <= 1;                           // a ball
    if (kind == 2) inside = d.length() <= 1.2 && d.length() >= inner;  // a shell
    if (kind == 3) inside = rng.chance(share);                         // noise
    if (kind == 4) inside = std::abs(d[axis]) > inner * 0.8;           // two parts
    if (kind == 5) inside = d[0] + d[1] * inner + d[2] * share < 0.3;  // cut off at an angle
    region[i] = inside;
  }
  return region;
}

/// Without the slice at `position`; what lies beyond it moves down by one.
CoordBBox withoutSlice(CoordBBox box, int axis, int position) {
  if (box.min()[axis] > position) --box.min()[axis];
  if (box.max()[axis] >= position) --box.max()[axis];
  return box;
}

RandomCase withoutSlice(const RandomCase& c, int axis, int position) {
  RandomCase result = c;
  result.object = ObjectVolume(withoutSlice(c.object.box(), axis, position));
  for (int i = 0; i < result.object.size(); ++i) {
    Coord p = result.object.coord(i);
    if (p[axis] >= position) ++p[axis];
    result.object[i] = c.object[p];
  }
  if (c.domain) result.domain = withoutSlice(*c.domain, axis, position);
  if (c.region) {
    ObjectVolume region(*result.domain);
    for (int i = 0; i < region.size(); ++i) {
      Coord p = region.coord(i);
      if (p[axis] >= position) ++p[axis];
      region[i] = c.region->get(p, 0);
    }
    setRegion(result, region);
  }
  return result;
}

/// Of a third of the cases: small ones, those of likely voxels, any; all along every axis. A
/// generator of its own leaves the rest of a case as it was.
std::optional<VoxelWeights> randomWeights(uint64_t seed) {
  Rng rng(seed * 3 + (uint64_t(1) << 40));
  if (rng.chance(2. / 3)) return std::nullopt;
  constexpr std::array<std::array<int, 3>, 8> kTriples = {{{1, 1, 2},
                                                           {1, 1, 4},
                                                           {1, 2, 3},
                                                           {1, 4, 9},
                                                           {1, 1, 400},
                                                           {25, 25, 144},
                                                           {4, 4, 4},
                                                           {9, 9, 1}}};
  const int which = rng.below(int(kTriples.size()) + 2);
  std::array<int, 3> w{};
  if (which < int(kTriples.size()))
    w = kTriples[size_t(which)];
  else
    for (int& weight : w) weight = rng.between(1, which % 2 ? 12 : 100000);
  for (int i = 2; i > 0; --i) std::swap(w[size_t(i)], w[size_t(rng.below(i + 1))]);
  return VoxelWeights{w[0], w[1], w[2]};
}

class Shrinker {
 public:
  Shrinker(RandomCase failing, const std::function<bool(const RandomCase&)>& fails, int tries)
      : best_(std::move(failing)), fails_(fails), tries_(tries) {}

  RandomCase run() {
    for (bool smaller = true; smaller && tries_ > 0;) {
      smaller = simplifyOptions();
      smaller = dropSlices() || smaller;
      smaller = dropBlocks() || smaller;
    }
    return best_;
  }

 private:
  bool take(const RandomCase& candidate) {
    if (tries_-- <= 0 || !fails_(candidate)) return false;
    best_ = candidate;
    return true;
  }

  bool dropSlices() {
    bool smaller = false;
    for (int axis = 0; axis < 3; ++axis)
      for (int at = best_.object.box().max()[axis]; at >= best_.object.box().min()[axis]; --at)
        if (best_.object.box().dim()[axis] > 1)
          smaller = take(withoutSlice(best_, axis, at)) || smaller;
    return smaller;
  }

  /// Clears parts of the object: halves of what is left, then smaller ones, at last single voxels.
  bool dropBlocks() {
    bool smaller = false;
    std::vector<int> voxels;
    for (int i = 0; i < best_.object.size(); ++i)
      if (best_.object[i]) voxels.push_back(i);
    for (size_t part = (voxels.size() + 1) / 2; part > 0; part = part > 1 ? (part + 1) / 2 : 0)
      for (size_t first = 0; first < voxels.size(); first += part) {
        RandomCase candidate = best_;
        for (size_t i = first; i < std::min(first + part, voxels.size()); ++i)
          candidate.object[voxels[i]] = 0;
        if (!(candidate.object == best_.object)) smaller = take(candidate) || smaller;
        if (tries_ <= 0) return smaller;
      }
    return smaller;
  }

  bool simplifyOptions() {
    bool simpler = false;
    const auto attempt = [&](bool worthwhile, const auto& change) {
      if (!worthwhile) return;
      RandomCase candidate = best_;
      change(candidate);
      simpler = take(candidate) || simpler;
    };
    attempt(best_.threads != 1, [](RandomCase& c) { c.threads = 1; });
    attempt(best_.tiles != Tiles::none, [](RandomCase& c) { c.tiles = Tiles::none; });
    attempt(best_.options.gamma != 0, [](RandomCase& c) { c.options.gamma = 0; });
    attempt(best_.options.fillHoles != 0, [](RandomCase& c) { c.options.fillHoles = 0; });
    attempt(best_.options.merge.delta != 0, [](RandomCase& c) { c.options.merge.delta = 0; });
    attempt(best_.options.merge.minGrain != 0, [](RandomCase& c) { c.options.merge.minGrain = 0; });
    attempt(best_.options.tidy != 0, [](RandomCase& c) { c.options.tidy = 0; });
    attempt(best_.options.weights.has_value(), [](RandomCase& c) { c.options.weights.reset(); });
    attempt(best_.domain.has_value(), [](RandomCase& c) {
      c.domain.reset();
      c.region.reset();
      c.domainInMetadata = false;
      c.options.boundary = Boundary::automatic;
    });
    attempt(best_.region.has_value(), [](RandomCase& c) { c.region.reset(); });
    attempt(best_.domainInMetadata, [](RandomCase& c) { c.domainInMetadata = false; });
    const Coord origin = best_.object.box().min();
    attempt(origin != Coord(0), [&](RandomCase& c) {
      c.object = translated(c.object, Coord(0) - origin);
      if (c.domain) c.domain->translate(Coord(0) - origin);
      if (c.region) c.region = translated(*c.region, Coord(0) - origin);
    });
    return simpler;
  }

  RandomCase best_;
  const std::function<bool(const RandomCase&)>& fails_;
  int tries_;
};

}  // namespace

RandomCase randomCase(uint64_t seed, const std::optional<Coord>& size) {
  RandomCase c;
  c.seed = seed;
  int turn = int(seed % uint64_t(kCombinations));
  const auto choose = [&](int count) {
    const int chosen = turn % count;
    turn /= count;
    return chosen;
  };
  c.options.boundary = Boundary(choose(3));
  c.options.merge.adjacency = Adjacency(choose(2));
  c.options.merge.mode = MergeMode(choose(4));
  c.threads = 1 + choose(3);

  Rng rng(seed);
  c.options.gamma = kGammas[size_t(rng.below(int(kGammas.size())))];
  c.options.merge.theta = kThetas[size_t(rng.below(int(kThetas.size())))];
  const int holes = rng.below(int(kFillHoles.size()) + 2);  // twice the default
  if (holes < int(kFillHoles.size())) c.options.fillHoles = kFillHoles[size_t(holes)];
  c.options.merge.delta = kDeltas[size_t(rng.below(int(kDeltas.size())))];
  c.options.tidy = kTidies[size_t(rng.below(int(kTidies.size())))];
  c.kind = VolumeKind(rng.below(kVolumeKinds));
  const Coord origin = randomOrigin(rng);
  Coord drawn = randomSize(rng);
  if (seed % 6 == 5) drawn[int(seed / 6 % 3)] = 1;  // a slice
  c.object = randomVolume(c.kind, boxAt(origin, size.value_or(drawn)), rng);
  c.domain = randomDomain(c.object, rng);
  // Open without a domain is an error: rarely worth a run.
  if (c.options.boundary == Boundary::open && !c.domain && rng.chance(0.9))
    c.domain = c.object.box();
  c.domainInMetadata = c.domain && rng.chance(0.5);
  c.tiles = rng.chance(0.5) ? Tiles::wherePossible : Tiles::none;
  c.options.weights = randomWeights(seed);
  c.options.merge.strictness = kStrictnesses[seed / 7 % kStrictnesses.size()];
  c.options.merge.minGrain = kMinGrains[seed / 11 % kMinGrains.size()];
  return c;
}

void drawRegion(RandomCase& c) {
  if (!c.domain) return;
  Rng rng(c.seed + 77);
  CoordBBox box = *c.domain;
  if (rng.chance(0.3) && box.dim().x() > 2) box.min().x() += 1;  // the object loses a face
  ObjectVolume region = randomRegion(box, rng);
  if (objectBox(region).empty()) return;
  setRegion(c, region);
  for (int i = 0; i < c.object.size(); ++i)
    if (!c.region->get(c.object.coord(i), 0)) c.object[i] = 0;
}

std::optional<Domain> domainOf(const RandomCase& c) {
  if (c.region) return Domain(toMask(*c.region, c.tiles)->tree());
  if (c.domain) return Domain(*c.domain);
  return {};
}

std::optional<OracleDomain> oracleDomainOf(const RandomCase& c) {
  if (c.region) return OracleDomain(*c.region);
  if (c.domain) return OracleDomain(*c.domain);
  return {};
}

MaskGrid::Ptr maskOf(const RandomCase& c) {
  auto mask = toMask(c.object, c.tiles);
  if (c.domain && c.domainInMetadata) setDomain(*mask, *domainOf(c));
  return mask;
}

SegmentOptions optionsOf(const RandomCase& c) {
  SegmentOptions options = c.options;
  if (!c.domainInMetadata) options.domain = domainOf(c);
  options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = true;
  return options;
}

std::string describe(const RandomCase& c) {
  constexpr int kMaxPictureBytes = 3000;
  std::ostringstream text;
  const Coord dim = c.object.size() ? c.object.box().dim() : Coord(0);
  text << "seed " << c.seed << ": " << name(c.kind) << ", " << dim << " voxels from "
       << c.object.box().min() << ", " << countObject(c.object) << " of them object; domain "
       << (c.domain ? toString(*c.domain) : "unknown")
       << (c.domainInMetadata ? " (in the metadata)" : "") << "; boundary "
       << kBoundaryNames[size_t(c.options.boundary)] << ", gamma " << c.options.gamma << ", theta "
       << std::setprecision(17) << c.options.merge.theta << ", mode "
       << kModeNames[size_t(c.options.merge.mode)] << ", adjacency "
       << (c.options.merge.adjacency == Adjacency::cell ? "cell" : "manifold") << ", fill-holes "
       << (c.options.fillHoles ? std::to_string(*c.options.fillHoles) : "default") << ", delta "
       << c.options.merge.delta << ", strictness " << c.options.merge.strictness << ", least grain "
       << c.options.merge.minGrain << ", tidy " << c.options.tidy << ", weights "
       << c.options.weights.value_or(VoxelWeights{}).toString() << ", "
       << (c.tiles == Tiles::none ? "no tiles, " : "tiles, ") << c.threads << " threads\n";
  if (c.object.size() <= kMaxPictureBytes) text << picture(c.object);
  if (c.region) text << "in a region of " << countObject(*c.region) << " voxels\n";
  if (c.region && c.region->size() <= kMaxPictureBytes) text << picture(*c.region);
  return text.str();
}

RandomCase shrink(RandomCase failing, const std::function<bool(const RandomCase&)>& fails,
                  int tries) {
  return Shrinker(std::move(failing), fails, tries).run();
}

}  // namespace vdb_madf::test
