// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/sand_atlas.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/remesh.h"
#include "vdb_madf/exports/detail/stl_bytes.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/shapes/grain_mesh.h"
#include "vdb_madf/shapes/world_points.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr double kFinestFacet = 0.25;  // in voxels
constexpr int kFacetsAcross[] = {100, 30, 10, 3};

/// A grain alone, as label 1, with the lowest corner of its box at (1, 1, 1).
Int32Grid::Ptr particleOf(const Int32Tree& leaves, const GrainMeasures& grain) {
  const auto particle = Int32Grid::create(0);
  auto to = particle->getAccessor();
  const Coord shift = Coord(1) - grain.box.min();
  detail::forEachLeafOrigin(grain.box, [&](const Coord& origin) {
    const auto* leaf = leaves.probeConstLeaf(origin);
    if (!leaf) return;
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
      if (*voxel == grain.id) to.setValueOn(voxel.getCoord() + shift, 1);
  });
  return particle;
}

FloatGrid::Ptr densityOf(const Int32Grid& particle) {
  const auto density = FloatGrid::create(
      std::make_shared<openvdb::FloatTree>(particle.tree(), 0.0f, 1.0f, openvdb::TopologyCopy()));
  density->setName("density");
  density->setGridClass(openvdb::GRID_FOG_VOLUME);
  return density;
}

/// The center of the volume that a mesh encloses.
Vec3d centerOf(const GrainMesh& mesh) {
  const Vec3d reference(mesh.points.front());
  Vec3d moment(0);
  double sixfold = 0;
  for (const auto& triangle : mesh.triangles) {
    const Vec3d a = Vec3d(mesh.points[triangle[0]]) - reference,
                b = Vec3d(mesh.points[triangle[1]]) - reference,
                c = Vec3d(mesh.points[triangle[2]]) - reference;
    const double volume = a.dot(b.cross(c));
    sixfold += volume;
    moment += volume * (a + b + c) / 4;
  }
  return reference + moment / sixfold;
}

/// \p edge: of a voxel, mm
std::string stlOf(const GrainMesh& mesh, double volume, double edge) {
  const Vec3d center = centerOf(mesh);
  const double scale = edge * std::cbrt(volume / meshVolumes(mesh)[0]);
  std::vector<Vec3f> points = worldPoints(mesh, *openvdb::math::Transform::createLinearTransform());
  for (Vec3f& point : points) point = Vec3f(scale * (Vec3d(point) - center));
  std::string bytes = detail::stlHead("mm", uint32_t(mesh.triangles.size()));
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto triangle = detail::stlTriangle(points[a], points[b], points[c]);
    bytes.append(triangle.data(), triangle.size());
  }
  return bytes;
}

/// In facets of about this size, but smaller ones where that loses most of the grain.
GrainMesh inFacets(const GrainMesh& mesh, double facet, double volume) {
  for (;; facet /= 2) {
    facet = std::max(facet, kFinestFacet);
    GrainMesh made = detail::remesh(mesh, facet);
    const bool hasMost = !made.triangles.empty() && meshVolumes(made)[0] > volume / 2;
    if (hasMost || facet == kFinestFacet) return made;
  }
}

std::string nineDigits(double value) {
  return fmt::format("{:.9g}", value);
}

/// \p edge: of a voxel, micrometers
std::string tableOf(const std::vector<GrainMeasures>& grains, double edge) {
  std::string text =
      "Particle ID,Volume (µm³),Equivalent Diameter (µm),Major Axis Length (µm),Middle Axis Length "
      "(µm),Minor Axis Length (µm),True Sphericity (-),Convexity (-),Flatness (-),Elongation (-),"
      "Compactness (-)\n";
  for (size_t i = 0; i < grains.size(); ++i) {
    const GrainMeasures& grain = grains[i];
    const auto& axes = grain.ellipsoid.values;
    const auto& sphericity = grain.sphericity;
    text += std::to_string(i + 1);
    for (const double value : {grain.volume * edge * edge * edge, grain.equivalentDiameter * edge,
                               axes[0] * edge, axes[1] * edge, axes[2] * edge})
      text += "," + nineDigits(value);
    text += "," + (sphericity ? nineDigits(*sphericity) : "");
    for (const double value : {grain.solidity(), axes[2] / axes[1], axes[1] / axes[0]})
      text += "," + nineDigits(value);
    text += "," + (sphericity ? nineDigits(std::pow(*sphericity, 3)) : "") + "\n";
  }
  return text;
}

/// \p edge: of a voxel, micrometers
std::string aboutSand(const std::string& name, size_t particles, double edge) {
  nlohmann::ordered_json about;
  about["title"] = name;
  for (const char* key :
       {"description", "long_description", "image", "image_source_url", "contributor", "lat_lon",
        "publication_url", "source_data_url", "source_license", "supplementary_material_url"})
    about[key] = nullptr;
  about["number_of_particles"] = particles;
  about["microns_per_pixel"] = std::stod(nineDigits(edge));
  return about.dump(4, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

SandAtlasCounts writeSandAtlas(const std::string& folder, const Int32Grid& labels, int smoothing,
                               Interrupter* interrupter) {
  requireCubicVoxels(labels, "the Sand Atlas");
  detail::worldTransform(labels.transform());  // which refuses others than along the axes
  const auto size = storedVoxelSize(labels);
  if (!size)
    throw InvalidInput(
        "the Sand Atlas has lengths in mm, and the voxel size is not known: give it");
  OutputTree tree(folder);
  MeasureOptions options;
  options.shape = true;
  detail::WorkPart measuring(interrupter, 0, 30), writing(interrupter, 30, 100);
  std::vector<GrainMeasures> grains = measure(labels, options, &measuring).grains;
  SandAtlasCounts counts;
  counts.atFaces = grains.size();
  grains.erase(std::remove_if(grains.begin(), grains.end(),
                              [](const GrainMeasures& grain) { return grain.atDomainFace; }),
               grains.end());
  counts.particles = grains.size();
  counts.atFaces -= grains.size();
  if (grains.empty())
    throw InvalidInput("there is no grain that does not touch the faces: nothing to write");

  const Int32Tree::ConstPtr leaves = detail::withoutTiles(labels);
  GrainMeshOptions meshOptions;
  meshOptions.smoothing = smoothing;
  detail::parallelForEach(grains.size(), 1, &writing, [&](size_t i) {
    const GrainMeasures& grain = grains[i];
    const std::string name = fmt::format("/particle_{:05}", i + 1);
    const Int32Grid::Ptr particle = particleOf(*leaves, grain);
    tree.write("vdb" + name + ".vdb", vdbBytes(name, {densityOf(*particle)}));
    const GrainMesh mesh = grainMesh(*particle, meshOptions);
    const auto writeStl = [&](const std::string& quality, const GrainMesh& made) {
      tree.write("stl_" + quality + name + ".stl",
                 stlOf(made, double(grain.voxels), 1000 * size->edge()));
    };
    writeStl("ORIGINAL", mesh);
    for (const int across : kFacetsAcross)
      writeStl(std::to_string(across),
               inFacets(mesh, grain.ellipsoid.values[2] / across, double(grain.voxels)));
  });
  const std::string name = lastPart(folder);
  tree.write(name + ".csv", tableOf(grains, 1e6 * size->edge()));
  tree.write(name + ".json", aboutSand(name, grains.size(), 1e6 * size->edge()));
  tree.commit();
  return counts;
}

}  // namespace vdb_madf
