// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The verb edit, run as a user runs it; what edits do: edits/edit_labels_test.cc.

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

namespace {

/// Of the labels in a file.
std::string digestOf(const Bench& bench, const std::string& file) {
  bench.mustRun("measure " + file + " tables_of_digest -q");
  return Json::parse(bench.bytes("tables_of_digest/sample.json")).at("labels_digest");
}

Json metadataOf(const Bench& bench, const std::string& file, const std::string& grid) {
  return gridOf(infoOf(bench, file), grid).at("metadata");
}

}  // namespace

TEST_CASE("cli: edits are done in the order given, from the command line and from files", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold,power");
  bench.write("list.txt",
              "\xEF\xBB\xBF"
              "drop 2 # a bubble\r\n\nmin-voxels 30\n");
  const Json json = Json::parse(
      bench.mustRun("edit g.vdb e.vdb --merge 1,3 --edits list.txt --renumber --json -"));
  std::vector<std::string> texts;
  for (const Json& edit : json.at("edits")) texts.push_back(edit.at("edit"));
  CHECK(texts == std::vector<std::string>{"merge 1 3", "drop 2", "min-voxels 30", "renumber"});
  CHECK(json.at("edits")[0].at("grains") == Json{1});
  CHECK(json.at("edits")[1].at("dropped_grains") == 1);
  const int grains = json.at("grains"), voxels = json.at("voxels");
  int dropped = 1;
  for (const Json& edit : json.at("edits")) dropped += edit.at("dropped_grains").get<int>();
  CHECK(grains == json.at("grains_before").get<int>() - dropped);

  // All grids go along; what is said of the labels is true.
  CHECK(gridsOf(infoOf(bench, "e.vdb")) == std::set<std::string>{"grain", "power", "manifold"});
  const Json grain = metadataOf(bench, "e.vdb", "grain");
  CHECK(grain.at("madf_edits") == "merge 1 3; drop 2; min-voxels 30; renumber");
  CHECK(grain.at("madf_grains") == grains);
  CHECK(grain.at("madf_object_voxels") == voxels);
  CHECK(grain.count("madf_medial_balls") == 0);
  CHECK(grain.at("madf_strictness") == 11);
  const Json manifold = metadataOf(bench, "e.vdb", "manifold");
  CHECK(manifold.at("madf_grains") == grains);
  CHECK(manifold.count("madf_edits") == 0);
  CHECK(manifold.count("madf_manifold_graph") == 1);
  CHECK(manifold.at("madf_object_voxels") ==
        metadataOf(bench, "g.vdb", "manifold").at("madf_object_voxels"));

  // Another order gives other labels; the list through a pipe the same.
  bench.mustRun("edit g.vdb other.vdb --renumber --merge 1,3 --edits list.txt");
  CHECK(digestOf(bench, "other.vdb") != digestOf(bench, "e.vdb"));
  RunOptions piped;
  piped.piped = "merge 1 3\ndrop 2\nmin-voxels 30\nrenumber";
  REQUIRE(bench.run("edit g.vdb piped.vdb --edits -", piped).exitCode == 0);
  CHECK(bench.bytes("piped.vdb") == bench.bytes("e.vdb"));
  bench.mustRun("edit g.vdb one.vdb --merge 1,3 --edits list.txt --renumber --threads 1");
  CHECK(bench.bytes("one.vdb") == bench.bytes("e.vdb"));
}

TEST_CASE("cli: an edit and its inverse give back the labels", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold --merge both --theta -0.3");
  const std::string before = digestOf(bench, "g.vdb");
  const Json info = Json::parse(bench.mustRun("edit g.vdb split.vdb --split 1 --json -"));
  const Json parts = info.at("edits")[0].at("grains");
  REQUIRE(parts.size() == 2);
  CHECK(parts[0] == 1);
  CHECK(digestOf(bench, "split.vdb") != before);
  bench.mustRun("edit split.vdb back.vdb --merge 1," + std::to_string(parts[1].get<int>()));
  CHECK(digestOf(bench, "back.vdb") == before);
  bench.mustRun("edit g.vdb merged.vdb --merge 3,1 --merge 3,2");
  CHECK(digestOf(bench, "merged.vdb") != before);
  bench.mustRun("edit merged.vdb back.vdb --split 3");
  CHECK(digestOf(bench, "back.vdb") == before);
  // A fresh merging forgets the edits.
  bench.mustRun("remerge merged.vdb fresh.vdb --merge both --theta -0.3");
  CHECK(digestOf(bench, "fresh.vdb") == before);
  CHECK(metadataOf(bench, "fresh.vdb", "grain").count("madf_edits") == 0);
}

