// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/net_builder.h"

#include <algorithm>
#include <bitset>
#include <limits>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/shapes/detail/corner_fans.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kBlockGrain = 16;

class NetBuilder {
 public:
  NetBuilder(const LabelBlocks& blocks, const CoordBBox& domain, bool withLinks,
             Interrupter* interrupter)
      : blocks_(blocks), domain_(domain), withLinks_(withLinks), interrupter_(interrupter) {}

  SurfaceNet build() {
    count();
    net_.corners.resize(firstCorner_.back());
    net_.firstPoint.resize(net_.corners.size() + 1);
    net_.firstPoint.back() = firstPoint_.back();
    net_.pointGrain.resize(firstPoint_.back());
    net_.pointCorner.resize(firstPoint_.back());
    if (withLinks_) {
      std::array<uint32_t, 6> none;
      none.fill(SurfaceNet::kNone);
      net_.links.assign(net_.corners.size(), none);
      // Bits of both ends are set by the block of the lower one: a byte per direction until then.
      junctionBytes_.resize(net_.corners.size());
    }
    quads_.resize(firstQuad_.back());
    quadGrain_.resize(firstQuad_.back());
    quadBeyond_.resize(firstQuad_.back());
    pinches_.resize(blocks_.size());
    forEachBlock(30, 50, [&](size_t block, const LabelHalo& halo) { placeCorners(block, halo); });
    forEachBlock(50, 100, [&](size_t block, const LabelHalo& halo) { makeQuads(block, halo); });
    if (withLinks_) packJunctions();
    for (const auto& pinches : pinches_)
      net_.pinches.insert(net_.pinches.end(), pinches.begin(), pinches.end());
    std::sort(net_.pinches.begin(), net_.pinches.end());
    sortQuads();
    return std::move(net_);
  }

 private:
  /// From one to the other per cent of the work.
  template <typename F>
  void forEachBlock(int beginPercent, int endPercent, const F& f) const {
    WorkPart part(interrupter_, beginPercent, endPercent);
    parallelFor(blocks_.size(), kBlockGrain, &part, [&](size_t begin, size_t end) {
      LabelHalo halo;
      for (size_t block = begin; block < end; ++block) {
        blocks_.readHalo(block, halo);
        f(block, halo);
      }
    });
  }

