// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/track.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

#include "command.h"
#include "grid_image.h"
#include "input_options.h"
#include "json_file.h"
#include "label_pair.h"
#include "outputs.h"
#include "parse.h"
#include "text_file.h"
#include "track_output.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_folder.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/files/output_tree.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/vdb/slab_folder_writer.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

/// What a series writes of a scan.
struct SeriesFiles {
  std::string labels, grains, bonds;
};

SeriesFiles seriesFiles(const TrackArguments& o, const std::string& scan) {
  namespace fs = std::filesystem;
  const std::string stem = (fs::path(o.more.back()) / fs::path(scan).stem()).string();
  const bool isInSlabs = !o.motion.empty() && hasSlabsEnding(scan);
  return {stem + (isInSlabs ? ".slabs" : ".vdb"), stem + "_grains.csv", stem + "_bonds.csv"};
}

/// The scans after the first one of a series.
std::vector<std::string> laterScans(const TrackArguments& o) {
  std::vector<std::string> scans{o.after.path, o.out};
  scans.insert(scans.end(), o.more.begin(), o.more.end() - 1);
  return scans;
}

/// All that is read and written is told apart by its place. Returns what is written.
std::vector<std::string> parseSeries(TrackArguments& o) {
  for (const std::string& table : {o.json, o.grains, o.links, o.bonds, o.phi, o.network})
    if (!table.empty())
      throw WrongUsage(table + ": of more than two scans all tables go to the folder, " +
                       o.more.back());
  std::vector<std::string> outputs;
  for (const std::string& scan : laterScans(o)) {
    const SeriesFiles files = seriesFiles(o, scan);
    outputs.insert(outputs.end(), {files.labels, files.grains, files.bonds});
  }
  for (const std::string& scan : laterScans(o)) {
    InputOptions before = o.before, after = o.after;
    after.path = scan;
    parsePair(before, after, outputs);
    o.later.push_back(after);
  }
  return outputs;
}

void parse(TrackArguments& o) {
  std::vector<std::string> outputs{o.out, o.json, o.grains, o.links, o.bonds, o.phi, o.network};
  if (!o.more.empty()) {
    outputs = parseSeries(o);
    parsePair(o.before, o.after, {});
  } else {
    parsePair(o.before, o.after, outputs);
    const bool isScene = isZarrEnding(o.out);
    if (!o.out.empty() && !isScene && !hasSlabsEnding(o.out)) checkVolumeEnding(o.out);
    if (isScene && motionKindOf(o.motion) == MotionKind::free)
      throw WrongUsage(o.out +
                       ": a scene tells where the whole has gone, which --motion free does "
                       "not find: choose rigid or affine, or write labels");
  }
  if (!o.motion.empty() && !motionKindOf(o.motion)) checkOutputs(outputs, o.motion);
  if (!o.shift.empty()) o.track.shift = parseShift(o.shift, "--shift");
  o.track.minFaces = parseCount(o.minFaces, "--min-faces");
  o.track.sureFaces = parseCount(o.sureFaces, "--sure-faces");
  if (!(o.track.share > 0 && o.track.share <= 1))
    throw WrongUsage("--share: is the part of a grain, above 0 and at most 1");
  if (!o.phi.empty() && fileEnding(o.phi) != ".tsv")
    throw WrongUsage(o.phi + ": the ending for --phi must be .tsv");
  for (const std::string& file : {o.phi, o.network})
    if (!file.empty() && o.motion.empty())
      throw WrongUsage(file + ": tells how grains turned and moved: give --motion, too");
  // (Those for MUSEN, .txt, have no columns.)
  if (!o.network.empty() && (!isNetworkEnding(o.network) || fileEnding(o.network) == ".txt"))
    throw WrongUsage(o.network + ": the ending for --network must be .vtp, .graphml or .csv");
  if (!o.motion.empty() && !o.links.empty())
    throw WrongUsage("--links: lists voxels in common, which --motion does without: see --grains");
}

