// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/compare.h"

#include <cstdio>
#include <memory>

#include "command.h"
#include "input.h"
#include "json_file.h"
#include "vdb_madf/errors.h"

namespace vdb_madf::tools {

namespace {

struct Options {
  InputOptions truth, test;
  std::string json;
};

Json summary(const Options& o, const Comparison& c) {
  Json json;
  json["truth"] = o.truth.path;
  json["test"] = o.test.path;
  json["truth_grains"] = c.truthGrains;
  json["test_grains"] = c.testGrains;
  json["common_voxels"] = c.commonVoxels;
  json["truth_only_voxels"] = c.truthOnlyVoxels;
  json["test_only_voxels"] = c.testOnlyVoxels;
  json["misclassified_percent"] = c.misclassifiedPercent;
  json["mirror_misclassified_percent"] = c.mirrorMisclassifiedPercent;
  json["adjusted_rand_index"] = c.adjustedRandIndex;
  json["variation_of_information_bits"] = c.variationOfInformation;
  json["variation_split_bits"] = c.variationSplit;
  json["variation_merge_bits"] = c.variationMerge;
  return json;
}

void print(const Comparison& c) {
  std::printf("grains                    truth %lld, test %lld\n", (long long)c.truthGrains,
              (long long)c.testGrains);
  std::printf("voxels labelled           in both %lld, in truth only %lld, in test only %lld\n",
              (long long)c.commonVoxels, (long long)c.truthOnlyVoxels, (long long)c.testOnlyVoxels);
  std::printf("misclassified             %.4f %% (mirror %.4f %%)\n", c.misclassifiedPercent,
              c.mirrorMisclassifiedPercent);
  std::printf("adjusted Rand index       %.6f\n", c.adjustedRandIndex);
  std::printf("variation of information  %.6f bits (splits %.6f, merges %.6f)\n",
              c.variationOfInformation, c.variationSplit, c.variationMerge);
}

void run(const Options& o, const Common& common) {
  JsonFile jsonFile(o.json);
  const Int32Grid::Ptr truth = loadLabels(o.truth, "--truth-grid", common.progress);
  const Int32Grid::Ptr test = loadLabels(o.test, "--test-grid", common.progress);
  const Comparison comparison = compare(*truth, *test, common.progress);
  if (comparison.commonVoxels == 0 && comparison.truthGrains > 0 && comparison.testGrains > 0)
    throw InvalidInput(o.test.path + ": no voxel is labelled both here and in " + o.truth.path +
                       ", so there is nothing to compare: give labels of the same sample");
  common.progress->end();
  jsonFile.write(summary(o, comparison));
  if (!common.quiet && !jsonFile.isStandardOutput()) print(comparison);
}

}  // namespace

void addCompare(CLI::App& app, Common& common, Action& action) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = addVerb(app, common, "compare", "how well labels agree with the truth",
                           "vdb_madf compare balls.vdb grains.vdb");
  verb->add_option("TRUTH", o->truth.path, "labels: VDB or integer image")->required();
  verb->add_option("TEST", o->test.path, "labels: VDB or integer image")->required();
  verb->add_option("--truth-grid", o->truth.gridName, "grid of TRUTH")->type_name("NAME");
  verb->add_option("--test-grid", o->test.gridName, "grid of TEST")->type_name("NAME");
  verb->add_option("--json", o->json, "machine-readable result (-: standard output)")
      ->type_name("FILE");
  o->truth.addRaw(*verb);
  verb->callback([o, &common, &action] {
    for (InputOptions* input : {&o->truth, &o->test}) input->outputs = {o->json};
    o->truth.parse();
    o->test.parse();
    // --dims describes whichever of the two is RAW.
    for (InputOptions* input : {&o->truth, &o->test}) {
      input->sampleType = o->truth.sampleType;
      input->bigEndian = o->truth.bigEndian;
    }
    o->test.size = o->truth.size;
    for (InputOptions* input : {&o->truth, &o->test})
      if (!hasRawEnding(input->path)) input->size.reset();
    action = [o, &common] { run(*o, common); };
  });
}

}  // namespace vdb_madf::tools
