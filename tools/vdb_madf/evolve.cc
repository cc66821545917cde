// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/evolve.h"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>

#include "command.h"
#include "input_options.h"
#include "parse.h"
#include "sample_kinds.h"
#include "text_file.h"
#include "vdb_madf/files/output_folder.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

struct EvolveArguments {
  InputOptions input;
  std::string out, axis, drift;
  EvolveOptions evolve;

  std::string file(const std::string& name) const {
    return (std::filesystem::path(out) / name).string();
  }
  /// As many digits for each, so that files come in the order of the steps.
  std::string stepFile(int step) const {
    return file(fmt::format("step-{:0{}}.vdb", step, std::to_string(evolve.steps).size()));
  }
};

void parseVector(const std::string& text, const std::string& option, openvdb::Vec3d& vector) {
  if (text.empty()) return;
  const auto parts = split(text, ',');
  if (parts.size() != 3) throw WrongUsage(option + " " + text + ": write X,Y,Z");
  for (int axis = 0; axis < 3; ++axis) vector[axis] = parseNumber(parts[size_t(axis)], option);
}

void parse(EvolveArguments& o) {
  parseVector(o.axis, "--axis", o.evolve.axis);
  parseVector(o.drift, "--drift", o.evolve.drift);
  madeOfOptions([&] { checkEvolve(o.evolve); });
  o.input.outputs = {o.file("motion.csv"), o.file("fates.csv"), o.file("bonds.csv")};
  for (int step = 0; step <= o.evolve.steps; ++step) o.input.outputs.push_back(o.stepFile(step));
  o.input.parse();
}

void addMotionRow(std::ostream& csv, int step, const EvolvedStep& evolved) {
  csv << step;
  for (int n = 0; n < 9; ++n) csv << ',' << evolved.motion.linear(n / 3, n % 3);
  for (int axis = 0; axis < 3; ++axis) csv << ',' << evolved.motion.shift[axis];
  csv << '\n';
}

void addFateRows(std::ostream& csv, int step, const EvolvedStep& evolved) {
  for (const EvolvedGrain& g : evolved.grains)
    csv << step << ',' << g.grain << ',' << toString(g.fate) << ',' << g.voxels << ','
        << g.center.x() << ',' << g.center.y() << ',' << g.center.z() << '\n';
}

void addBondRows(std::ostream& csv, int step, const EvolvedStep& evolved) {
  for (const EvolvedBond& b : evolved.bonds)
    csv << step << ',' << b.first << ',' << b.second << ',' << toString(b.fate) << ',' << b.faces
        << '\n';
}

void printStep(const std::string& path, const EvolvedStep& evolved) {
  std::map<EvolvedFate, int64_t> counts;
  for (const EvolvedGrain& grain : evolved.grains) ++counts[grain.fate];
  std::string text;
  for (const auto& [fate, count] : counts)
    text += fmt::format("{} {} {}", text.empty() ? ":" : ",", count, toString(fate));
  std::printf("%s%s\n", path.c_str(), text.c_str());
}

void runEvolve(const EvolveArguments& o, const Common& common) {
  OutputFolder folder(o.out);
  TextFile motionFile(o.file("motion.csv")), fateFile(o.file("fates.csv")),
      bondFile(o.file("bonds.csv"));
  const Int32Grid::Ptr labels = loadLabels(o.input, "--grid", common.progress);
  std::ostringstream motion, fates, bonds;
  motion.precision(9);
  fates.precision(9);
  motion << "step,f_xx,f_xy,f_xz,f_yx,f_yy,f_yz,f_zx,f_zy,f_zz,shift_x,shift_y,shift_z\n";
  fates << "step,grain,fate,voxels,center_x,center_y,center_z\n";
  bonds << "step,first,second,fate,faces\n";
  OutputSet files;
  common.progress->start("evolve");
  const Evolution evolution =
      withFileName(o.input.path, [&] { return Evolution(*labels, o.evolve, common.progress); });
  for (int step = 0; step <= o.evolve.steps; ++step) {
    common.progress->start("evolve");
    const EvolvedStep result = evolution.after(step, common.progress);
    common.progress->start("write");
    writeVdb(o.stepFile(step), {result.labels}, common.progress);
    common.progress->end();
    addMotionRow(motion, step, result);
    addFateRows(fates, step, result);
    addBondRows(bonds, step, result);
    if (!common.quiet) printStep(o.stepFile(step), result);
  }
  motionFile.write(motion.str());
  fateFile.write(fates.str());
  bondFile.write(bonds.str());
  files.commit();
  folder.keep();
}

}  // namespace

void addEvolve(Verb generate, Common& common, Action& action) {
  auto o = std::make_shared<EvolveArguments>();
  Verb verb = addVerb(
      generate, common, "evolve", "a series of scans of labels that move, break, grow and vanish",
      "vdb_madf generate evolve grains.vdb scans --steps 2 --strain 0.16 --turn 10");
  EvolveOptions& evolve = o->evolve;
  verb.option("IN", o->input.path, "labels: VDB or integer image").required();
  verb.option("OUT", o->out,
              "folder for the labels after each step, step-N.vdb, and the truth: motion.csv, "
              "fates.csv, bonds.csv")
      .required();
  verb.option("--steps", evolve.steps, "steps in which the motion grows").showDefault();
  verb.option("--strain", evolve.strain, "shortening along z at the end, as a share").showDefault();
  verb.option("--shear", evolve.shear, "simple shear of x along z at the end").showDefault();
  verb.option("--turn", evolve.degrees, "degrees about the axis at the end").showDefault();
  verb.option("--axis", o->axis, "of the turn, through the center of the box (default 0,0,1)")
      .typeName("X,Y,Z");
  verb.option("--drift", o->drift, "shift of the whole at the end, voxels (default 0,0,0)")
      .typeName("X,Y,Z");
  verb.flag(
      "--rigid-grains", evolve.rigidGrains,
      "grains keep their shapes: their centers move as the whole does, and they turn with it");
  verb.option("--vanish", evolve.vanish, "share of the grains that has vanished at the end")
      .showDefault();
  verb.option("--enter", evolve.enter,
              "share of the grains that is not there at step 0, and enters")
      .showDefault();
  verb.option("--break", evolve.breaks, "share of the bonds that has broken at the end")
      .showDefault();
  verb.option("--break-gap", evolve.gap,
              "voxels: so near to the other grain of a broken bond, each loses its own")
      .showDefault();
  verb.option("--grow", evolve.growth,
              "voxels by which grains have grown at the end, or, below 0, have dissolved")
      .showDefault();
  verb.option(
          "--noise", evolve.noise,
          "roughens boundaries: standard deviation of where voxels look for their label, voxels")
      .showDefault();
  verb.option("--seed", evolve.seed, "same seed, same bits")
      .notNegative()  // would wrap around
      .showDefault();
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  o->input.addRaw(verb);
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runEvolve(*o, common); };
  });
}

}  // namespace vdb_madf::tools
