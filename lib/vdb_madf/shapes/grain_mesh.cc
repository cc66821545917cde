// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/grain_mesh.h"

#include <algorithm>
#include <limits>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/shapes/detail/surface_net.h"

namespace vdb_madf {

namespace {

using detail::LabelBlocks;
using detail::LabelHalo;
using detail::SurfaceNet;
using openvdb::Vec3d;

constexpr size_t kBlockGrain = 16;
constexpr size_t kItemGrain = 1 << 16;
constexpr int kMaxRounds = 1000;

// --- around one corner

// The eight voxels around a corner: number dx*4 + dy*2 + dz, d = 0 below the corner, 1 above. The
// twelve faces between them: axis*4 + du*2 + dv, where u and v are the axes after `axis`, cyclic.

constexpr int kShift[3] = {2, 1, 0};

int voxelAt(int axis, int da, int du, int dv) {
  return da << kShift[axis] | du << kShift[(axis + 1) % 3] | dv << kShift[(axis + 2) % 3];
}

/// For every set of voxels around a corner (bit n: voxel n belongs to the grain): which of the
/// faces of the set around the corner hang together in one fan.
struct Fans {
  std::array<uint8_t, 256> count{};
  std::array<std::array<uint8_t, 12>, 256> fan{};  ///< of a face; 0xff: it is no face of the set
};

std::array<uint8_t, 12> joinFaces(int set) {
  std::array<uint8_t, 12> root;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      const bool below = set >> voxelAt(axis, 0, side >> 1, side & 1) & 1;
      const bool above = set >> voxelAt(axis, 1, side >> 1, side & 1) & 1;
      const int face = axis * 4 + side;
      root[size_t(face)] = below != above ? uint8_t(face) : uint8_t(0xff);
    }
  const auto join = [&root](int a, int b) {
    const uint8_t low = std::min(root[size_t(a)], root[size_t(b)]);
    const uint8_t high = std::max(root[size_t(a)], root[size_t(b)]);
    for (uint8_t& r : root)
      if (r == high) r = low;
  };
  // Each of the six edges that end in the corner has four voxels and four possible faces around it.
  for (int axis = 0; axis < 3; ++axis)
    for (int end = 0; end < 2; ++end) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      // Faces across u are told by (d_v, d_axis), faces across v by (d_axis, d_u).
      const auto acrossU = [&](int dv) { return u * 4 + dv * 2 + end; };
      const auto acrossV = [&](int du) { return v * 4 + end * 2 + du; };
      int faces[4], count = 0;
      for (const int face : {acrossU(0), acrossU(1), acrossV(0), acrossV(1)})
        if (root[size_t(face)] != 0xff) faces[count++] = face;
      if (count == 2) join(faces[0], faces[1]);
      if (count < 4) continue;
      // Two voxels that touch along the edge only: each keeps its two faces together.
      for (int du = 0; du < 2; ++du)
        for (int dv = 0; dv < 2; ++dv)
          if (set >> voxelAt(axis, end, du, dv) & 1) join(acrossU(dv), acrossV(du));
    }
  return root;
}

const Fans& fans() {
  static const Fans table = [] {
    Fans result;
    for (int set = 0; set < 256; ++set) {
      const std::array<uint8_t, 12> root = joinFaces(set);
      std::array<uint8_t, 12> number;
      number.fill(0xff);
      uint8_t count = 0;
      for (size_t face = 0; face < 12; ++face)
        if (root[face] == face) number[face] = count++;
      for (size_t face = 0; face < 12; ++face)
        result.fan[size_t(set)][face] = root[face] == 0xff ? 0xff : number[root[face]];
      result.count[size_t(set)] = count;
    }
    return result;
  }();
  return table;
}

/// The grains that meet at a corner, ascending, each with its voxels.
struct Corner {
  int grains = 0, labels = 0;  // labels: with the background
  std::array<int32_t, 8> label{};
  std::array<uint8_t, 8> set{};
  int pointCount = 0;