TEST_CASE("cli: small grains join their neighbors, and a split gives them back", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold");
  const Json json = Json::parse(bench.mustRun("edit g.vdb e.vdb --join-below 400 --json -"));
  const int joined = json.at("edits")[0].at("joined_grains");
  REQUIRE(joined > 0);
  CHECK(json.at("grains") == json.at("grains_before").get<int>() - joined);
  CHECK(json.at("voxels") == json.at("voxels_before"));
  CHECK(metadataOf(bench, "e.vdb", "grain").at("madf_edits") == "join-below 400");
  bench.write("list.txt", "join-below 400\n");
  CHECK(bench.mustRun("edit g.vdb listed.vdb --edits list.txt")
            .find("join-below 400: joined " + std::to_string(joined) + " grain") !=
        std::string::npos);
  CHECK(bench.bytes("listed.vdb") == bench.bytes("e.vdb"));
  std::string splits;
  for (const Json& grown : json.at("edits")[0].at("grains"))
    splits += " --split " + std::to_string(grown.get<int>());
  bench.mustRun("edit e.vdb back.vdb" + splits);
  CHECK(digestOf(bench, "back.vdb") == digestOf(bench, "g.vdb"));
}

TEST_CASE("cli: edits of labels of another program", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb --voxel-size 10um");
  bench.mustRun("convert s.vdb s.tif --grid truth");
  bench.mustRun("edit s.tif e.tif --drop 2,4 --renumber");
  CHECK(Json::parse(bench.mustRun("edit s.tif f.tif --drop 2 --json -")).at("output") == "f.tif");
  bench.mustRun("edit s.vdb e.vdb --grid truth --drop 4,2 --renumber --drop-at-faces");
  CHECK(metadataOf(bench, "e.vdb", "truth").at("madf_edits") ==
        "drop 4 2; renumber; drop-at-faces");
  CHECK(gridsOf(infoOf(bench, "e.vdb")) == std::set<std::string>{"object", "truth"});
  bench.write("none.txt", "# no edits\n");
  bench.mustRun("edit s.vdb f.vdb --grid truth --edits none.txt --drop 4,2 --renumber");
  CHECK(digestOf(bench, "e.tif") == digestOf(bench, "f.vdb"));
  // The size of voxels, of the file or given, for diameters.
  bench.mustRun("edit s.tif large.tif --min-diameter 140um");
  bench.mustRun("convert s.tif s.npy");
  bench.mustRun("edit s.npy large.npy --min-diameter 14mm --voxel-size 1mm");
  CHECK(digestOf(bench, "large.tif") == digestOf(bench, "large.npy"));
  CHECK(digestOf(bench, "large.tif") != digestOf(bench, "s.tif"));
  refuses(bench, kFailed, "edit s.npy o.npy --min-diameter 14mm",
          {"s.npy", "min-diameter 14000um", "--voxel-size"});
}

TEST_CASE("cli: edits that cannot be done are told in a line", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold");
  const auto says = [&](const std::string& options, const std::vector<std::string>& what) {
    refuses(bench, kFailed, "edit g.vdb o.vdb " + options, what);
  };
  says("--drop 99", {"g.vdb", "drop 99: there is no grain 99"});
  says("--merge 1,2 --split 2", {"there is no grain 2 any more, after 'merge 1 2'"});
  says("--keep 1 --keep 2", {"keep 2: there is no grain 2 any more, after 'keep 1'"});
  bench.write("wrong.txt", "merge 1 2\nsplot 3\n");
  bench.write("none.txt", std::string("\0\1\2\xff\xfe", 5));
  bench.write("twice.txt", "drop 1\ndrop 1\n");
  says("--edits wrong.txt", {"wrong.txt: line 2: 'splot' is no edit"});
  says("--edits none.txt", {"none.txt: line 1"});
  says("--edits twice.txt", {"drop 1: there is no grain 1 any more, after 'drop 1'"});
  says("--edits missing.txt", {"missing.txt"});
  says("--edits /proc/self/mem", {"/proc/self/mem: cannot be read"});
  says("--edits /proc/self/status", {"/proc/self/status: line 1: 'Name:' is no edit"});
  // Nothing left is no error, but worth knowing.
  const Outcome empty = bench.run("edit g.vdb o.vdb --min-voxels 1000000");
  CHECK(empty.exitCode == 0);
  CHECK(empty.err == "vdb_madf: note: o.vdb: no grain is left\n");
  CHECK(gridOf(infoOf(bench, "o.vdb"), "grain").at("active_voxels") == 0);
}
