// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/hexahedra_file.h"
#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/labels/grain_name.h"

#include <algorithm>
#include <array>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/vtk_file.h"
#include "vdb_madf/files/detail/buffered_output.h"
#include "vdb_madf/files/file_ending.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

using detail::BufferedOutput;
using openvdb::Vec3d;
using Mask = LeafIndex::Mask;
using Nodes = std::array<uint32_t, 8>;

/// The corners of an element, in the order that VTK and Abaqus share: around the lower face
/// counterclockwise seen from above, then the upper one. Bits: 4: +x, 2: +y, 1: +z.
constexpr unsigned kCorners[8] = {0, 4, 6, 2, 1, 5, 7, 3};

/// Adds to a mask itself, moved by a voxel up an axis. Returns what falls into the next leaf.
Mask spread(Mask& mask, int axis) {
  Mask next{};
  for (size_t x = 8; x-- > 0;) {
    const uint64_t word = mask[x];
    if (axis == 0) {
      (x == 7 ? next[0] : mask[x + 1]) |= word;
    } else if (axis == 1) {
      next[x] = word >> 56;
      mask[x] |= word << 8;
    } else {
      next[x] = word >> 7 & detail::kFirstZ;
      mask[x] |= word << 1 & ~detail::kFirstZ;
    }
  }
  return next;
}

/// The corners of voxels: corner p is the point p - 1/2, shared by the voxels p - 1 to p.
LeafIndex cornersOf(const LeafIndex& voxels) {
  MaskGrid corners;
  auto accessor = corners.getAccessor();
  for (size_t leaf = 0; leaf < voxels.leafCount(); ++leaf) {
    std::array<Mask, 8> parts;  // of the leaf and those next to it, as in kCorners
    parts[0] = voxels.mask(leaf);
    parts[4] = spread(parts[0], 0);
    for (const size_t i : {0u, 4u}) parts[i + 2] = spread(parts[i], 1);
    for (const size_t i : {0u, 2u, 4u, 6u}) parts[i + 1] = spread(parts[i], 2);
    for (int i = 0; i < 8; ++i) {
      const Mask& part = parts[size_t(i)];
      if (std::all_of(part.begin(), part.end(), [](uint64_t word) { return word == 0; })) continue;
      const Coord step(i & 4 ? 8 : 0, i & 2 ? 8 : 0, i & 1 ? 8 : 0);
      auto& mask = accessor.touchLeaf(voxels.origin(leaf) + step)->getValueMask();
      for (openvdb::Index x = 0; x < 8; ++x) mask.getWord<openvdb::Index64>(x) |= part[x];
    }
  }
  return LeafIndex(corners);
}

class Hexahedra {
 public:
  Hexahedra(const Int32Grid& labels, Interrupter* interrupter)
      : world_(detail::cubicTransform(labels.transform())), labels_(labels, interrupter) {
    const auto voxels = size_t(labels_.index().voxelCount());
    if (voxels > kMaxHexahedra)
      throw InvalidInput("one element for each of " + std::to_string(voxels) +
                         " voxels is too much (at most " + std::to_string(kMaxHexahedra) +
                         "): make the labels smaller first (export --as lod)");
    corners_ = cornersOf(labels_.index());
    around_.resize(labels_.index().leafCount());
    size_t corner = 0;
    for (size_t leaf = 0; leaf < around_.size(); ++leaf) {
      while (corners_.origin(corner) != labels_.index().origin(leaf)) ++corner;  // both sorted
      around_[leaf] = leavesFrom(uint32_t(corner));
      addElements(leaf);
    }
    detail::parallelSort(elements_.begin(), elements_.end());
    for (size_t i = 0; i < elements_.size(); ++i) counts_.grains += isFirst(i);
    counts_.elements = elements_.size();
    counts_.nodes = size_t(corners_.voxelCount());
  }

  const HexahedraCounts& counts() const { return counts_; }

  int32_t label(size_t element) const { return int32_t(elements_[element] >> 32); }
  /// Of its grain.
  bool isFirst(size_t element) const {
    return element == 0 || label(element) != label(element - 1);
  }
  Nodes nodes(size_t element) const {
    const auto id = VoxelId(elements_[element] & 0xffffffffu);
    Nodes result;
    for (size_t i = 0; i < 8; ++i) {
      const unsigned x = (id >> 6 & 7) + (kCorners[i] >> 2),
                     y = (id >> 3 & 7) + (kCorners[i] >> 1 & 1), z = (id & 7) + (kCorners[i] & 1);
      const uint32_t leaf = around_[id >> 9][(x >> 3) * 4 + (y >> 3) * 2 + (z >> 3)];
      result[i] = uint32_t(corners_.rank(leaf * 512 + (x & 7) * 64 + (y & 7) * 8 + (z & 7)));
    }
    return result;
  }

