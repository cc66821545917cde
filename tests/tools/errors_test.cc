// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the command refuses, and how: the exit code, one line on stderr, nothing on stdout, no file
// left.

#include <csignal>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

namespace {

/// Renames a metadata key in a VDB file, so that no program finds it.
void hideMetadata(const Bench& bench, const std::string& file, const std::string& key) {
  std::string bytes = bench.bytes(file);
  size_t at = bytes.find(key);
  REQUIRE(at != std::string::npos);
  for (; at != std::string::npos; at = bytes.find(key, at)) bytes[at] = '_';
  bytes[21] = '0';  // a UUID that is no digest, as other programs write
  bench.write(file, bytes);
}

std::string floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

}  // namespace

TEST_CASE("cli: a wrong command line ends with 2 before any file is opened", "[cli]") {
  const Bench bench;
  const std::pair<const char*, const char*> cases[] = {
      {"", "--help"},
      {"-q", "--help"},
      {"frobnicate", "frobnicate"},
      {"generate", "generate --help"},
      {"generate cubes x.vdb", "cubes"},
      {"segment", "IN"},
      {"segment in.vdb", "OUT"},
      {"segment in.vdb out.vdb more", "more"},
      {"segment in.vdb out.vdb --frobnicate", "--frobnicate"},
      {"segment in.vdb out.jpg", "out.jpg"},
      {"segment in.vdb out.tif --keep balls", "--keep"},
      {"segment in.vdb in.vdb", "in.vdb"},
      {"segment in.vdb out.vdb --json in.vdb", "in.vdb"},
      {"segment in.vdb out.vdb --json out.vdb", "out.vdb"},
      {"segment in.vdb out.vdb --merge both --theta nan", "--theta"},
      {"segment in.vdb out.vdb --merge both --theta inf", "--theta"},
      {"segment in.vdb out.vdb --merge both --theta -1.001", "--theta"},
      {"segment in.vdb out.vdb --merge both --theta 1.001", "--theta"},
      {"segment in.vdb out.vdb --theta", "--theta"},
      {"segment in.vdb out.vdb --theta -0.8", "belongs to the tests: add --merge both"},
      {"remerge in.vdb out.vdb --delta 3", "--delta: belongs to the tests"},
      {"sweep in.vdb out.csv --theta -0.9", "--theta: belongs to the tests"},
      {"segment in.vdb out.vdb --gamma -1", "--gamma"},
      {"segment in.vdb out.vdb --gamma 0.5", "--gamma"},
      {"segment in.vdb out.vdb --gamma 99999999999999999999", "--gamma"},
      {"segment in.vdb out.vdb --fill-holes -1", "--fill-holes"},
      {"segment in.vdb out.vdb --fill-holes many", "--fill-holes"},
      {"segment in.vdb out.vdb --min-grain -1", "--min-grain -1: must be a whole number"},
      {"remerge in.vdb out.vdb --min-grain 2.5", "--min-grain 2.5: must be a whole number"},
      {"sweep in.vdb out.csv --min-grain few", "--min-grain few: must be a whole number"},
      {"segment in.vdb out.vdb --merge both --delta 81", "--delta"},
      {"segment in.vdb out.vdb --merge both --delta 0.25", "--delta"},
      {"segment in.vdb out.vdb --tidy -1", "--tidy"},
      {"segment in.vdb out.vdb --tidy 1001", "--tidy"},
      {"segment in.vdb out.vdb --paper --tidy 2", "--paper"},
      {"segment in.vdb out.vdb --paper --merge both", "--paper"},
      {"segment in.vdb out.vdb --paper --adjacency cell", "--paper"},
      {"segment in.vdb out.vdb --merge most", "--merge"},
      {"segment in.vdb out.vdb --merge both --adjacency near", "--adjacency"},
      {"segment in.vdb out.vdb --boundary wide", "--boundary"},
      {"segment in.vdb out.vdb --keep distance,all", "all"},
      {"segment in.vdb out.vdb --threads 0", "--threads"},
      {"segment in.vdb out.vdb --threads -2", "--threads"},
      {"segment in.vdb out.vdb --threads 1.5", "--threads"},
      {"segment in.vdb out.vdb --voxel-size 8.5", "unit"},
      {"segment in.vdb out.vdb --voxel-size um", "--voxel-size"},
      {"segment in.vdb out.vdb --voxel-size 0um", "--voxel-size"},
      {"segment in.vdb out.vdb --voxel-size -1mm", "--voxel-size"},
      {"segment in.vdb out.vdb --voxel-size nanum", "--voxel-size"},
      {"segment in.vdb out.vdb --voxel-size 8,5um", "write a point"},
      {"segment in.vdb out.vdb --voxel-size 1x2um", "one edge or three"},
      {"segment in.vdb out.vdb --voxel-size 1x1x3", "unit"},
      {"segment in.vdb out.vdb --voxel-size 1x1xum", "finite"},
      {"segment in.vdb out.vdb --voxel-size 1x0x1um", "between"},
      {"generate snow out.vdb --size 16 --voxel-size 1x1x3um", "cubes"},
      {"generate bed out.vdb --size 16 --voxel-size 3x1x1um", "cubes"},
      {"generate spheres out.vdb --voxel-size 1x1x3um --surface 1:4", "cubes"},
      {"generate sintered out.vdb --voxel-size 1x1x3um --scan-noise 1:0.1", "cubes"},
      {"generate spheres out.vdb --voxel-size 1x1um", "one edge or three"},
      {"generate spheres out.vdb --voxel-size 1x1x3x1um", "one edge or three"},
      {"generate spheres out.vdb --voxel-size 1x0x3um", "between"},
      {"generate sintered out.vdb --voxel-size 1x1x-3um", "between"},
      {"generate pack out.vdb --size 24 --radius 4 --voxel-size 1x25x1um", "larger size"},
      {"generate evolve in.vdb out --strain 1", "strain must be -0.9 to 0.9"},
      {"generate evolve in.vdb out --axis 1,2", "--axis 1,2: write X,Y,Z"},
      {"generate evolve in.vdb out --axis 0,0,0", "no direction"},
      {"segment in.vdb out.vdb --voxel-size 8.5.5um", "unit"},
      {"segment in.vdb out.vdb --voxel-size 8.5foot", "unit"},
      {"segment in.vdb out.vdb --threshold 0,5", "write a point"},
      {"segment in.vdb out.vdb --range :5", "A:B"},
      {"segment in.vdb out.vdb --range 5:", "A:B"},
      {"segment in.vdb out.vdb --domain 0,0,0", "--domain"},
      {"segment in.vdb out.vdb --domain 5,5,5:4,9,9", "--domain"},
      {"segment in.vdb out.vdb --domain 0,0,0:99999999,1,1", "--domain"},
      {"segment in.vdb out.vdb --phase 1 --threshold 2", "--phase"},
      {"segment in.vdb out.vdb --phase nan", "--phase"},
      {"segment in.vdb out.vdb --range 3:1", "--range"},
      {"segment in.vdb out.vdb --range 3", "--range"},
      {"segment in.vdb out.vdb --threshold one", "--threshold"},
      {"segment in.vdb out.vdb --threshold 5:3", "exceeds"},
      {"segment in.vdb out.vdb --threshold 1:2:3", "LOW:HIGH"},
      {"segment in.vdb out.vdb --phase 1,", "--phase"},
      {"segment in.vdb out.vdb --median 4", "--median"},
      {"segment in.vdb out.vdb --smooth -1", "--smooth"},
      {"segment in.vdb out.vdb --smooth 21", "--smooth"},
      {"segment in.vdb out.vdb --despeckle -1", "--despeckle"},
      {"segment in.vdb out.vdb --threshold=", "--threshold"},
      {"segment in.raw out.vdb --dims 4x4", "--dims"},
      {"segment in.raw out.vdb --dims 4x4x0 --type uint8", "--dims"},
      {"segment in.raw out.vdb --dims 4x4x4", "--type"},
      {"segment in.raw out.vdb --dims 4x4x4 --type uint9", "uint9"},
      {"segment in.raw out.vdb --type uint8", "--dims"},
      {"segment in.raw out.vdb --big-endian", "--dims"},
      {"segment in.raw out.vdb --skip 4", "--dims"},
      {"segment in.raw out.vdb --dims 4x4x4 --type uint8 --skip -4", "--skip"},
      {"convert in.tif out.jpg", "out.jpg"},
      {"convert in.tif out.tif --labels", "--labels"},
      {"convert in.tif out.vdb --labels --phase 1", "--labels"},
      {"convert in.tif -", "npy:-"},
      {"convert in.tif tif:-", "npy:-"},
      {"export in.vdb ply:- --as mesh", "npy:-"},
      {"segment in.tif npy:- --json -", "standard output"},
      {"generate snow raw:- --size 16", "raw:-"},
      {"convert in.tif in.tif", "in.tif"},
      {"convert in.raw in.mhd --dims 4x4x4 --type uint8", "in.raw"},
      {"convert in.tif out.raw --out-type text", "text"},
      {"convert in.tif out.vdb --out-type int32", "--out-type"},
      {"remerge in.vdb out.jpg", "out.jpg"},
      {"remerge in.vdb in.vdb", "in.vdb"},
      {"remerge in.vdb out.vdb --merge both --theta 2", "--theta"},
      {"remerge in.vdb out.vdb --gamma 2", "--gamma"},
      {"remerge in.vdb out.vdb --merge both --delta -1", "--delta"},
      {"remerge in.vdb out.vdb --tidy x", "--tidy"},
      {"edit in.vdb out.vdb", "--merge"},
      {"edit in.vdb out.jpg --renumber", "out.jpg"},
      {"edit in.vdb in.vdb --renumber", "in.vdb"},
      {"edit in.vdb out.vdb --join-below -3", "--join-below -3: '-3' is no number of voxels"},
      {"edit in.vdb out.vdb --join-below 2.5", "--join-below 2.5: '2.5' is no number of voxels"},
      {"edit in.vdb out.vdb --merge 12", "--merge 12: merge takes 2 or more"},
      {"edit in.vdb out.vdb --merge 12,17,12", "grain 12 is named twice"},
      {"edit in.vdb out.vdb --split 1,2", "--split 1,2: split takes one grain"},
      {"edit in.vdb out.vdb --drop 0", "grain 0 cannot be"},
      {"edit in.vdb out.vdb --keep x", "'x'"},
      {"edit in.vdb out.vdb --min-voxels 0.5", "--min-voxels"},
      {"edit in.vdb out.vdb --max-diameter 100", "--max-diameter"},
      {"edit in.vdb out.vdb --edits out.vdb", "out.vdb"},
      {"edit - out.vdb --edits -", "--edits -"},
      {"sweep in.vdb out.txt", "out.txt"},
      {"sweep in.vdb out.csv --plot out.csv", "out.csv"},
      {"sweep in.vdb out.csv --merge both --theta -1:0", "--theta"},
      {"sweep in.vdb out.csv --merge both --theta -1:-0.5:0", "--theta"},
      {"sweep in.vdb out.csv --merge both --theta -0.5:-1:0.1", "--theta"},
      {"sweep in.vdb out.csv --merge both --theta -2", "--theta"},
      {"sweep in.vdb out.csv --merge both --theta -0.5,-0.5", "twice"},
      {"sweep in.vdb out.csv --gamma 0,x", "--gamma"},
      {"sweep in.vdb out.csv --gamma 3,3", "twice"},
      {"sweep in.vdb out.csv --merge both --delta 2,2", "twice"},
      {"sweep in.vdb out.csv --merge both --delta 2,100", "--delta"},
      {"sweep in.vdb out.csv --merge cell", "cell"},
      {"sweep in.vdb out.csv --small 0.5", "--small"},
      {"sweep in.vdb out.csv --merge both,neck --strictness 9", "belongs to --merge score"},
      {"sweep in.vdb out.csv --merge score --theta -0.9", "--theta: belongs to"},
      {"sweep in.vdb out.csv --merge score --delta 3", "--delta: belongs to"},
      {"sweep in.vdb out.csv --merge score --strictness 9,9", "twice"},
      {"sweep in.vdb out.csv --merge score --strictness 9:x:1", "--strictness"},
      {"sweep in.vdb out.csv --merge score --strictness 1e6", "--strictness"},
      {"sweep in.vdb out.csv --merge score,both --plot o.svg", "--plot"},
      {"segment in.vdb out.vdb --merge neck --strictness 10",
       "--strictness: belongs to --merge score, not neck"},
      {"segment in.vdb out.vdb --paper --strictness 10", "belongs to --merge score"},
      {"segment in.vdb out.vdb --merge score --theta -0.8", "--theta: belongs to"},
      {"segment in.vdb out.vdb --merge score --adjacency cell", "--adjacency: belongs to"},
      {"remerge in.vdb out.vdb --merge score --delta 2", "--delta: belongs to"},
      {"remerge in.vdb out.vdb --merge score --strictness x", "--strictness"},
      {"remerge in.vdb out.vdb --merge score --strictness nan", "--strictness"},
      {"render in.vdb o.png --azimuth nan", "--azimuth"},
      {"render in.vdb o.png --elevation nan", "--elevation"},
      {"sweep in.vdb o.csv --plot o.jpg", "o.jpg"},
      {"collect", "DIR"},
      {"collect folder", ".csv"},
      {"collect folder other", ".csv"},
      {"collect out.csv", "folders"},
      {"compare in.vdb", "TEST"},
      {"compare in.vdb other.vdb --json other.vdb", "other.vdb"},
      {"compare in.vdb other.vdb --grains in.vdb", "in.vdb"},
      {"compare in.vdb other.vdb --json a --confusion a", "a"},
      {"track in.vdb", "AFTER"},
      {"track in.vdb other.vdb out.jpg", "out.jpg"},
      {"track in.vdb other.vdb other.vdb", "other.vdb"},
      {"track in.vdb other.vdb --grains a.csv --bonds a.csv", "a.csv"},
      {"track in.vdb other.vdb --shift 1,2", "X,Y,Z"},
      {"track in.vdb other.vdb --shift 1,2,99999", "--shift"},
      {"track in.vdb other.vdb --shift 1,2,3 --max-shift 5", "--max-shift"},
      {"track in.vdb other.vdb --max-shift 257", "--max-shift"},
      {"track in.vdb other.vdb --shift 1,2,3 --motion free", "--motion"},
      {"track in.vdb other.vdb --motion free --links l.csv", "--links"},
      {"track in.vdb other.vdb --motion free --gap 0", "--gap"},
      {"track in.vdb other.vdb --share 0", "--share"},
      {"track in.vdb other.vdb --share 1.1", "--share"},
      {"track in.vdb other.vdb --min-faces -1", "--min-faces"},
      {"export in.vdb out.ply --bonds b.csv", "--bonds"},
      {"export in.vdb out.txt --as clumps --cover c.txt", "c.txt"},
      {"export in.vdb out.csv --as clumps --cover c.csv --bonds c.csv", "c.csv"},
      {"render in.vdb out.jpg", "out.jpg"},
      {"render in.vdb out.png --only all", "--only"},
      {"render in.vdb out.png --size 0", "--size"},
      {"render in.vdb out.png --elevation 100", "--elevation"},
      {"report in.vdb", "in.vdb"},
      {"report out.html", "labels"},
      {"report in.vdb out.html --triangles 0", "--triangles"},
      {"report in.vdb out.html --ice --density 900", "--ice"},
      {"report in.vdb other.vdb out.html --sweep s.csv", "--sweep"},
      {"info", "FILE"},
      {"generate snow out.jpg", "out.jpg"},
      {"generate snow out.vdb --size 0", "--size"},
      {"generate snow out.vdb --size 16 --dims 16x16x16", "--dims"},
      {"generate snow out.vdb --size 16 --seed -1", "--seed"},
      {"generate snow out.vdb --size 16 --length nan", "length"},
      {"generate snow out.vdb --size 16 --fraction 1", "--fraction"},
      {"generate pack out.vdb --size 16 --fraction nan", "--fraction"},
      {"generate pack out.vdb --size 16 --radius 9:6", "--radius"},
      {"generate particles out.vdb --shape rods --aspect 9:6", "--aspect"},
      {"generate particles out.vdb --shape rods --aspect 0.5", "aspect"},
      {"generate particles out.vdb --shape plates --aspect 4:8", "--aspect"},
      {"generate spheres out.vdb --size 24 --count 0", "count"},
      {"generate spheres out.vdb --size 24 --count 1000 --radius 4", "1000"},
      {"generate sintered out.vdb --size 24 --neck -1", "neck"},
      {"generate particles out.vdb --size 24 --shape cubes", "--shape"},
      {"generate particles out.vdb --size 24 --lognormal 2", "lognormal"},
      {"generate bed out.vdb --size 24 --rounds -1", "rounds"},
      {"generate spheres out.vdb --size 40 --count 3 --radius 6 --surface 1", "--surface"},
      {"generate sintered out.vdb --size 24 --surface 1:99", "length"},
      {"generate sintered out.vdb --size 24 --scan-noise 1:x", "--scan-noise"},
      {"generate spheres out.vdb --gray out.png", "--gray out.png: the scan is an image"},
      {"generate spheres out.vdb --gray npy:-", "--gray npy:-"},
      {"generate spheres out.tif --gray out.truth.tif", "two outputs"},
      {"generate spheres out.vdb --gray out.tif --surface 1:4", "leave one out"},
      {"generate pack out.vdb --gray out.tif", "no option --gray"},
      {"generate sintered out.vdb --size 24 --scan-noise 1:2", "noise"}};
  for (const auto& [arguments, says] : cases) refuses(bench, kWrongUsage, arguments, {says});
}

