// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/samples/balls.h"
#include "vdb_madf/samples/bed.h"
#include "vdb_madf/samples/pack.h"
#include "vdb_madf/samples/particles.h"
#include "vdb_madf/samples/scan.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/samples/snow.h"
#include "vdb_madf/samples/spheres.h"

namespace vdb_madf::tools {

/// What is typed for any kind of sample, and the options of each kind.
struct GenerateArguments {
  std::string centers, out, gray, dims, radius, shape, aspect, surface, scanNoise, voxelSizeText;
  int size = 0;
  uint64_t seed = 1;
  bool numbered = false;
  std::optional<VoxelSize> voxelSize;
  SphereOptions spheres;
  PackOptions pack;
  SnowOptions snow;
  SinteredOptions sintered;
  ParticleOptions particles;
  BedOptions bed;
  BallOptions balls;
  ScanOptions scan;
};

/// A kind of sample: its own options, and the call that makes it.
struct SampleKind {
  const char *name, *description, *example;
  void (*add)(Verb verb, GenerateArguments& options);
  /// Turns what was typed into the options of the kind. @throw WrongUsage
  void (*parse)(GenerateArguments& options);
  Sample (*make)(const GenerateArguments& options, Interrupter* interrupter);
  bool hasTruth = true;
  bool cubesOnly = false;
  bool hasBodies = true;
  bool isListed = false;
};

/// All kinds, in the order of the help.
const std::vector<SampleKind>& sampleKinds();

/// What make() gives. Nothing but options goes into it, so whatever cannot be made is their fault:
/// an InvalidInput becomes a WrongUsage.
template <typename Make>
auto madeOfOptions(const Make& make) {
  try {
    return make();
  } catch (const InvalidInput& error) {
    throw WrongUsage(std::string("cannot generate this: ") + error.what());
  }
}

}  // namespace vdb_madf::tools
