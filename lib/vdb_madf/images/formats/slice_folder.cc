// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/slice_folder.h"

#include <algorithm>
#include <filesystem>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/key_value_header.h"
#include "vdb_madf/images/formats/picture_slice.h"
#include "vdb_madf/images/formats/slice_names.h"

namespace vdb_madf::detail {

namespace {

/// Logs have some kilobytes.
constexpr uint64_t kMaxLogBytes = uint64_t(1) << 20;

/// Runs of digits are compared as numbers, all else by bytes.
bool naturallyBefore(const std::string& a, const std::string& b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!isDigit(a[i]) || !isDigit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    size_t endA = i, endB = j;
    while (endA < a.size() && isDigit(a[endA])) ++endA;
    while (endB < b.size() && isDigit(b[endB])) ++endB;
    if (endA - i != endB - j) return endA - i < endB - j;
    const int order = a.compare(i, endA - i, b, j, endB - j);
    if (order != 0) return order < 0;
    i = endA, j = endB;
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // they differ only in leading zeros
}

/// From the last line of the log that has it: the section of the reconstruction is the last.
std::optional<double> micrometersIn(const std::string& path, const std::string& log) {
  HeaderSyntax syntax;
  syntax.skipsOtherLines = true;
  syntax.canonicalKey = [](const std::string& key) { return lowerCase(key); };
  std::optional<double> found;
  const KeyValueHeader header(path, log, syntax);
  for (const auto& [key, text] : header.fields()) {
    const auto value = reals(text);
    if ((key == "pixel size (um)" || key == "image pixel size (um)") && value && value->size() == 1)
      found = value->front();
  }
  return found;
}

class PictureStack : public ImageReader {
 public:
  PictureStack(const std::string& path, const std::vector<std::string>& files) {
    path_ = path;
    files_ = files;
    for (const std::string& name : files_) {
      const InputFile file(name);
      const PictureHeader picture = isPng(file) ? pngHeader(file) : bmpHeader(file);
      if (name == files_.front()) {
        picture_ = picture;
        info_.format = isPng(file) ? "png" : "bmp";
      } else if (!picture.sameAs(picture_)) {
        throw IoError(name + ": is " + picture.text() + ", but the first slice of the folder is " +
                      picture_.text());
      }
    }
    info_.size = checkedSize(path, {picture_.width, picture_.height, int64_t(files_.size())});
    info_.type = picture_.type;
  }
  void setVoxelSize(const std::optional<VoxelSize>& size) { info_.voxelSize = size; }
  void setNotes(const std::vector<std::string>& notes) { notes_ = notes; }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    char* to = static_cast<char*>(samples);
    for (int z = first; z < first + count; ++z, to += sliceBytes(info_)) {
      const InputFile file(files_[size_t(z)]);
      if (isPng(file))
        readPng(file, picture_, to);
      else
        readBmp(file, picture_, to);
    }
  }

 private:
  static bool isPng(const InputFile& file) { return isPngHeader(file.head(8)); }

  PictureHeader picture_;
};

}  // namespace

std::vector<std::string> slicesIn(const std::string& folder,
                                  const std::vector<std::string>& endings) {
  std::vector<std::string> names, paths;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::string ending = fileEnding(name);
    const std::string stem = entry->path().stem().string();
    const bool preview = stem.size() > 4 && stem.compare(stem.size() - 4, 4, "_spr") == 0;
    if (name[0] != '.' && !preview &&
        std::find(endings.begin(), endings.end(), ending) != endings.end())
      names.push_back(name);
  }
  if (error) throw IoError(folder + ": cannot be listed: " + error.message());
  std::sort(names.begin(), names.end(), naturallyBefore);
  for (const std::string& name : names)
    paths.push_back((std::filesystem::path(folder) / name).string());
  return paths;
}

std::optional<VoxelSize> voxelSizeInLog(const std::string& folder) {
  std::optional<VoxelSize> size;
  for (const std::string& path : slicesIn(folder, {".log"})) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) continue;
    const auto edge = micrometersIn(path, InputFile(path).head(kMaxLogBytes));
    if (!edge) continue;
    if (size) return std::nullopt;  // which one belongs to the slices?
    size = checkedVoxelSize(path, {*edge, *edge, *edge}, unitsPerMetre("um"));
  }
  return size;
}

std::vector<std::string> picturesIn(const std::string& folder) {
  std::vector<std::string> png = slicesIn(folder, {".png"}), bmp = slicesIn(folder, {".bmp"});
  if (!png.empty() && !bmp.empty())
    throw IoError(folder + ": has .png and .bmp files: move those away that are no slices");
  return png.empty() ? bmp : png;
}

std::unique_ptr<ImageReader> openPictureFolder(const std::string& folder) {
  const std::vector<std::string> files = picturesIn(folder);
  if (files.empty()) throw IoError(folder + ": has no slices: no .tif, .tiff, .png or .bmp files");
  auto stack = std::make_unique<PictureStack>(folder, files);
  stack->setVoxelSize(voxelSizeInLog(folder));
  stack->setNotes(numberingNotes(folder, files));
  return stack;
}

std::unique_ptr<ImageReader> openPicture(std::unique_ptr<InputFile> file) {
  return std::make_unique<PictureStack>(file->path(), std::vector<std::string>{file->path()});
}

}  // namespace vdb_madf::detail