TEST_CASE("cli: a misspelt verb or option is named first, with what was likely meant", "[cli]") {
  const Bench bench;
  const std::pair<const char*, const char*> cases[] = {
      {"segmnt a.tif o.vdb", "there is no verb segmnt: did you mean segment?"},
      {"sgement --help", "there is no verb sgement: did you mean segment?"},
      {"help convrt", "there is no verb convrt: did you mean convert?"},
      {"generate sphere x.vdb", "there is no verb sphere: did you mean spheres?"},
      {"segment a.tif o.vdb --treshold 3",
       "there is no option --treshold: did you mean --threshold?"},
      {"segment a.tif --treshold 3", "there is no option --treshold: did you mean --threshold?"},
      {"segment a.tif o.vdb --voxelsize=3um",
       "there is no option --voxelsize: did you mean --voxel-size?"},
      {"segment a.tif o.vdb --thresh 1", "did you mean --threshold?"},
      {"segment a.tif o.vdb more and more", "not expected: more and more (see"}};
  for (const auto& [arguments, says] : cases) refuses(bench, kWrongUsage, arguments, {says});
  for (const char* far : {"frobnicate a b", "segment a.tif o.vdb --frobnicate"})
    CHECK(bench.run(far).err.find("did you mean") == std::string::npos);
}

