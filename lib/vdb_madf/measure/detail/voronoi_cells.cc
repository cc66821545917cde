// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/voronoi_cells.h"

#include <algorithm>
#include <array>
#include <limits>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/measure/detail/voxel_shape.h"

namespace vdb_madf::detail {

namespace {

constexpr int kLabelBits = 31;
constexpr int64_t kNoLabel = std::numeric_limits<int64_t>::max();
constexpr int kSlicesTogether = 8;

/// Orders by squared distance, then label: both below 2^31.
int64_t keyOf(int64_t squaredDistance, int32_t label) {
  return squaredDistance << kLabelBits | label;
}

/// A row of keys and the lower envelope of their parabolas.
class KeyRow {
 public:
  KeyRow(int length, int32_t weight)
      : weight_(keyOf(weight, 0)), keys_(size_t(length)), sites_(size_t(length)) {}

  /// key(t) = min over s of key(s) + weight (t - s)^2, in place.
  void sweep(int64_t* keys, size_t stride) {
    const int length = int(keys_.size());
    size_t count = 0;
    for (int s = 0; s < length; ++s) {
      keys_[size_t(s)] = keys[size_t(s) * stride];
      if (keys_[size_t(s)] == kNoLabel) continue;
      while (count > 0 &&
             at(sites_[count - 1].place, sites_[count - 1].from) >= at(s, sites_[count - 1].from))
        --count;
      const int from = count == 0 ? 0 : lastOf(sites_[count - 1].place, s) + 1;
      if (from < length) sites_[count++] = {s, from};
    }
    for (size_t i = 0; i < count; ++i)
      for (int t = sites_[i].from; t < (i + 1 < count ? sites_[i + 1].from : length); ++t)
        keys[size_t(t) * stride] = at(sites_[i].place, t);
  }

 private:
  struct Site {
    int place, from;  // the first position at which it is the least
  };
  int64_t at(int site, int t) const {
    return keys_[size_t(site)] + weight_ * (t - site) * (t - site);
  }
  /// The last position, beyond the row perhaps, at which the first of two is not the larger one.
  int lastOf(int first, int second) const {
    const int64_t difference = keys_[size_t(second)] - keys_[size_t(first)] +
                               weight_ * (int64_t(second) * second - int64_t(first) * first);
    return int(std::min<int64_t>(difference / (2 * weight_ * (second - first)),
                                 std::numeric_limits<int>::max() - 1));
  }

  int64_t weight_;
  std::vector<int64_t> keys_;
  std::vector<Site> sites_;
};

uint64_t pairOf(int32_t a, int32_t b) {
  return uint64_t(uint32_t(std::min(a, b))) << 32 | uint32_t(std::max(a, b));
}

}  // namespace

/// What some slices have of all cells.
struct VoronoiCells::Part {
  std::unordered_map<int32_t, Cell> cells;
  std::vector<uint64_t> neighbors;
};

VoronoiCells::VoronoiCells(const Domain& domain, const openvdb::math::Transform& transform)
    : domain_(domain), min_(domain.box().min()), dim_(domain.box().dim()) {
  if (!VoxelShape{proportions(transform)}.isCube())
    weights_ = weightsOfEdges(voxelEdges(transform), dim_).weights;
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis)
    longest += double(weights_[axis]) * double(dim_[axis]) * double(dim_[axis]);
  if (longest >= double(int64_t(1) << kLabelBits))
    throw InvalidInput("cells of grains: the domain is too large for exact distances; crop it");
  columns_.resize(size_t(dim_.x()) * size_t(dim_.y()));
}

void VoronoiCells::add(const LabelLeaves& slab) {
  // Leaves ascend by x, y, z: those of a column of leaves follow each other.
  const LeafIndex& index = slab.index();
  std::vector<size_t> first;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
    if (leaf == 0 || index.origin(leaf).x() != index.origin(leaf - 1).x() ||
        index.origin(leaf).y() != index.origin(leaf - 1).y())
      first.push_back(leaf);
  first.push_back(index.leafCount());
  const auto addLeaf = [&](size_t leaf) {
    std::array<int32_t, 512> labels{};
    for (const LabelPart& part : slab.parts(leaf))
      for (int word = 0; word < 8; ++word)
        for (uint64_t bits = part.mask[size_t(word)]; bits; bits &= bits - 1)
          labels[size_t(word * 64 + __builtin_ctzll(bits))] = part.label;
    for (int offset = 0; offset < 512; ++offset) {
      const int32_t label = labels[size_t(offset)];
      if (label == 0) continue;
      const Coord p = index.origin(leaf) + Coord(offset >> 6, offset >> 3 & 7, offset & 7) - min_;
      std::vector<Run>& runs = columns_[size_t(p.x()) * size_t(dim_.y()) + size_t(p.y())];
      if (!runs.empty() && runs.back().label == label && runs.back().end == p.z())
        ++runs.back().end;
      else
        runs.push_back({p.z(), p.z() + 1, label});
    }
  };
  parallelFor(first.size() - 1, 1, nullptr, [&](size_t begin, size_t end) {
    for (size_t leaf = first[begin]; leaf < first[end]; ++leaf) addLeaf(leaf);
  });
}

