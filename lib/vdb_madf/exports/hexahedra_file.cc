// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/hexahedra_file.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/vtk_file.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/labels/grain_name.h"

namespace vdb_madf {

namespace {

using detail::OutputStream;
using openvdb::Vec3d;

void writeVtu(const std::string& path, const Hexahedra& mesh, Interrupter* interrupter) {
  constexpr uint8_t kVtkHexahedron = 12;
  const uint64_t elements = mesh.counts().elements, nodes = mesh.counts().nodes;
  detail::VtkFile file("UnstructuredGrid");
  file.xml("<UnstructuredGrid>\n<Piece NumberOfPoints=\"" + std::to_string(nodes) +
           "\" NumberOfCells=\"" + std::to_string(elements) +
           "\">\n<CellData Scalars=\"grain_id\">\n");
  file.array("Int32", "grain_id", 1, 4 * elements, [&](OutputStream& out) {
    for (size_t i = 0; i < elements; ++i) out.value(mesh.label(i));
  });
  file.xml("</CellData>\n<Points>\n");
  file.array("Float64", "Points", 3, 24 * nodes, [&](OutputStream& out) {
    mesh.forEachNode([&](const Vec3d& place) { out.value(place); });
  });
  file.xml("</Points>\n<Cells>\n");
  file.array("Int32", "connectivity", 1, 32 * elements, [&](OutputStream& out) {
    for (size_t i = 0; i < elements; ++i) out.value(mesh.nodes(i));
  });
  file.array("Int32", "offsets", 1, 4 * elements, [&](OutputStream& out) {
    for (size_t i = 1; i <= elements; ++i) out.value(int32_t(8 * i));
  });
  file.array("UInt8", "types", 1, elements, [&](OutputStream& out) {
    for (size_t i = 0; i < elements; ++i) out.value(kVtkHexahedron);
  });
  file.xml("</Cells>\n</Piece>\n</UnstructuredGrid>\n");
  file.write(path, interrupter);
}

/// Sets of the nodes that lie outermost along an axis: what a load or a support takes hold of.
void writeFaceSets(OutputStream& out, const Hexahedra& mesh) {
  constexpr int kPerLine = 16;
  if (mesh.counts().nodes == 0) return;
  openvdb::BBoxd box;
  mesh.forEachNode([&](const Vec3d& place) { box.expand(place); });
  for (int axis = 0; axis < 3; ++axis)
    for (const bool isMax : {false, true}) {
      const double plane = isMax ? box.max()[axis] : box.min()[axis];
      out.text(std::string("*NSET, NSET=face_") + "xyz"[axis] + (isMax ? "_max" : "_min"));
      size_t node = 0, written = 0;
      mesh.forEachNode([&](const Vec3d& place) {
        ++node;
        if (place[axis] != plane) return;
        out.text(written++ % kPerLine == 0 ? "\n" : ", ");
        out.number(node);
      });
      out.text("\n");
    }
}

void writeInp(const std::string& path, const Hexahedra& mesh, Interrupter* interrupter) {
  OutputStream out(path, interrupter);
  out.text("** Voxels of grains as elements (vdb_madf)\n*NODE\n");
  size_t node = 0;
  mesh.forEachNode([&](const Vec3d& place) {
    out.number(++node);
    for (int axis = 0; axis < 3; ++axis) out.number(", ", place[axis]);
    out.text("\n");
  });
  for (size_t i = 0; i < mesh.counts().elements; ++i) {
    if (mesh.isFirst(i)) out.text("*ELEMENT, TYPE=C3D8, ELSET=" + grainName(mesh.label(i)) + "\n");
    out.number(i + 1);
    for (const uint32_t corner : mesh.nodes(i)) out.number(", ", uint64_t(corner) + 1);
    out.text("\n");
  }
  writeFaceSets(out, mesh);
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
