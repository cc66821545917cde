// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/zarr_description.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/json_text.h"
#include "vdb_madf/images/detail/sample_conversion.h"

namespace vdb_madf::detail {

namespace {

using Compressor = ZarrCodec::Compressor;

constexpr uint64_t kMaxSide = kMaxImageSide;
constexpr size_t kMaxAxes = 8;
/// More codecs than this are no honest array.
constexpr size_t kMaxCodecs = 8;

std::string quotedJson(const Json& json) {
  return detail::inQuotes(json.dump(-1, ' ', true, Json::error_handler_t::replace));
}

/// The axes of a shape: x, y, z of the last three, the others have to be 1.
ImageSize lastThree(const std::string& name, const char* key, const Json& shape) {
  if (!shape.is_array() || shape.size() < 3 || shape.size() > kMaxAxes)
    throw IoError(name + ": its " + key + " " + quotedJson(shape) +
                      " is not that of a volume: choose another array",
                  Hint::dataset);
  ImageSize last;
  for (size_t i = 0; i < shape.size(); ++i) {
    const Json& length = shape[i];
    if (!length.is_number_unsigned() || length.get<uint64_t>() < 1 ||
        length.get<uint64_t>() > kMaxSide)
      throw IoError(name + ": its " + key + " " + quotedJson(shape) + " is not within 1 .. " +
                    std::to_string(kMaxSide) + " a side");
    const auto n = length.get<uint64_t>();
    if (i + 3 >= shape.size())
      last[int(shape.size() - 1 - i)] = int(n);
    else if (n != 1)
      throw IoError(name + ": has " + std::to_string(n) + " volumes along axis " +
                    std::to_string(i) + ": save one as an array of its own");
  }
  return last;
}

/// The fill value as a sample; null and what is absent are 0.
template <typename T>
bool fillSample(const Json& fill, T& sample) {
  sample = T(0);
  if (fill.is_null()) return true;
  if (fill.is_boolean()) {
    sample = T(fill.get<bool>());
    return true;
  }
  if constexpr (std::is_floating_point_v<T>) {
    const std::string text = textOf(fill);
    if (text == "NaN") sample = std::numeric_limits<T>::quiet_NaN();
    if (text == "Infinity") sample = std::numeric_limits<T>::infinity();
    if (text == "-Infinity") sample = -std::numeric_limits<T>::infinity();
    if (!text.empty()) return sample != 0;
  }
  if (!fill.is_number()) return false;
  const double value = fill.get<double>();
  if (!fits<T>(value)) return false;
  sample = T(value);
  return true;
}

void setFill(const std::string& name, const Json& fill, ZarrDescription& array) {
  const bool filled = withSampleType(array.stored.type, [&](auto sample) {
    const bool good = fillSample(fill, sample);
    std::memcpy(array.fill.data(), &sample, sizeof sample);
    return good;
  });
  if (!filled)
    throw IoError(name + ": its fill value " + quotedJson(fill) + " is no " +
                  sampleTypeName(array.stored.type));
}

/// The shape and that of what its chunks, or shards, are.
ImageSize setShapes(const std::string& name, const Json& shape, const Json& chunks,
                    ZarrDescription& array) {
  array.size = lastThree(name, "shape", shape);
  const ImageSize chunk = lastThree(name, "chunks", chunks);
  array.leading = shape.size() - 3;
  if (chunks.size() != shape.size())
    throw IoError(name + ": its shape and its chunks have different numbers of axes");
  return chunk;
}

/// \p order: the axes as they are stored, the last is the fastest.
void setChunk(const std::string& name, const ImageSize& chunk, const std::vector<size_t>& order,
              ZarrDescription& array) {
  array.chunk = chunk;
  uint64_t step = 1;  // < 2^60
  for (size_t i = order.size(); i-- > 0;) {
    if (order[i] < array.leading) continue;
    const size_t axis = order.size() - 1 - order[i];  // x: 0
    array.stride[axis] = step;
    step *= uint64_t(chunk[int(axis)]);
  }
  if (array.chunkSamples() > kMaxZarrChunkBytes / array.stored.bytes())
    throw IoError(name + ": its chunks are larger than 2 GB");
}

std::vector<size_t> orderOf(size_t axes, bool isReversed) {
  std::vector<size_t> order(axes);
  std::iota(order.begin(), order.end(), size_t(0));
  if (isReversed) std::reverse(order.begin(), order.end());
  return order;
}

/// What version 3 calls by a name, alone or with its configuration.
struct Named {
  std::string name;
  const Json& configuration;
};
Named named(const Json& json) {
  return {json.is_string() ? textOf(json) : textOf(member(json, "name")),
          member(json, "configuration")};
}

std::optional<Compressor> compressorOf(const std::string& codec) {
  if (codec == "blosc") return Compressor::blosc;
  if (codec == "gzip") return Compressor::deflate;
  if (codec == "zstd") return Compressor::zstd;
  return std::nullopt;
}

[[noreturn]] void refuseCodec(const std::string& name, const std::string& codec) {
  throw IoError(name + ": its codec " + detail::inQuotes(codec) +
                " cannot be read in its place: first transpose, then bytes or sharding_indexed, "
                "then gzip, zstd or blosc, and crc32c");
}

bool isBigEndian(const std::string& name, const Json& configuration, size_t sampleBytes) {
  const std::string endian = textOf(member(configuration, "endian"));
  if (endian == "big") return true;
  if (endian != "little" && sampleBytes > 1)
    throw IoError(name + ": its codec bytes has no byte order");
  return false;
}

/// The codecs of a chunk, of an array with the known shape and type.
class CodecChain {
 public:
  CodecChain(const std::string& name, const Json& codecs, size_t axes)
      : name_(name), order_(orderOf(axes, false)) {
    if (!codecs.is_array() || codecs.empty() || codecs.size() > kMaxCodecs)
      throw IoError(name + ": its codecs " + quotedJson(codecs) + " are none that can be read");
    size_t i = 0;
    for (; i < codecs.size() && named(codecs[i]).name == "transpose"; ++i)
      transpose(named(codecs[i]).configuration);
    if (i == codecs.size()) throw IoError(name + ": its codecs make no bytes");
    toBytes_ = &codecs[i];
    if (toBytes().name != "bytes" && toBytes().name != "sharding_indexed")
      refuseCodec(name, toBytes().name);
    for (++i; i < codecs.size(); ++i) addBytesCodec(named(codecs[i]).name);
  }

