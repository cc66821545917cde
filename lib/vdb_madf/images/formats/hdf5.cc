// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/hdf5.h"

#include <hdf5.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/isolated_reader.h"
#include "vdb_madf/images/detail/stored_type.h"

namespace vdb_madf::detail {

namespace {

/// Chunks up to this are kept for the next slabs.
constexpr uint64_t kMaxCacheBytes = uint64_t(256) << 20;
/// A prime number well above the chunks of a layer.
constexpr size_t kCacheSlots = 12421;
/// A byte of the file may stand for so many of samples: compression, and chunks that were never
/// written and hold the fill value.
constexpr uint64_t kMaxExpansion = uint64_t(1) << 16;
constexpr size_t kMaxListed = 8;
constexpr int kMaxAxes = 8;

/// An open object of the library.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  explicit operator bool() const { return id_ >= 0; }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// While it lives, the library does not print its errors.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

Handle openDataset(hid_t file, const std::string& name, hid_t access = H5P_DEFAULT) {
  return Handle(H5Dopen2(file, name.c_str(), access), H5Dclose);
}

/// The lengths of the axes; empty if there are none or too many.
std::vector<hsize_t> lengthsOf(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  if (!space) return {};
  const int axes = H5Sget_simple_extent_ndims(space);
  if (axes < 1 || axes > kMaxAxes) return {};
  std::vector<hsize_t> lengths(static_cast<size_t>(axes));
  if (H5Sget_simple_extent_dims(space, lengths.data(), nullptr) < 0) return {};
  return lengths;
}

/// The type that the samples have in memory.
Handle nativeType(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  return Handle(type ? H5Tget_native_type(type, H5T_DIR_ASCEND) : -1, H5Tclose);
}

/// Nothing for text, records, half floats ...
std::optional<StoredType> storedType(hid_t native) {
  H5T_class_t kind = H5Tget_class(native);
  Handle base(H5Tcopy(native), H5Tclose);
  if (kind == H5T_ENUM) {  // h5py's bool
    base = Handle(H5Tget_super(native), H5Tclose);
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
  const std::vector<hsize_t> lengths = lengthsOf(dataset);
  const Handle native = nativeType(dataset);
  return lengths.size() >= 3 && native && storedType(native);
}

/// Visits the links of a file; must not throw through the library.
herr_t collectVolume(hid_t group, const char* name, const H5L_info_t*, void* list) {
  try {
    const Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
    if (object && H5Iget_type(object) == H5I_DATASET && isVolume(object))
      static_cast<std::vector<std::string>*>(list)->push_back(name);
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

std::string onlyVolume(const std::string& path, hid_t file) {
  std::vector<std::string> volumes;
  if (H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, collectVolume, &volumes) < 0)
    throw IoError(path + ": its list of datasets is damaged: name one", Hint::dataset);
  if (volumes.size() == 1) return volumes[0];
  if (volumes.empty())
    throw IoError(path + ": holds no dataset of three dimensions with numbers in it");
  std::string list;
  for (size_t i = 0; i < volumes.size() && i < kMaxListed; ++i)
    list += (i ? ", " : "") + detail::quoted(volumes[i]);
  throw IoError(
      path + ": choose one of its datasets: " + list + (volumes.size() > kMaxListed ? " ..." : ""),
      Hint::dataset);
}

ImageSize sizeOf(const std::string& path, const std::string& name,
                 const std::vector<hsize_t>& lengths) {
  if (lengths.size() < 3)
    throw IoError(path + ": dataset " + detail::quoted(name) + " has " +
                  std::to_string(lengths.size()) + " dimensions; only 3-D ones can be read");
  std::vector<int64_t> size;
  for (size_t i = 0; i < lengths.size(); ++i) {
    if (i + 3 < lengths.size() && lengths[i] != 1)
      throw IoError(path + ": dataset " + detail::quoted(name) + " has " +
                    std::to_string(lengths[i]) + " volumes along axis " + std::to_string(i) +
                    ": save one as a dataset of its own");
    if (i + 3 >= lengths.size())
      size.insert(size.begin(), int64_t(std::min<hsize_t>(lengths[i], hsize_t(1) << 40)));
  }
  return checkedSize(path, size);
}

std::optional<VoxelSize> elementSize(const std::string& path, hid_t dataset) {
  const char* name = "element_size_um";
  if (H5Aexists(dataset, name) <= 0) return std::nullopt;
  const Handle attribute(H5Aopen(dataset, name, H5P_DEFAULT), H5Aclose);
  const Handle space(attribute ? H5Aget_space(attribute) : -1, H5Sclose);
  double edges[3] = {};
  if (!space || H5Sget_simple_extent_npoints(space) != 3 ||
      H5Aread(attribute, H5T_NATIVE_DOUBLE, edges) < 0)
    throw IoError(path + ": the attribute element_size_um cannot be read as three numbers");
  return cubicVoxelSize(path, {edges[2], edges[1], edges[0]}, unitsPerMetre("um"));
}

class Hdf5Reader : public ImageReader {
 public:
  Hdf5Reader(const std::string& path, Handle file, const std::string& name)
      : file_(std::move(file)),
        name_(name),
        dataset_(openDataset(file_, name)),
        native_(dataset_ ? nativeType(dataset_) : Handle(-1, H5Tclose)) {
    path_ = path;
    files_ = {path};
    if (!dataset_) fail("cannot be opened: there is none or it is damaged");
    lengths_ = lengthsOf(dataset_);
    const auto stored = native_ ? storedType(native_) : std::nullopt;
    if (!stored) fail("holds no integers, bool, float32 or float64");
    stored_ = *stored;
    info_.size = sizeOf(path, name, lengths_);
    info_.type = stored_.type;
    info_.format = "hdf5";
    info_.voxelSize = elementSize(path, dataset_);
    checkStorage();
  }

  void read(int first, int count, void* samples) override {
    const Quiet quiet;
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
    throw IoError(path_ + ": dataset " + detail::quoted(name_) + " " + why);
  }

  /// The file can hold what is claimed. Chunks are then kept from slab to slab.
  void checkStorage() {
    const uint64_t held =
        std::min<uint64_t>(H5Dget_storage_size(dataset_), InputFile(path_).size());
    const uint64_t bytes = imageBytes(info_) / sampleSize(info_.type) * stored_.bytes();
    if (bytes / kMaxExpansion > held || held == 0)
      fail("has " + std::to_string(held) + " bytes in the file, too few for " +
           std::to_string(bytes) + " of samples");
    const Handle creation(H5Dget_create_plist(dataset_), H5Pclose);
    if (!creation || H5Pget_layout(creation) != H5D_CHUNKED) {
      if (held < bytes) fail("is cut short");
      return;
    }
    std::vector<hsize_t> chunk(lengths_.size(), 1);
    if (H5Pget_chunk(creation, int(chunk.size()), chunk.data()) < 0) fail("is damaged");
    uint64_t chunkBytes = stored_.bytes();
    for (const hsize_t n : chunk)
      if (n < 1 || (chunkBytes *= n) > std::max(bytes, held * kMaxExpansion))
        fail("has chunks that are too large for it");
    const uint64_t depth =
        std::min<uint64_t>(chunk[chunk.size() - 3], lengths_[lengths_.size() - 3]);
    const uint64_t layer = bytes / lengths_[lengths_.size() - 3] * depth;
    const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access, kCacheSlots,
                       size_t(std::min(kMaxCacheBytes, layer * 2 + chunkBytes)), 1.0);
    dataset_ = openDataset(file_, name_, access);
    if (!dataset_) fail("cannot be opened again");
  }

  void readStored(int first, int count, void* to) const {
    std::vector<hsize_t> begin(lengths_.size(), 0), extent(lengths_);
    begin[begin.size() - 3] = hsize_t(first);
    extent[extent.size() - 3] = hsize_t(count);
    const Handle file(H5Dget_space(dataset_), H5Sclose);
    const Handle memory(H5Screate_simple(int(extent.size()), extent.data(), nullptr), H5Sclose);
    if (!file || !memory ||
        H5Sselect_hyperslab(file, H5S_SELECT_SET, begin.data(), nullptr, extent.data(), nullptr) <
            0 ||
        H5Dread(dataset_, native_, memory, file, H5P_DEFAULT, to) < 0)
      fail("cannot be read from slice " + std::to_string(first) +
           " on: it is damaged, or has a filter that is not installed");
  }

  Handle file_;
  std::string name_;
  Handle dataset_, native_;
  std::vector<hsize_t> lengths_;  ///< as in the file: ... z, y, x
  StoredType stored_;
};

std::unique_ptr<ImageReader> openHere(const std::string& path, const std::string& dataset) {
  const Quiet quiet;
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) throw IoError(path + ": is damaged or no HDF5 file");
  const std::string name = dataset.empty() ? onlyVolume(path, file) : dataset;
  return std::make_unique<Hdf5Reader>(path, std::move(file), name);
}

}  // namespace

std::unique_ptr<ImageReader> openHdf5(const std::string& path, const std::string& dataset) {
  const InputFile exists(path);  // says better what is wrong with a path
  // The library (1.10 at least) crashes on many a damaged file.
  return openIsolated(path, [&] { return openHere(path, dataset); });
}

}  // namespace vdb_madf::detail