  /// \p at: the halo's value at the voxel above the corner.
  explicit Corner(const int32_t* at) {
    static constexpr int kBack[3] = {100, 10, 1};
    std::array<int32_t, 8> voxel;
    for (int n = 0; n < 8; ++n) {
      int back = 0;
      for (int axis = 0; axis < 3; ++axis)
        if (!(n >> kShift[axis] & 1)) back += kBack[axis];
      voxel[size_t(n)] = at[-back];
    }
    if (std::all_of(voxel.begin(), voxel.end(), [&](int32_t v) { return v == voxel[0]; })) return;
    label = voxel;
    std::sort(label.begin(), label.end());
    labels = int(std::unique(label.begin(), label.end()) - label.begin());
    grains = labels;
    if (label[0] == 0) {
      std::copy(label.begin() + 1, label.begin() + labels, label.begin());
      --grains;
    }
    for (int g = 0; g < grains; ++g) {
      int bits = 0;
      for (int n = 0; n < 8; ++n) bits |= int(voxel[size_t(n)] == label[size_t(g)]) << n;
      set[size_t(g)] = uint8_t(bits);
      pointCount += fans().count[size_t(bits)];
    }
  }

  /// Place among the corner's points of the one that a grain's face uses.
  uint32_t point(int32_t grain, int face) const {
    uint32_t before = 0;
    size_t g = 0;
    for (; label[g] != grain; ++g) before += fans().count[set[g]];
    return before + fans().fan[set[g]][size_t(face)];
  }
};

size_t haloAt(int x, int y, int z) {
  return size_t((x + 1) * 100 + (y + 1) * 10 + z + 1);
}

// --- the net