  Named toBytes() const { return named(*toBytes_); }
  const std::vector<size_t>& order() const { return order_; }
  const ZarrCodec& codec() const { return codec_; }
  /// True if samples are coded as they lie.
  bool isPlain() const {
    return codec_.compressor == Compressor::none && codec_.innerSums == 0 && isInOrder();
  }
  bool isInOrder() const { return order_ == orderOf(order_.size(), false); }

 private:
  /// Axis i of what comes out is the axis order[i] of what goes in.
  void transpose(const Json& configuration) {
    const Json& order = member(configuration, "order");
    std::vector<size_t> next;
    std::vector<bool> isUsed(order_.size());
    if (order.is_array() && order.size() == order_.size())
      for (const Json& axis : order) {
        if (!axis.is_number_unsigned() || axis.get<uint64_t>() >= order_.size() ||
            isUsed[axis.get<size_t>()])
          break;
        isUsed[axis.get<size_t>()] = true;
        next.push_back(order_[axis.get<size_t>()]);
      }
    if (next.size() != order_.size())
      throw IoError(name_ + ": its codec transpose has the order " + quotedJson(order) +
                    ", which is none of its axes");
    order_ = next;
  }

  void addBytesCodec(const std::string& codec) {
    if (codec == "crc32c") {
      ++(codec_.compressor == Compressor::none ? codec_.innerSums : codec_.outerSums);
      return;
    }
    const auto compressor = compressorOf(codec);
    if (!compressor) refuseCodec(name_, codec);
    if (codec_.compressor != Compressor::none)
      throw IoError(name_ + ": is compressed twice, which cannot be read");
    codec_.compressor = *compressor;
  }

