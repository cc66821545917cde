// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/vti_file.h"

#include <zlib.h>

#include <algorithm>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/vtk_file.h"
#include "vdb_madf/files/detail/buffered_output.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/detail/label_blocks.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;

constexpr int kSlab = 8;  // slices
/// Label images are mostly runs: more effort gains little.
constexpr int kZlibLevel = 3;

/// The labels of a box, eight slices at a time.
class Slabs {
 public:
  Slabs(const Int32Grid& labels, const CoordBBox& box)
      : tree_(detail::withoutTiles(labels)), box_(box) {
    std::vector<const Leaf*> leaves;
    tree_->getNodes(leaves);
    leaves_.resize(count());
    for (const Leaf* leaf : leaves) {
      CoordBBox part = leaf->getNodeBoundingBox();
      part.intersect(box);
      if (part.empty()) continue;
      const size_t first = slabOf(part.min().z()), last = slabOf(part.max().z());
      leaves_[first].push_back(leaf);
      if (last != first) leaves_[last].push_back(leaf);
    }
  }

  size_t count() const { return size_t(box_.dim().z() + kSlab - 1) / kSlab; }
  CoordBBox slabBox(size_t slab) const {
    CoordBBox result = box_;
    result.min().z() = box_.min().z() + int(slab) * kSlab;
    result.max().z() = std::min(result.min().z() + kSlab - 1, box_.max().z());
    return result;
  }
  std::vector<int32_t> read(size_t slab) const {
    const CoordBBox box = slabBox(slab);
    std::vector<int32_t> values(box.volume());
    for (const Leaf* leaf : leaves_[slab]) copy(*leaf, box, values);
    return values;
  }

 private:
  size_t slabOf(int z) const { return size_t(z - box_.min().z()) / kSlab; }

  static void copy(const Leaf& leaf, const CoordBBox& box, std::vector<int32_t>& values) {
    const int32_t* data = leaf.buffer().data();
    CoordBBox part = leaf.getNodeBoundingBox();
    part.intersect(box);
    const Coord size = box.dim();
    for (int z = part.min().z(); z <= part.max().z(); ++z)
      for (int y = part.min().y(); y <= part.max().y(); ++y)
        for (int x = part.min().x(); x <= part.max().x(); ++x) {
          const Coord p = Coord(x, y, z) - box.min();
          values[(size_t(p.z()) * size_t(size.y()) + size_t(p.y())) * size_t(size.x()) +
                 size_t(p.x())] = detail::labelAt(leaf, data, Leaf::coordToOffset(Coord(x, y, z)));
        }
  }

  Int32Tree::ConstPtr tree_;
  CoordBBox box_;
  std::vector<std::vector<const Leaf*>> leaves_;  // of each slab
};

std::string deflated(const std::vector<int32_t>& values) {
  const uLong bytes = uLong(4 * values.size());
  std::string result(compressBound(bytes), '\0');
  uLongf length = uLongf(result.size());
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &length,
                reinterpret_cast<const Bytef*>(values.data()), bytes, kZlibLevel) != Z_OK)
    throw std::bad_alloc();
  result.resize(length);
  result.shrink_to_fit();
  return result;
}

detail::VtkFile::Blocks deflatedBlocks(const Slabs& slabs, Interrupter* interrupter) {
  detail::VtkFile::Blocks blocks;
  blocks.data.resize(slabs.count());
  detail::parallelFor(slabs.count(), 1, interrupter, [&](size_t begin, size_t end) {
    for (size_t slab = begin; slab < end; ++slab) blocks.data[slab] = deflated(slabs.read(slab));
  });
  blocks.wholeBytes = 4 * uint64_t(slabs.slabBox(0).volume());
  blocks.lastBytes = 4 * uint64_t(slabs.slabBox(slabs.count() - 1).volume());
  return blocks;
}

std::string triple(const openvdb::Vec3d& v) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) text += (axis ? " " : "") + detail::shortestDecimal(v[axis]);
  return text;
}

}  // namespace

void writeVti(const std::string& path, const Int32Grid& labels, const CoordBBox& box,
              bool compressed, Interrupter* interrupter) {
  if (box.empty()) throw InvalidInput("there is no voxel and no domain: nothing to write");
  const detail::CubicTransform world = detail::cubicTransform(labels.transform());
  const Slabs slabs(labels, box);
  std::string extent;
  for (int axis = 0; axis < 3; ++axis)
    extent += (axis ? " " : "") + std::to_string(box.min()[axis]) + " " +
              std::to_string(int64_t(box.max()[axis]) + 1);
  detail::VtkFile file("ImageData");
  file.xml("<ImageData WholeExtent=\"" + extent + "\" Origin=\"" +
           triple(world.origin - openvdb::Vec3d(0.5 * world.edge)) + "\" Spacing=\"" +
           triple(openvdb::Vec3d(world.edge)) + "\">\n<Piece Extent=\"" + extent +
           "\">\n<CellData Scalars=\"grain_id\">\n");
  if (compressed) {
    file.compressedArray("Int32", "grain_id", 1, deflatedBlocks(slabs, interrupter));
  } else {
    file.array("Int32", "grain_id", 1, 4 * uint64_t(box.volume()),
               [&](detail::BufferedOutput& out) {
                 for (size_t slab = 0; slab < slabs.count(); ++slab) {
                   const std::vector<int32_t> values = slabs.read(slab);
                   out.bytes(values.data(), 4 * values.size());
                 }
               });
  }
  file.xml("</CellData>\n</Piece>\n</ImageData>\n");
  file.write(path, interrupter);
}

}  // namespace vdb_madf