  template <typename F>
  static void forEachPlace(const F& f) {
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y)
        for (int z = 0; z < 8; ++z) f(x, y, z);
  }

  /// Visits the places of a block around whose corners the labels are not all alike.
  template <typename F>
  static void forEachMixedPlace(const LabelHalo& halo, const F& f) {
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y) {
        const int32_t* row = &halo[haloAt(x, y, 0)];
        std::array<int32_t, 8> isMixed{};  // along z
        for (const int step : {0, kHaloStride[0], kHaloStride[1], kHaloStride[0] + kHaloStride[1]})
          for (int z = 0; z < 8; ++z)
            isMixed[size_t(z)] |= (row[z] ^ row[z - step]) | (row[z] ^ row[z - step - 1]);
        for (int z = 0; z < 8; ++z)
          if (isMixed[size_t(z)]) f(x, y, z);
      }
  }

  void count() {
    std::vector<std::array<uint32_t, 3>> counts(blocks_.size());
    forEachBlock(0, 30, [&](size_t block, const LabelHalo& halo) {
      uint32_t corners = 0, points = 0, quads = 0;
      forEachMixedPlace(halo, [&](int x, int y, int z) {
        const int32_t* at = &halo[haloAt(x, y, z)];
        const Corner corner(at);
        ++corners;
        points += uint32_t(corner.pointCount);
        for (const int step : kHaloStride)
          if (at[0] != at[-step]) quads += uint32_t(at[0] > 0) + uint32_t(at[-step] > 0);
      });
      counts[block] = {corners, points, quads};
    });
    uint64_t corners = 0, points = 0, quads = 0;
    for (const auto& [c, p, q] : counts) {
      firstCorner_.push_back(uint32_t(corners));
      firstPoint_.push_back(uint32_t(points));
      firstQuad_.push_back(uint32_t(quads));
      corners += c;
      points += p;
      quads += q;
      if (std::max(points, 2 * quads) >= std::numeric_limits<uint32_t>::max())
        throw InvalidInput(
            "the meshes have more than 4,294,967,294 points or triangles: "
            "coarsen or crop the volume");
    }
    firstCorner_.push_back(uint32_t(corners));
    firstPoint_.push_back(uint32_t(points));
    firstQuad_.push_back(uint32_t(quads));
  }

  void placeCorners(size_t block, const LabelHalo& halo) {
    uint32_t number = firstCorner_[block], point = firstPoint_[block];
    forEachMixedPlace(halo, [&](int x, int y, int z) {
      const Corner corner(&halo[haloAt(x, y, z)]);
      net_.corners[number] = blocks_.origin(block).offsetBy(x, y, z);
      net_.firstPoint[number] = point;
      for (int g = 0; g < corner.grains; ++g)
        for (int fan = 0; fan < fans().count[corner.set[size_t(g)]]; ++fan) {
          net_.pointGrain[point] = blocks_.number(corner.label[size_t(g)]);
          net_.pointCorner[point++] = number;
        }
      ++number;
    });
  }

  /// Numbers of the corners 0 .. 8 of a block, its own and those of the blocks above it.
  static constexpr int kSide = 9;
  using CornerTable = std::array<uint32_t, kSide * kSide * kSide>;
  static size_t tableAt(int x, int y, int z) { return size_t((x * kSide + y) * kSide + z); }

  void readCorners(size_t block, CornerTable& table) const {
    table.fill(SurfaceNet::kNone);
    const Coord origin = blocks_.origin(block);
    for (int side = 0; side < 8; ++side) {
      const Coord step(8 * (side >> 2), 8 * (side >> 1 & 1), 8 * (side & 1));
      const size_t other = side == 0 ? block : blocks_.find(origin + step);
      if (other == LabelBlocks::kNone) continue;
      for (uint32_t i = firstCorner_[other]; i < firstCorner_[other + 1]; ++i) {
        const Coord p = net_.corners[i] - origin;
        if (p.x() <= 8 && p.y() <= 8 && p.z() <= 8) table[tableAt(p.x(), p.y(), p.z())] = i;
      }
    }
  }

  /// The corners of a block as they are met: each is one of many quads.
  class CornerCache {
   public:
    /// Another block.
    void begin(const LabelHalo& halo) {
      halo_ = &halo;
      isKnown_.reset();
    }
    const Corner& at(const Coord& p) {
      const size_t place = tableAt(p.x(), p.y(), p.z());
      if (!isKnown_[place]) {
        corners_[place] = Corner(&(*halo_)[haloAt(p.x(), p.y(), p.z())]);
        isKnown_[place] = true;
      }
      return corners_[place];
    }

   private:
    const LabelHalo* halo_ = nullptr;
    std::array<Corner, kSide * kSide * kSide> corners_;
    std::bitset<kSide * kSide * kSide> isKnown_;
  };

  void makeQuads(size_t block, const LabelHalo& halo) {
    CornerTable table;
    readCorners(block, table);
    CornerCache& corners = caches_.local();
    corners.begin(halo);
    uint32_t next = firstQuad_[block];
    const Coord origin = blocks_.origin(block);
    const bool isInner =
        domain_.empty() || domain_.isInside(CoordBBox(origin.offsetBy(-1), origin.offsetBy(7)));
    forEachPlace([&](int x, int y, int z) {
      if (table[tableAt(x, y, z)] == SurfaceNet::kNone) return;  // all is alike around it
      const int32_t* at = &halo[haloAt(x, y, z)];
      const Coord p = origin.offsetBy(x, y, z);
      for (int axis = 0; axis < 3; ++axis) {
        const int32_t above = at[0], below = at[-kHaloStride[axis]];
        if (above != below) {
          if (below > 0) {
            quadBeyond_[next] = beyond(above, p, axis, 1);
            addQuad(corners, table, Coord(x, y, z), axis, below, false, next++);
          }
          if (above > 0) {
            quadBeyond_[next] = beyond(below, p, axis, 0);
            addQuad(corners, table, Coord(x, y, z), axis, above, true, next++);
          }
        }
        if (isPinched(at, axis))
          pinches_[block].push_back(
              {table[tableAt(x, y, z)],
               table[tableAt(x + (axis == 0), y + (axis == 1), z + (axis == 2))]});
        if (withLinks_) addLink(at, table, origin, Coord(x, y, z), axis, isInner);
      }
    });
  }

  /// The face across `axis` below voxel p, as a grain below it (normal +axis) or above it sees it.
  void addQuad(CornerCache& corners, const CornerTable& table, const Coord& p, int axis,
               int32_t grain, bool isAbove, uint32_t number) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    static constexpr int kAround[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    std::array<uint32_t, 4> quad;
    for (size_t n = 0; n < 4; ++n) {
      Coord q = p;
      q[u] += kAround[n][0];
      q[v] += kAround[n][1];
      const uint32_t corner = table[tableAt(q.x(), q.y(), q.z())];
      // Seen from this corner, the face lies on the other side of it along u and v.
      const int face = axis * 4 + (1 - kAround[n][0]) * 2 + (1 - kAround[n][1]);
      quad[n] = net_.firstPoint[corner];
      if (net_.firstPoint[corner + 1] > quad[n] + 1) quad[n] += corners.at(q).point(grain, face);
    }
    if (isAbove) std::swap(quad[1], quad[3]);
    quads_[number] = quad;
    quadGrain_[number] = blocks_.number(grain);
  }

  /// What a grain has across the face below voxel p along `axis`, of which \p label is the other
  /// side: below (0) or above (1).
  int32_t beyond(int32_t label, const Coord& p, int axis, int side) const {
    const bool isFace = !domain_.empty() && (side ? p[axis] == domain_.max()[axis] + 1
                                                  : p[axis] == domain_.min()[axis]);
    return label > 0 ? label : isFace ? -1 - 2 * axis - side : 0;
  }

  /// True if along the edge from a corner upwards two voxels of a grain touch in nothing else, and
  /// yet have the same points at both ends.
  bool isPinched(const int32_t* at, int axis) const {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const int u = kHaloStride[a], v = kHaloStride[b];
    for (const auto& [one, other, left, right] :
         {std::array{at[0], at[-u - v], at[-u], at[-v]}, {at[-u], at[-v], at[0], at[-u - v]}}) {
      if (one <= 0 || one != other || one == left || one == right) continue;
      // The faces across u lie on either side of v, one of either voxel; see corner_fans.h.
      const auto isOne = [&, grain = one](const int32_t* corner, int end) {
        const Corner around(corner);
        return around.point(grain, a * 4 + 2 + end) == around.point(grain, a * 4 + end);
      };
      if (isOne(at, 1) && isOne(at + kHaloStride[axis], 0)) return true;
    }
    return false;
  }

  /// Labels around the edge of the lattice from corner p upwards along `axis`, with what is outside
  /// of the domain as another one.
  std::array<int32_t, 4> labelsAround(const int32_t* at, const Coord& p, int axis) const {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    std::array<int32_t, 4> around;
    for (int n = 0; n < 4; ++n) {
      Coord voxel = p;
      voxel[a] -= n >> 1;
      voxel[b] -= n & 1;
      const int32_t label = at[-(n >> 1) * kHaloStride[a] - (n & 1) * kHaloStride[b]];
      const bool isInside = domain_.empty() || domain_.isInside(voxel);
      around[size_t(n)] = isInside || label > 0 ? label : -1;
    }
    return around;
  }

  /// The edge of the lattice from corner p upwards along `axis`; `isInner`: all voxels around it
  /// are known to be in the domain.
  void addLink(const int32_t* at, const CornerTable& table, const Coord& origin, const Coord& p,
               int axis, bool isInner) {
    const int u = kHaloStride[(axis + 1) % 3], v = kHaloStride[(axis + 2) % 3];
    if (at[0] == at[-u] && at[0] == at[-v] && at[0] == at[-u - v]) return;
    const auto [a, b, c, d] = isInner ? std::array{at[0], at[-u], at[-v], at[-u - v]}
                                      : labelsAround(at, origin + p, axis);
    const int labels = 1 + (b != a) + (c != a && c != b) + (d != a && d != b && d != c);
    Coord q = p;
    ++q[axis];
    const uint32_t low = table[tableAt(p.x(), p.y(), p.z())],
                   high = table[tableAt(q.x(), q.y(), q.z())];
    net_.links[low][size_t(2 * axis + 1)] = high;
    net_.links[high][size_t(2 * axis)] = low;
    if (labels < 3) return;
    junctionBytes_[low][size_t(2 * axis + 1)] = 1;
    junctionBytes_[high][size_t(2 * axis)] = 1;
  }

  void packJunctions() {
    net_.junctions.resize(net_.corners.size());
    for (size_t i = 0; i < net_.corners.size(); ++i)
      for (size_t d = 0; d < 6; ++d)
        net_.junctions[i] = uint8_t(net_.junctions[i] | junctionBytes_[i][d] << d);
    junctionBytes_.clear();
    junctionBytes_.shrink_to_fit();
  }

  void sortQuads() {
    net_.firstQuad.assign(blocks_.labels().size() + 1, 0);
    for (const uint32_t grain : quadGrain_) ++net_.firstQuad[grain + 1];
    for (size_t g = 1; g < net_.firstQuad.size(); ++g) net_.firstQuad[g] += net_.firstQuad[g - 1];
    std::vector<uint32_t> next(net_.firstQuad.begin(), net_.firstQuad.end() - 1);
    net_.quads.resize(quads_.size());
    net_.quadBeyond.resize(quads_.size());
    for (size_t i = 0; i < quads_.size(); ++i) {
      const uint32_t place = next[quadGrain_[i]]++;
      net_.quads[place] = quads_[i];
      net_.quadBeyond[place] = quadBeyond_[i];
    }
  }

  const LabelBlocks& blocks_;
  const CoordBBox domain_;
  const bool withLinks_;
  Interrupter* interrupter_;
  std::vector<uint32_t> firstCorner_, firstPoint_, firstQuad_;  // per block, one more at the end
  std::vector<std::array<uint8_t, 6>> junctionBytes_;
  std::vector<std::array<uint32_t, 4>> quads_;
  std::vector<uint32_t> quadGrain_;
  std::vector<int32_t> quadBeyond_;
  std::vector<std::vector<std::array<uint32_t, 2>>> pinches_;  // per block
  PerThread<CornerCache> caches_;
  SurfaceNet net_;
};

}  // namespace

SurfaceNet buildNet(const LabelBlocks& blocks, const CoordBBox& domain, bool withLinks,
                    Interrupter* interrupter) {
  return NetBuilder(blocks, domain, withLinks, interrupter).build();
}

}  // namespace vdb_madf::detail
