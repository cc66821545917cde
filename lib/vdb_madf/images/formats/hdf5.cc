// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/hdf5_handle.h"
#include "vdb_madf/files/detail/hdf5_output.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/isolated_reader.h"
#include "vdb_madf/images/detail/stored_type.h"
#include "vdb_madf/images/formats/hdf5_sources.h"
#include "vdb_madf/images/formats/hdf5_voxel_size.h"

namespace vdb_madf::detail {

namespace {

/// Chunks up to this are kept for the next slabs.
constexpr uint64_t kMaxCacheBytes = uint64_t(256) << 20;
/// A prime number well above the chunks of a layer.
constexpr size_t kCacheSlots = 12421;
/// A byte of the file may stand for so many of samples: compression, and chunks that were never
/// written and hold the fill value.
constexpr uint64_t kMaxHdf5Expansion = uint64_t(1) << 16;
constexpr size_t kMaxListed = 8;

/// The type that the samples have in memory.
Hdf5Handle nativeType(hid_t dataset) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  return Hdf5Handle(type ? H5Tget_native_type(type, H5T_DIR_ASCEND) : -1, H5Tclose);
}

/// Nothing for text, records ... Half floats are floats in memory.
std::optional<StoredType> storedType(hid_t native) {
  H5T_class_t kind = H5Tget_class(native);
  Hdf5Handle base(H5Tcopy(native), H5Tclose);
  if (kind == H5T_ENUM) {  // h5py's bool
    base = Hdf5Handle(H5Tget_super(native), H5Tclose);
    kind = H5Tget_class(base);
  }
  const size_t size = H5Tget_size(base);
  if (kind == H5T_FLOAT && size == 4) return StoredType{SampleType::float32, false, false};
  if (kind == H5T_FLOAT && size == 8) return StoredType{SampleType::float64, false, false};
  if (kind != H5T_INTEGER) return std::nullopt;
  const bool negative = H5Tget_sign(base) == H5T_SGN_2;
  if (size == 1) return StoredType{negative ? SampleType::int8 : SampleType::uint8, false, false};
  if (size == 2) return StoredType{negative ? SampleType::int16 : SampleType::uint16, false, false};
  if (size == 4 || size == 8)
    return StoredType{negative ? SampleType::int32 : SampleType::uint32, size == 8, false};
  return std::nullopt;
}

bool isVolume(hid_t dataset) {
  const std::vector<hsize_t> lengths = hdf5Lengths(dataset);
  const Hdf5Handle native = nativeType(dataset);
  return lengths.size() >= 3 && native && storedType(native);
}

/// The volumes that the links of a file lead to.
struct VolumeList {
  std::vector<std::vector<std::string>> volumes;  ///< all names of each, in the order of the links
  std::map<std::string, size_t> places;           ///< in `volumes`, of each object
  std::vector<std::string> otherGroups;  ///< links to groups of other files, which are not visited
  std::vector<std::string> deadLinks;    ///< links to other files that lead nowhere
};

/// Which object of which file it is, whatever link led to it.
std::string identityOf(hid_t object) {
#if H5_VERSION_GE(1, 12, 0)
  H5O_info2_t info;
  if (H5Oget_info3(object, &info, H5O_INFO_BASIC) < 0) return "";
  return std::to_string(info.fileno) + std::string(1, ' ') +
         std::string(reinterpret_cast<const char*>(&info.token), sizeof info.token);
#else
  H5O_info_t info;
  if (H5Oget_info2(object, &info, H5O_INFO_BASIC) < 0) return "";
  return std::to_string(info.fileno) + " " + std::to_string(info.addr);
#endif
}

void addVolume(VolumeList& list, const std::string& object, const std::string& name) {
  const auto [place, isNew] =
      list.places.emplace(object.empty() ? name : object, list.volumes.size());
  if (isNew) list.volumes.emplace_back();
  list.volumes[place->second].push_back(name);
}

/// Visits the links of a file; must not throw through the library.
herr_t collectVolume(hid_t group, const char* name, const H5L_info_t* link, void* to) {
  try {
    auto& list = *static_cast<VolumeList*>(to);
    const Hdf5Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
    const H5I_type_t type = object ? H5Iget_type(object) : H5I_BADID;
    if (type == H5I_DATASET && isVolume(object))
      addVolume(list, identityOf(object), name);
    else if (link->type == H5L_TYPE_EXTERNAL && type == H5I_GROUP)
      list.otherGroups.push_back(name);
    else if (link->type == H5L_TYPE_EXTERNAL && !object)
      list.deadLinks.push_back(name);
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

[[noreturn]] void failAtLink(const std::string& path, const std::string& name,
                             const std::string& target) {
  throw IoError(path + ": " + inQuotes(name) + " is a link to another file, " + target +
                ", that cannot be opened: put that file beside this one");
}

/// All names of the dataset that is wanted, the one to open first.
std::vector<std::string> namesOf(const std::string& path, hid_t file, const std::string& wanted) {
  VolumeList list;
  const bool visited = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, collectVolume, &list) >= 0;
  if (!wanted.empty()) {
    std::vector<std::string> names = {wanted};
    const Hdf5Handle dataset = openHdf5Dataset(file, wanted);
    const auto place = dataset ? list.places.find(identityOf(dataset)) : list.places.end();
    if (place != list.places.end())
      for (const std::string& name : list.volumes[place->second]) names.push_back(name);
    return names;
  }
  if (!visited) throw IoError(path + ": its list of datasets is damaged: name one", Hint::dataset);
  if (list.volumes.size() == 1) return list.volumes[0];
  if (list.volumes.empty() && !list.deadLinks.empty())
    failAtLink(path, list.deadLinks[0], missingHdf5Link(file, list.deadLinks[0]));
  if (list.volumes.empty() && !list.otherGroups.empty())
    throw IoError(path + ": holds no volume itself, and " + inQuotes(list.otherGroups[0]) +
                      " is a group of another file: name a dataset in it",
                  Hint::dataset);
  if (list.volumes.empty())
    throw IoError(path + ": holds no dataset of three dimensions with numbers in it");
  std::string text;
  for (size_t i = 0; i < list.volumes.size() && i < kMaxListed; ++i)
    text += (i ? ", " : "") + inQuotes(list.volumes[i][0]);
  throw IoError(path + ": choose one of its datasets: " + text +
                    (list.volumes.size() > kMaxListed ? " ..." : ""),
                Hint::dataset);
}

ImageSize sizeOf(const std::string& path, const std::string& name,
                 const std::vector<hsize_t>& lengths) {
  if (lengths.size() < 3)
    throw IoError(path + ": dataset " + inQuotes(name) + " has " + std::to_string(lengths.size()) +
                  " dimensions; only 3-D ones can be read");
  std::vector<int64_t> size;
  for (size_t i = 0; i < lengths.size(); ++i) {
    if (i + 3 < lengths.size() && lengths[i] != 1)
      throw IoError(path + ": dataset " + inQuotes(name) + " has " + std::to_string(lengths[i]) +
                    " volumes along axis " + std::to_string(i) +
                    ": save one as a dataset of its own");
    if (i + 3 >= lengths.size())
      size.insert(size.begin(), int64_t(std::min<hsize_t>(lengths[i], hsize_t(1) << 40)));
  }
  return checkedSize(path, size);
}

class Hdf5Reader : public ImageReader {
 public:
  Hdf5Reader(const std::string& path, Hdf5Handle file, const std::vector<std::string>& names)
      : file_(std::move(file)),
        name_(names.front()),
        dataset_(openHdf5Dataset(file_, name_)),
        native_(dataset_ ? nativeType(dataset_) : Hdf5Handle(-1, H5Tclose)) {
    path_ = path;
    files_ = {path};
    if (!dataset_) {
      const std::string target = missingHdf5Link(file_, name_);
      if (!target.empty()) failAtLink(path, name_, target);
      fail("cannot be opened: there is none or it is damaged");
    }
    lengths_ = hdf5Lengths(dataset_);
    const auto stored = native_ ? storedType(native_) : std::nullopt;
    if (!stored) fail("holds no integers, bool, float32 or float64");
    stored_ = *stored;
    info_.size = sizeOf(path, name_, lengths_);
    info_.type = stored_.type;
    info_.format = "hdf5";
    checkAxisNames(path, hdf5AxisNames(dataset_));
    info_.voxelSize = hdf5VoxelSize(path, file_, dataset_, names);
    checkStorage();
  }

  void read(int first, int count, void* samples) override {
    const Hdf5Quiet quiet;
    checkSlices(path_, info_, first, count);
    char* to = static_cast<char*>(samples);
    if (!stored_.is64Bit) return readStored(first, count, to);
    const size_t slice = size_t(info_.size.x) * size_t(info_.size.y);
    std::vector<char> piece(slice * stored_.bytes());
    for (int z = first; z < first + count; ++z, to += sliceBytes(info_)) {
      readStored(z, 1, piece.data());
      toSamples(path_, stored_, piece.data(), slice, to);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw IoError(path_ + ": dataset " + inQuotes(name_) + " " + why);
  }

  /// The files can hold what is claimed. Chunks are then kept from slab to slab.
  void checkStorage() {
    const Hdf5Sources sources = hdf5Sources(path_, name_, dataset_);
    files_.insert(files_.end(), sources.files.begin(), sources.files.end());
    const uint64_t held = sources.bytes;
    const uint64_t bytes = imageBytes(info_) / sampleSize(info_.type) * stored_.bytes();
    if (bytes / kMaxHdf5Expansion > held || held == 0)
      fail("has " + std::to_string(held) + " bytes in the file, too few for " +
           std::to_string(bytes) + " of samples");
    if (sources.isVirtual) return;
    const Hdf5Handle creation(H5Dget_create_plist(dataset_), H5Pclose);
    if (!creation || H5Pget_layout(creation) != H5D_CHUNKED) {
      const Hdf5Handle type(H5Dget_type(dataset_), H5Tclose);
      const uint64_t stored = type ? uint64_t(H5Tget_size(type)) : stored_.bytes();
      if (held < bytes / stored_.bytes() * stored) fail("is cut short");
      return;
    }
    std::vector<hsize_t> chunk(lengths_.size(), 1);
    if (H5Pget_chunk(creation, int(chunk.size()), chunk.data()) < 0) fail("is damaged");
    uint64_t chunkBytes = stored_.bytes();
    for (const hsize_t n : chunk)
      if (n < 1 || (chunkBytes *= n) > std::max(bytes, held * kMaxHdf5Expansion))
        fail("has chunks that are too large for it");
    const uint64_t depth =
        std::min<uint64_t>(chunk[chunk.size() - 3], lengths_[lengths_.size() - 3]);
    const uint64_t layer = bytes / lengths_[lengths_.size() - 3] * depth;
    const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access, kCacheSlots,
                       size_t(std::min(kMaxCacheBytes, layer * 2 + chunkBytes)), 1.0);
    dataset_.close();  // one that is open keeps its cache, whoever opens it again
    dataset_ = openHdf5Dataset(file_, name_, access);
    if (!dataset_) fail("cannot be opened again");
  }

  void readStored(int first, int count, void* to) const {
    std::vector<hsize_t> begin(lengths_.size(), 0), extent(lengths_);
    begin[begin.size() - 3] = hsize_t(first);
    extent[extent.size() - 3] = hsize_t(count);
    const Hdf5Handle file(H5Dget_space(dataset_), H5Sclose);
    const Hdf5Handle memory(H5Screate_simple(int(extent.size()), extent.data(), nullptr), H5Sclose);
    if (!file || !memory ||
        H5Sselect_hyperslab(file, H5S_SELECT_SET, begin.data(), nullptr, extent.data(), nullptr) <
            0 ||
        H5Dread(dataset_, native_, memory, file, H5P_DEFAULT, to) < 0)
      fail("cannot be read from slice " + std::to_string(first) + " on: " + missingFilter());
  }

  /// Why the library may have failed.
  std::string missingFilter() const {
    const Hdf5Handle creation(H5Dget_create_plist(dataset_), H5Pclose);
    const int count = creation ? H5Pget_nfilters(creation) : 0;
    for (int i = 0; i < count; ++i) {
      constexpr size_t kMaxName = 64;
      char name[kMaxName] = "";
      unsigned flags = 0, config = 0;
      size_t values = 0;
      const H5Z_filter_t filter =
          H5Pget_filter2(creation, unsigned(i), &flags, &values, nullptr, kMaxName, name, &config);
      if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
      name[kMaxName - 1] = '\0';
      return "its filter " + std::to_string(filter) + " " + inQuotes(name) +
             " is not installed: save it with gzip, or without";
    }
    return "it is damaged";
  }

  Hdf5Handle file_;
  std::string name_;
  Hdf5Handle dataset_, native_;
  std::vector<hsize_t> lengths_;  ///< as in the file: ... z, y, x
  StoredType stored_;
};

std::unique_ptr<ImageReader> openHere(const std::string& path, const std::string& dataset) {
  const Hdf5Quiet quiet;
  Hdf5Handle file = openHdf5File(path);
  if (!file) throw IoError(path + ": is damaged or no HDF5 file");
  const std::vector<std::string> names = namesOf(path, file, dataset);
  return std::make_unique<Hdf5Reader>(path, std::move(file), names);
}

}  // namespace

std::unique_ptr<ImageReader> openHdf5(const std::string& path, const std::string& dataset) {
  const InputFile exists(path);  // says better what is wrong with a path
  // The library (1.10 at least) crashes on many a damaged file. No writer of ours is within it, and
  // holds its lock for ever, while the process is copied.
  const Hdf5Turn turn;
  return openIsolated(path, [&] { return openHere(path, dataset); });
}

}  // namespace vdb_madf::detail
