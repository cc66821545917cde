// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/labels/grain_name.h"

#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/glb_file.h"
#include "vdb_madf/exports/detail/stl_bytes.h"
#include "vdb_madf/exports/detail/vtk_file.h"
#include "vdb_madf/exports/detail/world_mesh.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_folder.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/files/written_together.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf {

namespace {

using detail::OutputStream;
using detail::WorldMesh;
using openvdb::Vec3f;

void writePly(const std::string& path, const WorldMesh& world, Interrupter* interrupter) {
  if (world.mesh().points.size() > size_t(std::numeric_limits<int32_t>::max()))
    throw InvalidInput(path +
                       ": PLY numbers points with 31 bits, and the mesh has more: "
                       "write .vtp");
  OutputStream out(path, interrupter);
  out.text("ply\nformat binary_little_endian 1.0\ncomment vdb_madf grains; lengths in " +
           world.unit() + "\nelement vertex " + std::to_string(world.mesh().points.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\n"
           "property int grain_id\nelement face " +
           std::to_string(world.mesh().triangles.size()) +
           "\nproperty list uchar int vertex_indices\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\n"
           "property int grain_id\nend_header\n");
  world.forEachPoint([&](size_t grain, uint32_t i) {
    out.value(world.point(i));
    out.value(world.color(grain));
    out.value(world.label(grain));
  });
  world.forEachTriangle([&](size_t grain, uint32_t i) {
    out.value(uint8_t(3));
    out.value(world.triangle(i));
    out.value(world.color(grain));
    out.value(world.label(grain));
  });
  out.commit();
}

/// Three numbers from 0 to 1.
void writeColor(OutputStream& out, const Rgb& color) {
  for (const uint8_t channel : color) out.number(" ", float(channel) / 255.0f);
}

/// With a file of materials beside it: few programs show colors of points.
void writeObj(const std::string& path, const WorldMesh& world, Interrupter* interrupter) {
  const auto beside = std::filesystem::path(path).replace_extension(".mtl");
  checkWrittenTogether(path, {beside.string()});
  OutputStream out(path, interrupter), materials(beside.string(), interrupter);
  std::map<Rgb, std::string> names;
  out.text("# vdb_madf grains; lengths in " + world.unit() + "\nmtllib " +
           beside.filename().string() + "\n");
  for (size_t grain = 0; grain < world.grainCount(); ++grain) {
    const Rgb color = world.color(grain);
    const auto& points = world.mesh().firstPoint;
    for (uint32_t i = points[grain]; i < points[grain + 1]; ++i) {
      const Vec3f p = world.point(i);
      out.text("v");
      for (int axis = 0; axis < 3; ++axis) out.number(" ", p[axis]);
      writeColor(out, color);
      out.text("\n");
    }
    const auto [name, isNew] = names.emplace(color, "color_" + std::to_string(names.size()));
    if (isNew) {
      materials.text("newmtl " + name->second + "\nKd");
      writeColor(materials, color);
      materials.text("\n");
    }
    out.text("g " + grainName(world.label(grain)) + "\nusemtl " + name->second + "\n");
    const auto& triangles = world.mesh().firstTriangle;
    for (uint32_t i = triangles[grain]; i < triangles[grain + 1]; ++i) {
      out.text("f");
      for (const uint32_t corner : world.triangle(i)) out.number(" ", uint64_t(corner) + 1);
      out.text("\n");
    }
  }
  OutputSet files;
  out.commit();
  materials.commit();
  files.commit();
}

/// Triangles of grains [begin, end).
void writeStl(OutputStream& out, const WorldMesh& world, size_t begin, size_t end) {
  const auto& first = world.mesh().firstTriangle;
  out.text(detail::stlHead(world.unit(), first[end] - first[begin]));
  for (uint32_t i = first[begin]; i < first[end]; ++i) {
    const auto [a, b, c] = world.triangle(i);
    out.value(detail::stlTriangle(world.point(a), world.point(b), world.point(c)));
  }
}

void writeVtp(const std::string& path, const WorldMesh& world, Interrupter* interrupter) {
  const uint64_t points = world.mesh().points.size(), triangles = world.mesh().triangles.size();
  detail::VtkFile file("PolyData");
  file.xml("<PolyData>\n<Piece NumberOfPoints=\"" + std::to_string(points) +
           "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
           std::to_string(triangles) + "\">\n<PointData Scalars=\"grain_id\">\n");
  const auto addGrains = [&](uint64_t count, const auto& forEach) {
    file.array("Int32", "grain_id", 1, 4 * count, [&world, forEach](OutputStream& out) {
      forEach([&](size_t grain, uint32_t) { out.value(world.label(grain)); });
    });
    file.array("UInt8", "color", 3, 3 * count, [&world, forEach](OutputStream& out) {
      forEach([&](size_t grain, uint32_t) { out.value(world.color(grain)); });
    });
  };
  addGrains(points, [&world](const auto& f) { world.forEachPoint(f); });
  file.xml("</PointData>\n<CellData Scalars=\"grain_id\">\n");
  addGrains(triangles, [&world](const auto& f) { world.forEachTriangle(f); });
  file.xml("</CellData>\n<Points>\n");
  file.array("Float32", "Points", 3, 12 * points, [&](OutputStream& out) {
    world.forEachPoint([&](size_t, uint32_t i) { out.value(world.point(i)); });
  });
  file.xml("</Points>\n<Polys>\n");
  file.array("Int64", "connectivity", 1, 24 * triangles, [&](OutputStream& out) {
    world.forEachTriangle([&](size_t, uint32_t i) {
      for (const uint32_t corner : world.triangle(i)) out.value(int64_t(corner));
    });
  });
  file.array("Int64", "offsets", 1, 8 * triangles, [&](OutputStream& out) {
    for (uint64_t i = 1; i <= triangles; ++i) out.value(int64_t(3 * i));
  });
  file.xml("</Polys>\n</Piece>\n</PolyData>\n");
  file.write(path, interrupter);
}

std::string stlName(int32_t label) {
  return grainName(label) + ".stl";
}

/// Grains of another sample among these would pass for grains of this one.
void checkNoOtherGrains(const std::string& folder, const std::vector<std::string>& names) {
  const std::set<std::string> ours(names.begin(), names.end());
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    int label = 0;
    if (std::sscanf(name.c_str(), "grain_%d", &label) == 1 && name == stlName(label) &&
        ours.count(name) == 0)
      throw IoError("cannot write " + folder + ": " + name +
                    " is there from another export; empty the folder, or choose another name");
  }
}

}  // namespace

