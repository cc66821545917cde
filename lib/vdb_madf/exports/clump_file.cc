// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/clump_file.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/grids/detail/world_transform.h"

#include <fmt/core.h>

namespace vdb_madf {

namespace {

using detail::OutputStream;
using openvdb::Vec3d;

/// f(clump, its number, center, radius) for all balls, world. Clumps that have balls are numbered.
template <typename F>
void forEachBall(const std::vector<Clump>& clumps, const detail::WorldTransform& world,
                 const F& f) {
  size_t number = 0;
  for (const Clump& clump : clumps) {
    for (const Clump::Ball& ball : clump.balls)
      f(clump, number, world.origin + world.edges * ball.center.asVec3d(),
        world.shortestEdge() * std::sqrt(ball.squaredRadius));
    number += !clump.balls.empty();
  }
}

void numbers(OutputStream& out, const Vec3d& center, char separator) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis) out.value(separator);
    out.number(center[axis]);
  }
}

/// `fix rigid` refuses bodies of one atom, or of atoms at one place: such a clump has a second one
/// within its ball, which touches nothing. Its radius, and how far it is from the center along x,
/// in radii of the ball.
constexpr double kCoreRadius = 0.5, kCoreShift = 1.0 / 16;

bool needsCore(const Clump& clump) {
  return clump.balls.size() == 1;
}

/// The density at which all atoms of a clump weigh as much as its grain of density 1, however they
/// overlap.
double densityOfAtoms(const Clump& clump, const detail::WorldTransform& world) {
  double volume = 0;
  for (const Clump::Ball& ball : clump.balls)
    volume += 4.0 / 3.0 * openvdb::math::pi<double>() * std::pow(ball.squaredRadius, 1.5);
  if (needsCore(clump)) volume *= 1 + std::pow(kCoreRadius, 3);
  const openvdb::Vec3d edges = world.edges / world.shortestEdge();
  return volume > 0 ? double(clump.voxels) * edges[0] * edges[1] * edges[2] / volume : 1;
}

void writeBonds(OutputStream& out, const std::vector<ClumpBond>& bonds) {
  if (bonds.empty()) return;
  out.text("\nBonds\n\n");
  for (size_t bond = 1; bond <= bonds.size(); ++bond)
    out.text(fmt::format("{} {} {} {}\n", bond, bond, bonds[bond - 1].firstBall + 1,
                         bonds[bond - 1].secondBall + 1));
}

void writeLammps(OutputStream& out, const std::vector<Clump>& clumps,
                 const std::vector<ClumpBond>& bonds, const detail::WorldTransform& world) {
  size_t atoms = size_t(std::count_if(clumps.begin(), clumps.end(), needsCore));
  openvdb::BBoxd box;
  forEachBall(clumps, world, [&](const Clump&, size_t, const Vec3d& center, double radius) {
    ++atoms;
    box.expand(center - Vec3d(radius));
    box.expand(center + Vec3d(radius));
  });
  if (atoms == 0) box = openvdb::BBoxd(Vec3d(0), Vec3d(1));
  out.text("LAMMPS data: grains as clumps of balls, a molecule each (vdb_madf)\n\n");
  out.text(std::to_string(atoms) + " atoms\n1 atom types\n");
  if (!bonds.empty())
    out.text(fmt::format("{} bonds\n{} bond types\n", bonds.size(), bonds.size()));
  out.text("\n");
  const char* names[3] = {" xlo xhi\n", " ylo yhi\n", " zlo zhi\n"};
  for (int axis = 0; axis < 3; ++axis)
    out.text(detail::shortestDecimal(box.min()[axis]) + " " +
             detail::shortestDecimal(box.max()[axis]) + names[axis]);
  out.text("\nAtoms # hybrid sphere molecular\n\n");
  std::vector<std::string> densities;
  for (const Clump& clump : clumps)
    if (!clump.balls.empty())
      densities.push_back(detail::shortestDecimal(densityOfAtoms(clump, world)));
  size_t atom = 0;
  const auto writeAtom = [&](const Clump&, size_t n, const Vec3d& center, double radius) {
    out.number(++atom);
    out.text(" 1 ");
    numbers(out, center, ' ');
    out.text(fmt::format(" {} {} {}\n", detail::shortestDecimal(2 * radius), densities[n], n + 1));
  };
  forEachBall(clumps, world, writeAtom);
  forEachBall(clumps, world, [&](const Clump& clump, size_t n, const Vec3d& center, double radius) {
    if (needsCore(clump))
      writeAtom(clump, n, center + Vec3d(kCoreShift * radius, 0, 0), kCoreRadius * radius);
  });
  writeBonds(out, bonds);
}

}  // namespace

