// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "json_file.h"
#include "outputs.h"
#include "text_file.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/csv_cell.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/read_text.h"
#include "vdb_madf/measure/columns.h"

namespace vdb_madf::tools {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFirstColumns = "sample,folder,";
constexpr uintmax_t kLargestSample = 64 << 20;  // bytes; a true one has some thousand

struct CollectArguments {
  std::vector<std::string> folders;
  std::string out;
};

struct MeasuredSample {
  std::string folder;
  std::string unit;  ///< of its lengths
  Json json;
};

/// A forgotten OUT.csv makes an output of the last file that a shell found: no table but our own is
/// replaced.
void checkReplaces(const std::string& out) {
  std::error_code ignored;
  if (!fs::is_regular_file(out, ignored) || fs::file_size(out, ignored) == 0) return;
  std::ifstream file(out, std::ios::binary);
  std::string header(kFirstColumns.size(), ' ');
  file.read(header.data(), std::streamsize(header.size()));
  if (!file.is_open() || file.bad())
    throw IoError(out + ": cannot be read: " + std::strerror(errno));
  if (header != kFirstColumns)
    throw WrongUsage(out +
                     ": is there, and not made by collect: choose another name for the table");
}

void parse(CollectArguments& o) {
  o.out = o.folders.back();
  o.folders.pop_back();
  if (!isOnStandardOutput(o.out) && fileEnding(o.out) != ".csv")
    throw WrongUsage(o.out + ": the last name is the table to write: its ending must be .csv");
  if (!isOnStandardOutput(o.out)) checkReplaces(o.out);
  if (o.folders.empty()) throw WrongUsage("give folders that measure has filled, then OUT.csv");
}

MeasuredSample readSample(const std::string& folder) {
  const fs::path path = fs::path(folder) / "sample.json";
  const auto refuse = [&](const std::string& what) {
    throw IoError(path.string() + ": " + what + ": make it again with vdb_madf measure");
  };
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) refuse("is no file");
  if (fs::file_size(path, ignored) > kLargestSample) refuse("is too large");
  MeasuredSample sample{folder, "",
                        Json::parse(readText(path.string(), kLargestSample), nullptr, false)};
  const auto text = [&](const char* key) {
    const auto found = sample.json.is_object() ? sample.json.find(key) : sample.json.end();
    return found != sample.json.end() && found->is_string() ? found->get<std::string>() : "";
  };
  sample.unit = text("length_unit");
  if (sample.unit != "mm" && sample.unit != "um" && sample.unit != "voxel")
    refuse("is not what measure writes");
  return sample;
}

/// The folders' samples. A folder without one is named and left out.
std::vector<MeasuredSample> readSamples(const CollectArguments& o, const Common& common) {
  std::vector<MeasuredSample> samples;
  std::set<fs::path> known;
  const auto leaveOut = [&](const std::string& folder, const char* why) {
    common.progress->note(folder + ": left out: " + why);
  };
  for (const std::string& folder : o.folders) {
    std::error_code ignored;
    if (!fs::exists(folder, ignored)) throw IoError(folder + ": there is no such folder");
    if (!fs::is_directory(folder, ignored))
      leaveOut(folder, "is no folder");
    else if (!fs::exists(fs::path(folder) / "sample.json", ignored))
      leaveOut(folder, "holds no sample.json");
    else if (!known.insert(fs::canonical(folder, ignored)).second)
      leaveOut(folder, "is given twice");
    else
      samples.push_back(readSample(folder));
  }
  if (samples.empty())
    throw InvalidInput("no folder holds a sample.json: give folders that measure has filled");
  return samples;
}

/// The unit of the table. Lengths in voxels stand beside no others.
std::string commonUnit(const std::vector<MeasuredSample>& samples) {
  std::string unit = samples.front().unit;
  for (const MeasuredSample& sample : samples) {
    if ((sample.unit == "voxel") != (unit == "voxel")) {
      const MeasuredSample& other = samples.front();
      throw InvalidInput("the lengths of " + other.folder + " are in " + other.unit +
                         ", those of " + sample.folder + " in " + sample.unit +
                         ": measure again with --voxel-size what lacks a voxel size");
    }
    if (sample.unit == "mm") unit = "mm";
  }
  return unit;
}

