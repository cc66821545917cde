// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/glb_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "vdb_madf/base/version.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/labels/grain_name.h"

namespace vdb_madf::detail {

namespace {

using Json = nlohmann::ordered_json;
using openvdb::Vec3d;
using openvdb::Vec3f;

// Numbers of the format.
constexpr uint32_t kMagic = 0x46546c67, kVersion2 = 2, kJsonChunk = 0x4e4f534a,
                   kBinaryChunk = 0x004e4942;
constexpr int kUint16 = 5123, kUint32 = 5125, kFloat = 5126, kVertices = 34962, kIndices = 34963;
constexpr uint64_t kHeaderBytes = 12, kChunkHeaderBytes = 8, kPointBytes = sizeof(Vec3f);
/// The largest index of a type stands for none, so a grain has at most so many points of 16 bits.
constexpr uint32_t kMaxShortPoints = 0xffff;

constexpr uint64_t padded(uint64_t bytes) {
  return (bytes + 3) / 4 * 4;
}

void requireRoom(const std::string& path, uint64_t bytes) {
  if (bytes > std::numeric_limits<uint32_t>::max())
    throw InvalidInput(path + ": a .glb holds 4 GiB, and the mesh takes " +
                       std::to_string((bytes >> 30) + 1) +
                       ": ask for fewer triangles, or write .ply");
}

/// glTF has y upwards, where we have z: a quarter of a turn, which its readers undo.
Vec3f turned(const Vec3f& p) {
  return {p.x(), p.z(), -p.y()};
}

Json triple(const Vec3f& p) {
  return {p[0], p[1], p[2]};
}

/// A list of so many items, each written by itself: there may be a hundred thousand.
template <typename Item>
std::string list(const std::string& name, size_t count, const Item& item) {
  std::string text;
  for (size_t i = 0; i < count; ++i) text += (i ? "," : "") + Json(item(i)).dump();
  return count ? ",\"" + name + "\":[" + text + "]" : "";  // the format has no empty lists
}

class GlbFile {
 public:
  GlbFile(const WorldMesh& world, const MeshFileOptions& options)
      : world_(world), options_(options) {
    bytes_ = indexStart();
    for (size_t grain = 0; grain < world.grainCount(); ++grain) {
      pivots_.push_back(pivot(grain));
      firstIndex_.push_back(bytes_);
      bytes_ += padded(3 * triangles(grain) * (isShort(grain) ? 2 : 4));
      const auto [place, isNew] =
          materials_.emplace(world.color(grain), uint32_t(materials_.size()));
      if (isNew) colors_.push_back(place->first);
    }
  }

  void write(const std::string& path, Interrupter* interrupter) const {
    std::string json = header();
    json.resize(padded(json.size()), ' ');
    const uint64_t all =
        kHeaderBytes + kChunkHeaderBytes + json.size() + (bytes_ ? kChunkHeaderBytes + bytes_ : 0);
    requireRoom(path, all);
    OutputStream out(path, interrupter);
    for (const uint32_t number :
         {kMagic, kVersion2, uint32_t(all), uint32_t(json.size()), kJsonChunk})
      out.value(number);
    out.text(json);
    if (bytes_) {
      out.value(uint32_t(bytes_));
      out.value(kBinaryChunk);
      world_.forEachPoint([&](size_t grain, uint32_t i) { out.value(placed(grain, i)); });
      for (size_t grain = 0; options_.shadeSmooth && grain < world_.grainCount(); ++grain)
        for (const Vec3f& normal : normals(grain)) out.value(normal);
      for (size_t grain = 0; grain < world_.grainCount(); ++grain) writeIndices(out, grain);
    }
    out.commit();
  }

 private:
  const GrainMesh& mesh() const { return world_.mesh(); }
  uint32_t firstPoint(size_t grain) const { return mesh().firstPoint[grain]; }
  uint32_t points(size_t grain) const { return firstPoint(grain + 1) - firstPoint(grain); }
  uint64_t triangles(size_t grain) const {
    return mesh().firstTriangle[grain + 1] - mesh().firstTriangle[grain];
  }
  bool isShort(size_t grain) const { return points(grain) <= kMaxShortPoints; }
  uint64_t pointBytes() const { return kPointBytes * mesh().points.size(); }
  /// Positions, perhaps normals, then indices.
  uint64_t indexStart() const { return pointBytes() * (options_.shadeSmooth ? 2 : 1); }
  size_t accessorsOfGrain() const { return options_.shadeSmooth ? 3 : 2; }