TEST_CASE("cli: an empty argument is an unset variable, not a default", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.tif --size 16 --length 6");
  for (const std::string option : {"--phase", "--theta", "--json", "--keep", "--grid"}) {
    CAPTURE(option);
    checkRefusal(bench.run(std::vector<std::string>{"segment", "s.tif", "o.vdb", option, ""}),
                 kWrongUsage, {option});
  }
  checkRefusal(bench.run(std::vector<std::string>{"info", ""}), kWrongUsage, {"empty"});
  CHECK(bench.names() == std::set<std::string>{"s.tif"});
}

TEST_CASE("cli: a file that is missing or none of ours is named", "[cli]") {
  const Bench bench;
  std::filesystem::create_directory(bench.path("folder"));
  std::filesystem::create_directory(bench.path("folder.vdb"));
  std::string garbage(3000, '\0');
  uint32_t state = 1;
  for (char& c : garbage) c = char((state = state * 1664525 + 1013904223) >> 24);
  std::vector<std::string> files{"missing.vdb", "missing.tif", "missing", "folder", "folder.vdb"};
  for (const std::string ending :
       {".vdb", ".tif", ".mhd", ".mha", ".nrrd", ".nhdr", ".npy", ".png", ".bmp", ".isq", ".nii",
        ".nii.gz", ".vol", ".longvol", ".h5", ".xyz"}) {
    files.push_back("empty" + ending);
    files.push_back("garbage" + ending);
    bench.write("empty" + ending, "");
    bench.write("garbage" + ending, garbage);
  }
  const std::set<std::string> byEachVerb{"missing.vdb", "missing.tif", "folder",     "folder.vdb",
                                         "empty.vdb",   "garbage.vdb", "garbage.tif"};
  for (const std::string& file : files) {
    refuses(bench, kFailed, "segment " + file + " out.vdb", {file});
    refuses(bench, kFailed, "info " + file, {file});
    if (!byEachVerb.count(file)) continue;
    refuses(bench, kFailed, "convert " + file + " out.raw", {file});
    refuses(bench, kFailed, "render " + file + " out.png", {file});
    refuses(bench, kFailed, "report " + file + " out.html", {file});
    refuses(bench, kFailed, "remerge " + file + " out.vdb", {file});
    refuses(bench, kFailed, "edit " + file + " out.vdb --renumber", {file});
  }
  refuses(bench, kFailed, "info garbage.vdb", {"not a VDB file"});
  refuses(bench, kFailed, "compare missing.vdb empty.vdb", {"missing.vdb"});
  refuses(bench, kFailed, "track missing.vdb empty.vdb", {"missing.vdb"});
  bench.write("s.raw", std::string(64, '\1'));
  refuses(bench, kFailed, "segment s.raw out.vdb", {"s.raw", "--dims"});
  for (const std::string layout :
       {"--dims 4x4x5 --type uint8", "--dims 4x4x3 --type uint8", "--dims 4x4x4 --type uint16"})
    refuses(bench, kFailed, "segment s.raw out.vdb " + layout, {"s.raw", "64 bytes"});
}