std::string describeClumps(const std::vector<Clump>& clumps, bool areCubes) {
  size_t balls = 0, without = 0;
  int64_t voxels = 0, uncovered = 0, outside = 0;
  double farthest = 0;
  for (const Clump& clump : clumps) {
    balls += clump.balls.size();
    without += clump.balls.empty();
    voxels += clump.voxels;
    uncovered += clump.uncovered;
    outside += clump.outside;
    farthest = std::max(farthest, clump.farthest);
  }
  const auto percent = [&](int64_t part) {
    return voxels ? 100.0 * double(part) / double(voxels) : 0.0;
  };
  std::string text = fmt::format(
      "{}, {}; uncovered {:.2f} %, outside the own grain {:.2f} %, volume error {:.2f} %, farthest "
      "voxel {:.2f} {} from its balls",
      counted(clumps.size(), "grain"), counted(balls, "ball"), percent(uncovered), percent(outside),
      percent(outside - uncovered), farthest, areCubes ? "voxels" : "shortest edges");
  if (without > 0) text += fmt::format("; {} without a ball", counted(without, "grain"));
  return text;
}

bool isClumpEnding(const std::string& path) {
  const std::string end = fileEnding(path);
  return end == ".csv" || end == ".txt" || end == ".data";
}

void writeClumps(const std::string& path, const std::vector<Clump>& clumps,
                 const openvdb::math::Transform& transform, const std::vector<ClumpBond>& bonds,
                 Interrupter* interrupter) {
  const detail::WorldTransform world = detail::worldTransform(transform);
  if (!isClumpEnding(path))
    throw InvalidInput(path + ": no clump format has this ending; use .csv, .txt or .data");
  OutputStream out(path, interrupter);
  if (fileEnding(path) == ".data") {
    writeLammps(out, clumps, bonds, world);
  } else {
    const bool isTable = fileEnding(path) == ".csv";
    out.text(isTable ? "grain_id,x,y,z,radius\n" : "#format x_y_z_r_clumpId\n");
    const auto writeBall = [&](const Clump& clump, size_t n, const Vec3d& center, double radius) {
      if (isTable) out.text(std::to_string(clump.label) + ",");
      numbers(out, center, isTable ? ',' : ' ');
      out.text((isTable ? "," : " ") + detail::shortestDecimal(radius));
      out.text(isTable ? "\n" : " " + std::to_string(n) + "\n");
    };
    forEachBall(clumps, world, writeBall);
  }
  out.commit();
}

void writeClumpCover(const std::string& path, const std::vector<Clump>& clumps,
                     const openvdb::math::Transform& transform, Interrupter* interrupter) {
  const detail::WorldTransform world = detail::worldTransform(transform);
  if (fileEnding(path) != ".csv")
    throw InvalidInput(path + ": the cover of the grains is written as .csv");
  OutputStream out(path, interrupter);
  out.text("grain_id,voxels,balls,uncovered,outside,volume_error,farthest\n");
  for (const Clump& clump : clumps) {
    out.text(fmt::format(
        "{},{},{},{},{},{},{}\n", clump.label, clump.voxels, clump.balls.size(), clump.uncovered,
        clump.outside, detail::shortestDecimal(clump.volumeError()),
        clump.balls.empty() ? "" : detail::shortestDecimal(world.shortestEdge() * clump.farthest)));
  }
  out.commit();
}

}  // namespace vdb_madf