  /// The centroid of what a grain's surface encloses; of one that is open or flat the mean of its
  /// points.
  Vec3f pivot(size_t grain) const {
    const Vec3d origin = turned(world_.point(firstPoint(grain)));
    Vec3d mean(0), sum(0), low(0), high(0);
    for (uint32_t i = firstPoint(grain); i < firstPoint(grain + 1); ++i) {
      const Vec3d p = turned(world_.point(i)) - Vec3f(origin);
      mean += p / points(grain);
      low = openvdb::math::minComponent(low, p);
      high = openvdb::math::maxComponent(high, p);
    }
    double volume = 0;
    for (uint32_t i = mesh().firstTriangle[grain]; i < mesh().firstTriangle[grain + 1]; ++i) {
      const auto corners = world_.triangle(i);
      const auto at = [&](size_t k) { return Vec3d(turned(world_.point(corners[k]))) - origin; };
      const Vec3d a = at(0), b = at(1), c = at(2);
      const double part = a.dot(b.cross(c)) / 6;
      volume += part;
      sum += part * (a + b + c) / 4;
    }
    const Vec3d extent = high - low;
    const double box = extent[0] * extent[1] * extent[2];
    return Vec3f(origin + (volume > 1e-3 * box ? sum / volume : mean));
  }

  /// A point, from the pivot of its grain.
  Vec3f placed(size_t grain, uint32_t point) const {
    return Vec3f(Vec3d(turned(world_.point(point))) - Vec3d(pivots_[grain]));
  }

  std::string header() const {
    const size_t grains = world_.grainCount();
    Json asset;
    asset["version"] = "2.0";
    asset["generator"] = std::string("vdb_madf ") + kVersion;
    Json scene;
    scene["name"] = "grains";
    for (size_t grain = 0; grain < grains; ++grain) scene["nodes"].push_back(grain);
    scene["extras"]["length_unit"] = options_.lengthUnit.empty() ? "voxel" : options_.lengthUnit;
    std::string text = "{\"asset\":" + asset.dump() + ",\"scene\":0,\"scenes\":[" + scene.dump() +
                       "]" + list("nodes", grains, [&](size_t grain) { return node(grain); }) +
                       list("meshes", grains, [&](size_t grain) { return meshOf(grain); }) +
                       list("materials", colors_.size(), [&](size_t i) { return material(i); }) +
                       list("accessors", grains * accessorsOfGrain(), [&](size_t i) {
                         return accessor(i / accessorsOfGrain(), i % accessorsOfGrain());
                       });
    if (bytes_) {
      Json views = Json::array({view(0, pointBytes(), kVertices)});
      if (options_.shadeSmooth) views.push_back(view(pointBytes(), pointBytes(), kVertices));
      views.push_back(view(indexStart(), bytes_ - indexStart(), kIndices));
      text += ",\"bufferViews\":" + views.dump() +
              ",\"buffers\":[{\"byteLength\":" + std::to_string(bytes_) + "}]";
    }
    return text + "}";
  }

  Json node(size_t grain) const {
    Json json;
    json["name"] = grainName(world_.label(grain));
    json["mesh"] = grain;
    json["translation"] = triple(pivots_[grain]);
    json["extras"] = measuresOf(world_.label(grain));
    return json;
  }

  Json measuresOf(int32_t label) const {
    Json json;
    json["grain_id"] = label;
    if (!options_.measured) return json;
    const std::vector<int32_t>& labels = options_.measured->grains;
    const auto place = std::lower_bound(labels.begin(), labels.end(), label);
    if (place == labels.end() || *place != label) return json;
    for (const GrainNetwork::Column& column : options_.measured->grainColumns) {
      const double value = column.values[size_t(place - labels.begin())];
      if (std::isnan(value)) continue;
      if (column.isCount)
        json[column.name] = int64_t(value);
      else
        json[column.name] = value;
    }
    return json;
  }

  Json meshOf(size_t grain) const {
    const size_t first = grain * accessorsOfGrain();
    Json primitive;
    primitive["attributes"]["POSITION"] = first;
    if (options_.shadeSmooth) primitive["attributes"]["NORMAL"] = first + 1;
    primitive["indices"] = first + accessorsOfGrain() - 1;
    primitive["material"] = materials_.at(world_.color(grain));
    Json json;
    json["name"] = grainName(world_.label(grain));
    json["primitives"] = Json::array({primitive});
    return json;
  }

