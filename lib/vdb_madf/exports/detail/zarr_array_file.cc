// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/zarr_array_file.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/labels/detail/label_blocks.h"

namespace vdb_madf::detail {

namespace {

using Json = nlohmann::ordered_json;
using Leaf = Int32Tree::LeafNodeType;

/// Labels are mostly runs: more effort gains little.
constexpr int kGzipLevel = 3;
/// zlib's widest window, and gzip's header (without name and time).
constexpr int kGzipWindow = 15 + 16;

std::string within(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

Json zyx(const Coord& c) {
  return Json::array({c.z(), c.y(), c.x()});
}

std::string gzipped(const std::vector<unsigned char>& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, kGzipLevel, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string coded(deflateBound(&stream, uLong(bytes.size())), '\0');
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<unsigned char*>(coded.data());
  stream.avail_out = uInt(coded.size());
  const int result = deflate(&stream, Z_FINISH);
  coded.resize(size_t(stream.total_out));
  deflateEnd(&stream);
  if (result != Z_STREAM_END) throw std::bad_alloc();
  return coded;
}

size_t voxelsOf(const Coord& edges) {
  return size_t(edges.x()) * size_t(edges.y()) * size_t(edges.z());
}

/// The chunks of a box that leaves reach into, within some slices, each with these leaves.
class Chunks {
 public:
  Chunks(const Int32Tree& tree, const CoordBBox& box, const Coord& edges, const CoordBBox& slices)
      : box_(box), edges_(edges) {
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
      CoordBBox part = leaf->getNodeBoundingBox();
      part.intersect(slices);
      if (part.empty()) continue;
      const Coord first = chunkOf(part.min()), last = chunkOf(part.max());
      for (int x = first.x(); x <= last.x(); ++x)
        for (int y = first.y(); y <= last.y(); ++y)
          for (int z = first.z(); z <= last.z(); ++z) pieces_.push_back({Coord(x, y, z), &*leaf});
    }
    std::sort(pieces_.begin(), pieces_.end());
    for (size_t i = 0; i < pieces_.size(); ++i)
      if (i == 0 || pieces_[i].chunk != pieces_[i - 1].chunk) first_.push_back(i);
    first_.push_back(pieces_.size());
  }

  size_t count() const { return first_.size() - 1; }
  const Coord& number(size_t i) const { return pieces_[first_[i]].chunk; }
  size_t voxels() const { return voxelsOf(edges_); }

  /// f(place in the chunk, x fastest; label) for the labeled voxels of a chunk within the box.
  template <typename F>
  void forEachLabel(size_t i, const F& f) const {
    const Coord& chunk = number(i);
    const Coord low =
        box_.min().offsetBy(chunk.x() * edges_.x(), chunk.y() * edges_.y(), chunk.z() * edges_.z());
    for (size_t piece = first_[i]; piece < first_[i + 1]; ++piece) {
      const Leaf& leaf = *pieces_[piece].leaf;
      const int32_t* values = leaf.buffer().data();
      CoordBBox part = leaf.getNodeBoundingBox();
      part.intersect(CoordBBox(low, low + edges_.offsetBy(-1)));
      part.intersect(box_);
      for (int x = part.min().x(); x <= part.max().x(); ++x)
        for (int y = part.min().y(); y <= part.max().y(); ++y)
          for (int z = part.min().z(); z <= part.max().z(); ++z)
            if (const int32_t label = labelAt(leaf, values, Leaf::coordToOffset({x, y, z})))
              f(placeOf(Coord(x, y, z) - low), label);
    }
  }

 private:
  struct Piece {
    Coord chunk;
    const Leaf* leaf;
    bool operator<(const Piece& o) const {
      return chunk != o.chunk ? chunk < o.chunk : leaf->origin() < o.leaf->origin();
    }
  };

  Coord chunkOf(const Coord& p) const {
    const Coord from = p - box_.min();
    return {from.x() / edges_.x(), from.y() / edges_.y(), from.z() / edges_.z()};
  }
  size_t placeOf(const Coord& p) const {
    return (size_t(p.z()) * size_t(edges_.y()) + size_t(p.y())) * size_t(edges_.x()) +
           size_t(p.x());
  }

  CoordBBox box_;
  Coord edges_;
  std::vector<Piece> pieces_;
  std::vector<size_t> first_;
};

/// The samples of a chunk; empty if all are 0.
std::vector<unsigned char> samplesOf(const Chunks& chunks, size_t i, ZarrSamples samples) {
  const bool isWide = samples == ZarrSamples::label;
  std::vector<unsigned char> bytes(chunks.voxels() * (isWide ? 4 : 1));
  bool isEmpty = true;
  chunks.forEachLabel(i, [&](size_t place, int32_t label) {
    isEmpty = false;
    if (!isWide) {
      bytes[place] = samples == ZarrSamples::mask ? 255 : static_cast<unsigned char>(label);
      return;
    }
    for (int byte = 0; byte < 4; ++byte)  // little-endian
      bytes[4 * place + size_t(byte)] = static_cast<unsigned char>(uint32_t(label) >> 8 * byte);
  });
  if (isEmpty) bytes.clear();
  return bytes;
}

}  // namespace

ZarrArray::ZarrArray(const OutputTree& folder, std::string name, const CoordBBox& box,
                     ZarrSamples samples, ZarrVersion version)
    : folder_(folder), name_(std::move(name)), box_(box), samples_(samples), version_(version) {
  for (int axis = 0; axis < 3; ++axis) edges_[axis] = std::min(kZarrChunk, box.dim()[axis]);
  writeDescription();
}

int ZarrArray::layerCount() const {
  return (box_.dim().z() + edges_.z() - 1) / edges_.z();
}

void ZarrArray::write(const Int32Tree& values, int begin, int end, Interrupter* interrupter) {
  CoordBBox slices = box_;
  slices.min().z() = firstSlice(begin);
  slices.max().z() = std::min(firstSlice(end) - 1, box_.max().z());
  const Chunks chunks(values, box_, edges_, slices);
  parallelFor(chunks.count(), 1, interrupter, [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const auto bytes = samplesOf(chunks, i, samples_);
      if (bytes.empty()) continue;
      isEmpty_ = false;
      folder_.write(chunkName(chunks.number(i)), gzipped(bytes));
    }
  });
}

