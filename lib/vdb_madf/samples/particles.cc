// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/particles.h"

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/samples/detail/bodies.h"
#include "vdb_madf/samples/detail/lattice.h"
#include "vdb_madf/samples/detail/least_cells.h"
#include "vdb_madf/samples/detail/mask_blocks.h"
#include "vdb_madf/samples/detail/placement.h"
#include "vdb_madf/samples/detail/sample_options.h"

namespace vdb_madf {

namespace {

using detail::Lattice;
using detail::MaskBlocks;
using detail::Particle;
using detail::Vector;

/// Marks the voxels of the box whose centers lie in the particle.
void addParticle(MaskBlocks& blocks, size_t block, const Particle& particle,
                 const Lattice& lattice) {
  CoordBBox box = lattice.voxelsIn(particle.box());
  box.intersect(blocks.box(block));
  for (int x = box.min().x(); x <= box.max().x(); ++x)
    for (int y = box.min().y(); y <= box.max().y(); ++y)
      for (int z = box.min().z(); z <= box.max().z(); ++z)
        if (particle.value(lattice.place({x, y, z})) < 1)
          blocks.node(block).touchLeaf({x, y, z})->setValueOn({x, y, z});
}

MaskTree::Ptr uniteParticles(const Coord& voxels, const Lattice& lattice,
                             const std::vector<Particle>& particles, Interrupter* interrupter) {
  MaskBlocks blocks(voxels);
  detail::parallelForEach(blocks.count(), 1, interrupter, [&](size_t block) {
    for (const Particle& particle : particles) addParticle(blocks, block, particle, lattice);
  });
  return blocks.takeTree();
}

class ParticleSites {
 public:
  static constexpr double kSlack = 1e-6;

  ParticleSites(const std::vector<Particle>& particles, const Lattice& lattice)
      : particles_(particles), lattice_(lattice) {
    for (const Particle& particle : particles) slopes_.push_back(particle.slope());
  }

  size_t size() const { return particles_.size(); }

  double value(size_t i, const Coord& p) const { return particles_[i].value(lattice_.place(p)); }

  detail::ValueRange range(size_t i, const Coord& lower, int edge) const {
    const Vector half = lattice_.edges() * ((edge - 1) / 2.0);
    const double middle = particles_[i].value(lattice_.place(lower) + half);
    const double change = slopes_[i] * half.length();
    return {middle - change, middle + change};
  }

 private:
  const std::vector<Particle>& particles_;
  const Lattice& lattice_;
  std::vector<double> slopes_;
};

}  // namespace

const std::vector<std::string>& particleShapeNames() {
  static const std::vector<std::string> names{
      "balls",   "ellipsoids",  "plates",           "prisms",       "polyhedra",  "rods",
      "columns", "sand-ottawa", "sand-ottawa-fine", "sand-hamburg", "sand-hostun"};
  return names;
}

bool haveAspect(ParticleShape shape) {
  return shape == ParticleShape::rods || shape == ParticleShape::columns;
}

bool isSand(ParticleShape shape) {
  return shape >= ParticleShape::sandOttawa;
}

Sample generateParticles(const ParticleOptions& options, Interrupter* interrupter) {
  detail::checkSize(options.size);
  detail::checkCount(options.count);
  detail::checkRadii(options.minRadius, options.maxRadius);
  detail::checkRange("aspect", options.maxAspect, 1, 100);
  detail::checkRange("least aspect", options.minAspect, 1, options.maxAspect);
  detail::checkRange("lognormal", options.lognormal, 0, 1);
  detail::checkRange("neck", options.neck, 0, 2);

  const Lattice lattice(options.voxelSize);
  const Coord voxels = lattice.voxels(options.size);
  const std::vector<Particle> particles = detail::placeParticles(options, interrupter);
  Sample sample;
  sample.object = MaskGrid::create(uniteParticles(voxels, lattice, particles, interrupter));
  sample.truth = Int32Grid::create(detail::LeastCells(ParticleSites(particles, lattice))
                                       .label(sample.object->tree(), interrupter));
  sample.bodies = detail::particleBodies(particles, lattice);
  detail::SourceText source("particles");
  source.size(options.size)
      .add("shape", particleShapeNames()[size_t(options.shape)])
      .add("count", std::to_string(options.count))
      .range("radius", options.minRadius, options.maxRadius);
  if (haveAspect(options.shape)) source.range("aspect", options.minAspect, options.maxAspect);
  source.add("lognormal", options.lognormal)
      .add("neck", options.neck)
      .add("seed", std::to_string(options.seed))
      .edges(options.voxelSize);
  return detail::described(sample, voxels, source, options.voxelSize);
}

}  // namespace vdb_madf