TEST_CASE("cli: a truncated file is refused at any length", "[cli]") {
  const Bench bench;
  for (const std::string ending : {".vdb", ".tif", ".mha"}) {
    bench.mustRun("generate snow s" + ending + " --size 24 --length 8");
    const std::string bytes = bench.bytes("s" + ending), cut = "cut" + ending;
    for (const double share : {0.01, 0.1, 0.5, 0.9, 0.999}) {
      bench.write(cut, bytes.substr(0, size_t(share * double(bytes.size()))));
      refuses(bench, kFailed, "segment " + cut + " out.vdb", {cut});
    }
  }
  bench.mustRun("generate snow s.mhd --size 24 --length 8");
  bench.write("s.raw", bench.bytes("s.raw").substr(0, 1000));
  refuses(bench, kFailed, "segment s.mhd out.vdb", {"s.mhd", "s.raw"});
}

TEST_CASE("cli: a grid has to be there, usable and the only one", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep power,manifold");
  refuses(bench, kFailed, "segment s.vdb o.vdb --grid snow",
          {"s.vdb", "'snow'", "object", "truth"});
  refuses(bench, kFailed, "render s.vdb o.png --grid snow", {"s.vdb", "'snow'", "truth"});
  refuses(bench, kFailed, "render s.vdb o.png --grid object", {"s.vdb", "'object'", "bool"});
  bench.mustRun("convert s.vdb mask.vdb --grid object --phase 1");
  refuses(bench, kFailed, "render mask.vdb o.png", {"mask.vdb", "labels (int32)", "segment"});
  refuses(bench, kFailed, "segment g.vdb o.vdb", {"g.vdb", "--grid", "grain", "power", "manifold"});
  refuses(bench, kFailed, "compare s.vdb g.vdb --truth-grid snow", {"s.vdb", "'snow'"});
  refuses(bench, kFailed, "remerge s.vdb o.vdb", {"s.vdb", "segment again with --keep manifold"});
  refuses(bench, kFailed, "edit mask.vdb o.vdb --renumber", {"mask.vdb", "labels (int32)"});
  refuses(bench, kFailed, "edit s.vdb o.vdb --split 1", {"s.vdb", "with --keep manifold"});
  bench.mustRun("convert s.vdb s.tif --grid truth");
  refuses(bench, kFailed, "segment s.tif o.vdb --grid truth", {"s.tif", "--grid"});
  refuses(bench, kFailed, "segment s.tif o.vdb --dataset truth", {"s.tif", "--dataset"});
  refuses(bench, kFailed, "segment s.vdb o.vdb --dataset truth", {"s.vdb", "--dataset", "--grid"});
}

