// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/simplify.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/shapes/detail/quadric.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr uint32_t kNone = SharedMesh::kNone;
constexpr size_t kSiteGrain = 1024;
constexpr size_t kGrainGrain = 4;
/// The part of the sites that may go, those of least error, that goes in one pass: a smaller one is
/// nearer to strict order, and takes more passes.
constexpr double kPassPart = 0.4;
/// More triangles around a point make fans.
constexpr size_t kMaxValence = 32;
/// Cosine of the angle by which no triangle may turn at once.
constexpr double kMinCosine = 0.2;
/// Planes along rims, by the square of their edges, against those of triangles, by their areas.
constexpr double kRimWeight = 1.0;
/// Squared error for each squared voxel of length: on planes short edges go first.
constexpr double kLengthCost = 1e-5;

/// An edge from a point to another of its grain, with the triangles on its two sides.
struct Spoke {
  uint32_t point, out, in;  ///< out: the triangle that goes from the center to the point
  bool isRim;               ///< the two triangles have unlike things beyond them
};
using Ring = std::vector<Spoke>;

struct Collapse {
  double cost;
  uint32_t from, to;
  bool operator<(const Collapse& other) const {
    return std::tie(cost, from) < std::tie(other.cost, other.from);
  }
};

class Simplifier {
 public:
  Simplifier(SharedMesh& mesh, double error, Interrupter* interrupter)
      : mesh_(mesh), mostSquared_(error * error), interrupter_(interrupter) {}

  bool run(uint64_t triangles) {
    if (mesh_.triangles.size() <= triangles) return false;
    if (mesh_.triangles.size() > kNone / 3)
      throw InvalidInput(
          "a mesh of more than 1,431,655,765 triangles cannot be simplified: coarsen or crop the "
          "volume");
    separateSites();
    pointsOfSite_.emplace(mesh_.pointSite, mesh_.positions.size());
    listTriangles();
    const size_t before = mesh_.triangles.size();
    beginSites();
    while (mesh_.triangles.size() > triangles) {
      WorkPart part(interrupter_, percentDone(before, triangles), percentDone(before, triangles));
      propose(&part);
      select(triangles);
      if (chosen_.empty()) break;
      apply();
      dropTriangles();
      listTriangles();
    }
    if (mesh_.triangles.size() == before) return false;
    dropPoints();
    return true;
  }

 private:
  /// Each pass takes about the same part of what is left.
  int percentDone(size_t before, uint64_t triangles) const {
    const double all = std::log(double(before) / double(triangles));
    return int(100 * std::log(double(before) / double(mesh_.triangles.size())) / all);
  }

  /// Where a grain meets itself and no other grain is, each of its points may go its own way.
  void separateSites() {
    const Lists points(mesh_.pointSite, mesh_.positions.size());
    for (size_t site = 0; site + 1 < points.first.size(); ++site) {
      const uint32_t begin = points.first[site], end = points.first[site + 1];
      const auto isOther = [&](uint32_t i) {
        return mesh_.pointGrain[points.items[i]] != mesh_.pointGrain[points.items[begin]];
      };
      bool isAlone = true;
      for (uint32_t i = begin; i < end; ++i) isAlone = isAlone && !isOther(i);
      for (uint32_t i = begin + 1; isAlone && i < end; ++i) {
        mesh_.pointSite[points.items[i]] = uint32_t(mesh_.positions.size());
        mesh_.positions.push_back(Vec3f(mesh_.positions[site]));
      }
    }
  }

  template <typename F>
  void forEachGrain(const F& f) const {
    parallelForEach(mesh_.grainCount(), kGrainGrain, nullptr,
                    [&](size_t g) { f(g, mesh_.firstTriangle[g], mesh_.firstTriangle[g + 1]); });
  }

  template <typename F>
  void forEachPoint(uint32_t site, const F& f) const {
    for (uint32_t i = pointsOfSite_->first[site]; i < pointsOfSite_->first[site + 1]; ++i)
      f(pointsOfSite_->items[i]);
  }

  /// The triangles around each point; those of different grains have none in common.
  void listTriangles() {
    lastAround_.assign(mesh_.pointSite.size(), 0);
    forEachGrain([&](size_t, uint32_t begin, uint32_t end) {
      for (uint32_t t = begin; t < end; ++t)
        for (const uint32_t point : mesh_.triangles[t]) ++lastAround_[point];
    });
    firstAround_.resize(lastAround_.size());
    uint32_t sum = 0;
    for (size_t p = 0; p < lastAround_.size(); ++p) {
      firstAround_[p] = sum;
      sum += lastAround_[p];
      lastAround_[p] = firstAround_[p];
    }
    around_.resize(sum);
    forEachGrain([&](size_t, uint32_t begin, uint32_t end) {
      for (uint32_t t = begin; t < end; ++t)
        for (const uint32_t point : mesh_.triangles[t]) around_[lastAround_[point]++] = t;
    });
  }

