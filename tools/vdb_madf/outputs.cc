// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "outputs.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_file.h"
#include "vdb_madf/files/same_file.h"
#include "vdb_madf/files/standard_streams.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/vdb/slab_folder.h"
#include "wrong_usage.h"

namespace vdb_madf::tools {

std::vector<std::string> filesOf(const std::vector<std::string>& outputs) {
  std::vector<std::string> files;
  for (const std::string& output : outputs) {
    if (output.empty() || isOnStandardOutput(output)) continue;
    files.push_back(output);
    for (const auto& [ending, beside] : {std::pair(".mhd", ".raw"), {".obj", ".mtl"}})
      if (fileEnding(output) == ending)
        files.push_back(std::filesystem::path(output).replace_extension(beside).string());
  }
  return files;
}

namespace {

/// True if the file would be one of a folder of slabs.
bool isOfSlabs(const std::string& file, const std::string& folder) {
  std::error_code ignored;
  const auto place = std::filesystem::absolute(file, ignored).parent_path();
  return isSlabFolder(folder) && isSameFile(place.string(), folder);
}

/// True if the file would go with the folder of slabs, or with what a run left of it.
bool goesWithSlabs(const std::string& file, const std::string& folder) {
  return fileEnding(folder) == ".slabs" &&
         (isWithin(file, folder) || isWithin(file, folder + ".part"));
}

}  // namespace

std::filesystem::path placeOf(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored) / "";
}

bool isWithin(const std::string& path, const std::string& folder) {
  const std::string inner = placeOf(path).string(), outer = placeOf(folder).string();
  return inner.compare(0, outer.size(), outer) == 0;
}

bool isOnStandardOutput(const std::string& output) {
  return output == "-" || output == "/dev/stdout" || isStandardOutput(output);
}

void checkOutputs(const std::vector<std::string>& outputs, const std::string& input) {
  if (std::count_if(outputs.begin(), outputs.end(), isOnStandardOutput) > 1)
    throw WrongUsage("two outputs would go to standard output; give one the name of a file");
  for (const std::string& output : outputs)
    if (isStandardOutput(output) && !isImageEnding(output) && fileEnding(output) != ".csv")
      throw WrongUsage(output + ": standard output takes raw:-, npy:-, nrrd:- and csv:-");
  const std::vector<std::string> files = filesOf(outputs);
  for (size_t i = 0; i < files.size(); ++i) {
    if (isSameFile(input, files[i]))
      throw WrongUsage(files[i] + ": the output would overwrite the input; choose another name");
    if (isOfSlabs(files[i], input))
      throw WrongUsage(files[i] +
                       ": the output would lie among the slabs of the input; choose "
                       "another folder");
    if (!input.empty() && goesWithSlabs(input, files[i]))
      throw WrongUsage(files[i] + ": replaces the slabs that are there, and the input " + input +
                       " is among them; choose another name");
    for (size_t j = 0; j < i; ++j)
      if (isSameFile(files[j], files[i]))
        throw WrongUsage(files[i] + ": two outputs would go to this file; choose another name");
  }
}

void checkWritable(const std::string& output) {
  if (isStandardOutput(output)) return;
  const std::vector<std::string> files = filesOf({output});
  removeLeftovers(files);
  checkImagePlace(output);
  for (const std::string& file : files) const OutputFile probe(file);
}

bool hasVdbEnding(const std::string& path) {
  return fileEnding(path) == ".vdb";
}
bool hasTiffEnding(const std::string& path) {
  const std::string ending = fileEnding(path);
  return ending == ".tif" || ending == ".tiff";
}
bool hasRawEnding(const std::string& path) {
  return fileEnding(path) == ".raw";
}
bool hasPngEnding(const std::string& path) {
  return fileEnding(path) == ".png";
}
bool hasSlabsEnding(const std::string& path) {
  return fileEnding(path) == ".slabs";
}
void checkTableEnding(const std::string& path) {
  if (!isOnStandardOutput(path) && fileEnding(path) != ".csv")
    throw WrongUsage(path + ": the output's ending must be .csv");
}

}  // namespace vdb_madf::tools