class NetBuilder {
 public:
  NetBuilder(const LabelBlocks& blocks, bool withLinks, Interrupter* interrupter)
      : blocks_(blocks), withLinks_(withLinks), interrupter_(interrupter) {}

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
    forEachBlock([&](size_t block, const LabelHalo& halo) { placeCorners(block, halo); });
    forEachBlock([&](size_t block, const LabelHalo& halo) { makeQuads(block, halo); });
    if (withLinks_) packJunctions();
    sortQuads();
    return std::move(net_);
  }

 private:
  template <typename F>
  void forEachBlock(const F& f) const {
    detail::parallelFor(blocks_.size(), kBlockGrain, interrupter_, [&](size_t begin, size_t end) {
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

  void count() {
    std::vector<std::array<uint32_t, 3>> counts(blocks_.size());
    forEachBlock([&](size_t block, const LabelHalo& halo) {
      uint32_t corners = 0, points = 0, quads = 0;
      forEachPlace([&](int x, int y, int z) {
        const int32_t* at = &halo[haloAt(x, y, z)];
        const Corner corner(at);
        corners += corner.labels > 0;
        points += uint32_t(corner.pointCount);
        for (const int step : {100, 10, 1})
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
    forEachPlace([&](int x, int y, int z) {
      const Corner corner(&halo[haloAt(x, y, z)]);
      if (corner.labels == 0) return;
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
  using CornerTable = std::array<uint32_t, 729>;
  static size_t tableAt(int x, int y, int z) { return size_t(x * 81 + y * 9 + z); }

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

  void makeQuads(size_t block, const LabelHalo& halo) {
    CornerTable table;
    readCorners(block, table);
    uint32_t next = firstQuad_[block];
    forEachPlace([&](int x, int y, int z) {
      const int32_t* at = &halo[haloAt(x, y, z)];
      static constexpr int kBack[3] = {100, 10, 1};
      for (int axis = 0; axis < 3; ++axis) {
        const int32_t above = at[0], below = at[-kBack[axis]];
        if (above != below) {
          if (below > 0) addQuad(halo, table, Coord(x, y, z), axis, below, false, next++);
          if (above > 0) addQuad(halo, table, Coord(x, y, z), axis, above, true, next++);
        }
        if (withLinks_) addLink(at, table, Coord(x, y, z), axis);
      }
    });
  }

  /// The face across `axis` below voxel p, as a grain below it (normal +axis) or above it sees it.
  void addQuad(const LabelHalo& halo, const CornerTable& table, const Coord& p, int axis,
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
      const Corner around(&halo[haloAt(q.x(), q.y(), q.z())]);
      quad[n] = net_.firstPoint[corner] + around.point(grain, face);
    }
    if (isAbove) std::swap(quad[1], quad[3]);
    quads_[number] = quad;
    quadGrain_[number] = blocks_.number(grain);
  }

  /// The edge of the lattice from corner p upwards along `axis`.
  void addLink(const int32_t* at, const CornerTable& table, const Coord& p, int axis) {
    static constexpr int kBack[3] = {100, 10, 1};
    const int u = kBack[(axis + 1) % 3], v = kBack[(axis + 2) % 3];
    std::array<int32_t, 4> around{at[0], at[-u], at[-v], at[-u - v]};
    std::sort(around.begin(), around.end());
    const auto labels = std::unique(around.begin(), around.end()) - around.begin();
    if (labels == 1) return;
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
    for (size_t i = 0; i < quads_.size(); ++i) net_.quads[next[quadGrain_[i]]++] = quads_[i];
  }

  const LabelBlocks& blocks_;
  const bool withLinks_;
  Interrupter* interrupter_;
  std::vector<uint32_t> firstCorner_, firstPoint_, firstQuad_;  // per block, one more at the end
  std::vector<std::array<uint8_t, 6>> junctionBytes_;
  std::vector<std::array<uint32_t, 4>> quads_;
  std::vector<uint32_t> quadGrain_;
  SurfaceNet net_;
};

/// Points by grain, quads as triangles.
GrainMesh assemble(const SurfaceNet& net, const std::vector<openvdb::Vec3f>& positions,
                   const std::vector<int32_t>& labels) {
  GrainMesh mesh;
  mesh.labels = labels;
  mesh.firstPoint.assign(labels.size() + 1, 0);
  for (const uint32_t grain : net.pointGrain) ++mesh.firstPoint[grain + 1];
  for (size_t g = 1; g <= labels.size(); ++g) mesh.firstPoint[g] += mesh.firstPoint[g - 1];
  std::vector<uint32_t> next(mesh.firstPoint.begin(), mesh.firstPoint.end() - 1);
  std::vector<uint32_t> place(net.pointGrain.size());
  mesh.points.resize(place.size());
  for (size_t p = 0; p < place.size(); ++p) {
    place[p] = next[net.pointGrain[p]]++;
    mesh.points[place[p]] = positions[net.pointCorner[p]];
  }
  mesh.firstTriangle.clear();
  for (const uint32_t first : net.firstQuad) mesh.firstTriangle.push_back(2 * first);
  mesh.triangles.resize(2 * net.quads.size());
  detail::parallelFor(net.quads.size(), kItemGrain, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto& quad = net.quads[i];
      mesh.triangles[2 * i] = {place[quad[0]], place[quad[1]], place[quad[2]]};
      mesh.triangles[2 * i + 1] = {place[quad[0]], place[quad[2]], place[quad[3]]};
    }
  });
  return mesh;
}

std::vector<openvdb::Vec3f> latticePositions(const SurfaceNet& net) {
  std::vector<openvdb::Vec3f> positions(net.corners.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const Coord& c = net.corners[i];
    positions[i] = {float(c.x()) - 0.5f, float(c.y()) - 0.5f, float(c.z()) - 0.5f};
  }
  return positions;
}

}  // namespace

GrainMesh grainMesh(const Int32Grid& labels, const GrainMeshOptions& options,
                    Interrupter* interrupter) {
  if (options.smoothing < 0 || options.smoothing > kMaxRounds)
    throw InvalidInput("smoothing must lie between 0 and 1000");
  const LabelBlocks blocks(labels);
  SurfaceNet net = NetBuilder(blocks, options.smoothing > 0, interrupter).build();
  const auto positions = options.smoothing > 0 ? detail::relax(net, options.smoothing,
                                                               blocks.voxelCounts(), interrupter)
                                               : latticePositions(net);
  return assemble(net, positions, blocks.labels());
}

std::vector<double> meshVolumes(const GrainMesh& mesh) {
  std::vector<double> volumes(mesh.labels.size());
  detail::parallelFor(volumes.size(), 16, nullptr, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) {
      const Vec3d reference(mesh.points[mesh.firstPoint[g]]);  // near: keeps the sum exact enough
      double sixfold = 0;
      for (uint32_t t = mesh.firstTriangle[g]; t < mesh.firstTriangle[g + 1]; ++t) {
        const auto& triangle = mesh.triangles[t];
        const Vec3d a = Vec3d(mesh.points[triangle[0]]) - reference,
                    b = Vec3d(mesh.points[triangle[1]]) - reference,
                    c = Vec3d(mesh.points[triangle[2]]) - reference;
        sixfold += a.dot(b.cross(c));
      }
      volumes[g] = sixfold / 6;
    }
  });
  return volumes;
}

}  // namespace vdb_madf