TEST_CASE("cli: labels are whole numbers of one sample", "[cli]") {
  const Bench bench;
  const std::string layout = " --dims 2x2x1 --type float32";
  bench.write("half.raw", floats({0, 1, 1.5f, 0}));
  bench.write("nan.raw", floats({0, 1, std::stof("nan"), 0}));
  bench.write("huge.raw", floats({0, 1, 3e9f, 0}));
  for (const std::string file : {"half.raw", "nan.raw", "huge.raw"}) {
    refuses(bench, kFailed, "render " + file + " o.png" + layout, {file});
    refuses(bench, kFailed, "compare " + file + " " + file + layout, {file});
    refuses(bench, kFailed, "convert " + file + " o.tif --out-type int32" + layout, {"int32"});
  }
  bench.write("a.raw", floats({1, 1, 0, 0}));
  bench.write("b.raw", floats({0, 0, 1, 1}));
  bench.write("none.raw", floats({0, 0, 0, 0}));
  for (const auto& [truth, test] : {std::pair<std::string, std::string>{"a.raw", "b.raw"},
                                    {"a.raw", "none.raw"},
                                    {"none.raw", "b.raw"}})
    refuses(bench, kFailed, "compare " + truth + " " + test + layout, {truth, test, "same sample"});
  bench.mustRun("compare none.raw none.raw" + layout);

  for (const std::string size : {"4", "8.5"})
    bench.mustRun("convert a.raw a" + size + ".mha --voxel-size " + size + "um" + layout);
  bench.mustRun("convert a.raw a.npy" + layout);
  refuses(bench, kFailed, "compare a4.mha a8.5.mha", {"a4.mha", "a8.5.mha", "2.125 times"});
  bench.mustRun("compare a4.mha a.npy");
}