  /// Dull, so that the color of a grain is what is seen.
  Json material(size_t i) const {
    Json color = Json::array();
    for (const uint8_t channel : colors_[i]) color.push_back(decimalOf(linearChannel(channel)));
    color.push_back(1);
    Json json;
    json["name"] = "color_" + std::to_string(i);
    json["pbrMetallicRoughness"] = {
        {"baseColorFactor", color}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
    return json;
  }

  Json accessor(size_t grain, size_t which) const {
    const bool isIndex = which + 1 == accessorsOfGrain();
    Json json;
    json["bufferView"] = which;
    json["byteOffset"] =
        isIndex ? firstIndex_[grain] - indexStart() : kPointBytes * firstPoint(grain);
    json["componentType"] = !isIndex ? kFloat : isShort(grain) ? kUint16 : kUint32;
    json["count"] = isIndex ? 3 * triangles(grain) : points(grain);
    json["type"] = isIndex ? "SCALAR" : "VEC3";
    if (which == 0) {
      Vec3f low(std::numeric_limits<float>::max()), high(-low);
      for (uint32_t i = firstPoint(grain); i < firstPoint(grain + 1); ++i) {
        const Vec3f p = placed(grain, i);
        low = openvdb::math::minComponent(low, p);
        high = openvdb::math::maxComponent(high, p);
      }
      json["min"] = triple(low);
      json["max"] = triple(high);
    }
    return json;
  }

  Json view(uint64_t offset, uint64_t length, int target) const {
    Json json;
    json["buffer"] = 0;
    json["byteOffset"] = offset;
    json["byteLength"] = length;
    if (target == kVertices) json["byteStride"] = kPointBytes;
    json["target"] = target;
    return json;
  }

  /// The normals of a grain's points: means over the triangles around, by their areas.
  std::vector<Vec3f> normals(size_t grain) const {
    std::vector<Vec3d> sums(points(grain), Vec3d(0));
    for (uint32_t i = mesh().firstTriangle[grain]; i < mesh().firstTriangle[grain + 1]; ++i) {
      const auto corners = world_.triangle(i);
      const Vec3d a = turned(world_.point(corners[0])), b = turned(world_.point(corners[1])),
                  c = turned(world_.point(corners[2]));
      const Vec3d across = (b - a).cross(c - a);
      for (const uint32_t corner : corners) sums[corner - firstPoint(grain)] += across;
    }
    std::vector<Vec3f> result;
    for (const Vec3d& sum : sums) {
      const double length = sum.length();
      result.push_back(length > 0 ? Vec3f(sum / length) : Vec3f(0, 1, 0));
    }
    return result;
  }

  /// Writes the corners as they are counted within the grain.
  void writeIndices(OutputStream& out, size_t grain) const {
    for (uint32_t i = mesh().firstTriangle[grain]; i < mesh().firstTriangle[grain + 1]; ++i)
      for (const uint32_t corner : world_.triangle(i)) {
        const uint32_t index = corner - firstPoint(grain);
        if (isShort(grain))
          out.value(uint16_t(index));
        else
          out.value(index);
      }
    if (isShort(grain) && triangles(grain) % 2) out.value(uint16_t(0));
  }

  const WorldMesh& world_;
  const MeshFileOptions& options_;
  std::vector<Vec3f> pivots_;         ///< of the grains
  std::vector<uint64_t> firstIndex_;  ///< bytes, of each grain
  uint64_t bytes_ = 0;                ///< of the chunk of numbers
  std::map<Rgb, uint32_t> materials_;
  std::vector<Rgb> colors_;  ///< of the materials
};

}  // namespace

void writeGlb(const std::string& path, const WorldMesh& world, const MeshFileOptions& options,
              Interrupter* interrupter) {
  checkGlbRoom(path, world.mesh().points.size(), world.mesh().triangles.size(),
               options.shadeSmooth);
  GlbFile(world, options).write(path, interrupter);
}

void checkGlbRoom(const std::string& path, uint64_t points, uint64_t triangles, bool hasNormals) {
  requireRoom(path, points * kPointBytes * (hasNormals ? 2 : 1) + triangles * 3 * sizeof(uint16_t));
}

}  // namespace vdb_madf::detail