  /// f(place) for all nodes, in order; world.
  template <typename F>
  void forEachNode(const F& f) const {
    for (size_t leaf = 0; leaf < corners_.leafCount(); ++leaf)
      for (unsigned offset = 0; offset < 512; ++offset)
        if (corners_.mask(leaf)[offset >> 6] >> (offset & 63) & 1)
          f(world_.origin +
            world_.edge * (corners_.coord(VoxelId(leaf * 512 + offset)).asVec3d() - Vec3d(0.5)));
  }

 private:
  /// The leaf of corners and those above it, as in kCorners.
  std::array<uint32_t, 8> leavesFrom(uint32_t leaf) const {
    std::array<uint32_t, 8> result;
    for (unsigned i = 0; i < 8; ++i) {
      result[i] = leaf;
      for (unsigned axis = 0; axis < 3; ++axis)
        if (result[i] != LeafIndex::kNone && i >> (2 - axis) & 1)
          result[i] = corners_.neighbors(result[i])[2 * axis + 1];
    }
    return result;
  }

  void addElements(size_t leaf) {
    for (const detail::LabelPart& part : labels_.parts(leaf))
      for (size_t x = 0; x < 8; ++x)
        detail::forEachBit(part.mask[x], [&](int bit) {
          elements_.push_back(uint64_t(part.label) << 32 | (leaf * 512 + x * 64 + size_t(bit)));
        });
  }

  detail::CubicTransform world_;
  detail::LabelLeaves labels_;
  LeafIndex corners_;
  std::vector<std::array<uint32_t, 8>> around_;  // leaves of corners_ of each leaf of labels_
  std::vector<uint64_t> elements_;               // label, then VoxelId
  HexahedraCounts counts_;
};

void writeVtu(const std::string& path, const Hexahedra& mesh, Interrupter* interrupter) {
  constexpr uint8_t kVtkHexahedron = 12;
  const uint64_t elements = mesh.counts().elements, nodes = mesh.counts().nodes;
  detail::VtkFile file("UnstructuredGrid");
  file.xml("<UnstructuredGrid>\n<Piece NumberOfPoints=\"" + std::to_string(nodes) +
           "\" NumberOfCells=\"" + std::to_string(elements) +
           "\">\n<CellData Scalars=\"grain_id\">\n");
  file.array("Int32", "grain_id", 1, 4 * elements, [&](BufferedOutput& out) {
    for (size_t i = 0; i < elements; ++i) out.value(mesh.label(i));
  });
  file.xml("</CellData>\n<Points>\n");
  file.array("Float64", "Points", 3, 24 * nodes, [&](BufferedOutput& out) {
    mesh.forEachNode([&](const Vec3d& place) { out.value(place); });
  });
  file.xml("</Points>\n<Cells>\n");
  file.array("Int32", "connectivity", 1, 32 * elements, [&](BufferedOutput& out) {
    for (size_t i = 0; i < elements; ++i) out.value(mesh.nodes(i));
  });
  file.array("Int32", "offsets", 1, 4 * elements, [&](BufferedOutput& out) {
    for (size_t i = 1; i <= elements; ++i) out.value(int32_t(8 * i));
  });
  file.array("UInt8", "types", 1, elements, [&](BufferedOutput& out) {
    for (size_t i = 0; i < elements; ++i) out.value(kVtkHexahedron);
  });
  file.xml("</Cells>\n</Piece>\n</UnstructuredGrid>\n");
  file.write(path, interrupter);
}

void writeInp(const std::string& path, const Hexahedra& mesh, Interrupter* interrupter) {
  BufferedOutput out(path, interrupter);
  out.text("** Voxels of grains as elements (vdb_madf)\n*NODE\n");
  size_t node = 0;
  mesh.forEachNode([&](const Vec3d& place) {
    out.number(++node);
    for (int axis = 0; axis < 3; ++axis) {
      out.text(", ");
      out.number(place[axis]);
    }
    out.text("\n");
  });
  for (size_t i = 0; i < mesh.counts().elements; ++i) {
    if (mesh.isFirst(i)) out.text("*ELEMENT, TYPE=C3D8, ELSET=" + grainName(mesh.label(i)) + "\n");
    out.number(i + 1);
    for (const uint32_t corner : mesh.nodes(i)) {
      out.text(", ");
      out.number(uint64_t(corner) + 1);
    }
    out.text("\n");
  }
  out.commit();
}

}  // namespace

bool isHexahedraEnding(const std::string& path) {
  const std::string end = fileEnding(path);
  return end == ".vtu" || end == ".inp";
}

HexahedraCounts writeHexahedra(const std::string& path, const Int32Grid& labels,
                               Interrupter* interrupter) {
  if (!isHexahedraEnding(path))
    throw InvalidInput(path + ": no format of elements has this ending; use .vtu or .inp");
  const Hexahedra mesh(labels, interrupter);
  if (fileEnding(path) == ".vtu")
    writeVtu(path, mesh, interrupter);
  else
    writeInp(path, mesh, interrupter);
  return mesh.counts();
}

}  // namespace vdb_madf