/// The cells of a sample by the names of their columns, which are added to `names` in their order.
class Row {
 public:
  Row(const MeasuredSample& sample, const std::string& unit, std::vector<std::string>& names)
      : unit_(unit), factor_(sample.unit == "um" && unit == "mm" ? 1e-3 : 1), names_(names) {
    setText("sample", sample.folder);
    setText("folder", sample.folder);
    for (const auto& [key, value] : sample.json.items()) add(key, value, sample.unit);
    setText("length_unit", unit);
  }

  std::string text(const std::vector<std::string>& names) const {
    std::string line;
    for (const std::string& name : names) {
      const auto found = cells_.find(name);
      if (&name != &names.front()) line += ',';
      if (found != cells_.end()) line += csvCell(found->second);
    }
    return line + '\n';
  }

 private:
  void setText(const std::string& name, const std::string& text) {
    cells_[name] = text;
    if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
  }

  /// A member of the sample. Those of a member of its own follow its name, the unit comes last:
  /// d50 of grain_diameter_by_volume_mm is grain_diameter_by_volume_d50_mm.
  void add(const std::string& key, const Json& value, const std::string& unit) {
    for (const int power : {-3, -2, -1, 3, 2, 1}) {
      const std::string suffix = unitSuffix(power, unit);
      if (key.size() <= suffix.size() ||
          key.compare(key.size() - suffix.size(), suffix.size(), suffix) != 0)
        continue;
      return addParts(key.substr(0, key.size() - suffix.size()), power, value);
    }
    addParts(key, 0, value);
  }

  void addParts(const std::string& stem, int power, const Json& value) {
    if (value.is_object()) {
      for (const auto& [part, inner] : value.items())
        if (part == "eigenvalues")
          addThree(stem + "_eigenvalue_", "123", power, inner);
        else
          addValue(stem + "_" + part, power, inner);
    } else if (stem == "box_min" || stem == "box_max" || stem == "correlation_length" ||
               (stem == "voxel_size" && value.is_array())) {
      addThree(stem + "_", "xyz", power, value);
    } else {
      addValue(stem, power, value);
    }
  }

  void addThree(const std::string& stem, const std::string& parts, int power, const Json& value) {
    for (size_t i = 0; i < 3 && value.is_array() && i < value.size(); ++i)
      addValue(stem + parts[i], power, value[i]);
  }

  /// Distributions and tensors have no cell.
  void addValue(const std::string& stem, int power, const Json& value) {
    const std::string name = stem + unitSuffix(power, unit_);
    if (value.is_structured()) return;
    if (value.is_string())
      setText(name, value.get<std::string>());
    else if (value.is_null())
      setText(name, "");
    else if (value.is_number() && power != 0 && factor_ != 1)
      setText(name, Json(scaled(value.get<double>(), power, factor_)).dump());
    else
      setText(name, value.dump());
  }

  std::string unit_;
  double factor_;  ///< of the sample's lengths
  std::vector<std::string>& names_;
  std::map<std::string, std::string> cells_;
};

void runCollect(const CollectArguments& o, const Common& common) {
  TextFile file(o.out);
  const std::vector<MeasuredSample> samples = readSamples(o, common);
  const std::string unit = commonUnit(samples);
  std::vector<std::string> names;
  std::vector<Row> rows;
  for (const MeasuredSample& sample : samples) rows.emplace_back(sample, unit, names);
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + csvCell(name);
  text += '\n';
  for (const Row& row : rows) text += row.text(names);
  file.write(text);
  if (!common.quiet && !file.isStandardOutput())
    std::printf("%s: %s, %s\n", o.out.c_str(), counted(int64_t(rows.size()), "sample").c_str(),
                counted(int64_t(names.size()), "column").c_str());
}

}  // namespace

void addCollect(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<CollectArguments>();
  Verb verb = addVerb(command, common, "collect", "one table of many samples, a row each",
                      "vdb_madf collect results/*/ samples.csv");
  verb.option("DIR", o->folders, "folders that measure has filled; last, the table to write")
      .required();
  verb.onParsed([o, &common, &action] {
    parse(*o);
    action = [o, &common] { runCollect(*o, common); };
  });
}

}  // namespace vdb_madf::tools
