// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "sample_kinds.h"

#include <algorithm>

#include "parse.h"

namespace vdb_madf::tools {

namespace {

template <typename KindOptions>
void parseSize(const GenerateArguments& typed, KindOptions& kind) {
  if (!typed.dims.empty()) kind.size = parseDims(typed.dims, "--dims");
  if (typed.size > 0) kind.size = Coord(typed.size);
}

template <typename KindOptions>
void parseSizeAndSeed(const GenerateArguments& typed, KindOptions& kind) {
  parseSize(typed, kind);
  kind.seed = typed.seed;
}

/// A:B, or A for both; they stay as they are if nothing is typed.
void parseSpan(const std::string& text, const std::string& option, double& least,
               double& greatest) {
  if (text.empty()) return;
  const size_t colon = text.find(':');
  least = parseNumber(text.substr(0, colon), option);
  greatest = colon == std::string::npos ? least : parseNumber(text.substr(colon + 1), option);
  if (!(least > 0 && least <= greatest))
    throw WrongUsage(option + " " + text + ": write A:B, 0 < A <= B");
}

template <typename KindOptions>
void parseRadius(const GenerateArguments& typed, KindOptions& kind) {
  parseSpan(typed.radius, "--radius", kind.minRadius, kind.maxRadius);
}

/// What kinds whose balls have voxels of any shape share.
template <typename KindOptions>
void parseBodies(const GenerateArguments& typed, KindOptions& kind) {
  parseSizeAndSeed(typed, kind);
  parseRadius(typed, kind);
  kind.voxelSize = typed.voxelSize;
}

void parseShape(const std::string& text, ParticleShape& shape) {
  const auto& names = particleShapeNames();
  const auto name = std::find(names.begin(), names.end(), text);
  if (name != names.end()) shape = ParticleShape(name - names.begin());
}

void checkFraction(double fraction) {
  if (!(fraction > 0 && fraction < 1)) throw WrongUsage("--fraction must lie between 0 and 1");
}

}  // namespace

const std::vector<SampleKind>& sampleKinds() {
  static const std::vector<SampleKind> kKinds{
      {"spheres", "overlapping balls with known grains (paper, Table 1)",
       "vdb_madf generate spheres balls.vdb --count 100 --radius 20:30 --overlap 0.084",
       [](Verb verb, GenerateArguments& options) {
         SphereOptions& spheres = options.spheres;
         verb.option("--count", spheres.count, "number of balls").showDefault();
         verb.option("--radius", options.radius, "radii A:B, voxels (default 20:30)");
         verb.option("--overlap", spheres.overlap, "overlap of the balls (paper, section 6.1)")
             .showDefault();
         verb.option("--max-cover", spheres.maxCover, "most balls that may share a voxel (0: any)")
             .notNegative()
             .showDefault();
       },
       [](GenerateArguments& options) { parseBodies(options, options.spheres); },
       [](const GenerateArguments& options, Interrupter* interrupter) {
         return generateSpheres(options.spheres, interrupter);
       }},
      {"pack", "many balls at a given solid fraction",
       "vdb_madf generate pack pack.vdb --size 512 --fraction 0.25",
       [](Verb verb, GenerateArguments& options) {
         verb.option("--fraction", options.pack.fraction, "solid fraction").showDefault();
         verb.option("--radius", options.radius, "radii A:B, voxels (default 8:28)");
       },
       [](GenerateArguments& options) {
         parseBodies(options, options.pack);
         checkFraction(options.pack.fraction);
       },
       [](const GenerateArguments& options, Interrupter* interrupter) {
         return generatePack(options.pack, interrupter);
       },
       false, false, false},
      {"snow", "a snow-like random structure",
       "vdb_madf generate snow snow.vdb --size 256 --fraction 0.3 --voxel-size 10um",
       [](Verb verb, GenerateArguments& options) {
         verb.option("--fraction", options.snow.fraction, "solid fraction").showDefault();
         verb.option("--length", options.snow.length, "peak wavelength, voxels").showDefault();
       },
       [](GenerateArguments& options) {
         parseSizeAndSeed(options, options.snow);
         checkFraction(options.snow.fraction);
       },
       [](const GenerateArguments& options, Interrupter* interrupter) {
         return generateSnow(options.snow, interrupter);
       },
       false, true, false},
      {"sintered", "sintered balls with known grains",
       "vdb_madf generate sintered grains.vdb --count 90 --roughness 0.15",
       [](Verb verb, GenerateArguments& options) {
         SinteredOptions& sintered = options.sintered;
         verb.option("--count", sintered.count, "number of balls").showDefault();
         verb.option("--radius", options.radius, "radii A:B, voxels (default 12:22)");
         verb.option("--neck", sintered.neck, "least distance of centers / (ri + rj)")
             .showDefault();
         verb.option("--roughness", sintered.roughness, "amplitude of surface noise").showDefault();
       },
       [](GenerateArguments& options) { parseBodies(options, options.sintered); },
       [](const GenerateArguments& options, Interrupter* interrupter) {
         return generateSintered(options.sintered, interrupter);
       }},
      {"particles", "particles of one shape with known grains",
       "vdb_madf generate particles plates.vdb --shape plates --count 90 --radius 12:22",
       [](Verb verb, GenerateArguments& options) {
         ParticleOptions& particles = options.particles;
         verb.option("--shape", options.shape, "what they are (default ellipsoids)")
             .oneOf(particleShapeNames());
         verb.option("--count", particles.count, "number of particles").showDefault();
         verb.option("--radius", options.radius,
                     "radii A:B of the balls of equal volume, voxels (default 12:22)");
         verb.option("--aspect", options.aspect,
                     "of rods and columns: length over thickness, A:B (default 4:8)");
         verb.option("--lognormal", particles.lognormal,
                     "standard deviation of the logarithm of the radii (0: uniform radii)")
             .showDefault();
         verb.option("--neck", particles.neck, "size to which they shrink until none share a voxel")
             .showDefault();
       },
       [](GenerateArguments& options) {
         parseBodies(options, options.particles);
         ParticleOptions& particles = options.particles;
         parseShape(options.shape, particles.shape);
         if (!options.aspect.empty() && !haveAspect(particles.shape))
           throw WrongUsage("--aspect " + options.aspect + ": of --shape rods and columns only");
         parseSpan(options.aspect, "--aspect", particles.minAspect, particles.maxAspect);
       },
       [](const GenerateArguments& options, Interrupter* interrupter) {
         return generateParticles(options.particles, interrupter);
       }},
      {"bed", "a bed of balls, sintered by curvature flow, with known grains",
       "vdb_madf generate bed bed.vdb --size 200 --radius 16:25 --rounds 10",
       [](Verb verb, GenerateArguments& options) {
         verb.option("--radius", options.radius, "radii A:B, voxels (default 12:22)");
         verb.option("--rounds", options.bed.rounds, "rounds of sintering").showDefault();
       },
       [](GenerateArguments& options) {
         parseSizeAndSeed(options, options.bed);
         parseRadius(options, options.bed);
       },
       [](const GenerateArguments& options, Interrupter* interrupter) {
         return generateBed(options.bed, interrupter);
       },
       true, true},
      {"balls", "balls at the centers of a list, with known grains",
       "vdb_madf generate balls beads.txt beads.vdb --radius 10 --size 200",
       [](Verb verb, GenerateArguments& options) {
         verb.option("--radius", options.radius, "voxels for each unit of the list").required();
         verb.flag("--numbered", options.numbered, "skip the first number of each line");
       },
       [](GenerateArguments& options) {
         parseSize(options, options.balls);
         options.balls.voxelSize = options.voxelSize;
         options.balls.radius = parseNumber(options.radius, "--radius");
         options.balls.list = options.centers + (options.numbered ? " --numbered" : "");
       },
       [](const GenerateArguments& options, Interrupter* interrupter) {
         return generateBalls(options.balls, interrupter);
       },
       true, false, true, true},
  };
  return kKinds;
}

}  // namespace vdb_madf::tools
