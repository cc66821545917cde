// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/json_text.h"
#include "vdb_madf/images/formats/zarr_array.h"

namespace vdb_madf::detail {

namespace {

namespace fs = std::filesystem;

/// A decoded layer of chunks up to this is kept for the next slabs.
constexpr uint64_t kMaxLayerBytes = uint64_t(256) << 20;

bool isThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// The first image of the group's OME-Zarr metadata; null if there is none.
Json multiscale(const std::string& name, const fs::path& group) {
  Json attributes;
  if (isThere(group / ".zattrs"))
    attributes = jsonObjectWithoutLabels(name, (group / ".zattrs").string());
  else if (isThere(group / "zarr.json"))
    attributes = member(
        member(jsonObjectWithoutLabels(name, (group / "zarr.json").string()), "attributes"), "ome");
  const Json& images = member(attributes, "multiscales");
  return images.is_array() && !images.empty() && images[0].is_object() ? images[0] : Json();
}

/// Multiplies by the scales of a list of transformations, and of the sequences in it, in which
/// there is no other one. False if it cannot be understood.
bool applyScales(const Json& transformations, std::vector<double>& scale, bool isSequence = false) {
  if (transformations.is_null()) return true;
  if (!transformations.is_array()) return false;
  for (const Json& one : transformations) {
    if (textOf(member(one, "type")) == "sequence" &&
        (isSequence || !applyScales(member(one, "transformations"), scale, true)))
      return false;
    if (textOf(member(one, "type")) != "scale") continue;
    const Json& factors = member(one, "scale");
    if (!factors.is_array() || factors.size() != scale.size()) return false;
    for (size_t i = 0; i < scale.size(); ++i) {
      if (!factors[i].is_number()) return false;
      scale[i] *= factors[i].get<double>();
    }
  }
  return true;
}

/// True if a list of transformations, or a sequence in it, moves the image by a voxel or more.
bool isMoved(const Json& transformations, const std::vector<double>& scale) {
  if (!transformations.is_array()) return false;
  return std::any_of(transformations.begin(), transformations.end(), [&](const Json& one) {
    if (textOf(member(one, "type")) == "sequence")
      return isMoved(member(one, "transformations"), scale);
    const Json& shift = member(one, "translation");
    for (size_t i = 0; i < std::min(shift.size(), scale.size()); ++i)
      if (shift.is_array() && shift[i].is_number() &&
          isVoxelAway(shift[i].get<double>(), std::abs(scale[i])))
        return true;
    return false;
  });
}

/// The axes that the transformations of a scale lead to: before OME-Zarr 0.6 the only ones.
const Json& axesOf(const Json& image, const Json& transformations) {
  const Json& systems = member(image, "coordinateSystems");
  if (!systems.is_array()) return member(image, "axes");
  static const Json kNoAxes;
  if (!transformations.is_array() || transformations.empty()) return kNoAxes;
  const std::string name = textOf(member(member(transformations[0], "output"), "name"));
  const auto system = std::find_if(systems.begin(), systems.end(), [&](const Json& one) {
    return textOf(member(one, "name")) == name;
  });
  return system == systems.end() ? kNoAxes : member(*system, "axes");
}

/// Of the scale at `path` within the image; also sets info.isPlaced.
std::optional<VoxelSize> voxelSizeOf(const std::string& name, const Json& image,
                                     const std::string& path, size_t axesCount, ImageInfo& info) {
  const Json& datasets = member(image, "datasets");
  if (!datasets.is_array()) return std::nullopt;
  const auto dataset = std::find_if(datasets.begin(), datasets.end(), [&](const Json& one) {
    return textOf(member(one, "path")) == path;
  });
  if (dataset == datasets.end()) return std::nullopt;
  const Json& transformations = member(*dataset, "coordinateTransformations");
  const Json& axes = axesOf(image, transformations);
  if (!axes.is_array() || axes.size() != axesCount) return std::nullopt;
  std::vector<std::string> names;
  for (const Json& axis : axes) names.push_back(textOf(member(axis, "name")));
  checkAxisNames(name, names);
  if (transformations.is_null()) return std::nullopt;  // before version 0.4
  std::vector<double> scale(axesCount, 1.0);
  // Since version 0.6 what is said of all scales leads from these axes to others.
  const bool hasSystems = !member(image, "coordinateSystems").is_null();
  if (!applyScales(transformations, scale) ||
      (!hasSystems && !applyScales(member(image, "coordinateTransformations"), scale)))
    throw IoError(
        name + ": its scales cannot be read: correct its metadata, or give the voxel size",
        Hint::voxelSize);
  info.isPlaced =
      isMoved(transformations, scale) || isMoved(member(image, "coordinateTransformations"), scale);
  std::array<double, 3> edges;
  std::array<std::optional<double>, 3> units;
  for (size_t i = 0; i < 3; ++i) {  // x, y, z
    edges[i] = scale[axesCount - 1 - i];
    units[i] = unitsPerMetre(textOf(member(axes[axesCount - 1 - i], "unit")));
  }
  if (units[0] != units[1] || units[0] != units[2])
    throw IoError(name + ": its axes have different units");
  return checkedVoxelSize(name, edges, units[0]);
}

/// Checks the names that xarray gives the axes of an array of version 2, in its attributes.
void checkOwnAxes(const std::string& name, const fs::path& array) {
  const fs::path attributes = array / ".zattrs";
  if (isThere(attributes))
    checkAxisNames(name, textsOf(member(jsonObjectWithoutLabels(name, attributes.string()),
                                        "_ARRAY_DIMENSIONS")));
}

/// Which array of a group is meant if none is named.
std::string chooseArray(const std::string& path, const Json& image) {
  const Json& datasets = member(image, "datasets");
  if (datasets.is_array() && !datasets.empty() && !textOf(member(datasets[0], "path")).empty())
    return textOf(member(datasets[0], "path"));
  std::vector<std::string> arrays;
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error))
    if (ZarrArray::isThere(path, entry->path().string()))
      arrays.push_back(entry->path().filename().string());
  std::sort(arrays.begin(), arrays.end());
  if (arrays.size() == 1) return arrays[0];
  std::string list;
  for (size_t i = 0; i < arrays.size() && i < 8; ++i)
    list += (i ? ", " : "") + detail::inQuotes(arrays[i]);
  if (arrays.empty())
    throw IoError(path + ": this Zarr group holds no array itself: name one of a group in it",
                  Hint::dataset);
  throw IoError(path + ": choose one of its arrays: " + list + (arrays.size() > 8 ? " ..." : ""),
                Hint::dataset);
}