void ZarrArray::finish() const {
  const size_t bytes = voxelsOf(edges_) * (samples_ == ZarrSamples::label ? 4 : 1);
  if (isEmpty_) folder_.write(chunkName(Coord(0)), gzipped(std::vector<unsigned char>(bytes)));
}

std::string ZarrArray::chunkName(const Coord& number) const {
  return within(name_, (version_ == ZarrVersion::three ? "c/" : "") + std::to_string(number.z()) +
                           "/" + std::to_string(number.y()) + "/" + std::to_string(number.x()));
}

void ZarrArray::writeDescription() const {
  const bool isWide = samples_ == ZarrSamples::label;
  Json json;
  json["zarr_format"] = int(version_);
  if (version_ == ZarrVersion::two) {
    json["shape"] = zyx(box_.dim());
    json["chunks"] = zyx(edges_);
    json["dtype"] = isWide ? "<u4" : "|u1";
    json["compressor"] = {{"id", "gzip"}, {"level", kGzipLevel}};
    json["filters"] = nullptr;
    json["fill_value"] = 0;
    json["order"] = "C";
    json["dimension_separator"] = "/";
    return folder_.write(within(name_, ".zarray"), json.dump(2) + "\n");
  }
  json["node_type"] = "array";
  json["shape"] = zyx(box_.dim());
  json["data_type"] = isWide ? "uint32" : "uint8";
  json["chunk_grid"] = {{"name", "regular"}, {"configuration", {{"chunk_shape", zyx(edges_)}}}};
  json["chunk_key_encoding"] = {{"name", "default"}, {"configuration", {{"separator", "/"}}}};
  json["fill_value"] = 0;
  json["codecs"] = Json::array({{{"name", "bytes"}, {"configuration", {{"endian", "little"}}}},
                                {{"name", "gzip"}, {"configuration", {{"level", kGzipLevel}}}}});
  json["dimension_names"] = {"z", "y", "x"};
  folder_.write(within(name_, "zarr.json"), json.dump(2) + "\n");
}

void writeZarrGroup(const OutputTree& folder, const std::string& name,
                    const std::string& attributes, ZarrVersion version) {
  if (version == ZarrVersion::three) {
    folder.write(
        within(name, "zarr.json"),
        "{\"zarr_format\": 3, \"node_type\": \"group\", \"attributes\": " + attributes + "}\n");
    return;
  }
  folder.write(within(name, ".zgroup"), "{\"zarr_format\": 2}\n");
  folder.write(within(name, ".zattrs"), attributes + "\n");
}

}  // namespace vdb_madf::detail