std::string worldUnit(const openvdb::GridBase& grid) {
  if (const auto size = storedVoxelSize(grid)) return size->unit();
  return grid.voxelSize() == openvdb::Vec3d(1) ? "" : "an unknown unit";
}

bool isMeshEnding(const std::string& path) {
  const std::string end = fileEnding(path);
  return end == ".ply" || end == ".obj" || end == ".stl" || end == ".vtp" || isGlb(path);
}

bool isGlb(const std::string& path) {
  return fileEnding(path) == ".glb";
}

void checkMeshRoom(const std::string& path, uint64_t triangles, const MeshFileOptions& options) {
  // A closed mesh has half as many points as triangles, and two more (a grain with tunnels fewer).
  if (isGlb(path)) detail::checkGlbRoom(path, triangles / 2, triangles, options.shadeSmooth);
}

void writeMesh(const std::string& path, const GrainMesh& mesh, const MeshFileOptions& options,
               Interrupter* interrupter) {
  const WorldMesh world(mesh, options, path);
  const std::string end = fileEnding(path);
  if (end == ".ply")
    writePly(path, world, interrupter);
  else if (end == ".obj")
    writeObj(path, world, interrupter);
  else if (end == ".vtp")
    writeVtp(path, world, interrupter);
  else if (end == ".glb")
    detail::writeGlb(path, world, options, interrupter);
  else if (end == ".stl") {
    OutputStream out(path, interrupter);
    writeStl(out, world, 0, world.grainCount());
    out.commit();
  } else {
    throw InvalidInput(path +
                       ": no mesh format has this ending; use .ply, .obj, .stl, .glb or .vtp");
  }
}

void writeStlFolder(const std::string& folder, const GrainMesh& mesh,
                    const MeshFileOptions& options, Interrupter* interrupter) {
  const WorldMesh world(mesh, options, folder);
  OutputFolder made(folder);
  std::vector<std::string> names, paths;
  for (const int32_t label : mesh.labels) {
    names.push_back(stlName(label));
    paths.push_back(made.file(names.back()));
  }
  checkNoOtherGrains(folder, names);
  removeLeftovers(paths);
  std::vector<std::unique_ptr<OutputStream>> files;
  for (size_t grain = 0; grain < world.grainCount(); ++grain) {
    files.push_back(std::make_unique<OutputStream>(paths[grain], interrupter));
    writeStl(*files.back(), world, grain, grain + 1);
    files.back()->close();
  }
  OutputSet set;
  for (const auto& file : files) file->commit();
  set.commit();
  made.keep();
}

}  // namespace vdb_madf
