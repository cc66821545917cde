// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/vti_file.h"

#include <zlib.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/vtk_file.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/grids/detail/grid_slabs.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf {

namespace {

constexpr int kSlab = 8;  // slices
/// Label images are mostly runs: more effort gains little.
constexpr int kZlibLevel = 3;

struct LabelOf {
  int32_t operator()(int32_t value, bool active) const { return active && value > 0 ? value : 0; }
};

/// The labels of a box, eight slices at a time from its lowest on: all slabs but the last are of
/// one size, as the format wants its compressed blocks.
class Slabs {
 public:
  Slabs(const Int32Grid& labels, const CoordBBox& box) : slabs_(labels.tree(), box), box_(box) {}

  size_t count() const { return size_t(box_.dim().z() + kSlab - 1) / kSlab; }
  uint64_t voxels() const { return uint64_t(box_.volume()); }
  CoordBBox slabBox(size_t slab) const {
    const int z = box_.min().z() + int(slab) * kSlab;
    return detail::slicesOf(box_, z, std::min(kSlab, box_.max().z() - z + 1));
  }
  std::vector<int32_t> read(size_t slab) const {
    const CoordBBox box = slabBox(slab);
    std::vector<int32_t> values(box.volume());
    slabs_.read(box.min().z(), box.dim().z(), values.data());
    return values;
  }

 private:
  detail::GridSlabs<Int32Tree, LabelOf> slabs_;
  CoordBBox box_;
};

/// The colors of the voxels; background is black.
std::vector<Rgb> colorsOf(const std::vector<int32_t>& labels, const GrainColors& colors) {
  std::vector<Rgb> result(labels.size());
  int32_t last = 0;
  Rgb color{};
  for (size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != last) {
      last = labels[i];
      color = last > 0 ? colors.colorOf(last) : Rgb{};
    }
    result[i] = color;
  }
  return result;
}

template <typename T>
std::string deflated(const std::vector<T>& values) {
  const uLong bytes = uLong(sizeof(T) * values.size());
  std::string result(compressBound(bytes), '\0');
  uLongf length = uLongf(result.size());
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &length,
                reinterpret_cast<const Bytef*>(values.data()), bytes, kZlibLevel) != Z_OK)
    throw std::bad_alloc();
  result.resize(length);
  result.shrink_to_fit();
  return result;
}

/// An array of cell data: valuesOf(labels of a slab) for each slab.
template <typename ValuesOf>
void addArray(detail::VtkFile& file, const Slabs& slabs, bool compressed, const std::string& type,
              const std::string& name, int components, Interrupter* interrupter,
              const ValuesOf& valuesOf) {
  const uint64_t bytes = sizeof valuesOf({})[0];
  if (!compressed) {
    file.array(type, name, components, bytes * slabs.voxels(),
               [=, &slabs](detail::OutputStream& out) {
                 for (size_t slab = 0; slab < slabs.count(); ++slab) {
                   const auto values = valuesOf(slabs.read(slab));
                   out.bytes(values.data(), bytes * values.size());
                 }
               });
    return;
  }
  detail::VtkFile::Blocks blocks;
  blocks.data.resize(slabs.count());
  detail::parallelForEach(slabs.count(), 1, interrupter, [&](size_t slab) {
    blocks.data[slab] = deflated(valuesOf(slabs.read(slab)));
  });
  blocks.wholeBytes = bytes * uint64_t(slabs.slabBox(0).volume());
  blocks.lastBytes = bytes * uint64_t(slabs.slabBox(slabs.count() - 1).volume());
  file.compressedArray(type, name, components, std::move(blocks));
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
  const detail::WorldTransform world = detail::worldTransform(labels.transform());
  const Slabs slabs(labels, box);
  std::string extent;
  for (int axis = 0; axis < 3; ++axis)
    extent += (axis ? " " : "") + std::to_string(box.min()[axis]) + " " +
              std::to_string(int64_t(box.max()[axis]) + 1);
  detail::VtkFile file("ImageData");
  file.xml("<ImageData WholeExtent=\"" + extent + "\" Origin=\"" +
           triple(world.origin - 0.5 * world.edges) + "\" Spacing=\"" + triple(world.edges) +
           "\">\n<Piece Extent=\"" + extent + "\">\n<CellData Scalars=\"grain_id\">\n");
  const GrainColors colors = grainColors(labels, interrupter);
  addArray(file, slabs, compressed, "Int32", "grain_id", 1, interrupter,
           [](std::vector<int32_t> ids) { return ids; });
  addArray(file, slabs, compressed, "UInt8", "color", 3, interrupter,
           [&colors](const std::vector<int32_t>& ids) { return colorsOf(ids, colors); });
  file.xml("</CellData>\n</Piece>\n</ImageData>\n");
  file.write(path, interrupter);
}

}  // namespace vdb_madf