/// The twelve numbers of a guess: three rows of a matrix, each with a number of the shift.
Motion parseMotion(const std::string& text, const std::string& path) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) numbers.push_back(parseNumber(word, path));
  if (numbers.size() != 12)
    throw InvalidInput(path + ": has " + std::to_string(numbers.size()) +
                       " numbers: a guess of a motion is three rows of a matrix, each followed by "
                       "a number of the shift, 12 in all");
  Motion motion;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t column = 0; column < 3; ++column)
      motion.linear(int(row), int(column)) = numbers[4 * row + column];
    motion.shift[int(row)] = numbers[4 * row + 3];
  }
  withFileName(path, [&] { checkMotion(motion); });
  return motion;
}

MatchOptions motionOf(const std::string& text) {
  constexpr uint64_t kMostBytes = 1 << 16;
  if (const auto kind = motionKindOf(text)) return {*kind, std::nullopt};
  return {MotionKind::affine, parseMotion(readText(text, kMostBytes), text)};
}

constexpr GrainFate kGrainFates[] = {GrainFate::kept,     GrainFate::split,    GrainFate::merged,
                                     GrainFate::vanished, GrainFate::appeared, GrainFate::lost,
                                     GrainFate::outside};
constexpr BondFate kBondFates[] = {BondFate::kept,      BondFate::broken,    BondFate::created,
                                   BondFate::inside,    BondFate::detached,  BondFate::separated,
                                   BondFate::undecided, BondFate::unmatched, BondFate::outside};

/// Of a folder of slabs, slab by slab if that is asked for and can be done.
AnyLabels labelsOf(const InputOptions& input, const char* gridOption, bool bySlabs,
                   const Common& common) {
  if (bySlabs) return loadAnyLabels(input, gridOption, common.progress);
  return Int32Grid::ConstPtr(loadLabels(input, gridOption, common.progress));
}

Tracks tracksOf(const TrackArguments& o, const AnyLabels& before, const AnyLabels& after,
                const PairNames& names, const Common& common) {
  checkSameVoxels(aboutOf(before), aboutOf(after), names);
  const Tracks tracks =
      withFileName(names.second, [&] { return track(before, after, o.track, common.progress); });
  checkAnyCommon(tracks, names);
  return tracks;
}

const Int32Grid& wholeOf(const AnyLabels& labels) {
  return *std::get<Int32Grid::ConstPtr>(labels);
}

/// Writes tracked labels as a file.
void writeLabels(const std::string& path, const AnyLabels& labels, const std::string& source,
                 const Common& common) {
  if (hasVdbEnding(path))
    writeVdb(path, {std::get<Int32Grid::ConstPtr>(labels)}, common.progress);
  else if (const auto* const slabs = std::get_if<LabelSlabs>(&labels))
    writeSlabsAsImage(path, *slabs, std::nullopt, source, common);
  else
    writeGridAsImage(path, wholeOf(labels), std::nullopt, source, common);
}

