// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// From grains to meshes: one file for a viewer or a simulation, each grain a closed surface that
// fits its neighbors without a gap.

#include <filesystem>
#include <iostream>

#include "vdb_madf/exports/mesh_file.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/segmentation/segment.h"

int main() {
  vdb_madf::initialize();
  vdb_madf::SinteredOptions sample;
  sample.size = {64, 64, 64};
  sample.count = 5;
  const auto cut = vdb_madf::segment(*vdb_madf::generateSintered(sample).object);

  // The faces of voxels are smoothed; half as many triangles say nearly the same.
  vdb_madf::GrainMeshOptions options;
  options.smoothing = 10;
  options.triangles = vdb_madf::countTriangles(*cut.grain) / 2;
  const vdb_madf::GrainMesh mesh = vdb_madf::grainMesh(*cut.grain, options);

  // Smoothing keeps the volume of each grain: its mesh holds as much as its voxels do.
  const std::vector<double> volumes = vdb_madf::meshVolumes(mesh);
  for (size_t i = 0; i < mesh.labels.size(); ++i)
    std::cout << "grain " << mesh.labels[i] << ": "
              << mesh.firstTriangle[i + 1] - mesh.firstTriangle[i] << " triangles, volume "
              << volumes[i] << " of " << cut.grainVoxels[size_t(mesh.labels[i] - 1)] << " voxels\n";

  // The ending names the format. Places are those of the grid in the world, touching grains have
  // colors that differ.
  vdb_madf::MeshFileOptions file;
  file.transform = cut.grain->constTransformPtr();
  file.colors = vdb_madf::grainColors(*cut.grain);
  vdb_madf::writeMesh("grains.ply", mesh, file);
  return std::filesystem::file_size("grains.ply") > 0 && !mesh.labels.empty() ? 0 : 1;
}
