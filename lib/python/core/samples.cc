// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <functional>
#include <tuple>

#include "bindings.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/samples/balls.h"
#include "vdb_madf/samples/bed.h"
#include "vdb_madf/samples/pack.h"
#include "vdb_madf/samples/particles.h"
#include "vdb_madf/samples/scan.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/samples/snow.h"
#include "vdb_madf/samples/spheres.h"

namespace vdb_madf::python {

namespace {

/// Keyword arguments, each of which has to be taken by something.
class Arguments {
 public:
  Arguments(std::string kind, const py::dict& values)
      : kind_(std::move(kind)), values_(values.attr("copy")()) {}

  template <typename T>
  void take(const char* name, T& value) {
    if (!values_.contains(name)) return;
    try {
      value = values_.attr("pop")(name).template cast<T>();
    } catch (const py::cast_error&) {
      throw InvalidInput(std::string(name) + ": is out of range");
    }
  }
  void takeSpan(const char* name, double& least, double& greatest) {
    std::pair<double, double> span{least, greatest};
    take(name, span);
    std::tie(least, greatest) = span;
  }
  template <typename Options>
  void takeRadius(Options& options) {
    takeSpan("radius", options.minRadius, options.maxRadius);
  }
  /// @throw TypeError if something is left
  void end() const {
    for (const auto& item : values_)
      throw py::type_error("samples of kind '" + kind_ + "' have no option '" +
                           item.first.cast<std::string>() + "'");
  }

 private:
  std::string kind_;
  py::dict values_;
};

using Maker = std::function<Sample(Interrupter*)>;

template <typename Options>
void takeSize(Arguments& arguments, Options& options) {
  Index size = toIndex(options.size);
  arguments.take("size", size);
  options.size = toCoord(size);
  arguments.take("seed", options.seed);
}

Maker spheres(Arguments& a) {
  SphereOptions o;
  takeSize(a, o);
  a.takeRadius(o);
  a.take("count", o.count);
  a.take("overlap", o.overlap);
  a.take("max_cover", o.maxCover);
  return [o](Interrupter* interrupter) { return generateSpheres(o, interrupter); };
}

Maker pack(Arguments& a) {
  PackOptions o;
  takeSize(a, o);
  a.takeRadius(o);
  a.take("fraction", o.fraction);
  return [o](Interrupter* interrupter) { return generatePack(o, interrupter); };
}

Maker snow(Arguments& a) {
  SnowOptions o;
  takeSize(a, o);
  a.take("fraction", o.fraction);
  a.take("length", o.length);
  return [o](Interrupter* interrupter) { return generateSnow(o, interrupter); };
}

Maker sintered(Arguments& a) {
  SinteredOptions o;
  takeSize(a, o);
  a.takeRadius(o);
  a.take("count", o.count);
  a.take("neck", o.neck);
  a.take("roughness", o.roughness);
  return [o](Interrupter* interrupter) { return generateSintered(o, interrupter); };
}

Maker particles(Arguments& a) {
  ParticleOptions o;
  takeSize(a, o);
  a.takeRadius(o);
  a.take("count", o.count);
  a.take("lognormal", o.lognormal);
  a.take("neck", o.neck);
  std::string shape = particleShapeNames().at(size_t(o.shape));
  a.take("shape", shape);
  const auto& names = particleShapeNames();
  const auto name = std::find(names.begin(), names.end(), shape);
  if (name == names.end()) throw InvalidInput("shape='" + shape + "': there is no such shape");
  o.shape = ParticleShape(name - names.begin());
  if (haveAspect(o.shape)) a.takeSpan("aspect", o.minAspect, o.maxAspect);
  return [o](Interrupter* interrupter) { return generateParticles(o, interrupter); };
}

Maker bed(Arguments& a) {
  BedOptions o;
  takeSize(a, o);
  a.takeRadius(o);
  a.take("rounds", o.rounds);
  return [o](Interrupter* interrupter) { return generateBed(o, interrupter); };
}

Maker balls(Arguments& a) {
  BallOptions o;
  o.radius = 1;
  o.list = "centers";
  std::vector<std::array<double, 4>> centers;
  a.take("centers", centers);
  for (const auto& [z, y, x, r] : centers) o.balls.push_back({x, y, z, r});
  std::optional<Index> size;
  a.take("size", size);
  if (size) o.size = toCoord(*size);
  uint64_t seed = 0;  // that of the noise
  a.take("seed", seed);
  return [o](Interrupter* interrupter) { return generateBalls(o, interrupter); };
}

ScanOptions scanOptions(Arguments& a) {
  ScanOptions scan;
  a.take("seed", scan.seed);
  a.take("surface", scan.surface);
  a.take("surface_length", scan.surfaceLength);
  a.take("blur", scan.blur);
  a.take("noise", scan.noise);
  a.take("noise_length", scan.noiseLength);
  return scan;
}

/// The object, its true grains, and with `gray` a scan, else None.
py::tuple generate(const std::string& kind, const py::dict& options, bool gray,
                   const std::optional<std::array<double, 3>>& voxelSize, const Call& call) {
  using Make = Maker (*)(Arguments&);
  constexpr std::pair<const char*, Make> kKinds[] = {
      {"spheres", spheres},     {"pack", pack}, {"snow", snow},  {"sintered", sintered},
      {"particles", particles}, {"bed", bed},   {"balls", balls}};
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [&](const auto& known) { return kind == known.first; });
  if (found == std::end(kKinds))
    throw InvalidInput("kind '" + kind +
                       "': must be spheres, pack, snow, sintered, particles, bed or balls");
  Arguments scanArguments(kind, options);
  const ScanOptions scan = scanOptions(scanArguments);
  Arguments arguments(kind, options);
  const Maker make = found->second(arguments);
  scanOptions(arguments);
  arguments.end();
  if (voxelSize && !VoxelSize(reversed(*voxelSize)).isCube())
    throw InvalidInput("samples are made of cubes: give one edge");
  std::vector<uint16_t> values;
  const Sample sample = withoutLock(call, [&](Interrupter* interrupter) {
    checkScan(scan);
    Sample made = make(interrupter);
    if (!gray) return scanned(made, scan, interrupter);
    values = grayValues(made, scan, storedDomain(*made.object)->box(), interrupter);
    return made;
  });
  if (voxelSize) {
    setVoxelSize(*sample.object, VoxelSize(reversed(*voxelSize)));
    if (sample.truth) setVoxelSize(*sample.truth, VoxelSize(reversed(*voxelSize)));
  }
  py::object scanOf = py::none();
  if (gray) {
    const Coord dim = storedDomain(*sample.object)->box().dim();
    scanOf = py::array_t<uint16_t>({dim.z(), dim.y(), dim.x()}, values.data());
  }
  return py::make_tuple(GridPtr(sample.object), GridPtr(sample.truth), scanOf);
}

}  // namespace

void bindSamples(py::module_& m) {
  m.def("generate", generate, py::arg("kind"), py::arg("options"), py::arg("gray"),
        py::arg("voxel_size"), py::arg("call"));
}

}  // namespace vdb_madf::python