/// Writes tracked labels as a folder of slabs, which appears whole by itself.
void writeInSlabs(const std::string& path, const AnyLabels& labels, const std::string& source,
                  const Common& common) {
  const auto* const slabs = std::get_if<LabelSlabs>(&labels);
  const LabelSlabs written = slabs ? *slabs : singleSlab(wholeOf(labels).deepCopy());
  const SlabFolderWriter folder(path, written.cuts);
  for (size_t slab = 0; slab < written.slabCount(); ++slab)
    folder.write(slab, {written.read(slab, common.progress)}, common.progress);
  folder.commit(Json({{"input", source}}).dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Both scans, and where the whole has gone, as an OME-Zarr.
void writeScene(const TrackArguments& o, const Int32Grid& before, const Int32Grid& labels,
                const Tracks& tracks, const Common& common) {
  OmeScene scene{before, labels};
  if (tracks.whole) {
    scene.linear = tracks.whole->linear;
    scene.shift = tracks.whole->shift;
  } else {
    scene.shift = tracks.shift.asVec3d();
  }
  MeasureOptions measure;
  measure.minFaces = o.track.minFaces;
  common.progress->start("scene");
  writeOmeScene(o.out, scene, measure, common.progress);
  common.progress->end();
}

/// What a series has made is kept scan by scan: it may have taken hours. Says which files in the
/// folder are not of it, if it ends before `scan` is done.
void noteOlderFiles(const TrackArguments& o, const std::string& scan, const Common& common) {
  const auto isOlder = [&](const InputOptions& later) {
    return std::filesystem::exists(seriesFiles(o, later.path).grains);
  };
  const auto first = std::find_if(o.later.begin(), o.later.end(),
                                  [&](const InputOptions& later) { return later.path == scan; });
  const bool anyOlder = std::any_of(first, o.later.end(), isOlder);
  if (anyOlder)
    common.progress->note(o.more.back() + ": what it has of " + scan +
                          " and later scans is of an earlier run");
}

/// Tracks one scan of a series from the one before it. Returns its labels with the tracks.
AnyLabels runScan(const TrackArguments& o, const AnyLabels& before, bool bySlabs,
                  const Common& common) {
  const std::string& scan = o.after.path;
  const SeriesFiles files = seriesFiles(o, scan);
  TextFile grainFile(files.grains), bondFile(files.bonds);
  const AnyLabels after =
      labelsOf(o.after, "--after-grid", bySlabs && hasSlabsEnding(files.labels), common);
  const PairNames names = namesOf(o.before, o.after);
  common.progress->start("track");
  const Tracks tracks = tracksOf(o, before, after, names, common);
  AnyLabels labels = trackedLabels(after, tracks, common.progress);
  if (hasSlabsEnding(files.labels)) writeInSlabs(files.labels, labels, scan, common);
  OutputSet set;
  if (!hasSlabsEnding(files.labels)) writeLabels(files.labels, labels, scan, common);
  common.progress->end();
  for (const std::string& note : notesOn(tracks, aboutOf(before), aboutOf(after), o.track, names))
    common.progress->note(note);
  grainFile.write(trackedGrainTable(tracks));
  bondFile.write(trackedBondTable(tracks));
  set.commit();
  if (!common.quiet) {
    std::printf("%s%s\n", scan == o.later.front().path ? "" : "\n", scan.c_str());
    print(o, tracks, summaryOf(o, tracks));
  }
  return labels;
}

/// Each scan but the first one is tracked from the one before it, which has the tracks by now.
void runSeries(TrackArguments o, const Common& common) {
  for (const InputOptions& later : o.later)  // before hours of work
    if (!std::filesystem::exists(later.path))
      throw IoError(later.path + ": cannot be opened: No such file or directory");
  OutputFolder folder(o.more.back());
  const bool bySlabs = o.track.motion.has_value();
  AnyLabels before = labelsOf(o.before, "--before-grid", bySlabs, common);
  for (const InputOptions& later : o.later) {
    o.after = later;
    try {
      before = runScan(o, before, bySlabs, common);
    } catch (...) {
      noteOlderFiles(o, later.path, common);
      throw;
    }
    folder.keep();
    o.before.path = later.path;
  }
}

void runTrack(const TrackArguments& o, const Common& common) {
  const bool isScene = isZarrEnding(o.out);
  if (isScene)
    checkOutputTree(o.out);
  else if (!o.out.empty() && !hasSlabsEnding(o.out))
    checkWritable(o.out);
  if (!o.network.empty()) checkWritable(o.network);
  JsonFile jsonFile(o.json);
  TextFile grainFile(o.grains), linkFile(o.links), bondFile(o.bonds), phiFile(o.phi);
  const bool bySlabs = o.track.motion && !isScene;
  const AnyLabels before = labelsOf(o.before, "--before-grid", bySlabs, common);
  const AnyLabels after =
      labelsOf(o.after, "--after-grid", bySlabs && !hasVdbEnding(o.out), common);
  const PairNames names = namesOf(o.before, o.after);
  common.progress->start("track");
  const Tracks tracks = tracksOf(o, before, after, names, common);
  AnyLabels labels;
  if (!o.out.empty()) labels = trackedLabels(after, tracks, common.progress);
  const bool isInSlabs = hasSlabsEnding(o.out);
  if (isInSlabs) writeInSlabs(o.out, labels, o.after.path, common);
  OutputSet files;
  if (!o.out.empty() && !isScene && !isInSlabs) writeLabels(o.out, labels, o.after.path, common);
  common.progress->end();
  for (const std::string& note : notesOn(tracks, aboutOf(before), aboutOf(after), o.track, names))
    common.progress->note(note);
  grainFile.write(trackedGrainTable(tracks));
  linkFile.write(trackLinkTable(tracks));
  bondFile.write(trackedBondTable(tracks));
  if (!o.network.empty()) writeNetwork(o.network, motionNetwork(before, tracks), common.progress);
  if (!phiFile.isNowhere())
    phiFile.write(phiTable(tracks, boxOf(aboutOf(before)).min(), boxOf(aboutOf(after)).min()));
  Json json = summaryOf(o, tracks);
  addNotes(json, *common.progress);
  jsonFile.write(json);
  if (isScene) writeScene(o, wholeOf(before), wholeOf(labels), tracks, common);
  files.commit();
  if (!common.quiet) print(o, tracks, json);
}

}  // namespace

void addTrack(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<TrackArguments>();
  Verb verb = addVerb(command, common, "track",
                      "what became of grains and bonds from one scan of a sample to the next",
                      "vdb_madf track grains.vdb later.vdb tracked.vdb --max-shift 20");
  verb.option("BEFORE", o->before.path, "labels: VDB, folder of slabs or integer image").required();
  verb.option("AFTER", o->after.path, "labels of a later scan, of the same voxels").required();
  verb.option(
      "OUT", o->out,
      "gets the labels of AFTER with the numbers of BEFORE, also as a folder of slabs, .slabs; "
      ".zarr: both, as a scene of OME-Zarr");
  verb.option("MORE", o->more,
              "of a series, OUT being a scan: further scans, and last a folder, which gets labels "
              "and tables of all but the first");
  verb.option("--before-grid", o->before.gridName, "grid of BEFORE").typeName("NAME");
  verb.option("--after-grid", o->after.gridName, "grid of AFTER").typeName("NAME");
  const Option given =
      verb.option("--shift", o->shift, "how far the sample moved, in voxels (default: is found)")
          .typeName("X,Y,Z");
  verb.option("--max-shift", o->track.maxShift, "the largest shift that is looked for, voxels")
      .range(0, kMaxShift)
      .typeName("N")
      .showDefault()
      .excludes(given);
  verb.option(
          "--motion", o->motion,
          "the sample was turned or strained: 'rigid' or 'affine' is looked for, 'free' follows "
          "neighbors alone, FILE has a guess of 12 numbers")
      .typeName("KIND")
      .excludes(given);
  verb.option("--gap", o->track.gap,
              "with --motion: broken bonds are detached up to so many voxels, else separated")
      .range(1, kMaxGap)
      .typeName("N")
      .showDefault();
  verb.option("--sure-faces", o->sureFaces,
              "with --motion: whether a bond of fewer faces has broken is undecided")
      .typeName("N")
      .showDefault();
  verb.option("--share", o->track.share,
              "part of the smaller of two grains that they have to share to be linked")
      .typeName("F")
      .showDefault();
  verb.option("--min-faces", o->minFaces, "fewest voxel faces of a bond")
      .typeName("N")
      .showDefault();
  verb.option("--grains", o->grains, "CSV: a line per grain of either side").typeName("FILE");
  verb.option("--links", o->links, "CSV: a line per pair of grains that share voxels")
      .typeName("FILE");
  verb.option("--bonds", o->bonds, "CSV: a line per bond of either side").typeName("FILE");
  verb.option("--network", o->network,
              "with --motion: grains and bonds of BEFORE with their motion, .vtp, .graphml or .csv")
      .typeName("FILE");
  verb.option("--phi", o->phi,
              "with --motion: how BEFORE moved, as spam's discrete correlation takes it, .tsv")
      .typeName("FILE.tsv");
  verb.option("--json", o->json, "machine-readable result (-: standard output)").typeName("FILE");
  o->before.addRaw(verb);
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] {
      if (!o->motion.empty()) o->track.motion = motionOf(o->motion);
      checkOptions(o->track);
      if (!o->more.empty()) return runSeries(*o, besideOutput(common, o->more.back()));
      Common beside = common;
      for (const std::string& output :
           {o->out, o->json, o->grains, o->links, o->bonds, o->phi, o->network})
        beside = besideOutput(beside, output);
      runTrack(*o, beside);
    };
  });
}

}  // namespace vdb_madf::tools
