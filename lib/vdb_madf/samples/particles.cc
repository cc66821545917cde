// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/particles.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/samples/detail/least_cells.h"
#include "vdb_madf/samples/detail/mask_blocks.h"
#include "vdb_madf/samples/detail/particle_placement.h"
#include "vdb_madf/samples/detail/sample_options.h"

namespace vdb_madf {

namespace {

using detail::MaskBlocks;
using detail::Particle;
using detail::Vector;

/// Marks the voxels of the box that lie in the particle.
void addParticle(MaskBlocks& blocks, size_t block, const Particle& particle) {
  CoordBBox box = particle.box();
  box.intersect(blocks.box(block));
  for (int x = box.min().x(); x <= box.max().x(); ++x)
    for (int y = box.min().y(); y <= box.max().y(); ++y)
      for (int z = box.min().z(); z <= box.max().z(); ++z)
        if (particle.value(Vector(x, y, z)) < 1)
          blocks.node(block).touchLeaf({x, y, z})->setValueOn({x, y, z});
}

MaskTree::Ptr uniteParticles(const Coord& size, const std::vector<Particle>& particles,
                             Interrupter* interrupter) {
  MaskBlocks blocks(size);
  detail::parallelFor(blocks.count(), 1, interrupter, [&](size_t begin, size_t end) {
    for (size_t block = begin; block < end; ++block)
      for (const Particle& particle : particles) addParticle(blocks, block, particle);
  });
  return blocks.takeTree();
}

class ParticleSites {
 public:
  static constexpr double kSlack = 1e-6;

  explicit ParticleSites(const std::vector<Particle>& particles) : particles_(particles) {
    for (const Particle& particle : particles) slopes_.push_back(particle.slope());
  }

  size_t size() const { return particles_.size(); }

  double value(size_t i, const Coord& p) const { return particles_[i].value(detail::toVector(p)); }

  detail::ValueRange range(size_t i, const Coord& lower, int edge) const {
    const double half = (edge - 1) / 2.0;
    const double middle = particles_[i].value(detail::toVector(lower) + Vector(half));
    const double change = slopes_[i] * half * std::sqrt(3.0);
    return {middle - change, middle + change};
  }

 private:
  const std::vector<Particle>& particles_;
  std::vector<double> slopes_;
};

}  // namespace

const std::vector<std::string>& particleShapeNames() {
  static const std::vector<std::string> names{"balls", "ellipsoids", "plates", "prisms",
                                              "polyhedra"};
  return names;
}

Sample generateParticles(const ParticleOptions& options, Interrupter* interrupter) {
  detail::checkSize(options.size);
  detail::checkCount(options.count);
  detail::checkRadii(options.minRadius, options.maxRadius);
  detail::checkRange("lognormal", options.lognormal, 0, 1);
  detail::checkRange("neck", options.neck, 0, 2);

  const std::vector<Particle> particles = detail::placeParticles(options, interrupter);
  Sample sample;
  sample.object = MaskGrid::create(uniteParticles(options.size, particles, interrupter));
  sample.truth = Int32Grid::create(
      detail::LeastCells(ParticleSites(particles)).label(sample.object->tree(), interrupter));
  detail::SourceText source("particles");
  source.size(options.size)
      .add("shape", particleShapeNames()[size_t(options.shape)])
      .add("count", std::to_string(options.count))
      .range("radius", options.minRadius, options.maxRadius)
      .add("lognormal", options.lognormal)
      .add("neck", options.neck)
      .add("seed", std::to_string(options.seed));
  detail::describe(*sample.object, "object", options.size, source);
  detail::describe(*sample.truth, "truth", options.size, source);
  return sample;
}

}  // namespace vdb_madf