TEST_CASE("cli: the boundary and the domain have to fit the object", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun(kSpheres + "s.tif");
  for (const std::string file : {"s.vdb", "s.tif"})
    refuses(bench, kFailed, "segment " + file + " o.vdb --domain 0,0,0:9,9,9",
            {file, "leaves the domain"});
  refuses(bench, kFailed, "segment s.tif o.vdb --threshold 0", {"s.tif", "by value", "threshold"});
  bench.mustRun("segment s.tif o.vdb --threshold 0 --boundary closed");
  refuses(bench, kFailed, "segment s.vdb x.vdb --invert --domain 0,0,0:1048575,1048575,1048575",
          {"s.vdb", "domain", "crop"});
  refuses(bench, kFailed, "convert s.tif x.raw --domain 0,0,0:9,9,9", {"s.tif", "--domain"});

  bench.write("unknown.vdb", bench.bytes("s.vdb"));
  hideMetadata(bench, "unknown.vdb", "madf_domain_m");
  refuses(bench, kFailed, "segment unknown.vdb x.vdb --boundary open",
          {"unknown.vdb", "closed", "--domain"});
  refuses(bench, kFailed, "segment unknown.vdb x.vdb --invert", {"unknown.vdb", "domain"});
  bench.mustRun("segment unknown.vdb a.vdb");
  bench.mustRun("segment unknown.vdb b.vdb --boundary closed");
  CHECK(bench.bytes("a.vdb") == bench.bytes("b.vdb"));
  bench.mustRun("segment unknown.vdb c.vdb --boundary open --domain 0,0,0:39,39,39");
  bench.mustRun("segment s.vdb d.vdb");
  CHECK(bench.bytes("c.vdb") == bench.bytes("d.vdb"));
  CHECK_THAT(bench.mustRun("convert unknown.vdb u.raw --grid object"),
             vdb_madf::test::Contains("origin"));
}