/// Takes what the groups around an array say of it, the nearest first: it may be called "a/b".
void addPlace(const std::string& name, const fs::path& array, size_t axesCount, ImageInfo& info) {
  for (fs::path group = array.parent_path(); isZarrFolder(group.string());
       group = group.parent_path()) {
    const Json image = multiscale(name, group);
    info.voxelSize =
        voxelSizeOf(name, image, array.lexically_relative(group).string(), axesCount, info);
    if (info.voxelSize || !group.has_filename() || group == group.parent_path()) break;
  }
}

class ZarrReader : public ImageReader {
 public:
  ZarrReader(const std::string& path, const std::string& folder) : array_(path, folder) {
    path_ = path;
    files_ = {path, array_.descriptionPath()};
    info_.size = array_.size();
    info_.type = array_.type();
    info_.format = "zarr";
    const uint64_t depth = uint64_t(std::min(array_.slicesPerChunk(), info_.size.z));
    keepLayer_ = sliceBytes(info_) * depth <= kMaxLayerBytes;
  }
  size_t axes() const { return array_.leadingAxes() + 3; }
  ImageInfo& ownInfo() { return info_; }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    char* to = static_cast<char*>(samples);
    if (!keepLayer_) return array_.read(first, count, to);
    for (const int end = first + count; first < end;) {
      loadLayer(first / array_.slicesPerChunk());
      const int some = std::min(end, layerEnd()) - first;
      const size_t slice = size_t(sliceBytes(info_));
      std::memcpy(to, &layer_[slice * size_t(first - layerBegin())], slice * size_t(some));
      to += slice * size_t(some);
      first += some;
    }
  }

 private:
  int layerBegin() const { return number_ * array_.slicesPerChunk(); }
  int layerEnd() const {
    return int(std::min<int64_t>(info_.size.z, int64_t(layerBegin()) + array_.slicesPerChunk()));
  }
  void loadLayer(int number) {
    if (number == number_) return;
    number_ = number;
    layer_.resize(size_t(sliceBytes(info_)) * size_t(layerEnd() - layerBegin()));
    try {
      array_.read(layerBegin(), layerEnd() - layerBegin(), layer_.data());
    } catch (...) {
      number_ = -1;
      throw;
    }
  }

  ZarrArray array_;
  bool keepLayer_ = false;
  int number_ = -1;  ///< of the layer that is kept
  std::vector<char> layer_;
};

}  // namespace

bool isZarrFolder(const std::string& path) {
  for (const char* name : {".zarray", ".zgroup", ".zattrs", "zarr.json"})
    if (isThere(fs::path(path) / name)) return true;
  return false;
}

std::unique_ptr<ImageReader> openZarr(const std::string& path, const std::string& dataset) {
  fs::path array(path);
  if (!array.has_filename()) array = array.parent_path();  // ends with a slash
  std::string within = dataset;
  within.erase(0, std::min(within.find_first_not_of('/'), within.size()));
  if (!within.empty()) array = (array / within).lexically_normal();
  if (!array.has_filename()) array = array.parent_path();
  if (!ZarrArray::isThere(path, array.string()) && isZarrFolder(array.string()))
    array /= chooseArray(array.string(), multiscale(path, array));
  if (!ZarrArray::isThere(path, array.string()))
    throw IoError(path + ": there is no Zarr array " +
                  detail::inQuotes(dataset.empty() ? array.filename().string() : dataset) +
                  " in it");
  auto reader = std::make_unique<ZarrReader>(path, array.string());
  checkOwnAxes(path, array);
  addPlace(path, array, reader->axes(), reader->ownInfo());
  return reader;
}

}  // namespace vdb_madf::detail
