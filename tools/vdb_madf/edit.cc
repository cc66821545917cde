// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cstdio>
#include <memory>

#include "command.h"
#include "grid_image.h"
#include "input_options.h"
#include "json_file.h"
#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/edits/edit_labels.h"
#include "vdb_madf/files/output_set.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/files/standard_streams.h"
#include "vdb_madf/segmentation/ball_grids.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"

namespace vdb_madf::tools {

namespace {

constexpr char kEditsFile[] = "--edits";
constexpr uint64_t kMostEditBytes = uint64_t(1) << 24;  // of a file of edits

struct EditArguments {
  InputOptions input;
  std::string out, json;
  GivenOptions given;  ///< edits, and files of them, in their order
};

/// "--merge" and "12,17" are the edit "merge 12 17".
Edit editOf(const std::string& option, const std::string& value) {
  try {
    return parseEdit(option.substr(2) + " " + value);
  } catch (const InvalidInput& error) {
    throw WrongUsage(option + (value.empty() ? "" : " ") + value + ": " + error.what());
  }
}

void parse(EditArguments& o) {
  if (o.given.empty())
    throw WrongUsage("say what to edit (--merge, --split, --drop ...), or give a file of edits");
  o.input.outputs = {o.out, o.json};
  o.input.parse();
  checkVolumeEnding(o.out);
  for (const auto& [option, value] : o.given) {
    if (option != kEditsFile) {
      editOf(option, value);
      continue;
    }
    checkOutputs(o.input.outputs, value);
    if (isStandardInput(value) && isStandardInput(o.input.path))
      throw WrongUsage("--edits -: the labels come from standard input already");
  }
}

std::vector<Edit> readEdits(const EditArguments& o) {
  std::vector<Edit> edits;
  for (const auto& [option, value] : o.given) {
    if (option != kEditsFile) {
      edits.push_back(editOf(option, value));
      continue;
    }
    const std::string& path = value;
    const auto more =
        withFileName(path, [&] { return parseEdits(readText(path, kMostEditBytes)); });
    edits.insert(edits.end(), more.begin(), more.end());
  }
  return edits;
}

/// What a file has beside the labels, which are a grid of it; of an image nothing.
struct Input {
  std::vector<openvdb::GridBase::Ptr> grids;
  Int32Grid::Ptr labels, manifold;
};

Input read(const EditArguments& o, const Common& common) {
  Input input;
  if (!isVdb(o.input)) {
    input.labels = loadLabels(o.input, "--grid", common.progress);
    input.grids = {input.labels};
    return input;
  }
  input.grids = readVdb(o.input.path, {}, common.progress);
  input.labels = openvdb::gridPtrCast<Int32Grid>(chooseGrid(o.input, input.grids, GridUse::labels));
  for (const auto& grid : input.grids) {
    overrideFile(*grid, o.input.path, o.input.volume(common.progress));
    if (grid->getName() == "manifold") input.manifold = openvdb::gridPtrCast<Int32Grid>(grid);
  }
  return input;
}

Json summary(const EditArguments& o, const EditedLabels& edited) {
  Json json;
  json["input"] = o.input.path;
  json["output"] = o.out;
  json["grains_before"] = edited.grainsBefore;
  json["grains"] = edited.grains;
  json["voxels_before"] = edited.voxelsBefore;
  json["voxels"] = edited.voxels;
  json["edits"] = Json::array();
  for (const EditResult& result : edited.results) {
    json["edits"].push_back({{"edit", toString(result.edit)},
                             {"grains", result.grains},
                             {"dropped_grains", result.droppedGrains},
                             {"dropped_voxels", result.droppedVoxels}});
    if (result.edit.kind == Edit::Kind::joinBelow)
      json["edits"].back()["joined_grains"] = result.joinedGrains;
  }
  return json;
}

std::string didWhat(const EditResult& result) {
  std::string text;
  for (const int32_t grain : result.grains)
    text += (text.empty() ? "" : ", ") + std::to_string(grain);
  switch (result.edit.kind) {
    case Edit::Kind::split:
    case Edit::Kind::merge:
      return "now " + text;
    case Edit::Kind::joinBelow:
      return "joined " + counted(result.joinedGrains, "grain") + " to neighbors";
    case Edit::Kind::renumber:
      return "done";
    case Edit::Kind::strictness:
      return "as it is";
    default:
      return "dropped " + counted(result.droppedGrains, "grain") + ", " +
             counted(result.droppedVoxels, "voxel");
  }
}

void print(const EditArguments& o, const EditedLabels& edited, bool all) {
  constexpr size_t kMostLines = 20, kMostText = 60;
  std::printf("%s: %s, %lld before\n", o.out.c_str(), counted(edited.grains, "grain").c_str(),
              (long long)edited.grainsBefore);
  const auto& results = edited.results;
  const size_t lines = all ? results.size() : std::min(results.size(), kMostLines);
  for (size_t i = 0; i < lines; ++i) {
    std::string text = toString(results[i].edit);
    if (text.size() > kMostText) text = text.substr(0, kMostText) + "...";
    std::printf("  %s: %s\n", text.c_str(), didWhat(results[i]).c_str());
  }
  if (lines < results.size())
    std::printf("  and %s more (--verbose, --json)\n",
                counted(int64_t(results.size() - lines), "edit").c_str());
}

void runEdit(const EditArguments& o, const Common& common) {
  checkWritable(o.out);
  JsonFile jsonFile(o.json);
  const std::vector<Edit> edits = readEdits(o);
  Input input = read(o, common);
  common.progress->start("edit");
  const EditedLabels edited = withFileName(o.input.path, [&] {
    return editLabels(*input.labels, edits, input.manifold.get(), common.progress);
  });
  if (edited.grains == 0 && edited.grainsBefore > 0)
    common.progress->note(o.out + ": no grain is left");
  OutputSet files;
  if (!hasVdbEnding(o.out)) {
    writeGridAsImage(o.out, *edited.labels, std::nullopt, o.input.path, common);
  } else {
    // Every other grid goes along. Those of the segmentation are told how many grains there are.
    const bool isSegmentation = grainCount(*input.labels).has_value();
    std::vector<openvdb::GridBase::ConstPtr> out;
    for (const auto& grid : input.grids) {
      if (grid == input.labels) {
        out.push_back(edited.labels);
        continue;
      }
      if (isSegmentation) updateCounts(*grid, edited.grains, false);
      out.push_back(grid);
    }
    writeVdb(o.out, out, common.progress);
    common.progress->end();
  }
  Json json = summary(o, edited);
  addNotes(json, *common.progress);
  jsonFile.write(json);
  files.commit();
  if (!common.quiet) print(o, edited, common.verbose);
}

}  // namespace

void addEdit(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<EditArguments>();
  Verb verb = addVerb(command, common, "edit", "merge, split, drop and renumber grains",
                      "vdb_madf edit grains.vdb better.vdb --merge 1,2 --min-voxels 27");
  verb.option("LABELS", o->input.path, "labels: VDB or integer image").required();
  verb.option("OUT", o->out, "gets the edited labels; a .vdb all other grids too").required();
  const auto edit = [&](const std::string& name, const std::string& value,
                        const std::string& help) {
    verb.repeatedOption(name, o->given, help).typeName(value);
  };
  edit("--merge", "A,B,...", "makes one grain of these; edits are done in the order given");
  edit("--split", "A", "undoes a merge: of edits, else of the segmentation (needs its manifolds)");
  edit("--drop", "A,B,...", "drops these grains");
  edit("--keep", "A,B,...", "drops all others");
  edit("--min-voxels", "N", "drops grains of fewer voxels");
  edit("--max-voxels", "N", "drops grains of more");
  edit("--join-below", "N", "joins grains of fewer voxels to the neighbor of most shared faces");
  edit("--min-diameter", "LENGTH", "drops grains of a smaller equivalent diameter, such as 100um");
  edit("--max-diameter", "LENGTH", "drops grains of a larger one");
  verb.repeatedFlag("--drop-at-faces", o->given, "drops grains at the faces of the domain");
  verb.repeatedFlag("--renumber", o->given, "numbers grains 1, 2, 3 ... in the order they have");
  edit("--strictness", "K", "refuses labels that were merged with another one");
  edit(kEditsFile, "FILE", "edits from a file: a line an option without dashes, as 'merge 12 17'");
  verb.option("--grid", o->input.gridName, "VDB input: the grid to take").typeName("NAME");
  verb.option("--json", o->json, "machine-readable result (-: standard output)").typeName("FILE");
  o->input.addRaw(verb);
  o->input.addVoxelSize(verb);
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runEdit(*o, besideOutput(besideOutput(common, o->out), o->json)); };
  });
}

}  // namespace vdb_madf::tools