  template <typename F>
  void forEachTriangle(uint32_t point, const F& f) const {
    for (uint32_t i = firstAround_[point]; i < lastAround_[point]; ++i) f(around_[i]);
  }

  /// The two corners after a point of a triangle.
  std::array<uint32_t, 2> after(uint32_t triangle, uint32_t point) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return point == a ? std::array{b, c} : point == b ? std::array{c, a} : std::array{a, b};
  }

  Vec3d at(uint32_t point) const { return Vec3d(mesh_.positions[mesh_.pointSite[point]]); }

  void readRing(uint32_t center, Ring& ring) const {
    ring.clear();
    forEachTriangle(center, [&](uint32_t t) {
      ring.push_back({after(t, center)[0], t, kNone, false});
    });
    forEachTriangle(center, [&](uint32_t t) {
      const auto spoke = find(ring, after(t, center)[1]);
      spoke->in = t;
      spoke->isRim = mesh_.beyond[spoke->out] != mesh_.beyond[t];
    });
  }

  static Ring::iterator find(Ring& ring, uint32_t point) {
    return std::find_if(ring.begin(), ring.end(),
                        [&](const Spoke& spoke) { return spoke.point == point; });
  }

  static size_t rimCount(const Ring& ring) {
    return size_t(std::count_if(ring.begin(), ring.end(), [](const Spoke& s) { return s.isRim; }));
  }

  /// Sites that may go, and the planes around each.
  void beginSites() {
    const size_t count = mesh_.positions.size();
    quadrics_.resize(count);
    stamps_.assign(count, 0);
    std::vector<uint8_t> isFree(count);
    WorkPart part(interrupter_, 0, 0);
    parallelFor(count, kSiteGrain, &part, [&](size_t begin, size_t end) {
      Ring ring;
      for (size_t site = begin; site < end; ++site) {
        forEachPoint(uint32_t(site), [&](uint32_t p) { addPlanes(p, ring, quadrics_[site]); });
        isFree[site] = hasDistinctGrains(uint32_t(site));
      }
    });
    for (size_t site = 0; site < count; ++site)
      if (isFree[site]) sites_.push_back(uint32_t(site));
  }

  bool hasDistinctGrains(uint32_t site) const {
    std::vector<uint32_t> grains;
    forEachPoint(site, [&](uint32_t p) { grains.push_back(mesh_.pointGrain[p]); });
    std::sort(grains.begin(), grains.end());
    return std::adjacent_find(grains.begin(), grains.end()) == grains.end();
  }

  void addPlanes(uint32_t point, Ring& ring, Quadric& quadric) const {
    readRing(point, ring);
    const Vec3d here = at(point);
    for (const Spoke& spoke : ring) {
      const Vec3d along = at(spoke.point) - here;
      for (const uint32_t t : {spoke.out, spoke.in}) {
        const auto [b, c] = after(t, point);
        const Vec3d across = (at(b) - here).cross(at(c) - here);
        const double twice = across.length();
        if (!(twice > 0)) continue;
        if (t == spoke.out) quadric.addPlane(here, across / twice, twice / 2);
        if (!spoke.isRim) continue;
        const Vec3d upright = along.cross(across);
        const double length = upright.length();
        if (length > 0) quadric.addPlane(here, upright / length, kRimWeight * along.lengthSqr());
      }
    }
  }

  /// Scratch space of proposeFor().
  struct Work {
    std::vector<Ring> rings;  ///< of the site's points
    std::vector<size_t> rims;
    std::vector<uint32_t> points;
    std::vector<Collapse> collapses;
    Ring other;
  };

  void propose(Interrupter* interrupter) {
    costs_.resize(sites_.size());
    parallelFor(sites_.size(), kSiteGrain, interrupter, [&](size_t begin, size_t end) {
      Work work;
      for (size_t i = begin; i < end; ++i) costs_[i] = proposeFor(sites_[i], work);
    });
    proposed_.clear();
    for (const Collapse& collapse : costs_)
      if (collapse.to != kNone) proposed_.push_back(collapse);
    parallelSort(proposed_.begin(), proposed_.end());
  }

  /// The cheapest collapse of a site that is allowed.
  Collapse proposeFor(uint32_t site, Work& work) const {
    const Collapse none{0, site, kNone};
    work.points.clear();
    forEachPoint(site, [&](uint32_t p) { work.points.push_back(p); });
    work.rings.resize(std::max(work.rings.size(), work.points.size()));
    work.rims.clear();
    for (size_t k = 0; k < work.points.size(); ++k) {
      readRing(work.points[k], work.rings[k]);
      work.rims.push_back(rimCount(work.rings[k]));
      // Where rims meet or end, the site stays.
      if (work.rims[k] != 0 && work.rims[k] != 2) return none;
    }
    work.collapses.clear();
    for (const Spoke& spoke : work.rings[0]) {
      if (work.rims[0] == 2 && !spoke.isRim) continue;
      const Vec3d there = at(spoke.point);
      const double error = quadrics_[site].at(there);
      if (error > mostSquared_) continue;
      const Vec3d here(mesh_.positions[site]);
      work.collapses.push_back(
          {error + kLengthCost * (there - here).lengthSqr(), site, mesh_.pointSite[spoke.point]});
    }
    std::sort(work.collapses.begin(), work.collapses.end(), [](const auto& a, const auto& b) {
      return std::tie(a.cost, a.to) < std::tie(b.cost, b.to);
    });
    for (const Collapse& collapse : work.collapses)
      if (isAllowed(collapse.to, work)) return collapse;
    return none;
  }

  bool isAllowed(uint32_t to, Work& work) const {
    for (size_t k = 0; k < work.points.size(); ++k) {
      const Spoke* edge = nullptr;
      for (const Spoke& spoke : work.rings[k]) {
        if (mesh_.pointSite[spoke.point] != to) continue;
        if (edge) return false;
        edge = &spoke;
      }
      if (!edge || (work.rims[k] == 2 && !edge->isRim)) return false;
      if (!isAllowed(work.points[k], *edge, work.rings[k], work.rims[k] == 2, work.other))
        return false;
    }
    return true;
  }

  /// True if a point of the ring is linked to the center and to another point by rims.
  bool joinsRims(uint32_t to, Ring& ring, Ring& other) const {
    readRing(to, other);
    return std::any_of(other.begin(), other.end(), [&](const Spoke& spoke) {
      if (!spoke.isRim) return false;
      const auto also = find(ring, spoke.point);
      return also != ring.end() && also->isRim;
    });
  }

  /// Does the surface of one grain allow it? It stays one of discs around points (the link
  /// condition of closed surfaces), no rim meets another one, and no triangle turns over.
  bool isAllowed(uint32_t from, const Spoke& edge, Ring& ring, bool isOnRim, Ring& other) const {
    const uint32_t to = edge.point;
    size_t valence = 0, common = 0;
    forEachTriangle(to, [&](uint32_t t) {
      ++valence;
      common += find(ring, after(t, to)[0]) != ring.end();
    });
    if (ring.size() + valence > kMaxValence + 4) return false;
    if (ring.size() == 3 && valence == 3) return false;  // a tetrahedron
    if (common != 2 || (isOnRim && joinsRims(to, ring, other))) return false;
    const Vec3d here = at(from), there = at(to);
    for (const Spoke& spoke : ring) {
      if (spoke.out == edge.out || spoke.out == edge.in) continue;
      const Vec3d b = at(spoke.point), c = at(after(spoke.out, from)[1]);
      const Vec3d before = (b - here).cross(c - here), now = (b - there).cross(c - there);
      if (!(now.lengthSqr() > 0) ||
          before.dot(now) < kMinCosine * std::sqrt(before.lengthSqr() * now.lengthSqr()))
        return false;
    }
    return true;
  }

  /// Collapses that do not know of each other: none begins or ends at a site whose neighbors
  /// another one changes.
  void select(uint64_t triangles) {
    chosen_.clear();
    ++stamp_;
    uint64_t left = mesh_.triangles.size();
    const size_t most = size_t(kPassPart * double(proposed_.size())) + 1;
    for (size_t i = 0; i < std::min(most, proposed_.size()) && left > triangles; ++i) {
      const Collapse& collapse = proposed_[i];
      if (stamps_[collapse.from] == stamp_ || stamps_[collapse.to] == stamp_) continue;
      chosen_.push_back(collapse);
      stamps_[collapse.to] = stamp_;
      forEachPoint(collapse.from, [&](uint32_t point) {
        left -= 2;
        forEachTriangle(point, [&](uint32_t t) {
          for (const uint32_t corner : mesh_.triangles[t])
            stamps_[mesh_.pointSite[corner]] = stamp_;
        });
      });
    }
  }

  void apply() {
    parallelForEach(chosen_.size(), kSiteGrain, nullptr, [&](size_t i) {
      const Collapse& collapse = chosen_[i];
      forEachPoint(collapse.from, [&](uint32_t point) { move(point, collapse.to); });
      quadrics_[collapse.to] += quadrics_[collapse.from];
    });
    for (const Collapse& collapse : chosen_) stamps_[collapse.from] = kNone;
    sites_.erase(std::remove_if(sites_.begin(), sites_.end(),
                                [&](uint32_t site) { return stamps_[site] == kNone; }),
                 sites_.end());
  }

  void move(uint32_t point, uint32_t to) {
    uint32_t target = kNone;
    forEachPoint(to, [&](uint32_t other) {
      if (mesh_.pointGrain[other] == mesh_.pointGrain[point] && isNeighbor(point, other))
        target = other;
    });
    forEachTriangle(point, [&](uint32_t t) {
      auto& triangle = mesh_.triangles[t];
      if (std::count(triangle.begin(), triangle.end(), target))
        triangle[0] = kNone;
      else
        std::replace(triangle.begin(), triangle.end(), point, target);
    });
  }

  bool isNeighbor(uint32_t point, uint32_t other) const {
    bool result = false;
    forEachTriangle(point, [&](uint32_t t) {
      const auto& triangle = mesh_.triangles[t];
      result = result || std::count(triangle.begin(), triangle.end(), other);
    });
    return result;
  }

  void dropTriangles() {
    std::vector<uint32_t> first(mesh_.firstTriangle.size());
    forEachGrain([&](size_t grain, uint32_t begin, uint32_t end) {
      for (uint32_t t = begin; t < end; ++t) first[grain + 1] += mesh_.triangles[t][0] != kNone;
    });
    for (size_t g = 1; g < first.size(); ++g) first[g] += first[g - 1];
    std::vector<std::array<uint32_t, 3>> triangles(first.back());
    std::vector<int32_t> beyond(first.back());
    forEachGrain([&](size_t grain, uint32_t begin, uint32_t end) {
      uint32_t next = first[grain];
      for (uint32_t t = begin; t < end; ++t) {
        if (mesh_.triangles[t][0] == kNone) continue;
        triangles[next] = mesh_.triangles[t];
        beyond[next++] = mesh_.beyond[t];
      }
    });
    mesh_.firstTriangle.swap(first);
    mesh_.triangles.swap(triangles);
    mesh_.beyond.swap(beyond);
  }

  void dropPoints() {
    std::vector<uint32_t> site(mesh_.positions.size(), kNone), point(mesh_.pointSite.size(), kNone);
    uint32_t sites = 0, points = 0;
    for (size_t p = 0; p < point.size(); ++p) {
      if (firstAround_[p] == lastAround_[p]) continue;
      uint32_t& place = site[mesh_.pointSite[p]];
      if (place == kNone) place = 0;
      mesh_.pointSite[points] = mesh_.pointSite[p];
      mesh_.pointGrain[points] = mesh_.pointGrain[p];
      point[p] = points++;
    }
    mesh_.pointSite.resize(points);
    mesh_.pointGrain.resize(points);
    for (size_t s = 0; s < site.size(); ++s) {
      if (site[s] == kNone) continue;
      mesh_.positions[sites] = Vec3f(mesh_.positions[s]);
      site[s] = sites++;
    }
    mesh_.positions.resize(sites);
    for (uint32_t& s : mesh_.pointSite) s = site[s];
    for (auto& triangle : mesh_.triangles)
      for (uint32_t& p : triangle) p = point[p];
  }

  SharedMesh& mesh_;
  const double mostSquared_;
  Interrupter* interrupter_;
  std::optional<Lists> pointsOfSite_;
  std::vector<uint32_t> firstAround_, lastAround_, around_;  // triangles of points
  std::vector<uint32_t> sites_;                              // that may still go
  std::vector<Quadric> quadrics_;                            // per site
  std::vector<Collapse> costs_, proposed_, chosen_;
  std::vector<uint32_t> stamps_;  // per site: the last pass that changed its neighbors
  uint32_t stamp_ = 0;
};

}  // namespace

bool simplify(SharedMesh& mesh, uint64_t triangles, double error, Interrupter* interrupter) {
  return Simplifier(mesh, error, interrupter).run(triangles);
}

}  // namespace vdb_madf::detail