int64_t VoronoiCells::nearestInColumn(const std::vector<Run>& runs, int z) const {
  const auto above =
      std::partition_point(runs.begin(), runs.end(), [z](const Run& run) { return run.end <= z; });
  const auto key = [&](int64_t distance, int32_t label) {
    return keyOf(weights_.z * distance * distance, label);
  };
  int64_t least = kNoLabel;
  if (above != runs.end()) least = key(std::max(0, above->begin - z), above->label);
  if (above != runs.begin()) least = std::min(least, key(z - above[-1].end + 1, above[-1].label));
  return least;
}

/// 1 for the voxels of a slice that are in the domain, with a rim around it.
std::vector<char> VoronoiCells::inside(int z) const {
  const int nx = dim_.x(), ny = dim_.y();
  std::vector<char> result(size_t(nx + 2) * size_t(ny + 2));
  if (z < 0 || z >= dim_.z()) return result;
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      result[size_t(x + 1) * size_t(ny + 2) + size_t(y + 1)] =
          domain_.isBox() || domain_.isInside(min_ + Coord(x, y, z));
  return result;
}

VoronoiCells::Slice VoronoiCells::slice(int z) const {
  const size_t nx = size_t(dim_.x()), ny = size_t(dim_.y());
  std::vector<int64_t> keys(nx * ny);
  for (size_t i = 0; i < keys.size(); ++i) keys[i] = nearestInColumn(columns_[i], z);
  KeyRow alongY(dim_.y(), weights_.y), alongX(dim_.x(), weights_.x);
  for (size_t x = 0; x < nx; ++x) alongY.sweep(keys.data() + x * ny, 1);
  for (size_t y = 0; y < ny; ++y) alongX.sweep(keys.data() + y, ny);
  const std::vector<char> known = inside(z);
  Slice labels(nx * ny);
  for (size_t x = 0; x < nx; ++x)
    for (size_t y = 0; y < ny; ++y)
      if (const int64_t key = keys[x * ny + y];
          key != kNoLabel && known[(x + 1) * (ny + 2) + y + 1])
        labels[x * ny + y] = int32_t(key & ((int64_t(1) << kLabelBits) - 1));
  return labels;
}

void VoronoiCells::count(int begin, int end, Part& part) const {
  const size_t nx = size_t(dim_.x()), ny = size_t(dim_.y());
  Slice own = slice(begin), next;
  std::vector<char> below = inside(begin - 1), level = inside(begin), above;
  uint64_t last = 0;
  const auto touch = [&](int32_t a, int32_t b) {
    if (a == b || b == 0 || pairOf(a, b) == last) return;
    last = pairOf(a, b);
    part.neighbors.push_back(last);
  };
  for (int z = begin; z < end; ++z) {
    above = inside(z + 1);
    next = z + 1 < dim_.z() ? slice(z + 1) : Slice(nx * ny);
    Cell* cell = nullptr;
    int32_t cellLabel = 0;
    for (size_t x = 0; x < nx; ++x)
      for (size_t y = 0; y < ny; ++y) {
        const size_t i = x * ny + y, rimmed = (x + 1) * (ny + 2) + y + 1;
        const int32_t label = own[i];
        if (label == 0) continue;
        if (label != cellLabel) cell = &part.cells[cellLabel = label];
        ++cell->voxels;
        if (!(below[rimmed] && above[rimmed] && level[rimmed - 1] && level[rimmed + 1] &&
              level[rimmed - ny - 2] && level[rimmed + ny + 2]))
          cell->atDomainFace = true;
        if (x + 1 < nx) touch(label, own[i + ny]);
        if (y + 1 < ny) touch(label, own[i + 1]);
        touch(label, next[i]);
      }
    sortUnique(part.neighbors);
    below = std::move(level);
    level = std::move(above);
    own = std::move(next);
  }
}

std::unordered_map<int32_t, VoronoiCells::Cell> VoronoiCells::cells(
    Interrupter* interrupter) const {
  std::vector<Part> parts(size_t(dim_.z() + kSlicesTogether - 1) / kSlicesTogether);
  parallelForEach(parts.size(), 1, interrupter, [&](size_t i) {
    count(int(i) * kSlicesTogether, std::min(int(i + 1) * kSlicesTogether, dim_.z()), parts[i]);
  });
  Part whole;
  for (Part& part : parts) {
    for (const auto& [label, cell] : part.cells) {
      whole.cells[label].voxels += cell.voxels;
      whole.cells[label].atDomainFace |= cell.atDomainFace;
    }
    whole.neighbors.insert(whole.neighbors.end(), part.neighbors.begin(), part.neighbors.end());
    part = {};
  }
  sortUnique(whole.neighbors);
  for (const uint64_t pair : whole.neighbors) {
    ++whole.cells[int32_t(pair >> 32)].neighbors;
    ++whole.cells[int32_t(pair & 0xffffffff)].neighbors;
  }
  return std::move(whole.cells);
}

}  // namespace vdb_madf::detail