  std::string name_;
  std::vector<size_t> order_;
  const Json* toBytes_ = nullptr;
  ZarrCodec codec_;
};

void setBytes(const std::string& name, const CodecChain& chain, const ImageSize& chunk,
              ZarrDescription& array) {
  array.stored.bigEndian = isBigEndian(name, chain.toBytes().configuration, array.stored.bytes());
  array.codec = chain.codec();
  setChunk(name, chunk, chain.order(), array);
}

void setShards(const std::string& name, const CodecChain& outer, const ImageSize& shard,
               ZarrDescription& array) {
  const size_t axes = array.leading + 3;
  const Json& configuration = outer.toBytes().configuration;
  if (!outer.isPlain()) throw IoError(name + ": has codecs besides sharding, which cannot be read");
  const ImageSize chunk = lastThree(name, "chunk_shape", member(configuration, "chunk_shape"));
  if (member(configuration, "chunk_shape").size() != axes)
    throw IoError(name + ": its shards and its chunks have different numbers of axes");
  for (int axis = 0; axis < 3; ++axis)
    if (shard[axis] % chunk[axis] != 0)
      throw IoError(name + ": its shards are no multiples of its chunks");
  const CodecChain inner(name, member(configuration, "codecs"), axes);
  if (inner.toBytes().name == "sharding_indexed")
    throw IoError(name + ": has shards within shards, which cannot be read");
  const CodecChain index(name, member(configuration, "index_codecs"), axes + 1);
  if (index.toBytes().name != "bytes" || !index.isInOrder() ||
      index.codec().compressor != Compressor::none)
    throw IoError(name + ": the index of its shards is coded otherwise than as bytes and crc32c");
  const Json& location = member(configuration, "index_location");
  if (!location.is_null() && location != "end" && location != "start")
    throw IoError(name + ": the index of its shards is at " + quotedJson(location) +
                  ", not at start or end");
  setBytes(name, inner, chunk, array);
  array.isSharded = true;
  array.shards = {shard, location == "start",
                  isBigEndian(name, index.toBytes().configuration, sizeof(uint64_t)),
                  index.codec().innerSums};
}

/// Nothing may be there that a reader has to understand and this one does not.
void checkKeys(const std::string& name, const Json& json) {
  for (const auto& [key, value] : json.items()) {
    bool isKnown = false;
    for (const char* known :
         {"zarr_format", "node_type", "shape", "data_type", "chunk_grid", "chunk_key_encoding",
          "fill_value", "codecs", "attributes", "storage_transformers", "dimension_names"})
      isKnown = isKnown || key == known;
    if (!isKnown && member(value, "must_understand") != false)
      throw IoError(name + ": its description has " + detail::inQuotes(key) +
                    ", which cannot be read");
  }
  const Json& transformers = member(json, "storage_transformers");
  if (!transformers.is_null() && !(transformers.is_array() && transformers.empty()))
    throw IoError(name + ": has storage transformers, which cannot be undone: save it without");
}

std::optional<StoredType> storedTypeNamed(const std::string& type) {
  StoredType stored;
  if (type == "bool") return stored;
  stored.is64Bit = type == "int64" || type == "uint64";
  const auto sample = stored.is64Bit ? (type == "int64" ? SampleType::int32 : SampleType::uint32)
                                     : sampleTypeFromName(type);
  if (!sample) return std::nullopt;
  stored.type = *sample;
  return stored;
}

[[noreturn]] void refuseType(const std::string& name, const Json& type) {
  throw IoError(name + ": its type " + quotedJson(type) +
                " cannot be read: save integers, bool, float32 or float64");
}

void setKeys(const std::string& name, const Json& encoding, ZarrDescription& array) {
  const Named keys = named(encoding);
  if (keys.name != "default" && keys.name != "v2")
    throw IoError(name + ": its chunk keys are " + quotedJson(encoding) +
                  ", which cannot be read; only default and v2");
  const std::string separator = textOf(member(keys.configuration, "separator"));
  array.separator = keys.name == "default" ? '/' : '.';
  if (separator == "/" || separator == ".") array.separator = separator[0];
  if (keys.name == "default") array.keyPrefix = std::string("c") + array.separator;
}

}  // namespace

ZarrDescription readZarr2(const std::string& name, const std::string& path) {
  const Json json = jsonObject(name, path);
  if (member(json, "zarr_format") != 2)
    throw IoError(name + ": its description .zarray is not that of Zarr version 2");
  ZarrDescription array;
  const Json& shape = member(json, "shape");
  const ImageSize chunk = setShapes(name, shape, member(json, "chunks"), array);
  const Json& type = member(json, "dtype");
  const auto stored = storedTypeFromNumpy(textOf(type));
  if (!stored) refuseType(name, type);
  array.stored = *stored;
  const Json &compressor = member(json, "compressor"), &filters = member(json, "filters");
  const std::string codec = textOf(member(compressor, "id"));
  if (!compressor.is_null()) {
    const auto known = codec == "zlib" ? Compressor::deflate : compressorOf(codec);
    if (!known)
      throw IoError(name + ": its compressor " + detail::inQuotes(codec) +
                    " cannot be read; only blosc, zlib, gzip and zstd");
    array.codec.compressor = *known;
  }
  if (!filters.is_null() && !(filters.is_array() && filters.empty()))
    throw IoError(name + ": has filters, which cannot be undone: save it without");
  setFill(name, member(json, "fill_value"), array);
  array.separator = textOf(member(json, "dimension_separator")) == "/" ? '/' : '.';
  setChunk(name, chunk, orderOf(shape.size(), textOf(member(json, "order")) == "F"), array);
  return array;
}

ZarrDescription readZarr3(const std::string& name, const std::string& path) {
  const Json json = jsonObject(name, path);
  if (member(json, "zarr_format") != 3 || member(json, "node_type") != "array")
    throw IoError(name + ": its description zarr.json is not that of an array of Zarr version 3");
  checkKeys(name, json);
  checkAxisNames(name, textsOf(member(json, "dimension_names")));
  ZarrDescription array;
  const Named grid = named(member(json, "chunk_grid"));
  if (grid.name != "regular")
    throw IoError(name + ": its chunks are " + quotedJson(member(json, "chunk_grid")) +
                  ", which cannot be read: only a regular grid");
  const ImageSize chunk =
      setShapes(name, member(json, "shape"), member(grid.configuration, "chunk_shape"), array);
  const Json& type = member(json, "data_type");
  const auto stored = storedTypeNamed(textOf(type));
  if (!stored) refuseType(name, type);
  array.stored = *stored;
  const CodecChain codecs(name, member(json, "codecs"), array.leading + 3);
  if (codecs.toBytes().name == "sharding_indexed")
    setShards(name, codecs, chunk, array);
  else
    setBytes(name, codecs, chunk, array);
  setFill(name, member(json, "fill_value"), array);
  setKeys(name, member(json, "chunk_key_encoding"), array);
  return array;
}

}  // namespace vdb_madf::detail
