// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/files/detail/hdf5_output.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/slice_counter.h"
#include "vdb_madf/images/formats/formats.h"

namespace vdb_madf::detail {

namespace {

constexpr const char* kDataset = "data";
/// Of a chunk: along z as a slab, so that a layer of chunks is no more than that.
constexpr int kChunkDepth = 8, kChunkSide = 128;
/// Labels and masks shrink tenfold at the fastest level already.
constexpr unsigned kHdf5DeflateLevel = 1;

struct FileType {
  hid_t file, memory;
};

FileType fileType(SampleType type) {
  switch (type) {
    case SampleType::uint8:
      return {H5T_STD_U8LE, H5T_NATIVE_UINT8};
    case SampleType::int8:
      return {H5T_STD_I8LE, H5T_NATIVE_INT8};
    case SampleType::uint16:
      return {H5T_STD_U16LE, H5T_NATIVE_UINT16};
    case SampleType::int16:
      return {H5T_STD_I16LE, H5T_NATIVE_INT16};
    case SampleType::uint32:
      return {H5T_STD_U32LE, H5T_NATIVE_UINT32};
    case SampleType::int32:
      return {H5T_STD_I32LE, H5T_NATIVE_INT32};
    case SampleType::float32:
      return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT};
    case SampleType::float64:
      break;
  }
  return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE};
}

class Hdf5Writer : public ImageWriter {
 public:
  Hdf5Writer(const std::string& path, const ImageInfo& info)
      : counter_(path, info), type_(fileType(info.type)), dataset_(-1, H5Dclose) {
    const Hdf5Turn turn;
    file_.emplace(path);
    const std::array<hsize_t, 3> shape = {hsize_t(info.size.z), hsize_t(info.size.y),
                                          hsize_t(info.size.x)};
    const hsize_t chunk[] = {std::min<hsize_t>(shape[0], kChunkDepth),
                             std::min<hsize_t>(shape[1], kChunkSide),
                             std::min<hsize_t>(shape[2], kChunkSide)};
    const Hdf5Handle creation = timelessDataset();
    file_->check(H5Pset_chunk(creation, 3, chunk) >= 0 && H5Pset_shuffle(creation) >= 0 &&
                 H5Pset_deflate(creation, kHdf5DeflateLevel) >= 0);
    const Hdf5Handle space(H5Screate_simple(3, shape.data(), nullptr), H5Sclose);
    dataset_ = file_->checked(Hdf5Handle(
        H5Dcreate2(file_->id(), kDataset, type_.file, space, H5P_DEFAULT, creation, H5P_DEFAULT),
        H5Dclose));
    if (info.voxelSize) writeEdges(info.voxelSize->edges());
    layer_.resize(size_t(sliceBytes(info)) * chunk[0]);
  }

  ~Hdf5Writer() override {
    const Hdf5Turn turn;
    dataset_.close();
    file_.reset();
  }

  void write(int count, const void* samples) override {
    const char* from = static_cast<const char*>(samples);
    for (size_t left = counter_.add(count); left > 0;) {
      const size_t part = std::min(left, layer_.size() - filled_);
      std::memcpy(layer_.data() + filled_, from, part);
      from += part;
      filled_ += part;
      left -= part;
      if (filled_ == layer_.size()) writeLayer();
    }
  }

  void finish() override {
    counter_.finish();
    writeLayer();
    const Hdf5Turn turn;
    file_->check(dataset_.close() >= 0);
    file_->commit();
  }

 private:
  /// In micrometers, in the order of the axes.
  void writeEdges(const std::array<double, 3>& edges) {
    double values[3];
    for (size_t axis = 0; axis < 3; ++axis)
      values[axis] = reals(lengthIn(unitsPerMetre("um").value(), edges[2 - axis])).value().at(0);
    file_->check(writeHdf5Attribute(dataset_, "element_size_um", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
                                    3, values));
  }

  /// Whole chunks, so that each is compressed once.
  void writeLayer() {
    if (filled_ == 0) return;
    const Hdf5Turn turn;
    const ImageInfo& info = counter_.info();
    const hsize_t begin[] = {written_, 0, 0},
                  size[] = {filled_ / sliceBytes(info), hsize_t(info.size.y), hsize_t(info.size.x)};
    const Hdf5Handle to(H5Dget_space(dataset_), H5Sclose),
        from(H5Screate_simple(3, size, nullptr), H5Sclose);
    file_->check(to && from &&
                 H5Sselect_hyperslab(to, H5S_SELECT_SET, begin, nullptr, size, nullptr) >= 0 &&
                 H5Dwrite(dataset_, type_.memory, from, to, H5P_DEFAULT, layer_.data()) >= 0);
    written_ += size[0];
    filled_ = 0;
  }

  SliceCounter counter_;
  FileType type_;
  std::optional<Hdf5Output> file_;
  Hdf5Handle dataset_;
  std::vector<char> layer_;  ///< slices of a layer of chunks
  size_t filled_ = 0;        ///< bytes of it
  hsize_t written_ = 0;      ///< slices
};

}  // namespace

std::unique_ptr<ImageWriter> createHdf5(const std::string& path, const ImageInfo& info) {
  return std::make_unique<Hdf5Writer>(path, info);
}

}  // namespace vdb_madf::detail
