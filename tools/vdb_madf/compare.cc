// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/compare.h"

#include <cstdio>
#include <memory>
#include <sstream>

#include "command.h"
#include "input_options.h"
#include "json_file.h"
#include "label_pair.h"
#include "text_file.h"
#include "vdb_madf/files/output_set.h"

namespace vdb_madf::tools {

namespace {

struct CompareArguments {
  InputOptions truth, test;
  std::string json, grains, confusion;
};

Json list(const std::vector<GrainGroup>& groups, const char* whole, const char* parts) {
  Json json = Json::array();
  for (const GrainGroup& group : groups)
    json.push_back({{whole, group.grain}, {parts, group.parts}});
  return json;
}

bool sameTopology(const Comparison& c) {
  return c.truthOnlyVoxels == 0 && c.testOnlyVoxels == 0;
}

Json summary(const CompareArguments& o, const Comparison& c) {
  Json json;
  json["truth"] = o.truth.path;
  json["test"] = o.test.path;
  json["truth_grains"] = c.truthGrains;
  json["test_grains"] = c.testGrains;
  json["common_voxels"] = c.commonVoxels;
  json["truth_only_voxels"] = c.truthOnlyVoxels;
  json["test_only_voxels"] = c.testOnlyVoxels;
  json["same_topology"] = sameTopology(c);
  json["misclassified_percent"] = c.misclassifiedPercent;
  json["mirror_misclassified_percent"] = c.mirrorMisclassifiedPercent;
  json["adjusted_rand_index"] = c.adjustedRandIndex;
  json["variation_of_information_bits"] = c.variationOfInformation;
  json["variation_split_bits"] = c.variationSplit;
  json["variation_merge_bits"] = c.variationMerge;
  json["found_grains"] = c.foundGrains;
  json["mean_intersection_over_union"] = c.meanIntersectionOverUnion;
  json["splits"] = list(splits(c), "truth", "test");
  json["merges"] = list(merges(c), "test", "truth");
  return json;
}

void print(const Comparison& c) {
  std::printf("grains                    truth %lld, test %lld\n", (long long)c.truthGrains,
              (long long)c.testGrains);
  std::printf("voxels labeled            in both %lld, in truth only %lld, in test only %lld\n",
              (long long)c.commonVoxels, (long long)c.truthOnlyVoxels, (long long)c.testOnlyVoxels);
  std::printf("misclassified             %.4f %% (mirror %.4f %%)\n", c.misclassifiedPercent,
              c.mirrorMisclassifiedPercent);
  std::printf("adjusted Rand index       %.6f\n", c.adjustedRandIndex);
  std::printf("variation of information  %.6f bits (splits %.6f, merges %.6f)\n",
              c.variationOfInformation, c.variationSplit, c.variationMerge);
  std::printf("grains found              %lld of %lld (mean intersection over union %.4f)\n",
              (long long)c.foundGrains, (long long)c.truthGrains, c.meanIntersectionOverUnion);
  std::printf("splits, merges            %s split, %s merged\n",
              counted(c.splits, "truth grain").c_str(), counted(c.merges, "test grain").c_str());
}

/// One line per grain of either grid.
std::string grainTable(const Comparison& c) {
  std::ostringstream csv;
  csv << "side,grain,voxels,partner,overlap_voxels,intersection_over_union,pieces\n";
  csv.precision(9);
  for (const auto& [side, matches] :
       {std::pair<const char*, const std::vector<GrainMatch>&>{"truth", c.truthMatches},
        {"test", c.testMatches}})
    for (const GrainMatch& m : matches)
      csv << side << ',' << m.grain << ',' << m.voxels << ',' << m.partner << ',' << m.overlapVoxels
          << ',' << m.intersectionOverUnion << ',' << m.pieces << '\n';
  return csv.str();
}

std::string confusionTable(const Comparison& c) {
  std::ostringstream csv;
  csv << "truth,test,voxels\n";
  for (const Overlap& o : c.overlaps) csv << o.truth << ',' << o.test << ',' << o.voxels << '\n';
  return csv.str();
}

void runCompare(const CompareArguments& o, const Common& common) {
  JsonFile jsonFile(o.json);
  TextFile grainFile(o.grains), confusionFile(o.confusion);
  const PairNames names = namesOf(o.truth, o.test);
  Int32Grid::ConstPtr truth, test;  // their voxels are not there if they come in slabs
  Comparison comparison;
  if (isInSlabs(o.truth) || isInSlabs(o.test)) {
    const LabelSlabs truths = loadSlabs(o.truth, "--truth-grid", common.progress),
                     tests = loadSlabs(o.test, "--test-grid", common.progress);
    truth = truths.about;
    test = tests.about;
    checkSameVoxels(*truth, *test, names);
    comparison = compare(truths, tests, common.progress);
  } else {
    const Int32Grid::Ptr truths = loadLabels(o.truth, "--truth-grid", common.progress),
                         tests = loadLabels(o.test, "--test-grid", common.progress);
    truth = truths;
    test = tests;
    checkSameVoxels(*truth, *test, names);
    comparison = compare(*truths, *tests, common.progress);
  }
  checkAnyCommon(comparison, names);
  common.progress->end();
  for (const std::string& note : notesOn(comparison, *truth, *test)) common.progress->note(note);
  OutputSet files;
  grainFile.write(grainTable(comparison));
  confusionFile.write(confusionTable(comparison));
  Json json = summary(o, comparison);
  addNotes(json, *common.progress);
  jsonFile.write(json);
  files.commit();
  const bool asked = jsonFile.isStandardOutput() || grainFile.isStandardOutput() ||
                     confusionFile.isStandardOutput();
  if (!common.quiet && !asked) print(comparison);
}

}  // namespace

void addCompare(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<CompareArguments>();
  Verb verb = addVerb(command, common, "compare", "how well labels agree with the truth",
                      "vdb_madf compare balls.vdb grains.vdb");
  verb.option("TRUTH", o->truth.path, "labels: VDB or integer image").required();
  verb.option("TEST", o->test.path, "labels: VDB or integer image").required();
  verb.option("--truth-grid", o->truth.gridName, "grid of TRUTH").typeName("NAME");
  verb.option("--test-grid", o->test.gridName, "grid of TEST").typeName("NAME");
  verb.option("--json", o->json, "machine-readable result (-: standard output)").typeName("FILE");
  verb.option("--grains", o->grains, "CSV: a line per grain of either side").typeName("FILE");
  verb.option("--confusion", o->confusion, "CSV: voxels of each pair of labels that meets")
      .typeName("FILE");
  o->truth.addRaw(verb);
  verb.onParsed([o, &common, &action] {
    parsePair(o->truth, o->test, {o->json, o->grains, o->confusion});
    action = [o, &common] { runCompare(*o, common); };
  });
}

}  // namespace vdb_madf::tools