TEST_CASE("cli: a signal ends long work within a second and leaves nothing", "[cli]") {
  const Bench bench;
  // A sparse file: 512 MB of zeros, which the inversion turns into more work than a second's.
  bench.write("zeros.raw", "");
  std::filesystem::resize_file(bench.path("zeros.raw"), 800 * 800 * 800);
  const std::pair<int, double> cases[] = {
      {SIGINT, 0.0}, {SIGINT, 0.3}, {SIGTERM, 0.1}, {SIGHUP, 0.1}, {SIGQUIT, 0.1}};
  for (const auto& [signal, delay] : cases) {
    CAPTURE(signal, delay);
    RunOptions interrupted;
    interrupted.signal = signal;
    interrupted.delay = delay;
    interrupted.interruptOn = ".summary.json";  // the temporary file: the work has begun
    const auto before = bench.names();
    const Outcome outcome = bench.run(
        "segment zeros.raw o.vdb --dims 800x800x800 --type uint8 --invert --boundary closed"
        " --json summary.json",
        interrupted);
    checkRefusal(outcome, kInterrupted, {"interrupted"});
    CHECK(outcome.secondsAfterSignal < 1);
    CHECK(bench.names() == before);
  }
}

TEST_CASE("cli: segment refuses what needs more memory than allowed", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  refuses(bench, kFailed, "segment s.vdb g.vdb --max-memory 2M",
          {"s.vdb", "MiB of memory, and", "MiB may be used", "--max-memory"});
  for (const std::string size : {"0", "-1G", "3X", "much", "1GiBB", "nan", "100", "16e9", "1,5G"})
    refuses(bench, kWrongUsage, "segment s.vdb g.vdb --max-memory " + size, {size, "12GiB"});
  bench.mustRun("segment s.vdb g.vdb --max-memory 1.5GiB");
  for (const std::string size : {"1.5 GiB", "2gib", "2gb", "900M", "1e9B", "1e6 kb"})
    CHECK(bench.run({"segment", "s.vdb", "g.vdb", "--max-memory", size}).exitCode == 0);
  refuses(bench, kWrongUsage, "segment s.vdb", {"OUT is required"});
}

TEST_CASE("cli: an image that is too long is refused before its samples are read", "[cli]") {
  const Bench bench;
  bench.write("long.mha",
              "ObjectType = Image\nNDims = 3\nDimSize = 2 2 30000\nElementType = MET_UCHAR\n"
              "CompressedData = True\nElementDataFile = LOCAL\n" +
                  std::string(1000, 'x'));
  for (const std::string arguments :
       {"segment long.mha o.vdb", "segment long.mha --dry-run", "sweep long.mha o.csv"})
    refuses(bench, kFailed, arguments, {"long.mha", "30000 voxels long", "26754"});
  CHECK_THAT(bench.mustRun("info long.mha --header"), vdb_madf::test::Contains("30000"));
}
