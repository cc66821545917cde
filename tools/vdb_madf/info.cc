// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "command.h"
#include "image_values.h"
#include "input_options.h"
#include "json_file.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"

namespace vdb_madf::tools {

namespace {

struct InfoArguments {
  InputOptions input;
  std::string json, histogram;
  bool header = false;
};

/// Its value as a list of numbers, if it is a vector of this type.
template <typename Vector>
bool addVector(const openvdb::Metadata& value, Json& list) {
  using Typed = openvdb::TypedMetadata<Vector>;
  if (value.typeName() != Typed::staticTypeName()) return false;
  const Vector& vector = static_cast<const Typed&>(value).value();
  list = Json::array();
  for (int i = 0; i < Vector::size; ++i) list.push_back(vector[i]);
  return true;
}

/// Metadata as text, numbers as numbers, vectors as lists of them.
Json metadataValue(const openvdb::Metadata& value) {
  Json json;
  if (addVector<openvdb::Vec3i>(value, json) || addVector<openvdb::Vec3s>(value, json) ||
      addVector<openvdb::Vec3d>(value, json) || addVector<openvdb::Vec2i>(value, json) ||
      addVector<openvdb::Vec2s>(value, json) || addVector<openvdb::Vec2d>(value, json))
    return json;
  if (const auto plain = plainValue(value))
    std::visit([&](const auto& typed) { json = typed; }, *plain);
  else
    json = value.str();
  return json;
}

/// Wrong metadata of a domain are listed as they are.
std::optional<Domain> regionOf(const openvdb::GridBase& grid) {
  try {
    const auto domain = storedDomain(grid);
    if (domain && !domain->isBox()) return domain;
  } catch (const InvalidInput&) {
  }
  return std::nullopt;
}

Json describeGrid(const openvdb::GridBase& grid) {
  Json json;
  json["name"] = grid.getName();
  json["value_type"] = grid.valueType();
  json["class"] = openvdb::GridBase::gridClassToString(grid.getGridClass());
  json["active_voxels"] = grid.activeVoxelCount();
  const CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (grid.activeVoxelCount() > 0) {
    json["active_min"] = coordJson(box.min());
    json["active_max"] = coordJson(box.max());
  }
  const openvdb::Vec3d edge = grid.voxelSize();
  json["voxel_size_units"] = {edge.x(), edge.y(), edge.z()};
  if (const auto size = storedVoxelSize(grid)) json["voxel_size_mm"] = inMillimeters(*size);
  json["memory_bytes"] = grid.memUsage();
  if (const auto domain = regionOf(grid)) {
    json["domain"] = "region, " + regionText(*domain);
    json["region_voxels"] = int64_t(domain->voxelCount());
  }
  Json metadata = Json::object();
  for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta)
    if (meta->first != "name" && meta->first != "class")
      metadata[meta->first] = metadataValue(*meta->second);
  json["metadata"] = metadata;
  return json;
}

Json describeFile(const std::string& path, const VdbReadOptions& reading, Progress* progress) {
  Json grids = Json::array();
  for (const auto& grid : readVdb(path, reading, progress)) {
    grids.push_back(describeGrid(*grid));
    if (!hasVoxelsAlongAxes(*grid))
      progress->note(path + ": the voxels of grid '" + grid->getName() +
                     "' are not along the axes; only info reads it");
  }
  return grids;
}

/// Adds what another slab of the grid holds.
void addSlab(const Json& slab, Json& grid) {
  for (const char* key : {"active_voxels", "memory_bytes"})
    grid[key] = grid[key].get<int64_t>() + slab[key].get<int64_t>();
  if (!slab.contains("active_min")) return;
  const bool isFirst = !grid.contains("active_min");
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto join = [&](const char* key, const auto& choose) {
      const int own = slab[key][axis].get<int>();
      grid[key][axis] = isFirst ? own : choose(own, grid[key][axis].get<int>());
    };
    join("active_min", [](int a, int b) { return std::min(a, b); });
    join("active_max", [](int a, int b) { return std::max(a, b); });
  }
}

/// The grids of a folder of slabs, which are read one by one.
Json describeSlabs(const SlabFolder& folder, const VdbReadOptions& reading, Progress* progress) {
  Json grids = Json::array();
  for (size_t s = 0; s < folder.slabCount(); ++s) {
    const auto slab = readVdbSlab(folder, s, reading, progress);
    for (size_t i = 0; i < slab.size(); ++i) {
      // OpenVDB writes these of a file.
      for (const char* key :
           {openvdb::GridBase::META_FILE_BBOX_MIN, openvdb::GridBase::META_FILE_BBOX_MAX,
            openvdb::GridBase::META_FILE_MEM_BYTES, openvdb::GridBase::META_FILE_VOXEL_COUNT})
        slab[i]->removeMeta(key);
      removeGraph(*slab[i]);  // it has a part alone
      if (s == 0)
        grids.push_back(describeGrid(*slab[i]));
      else if (!isRegion(*slab[i], slab))  // which each slab has as a whole
        addSlab(describeGrid(*slab[i]), grids[i]);
    }
  }
  return grids;
}

Json describeImage(const ImageReader& image) {
  const ImageInfo& info = image.info();
  Json json;
  json["format"] = info.format;
  json["size"] = coordJson(toCoord(info.size));
  json["type"] = sampleTypeName(info.type);
  if (info.voxelSize) json["voxel_size_mm"] = inMillimeters(*info.voxelSize);
  if (const auto& edges = info.proportions) json["voxel_size_units"] = *edges;
  // Of slices in a folder; a Zarr group names itself, too.
  if (const auto& files = image.files();
      std::filesystem::is_directory(image.path()) && files.front() != image.path()) {
    json["files"] = files.size();
    json["first_file"] = std::filesystem::path(files.front()).filename().string();
    json["last_file"] = std::filesystem::path(files.back()).filename().string();
  }
  return json;
}

std::string plain(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void print(const Json& json) {
  std::cout << json["file"].get<std::string>() << ": " << json["format"].get<std::string>() << "\n";
  for (const auto& [key, value] : json.items())
    if (key != "file" && key != "format" && key != "grids" && key != "notes" &&
        key != "histogram_counts")
      std::cout << "  " << key << ": " << plain(value) << "\n";
  if (!json.contains("grids")) return;
  for (const Json& grid : json["grids"]) {
    std::cout << "  grid " << grid["name"].get<std::string>() << "\n";
    for (const auto& [key, value] : grid.items())
      if (key != "name" && key != "metadata")
        std::cout << "    " << key << ": " << plain(value) << "\n";
    for (const auto& [key, value] : grid["metadata"].items())
      std::cout << "    " << key << " = " << plain(value) << "\n";
  }
}

void runInfo(const InfoArguments& o, const Common& common) {
  JsonFile jsonFile(o.json);
  TextFile plot(o.histogram);
  Json json;
  json["file"] = o.input.path;
  if (isVdb(o.input)) {
    if (!plot.isNowhere())
      throw InvalidInput(o.input.path + ": --histogram is for images, and this is a VDB file");
    json["format"] = "vdb";
    VdbReadOptions reading;
    reading.anyVoxelShape = true;
    if (isInSlabs(o.input)) {
      const SlabFolder folder = openSlabFolder(o.input.path);
      json["slabs"] = folder.slabCount();
      json["grids"] = describeSlabs(folder, reading, common.progress);
    } else {
      json["grids"] = describeFile(o.input.path, reading, common.progress);
    }
  } else {
    const auto image = openVolumeImage(o.input.path, o.input.volume(common.progress));
    json.update(describeImage(*image));
    if (!o.header) {
      const Histogram histogram = countValues(o.input, common.progress);
      describeValues(o.input, histogram, json, common.progress);
      if (!plot.isNowhere()) plot.write(plotValues(o.input, histogram, *plotTypeOf(o.histogram)));
    }
  }
  common.progress->end();
  addNotes(json, *common.progress);
  jsonFile.write(json);
  if (!common.quiet && !jsonFile.isStandardOutput()) print(json);
}

}  // namespace

void addInfo(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<InfoArguments>();
  Verb verb = addVerb(command, common, "info", "what is in a file", "vdb_madf info grains.vdb");
  verb.option("FILE", o->input.path, "any readable volume").required();
  o->input.addRaw(verb);
  verb.flag("--header", o->header, "only what headers say: does not read the voxels of an image");
  verb.option("--histogram", o->histogram, "draws the histogram of an image: .svg, .pdf or .png")
      .typeName("FILE");
  verb.option("--json", o->json, "machine-readable result (-: standard output)").typeName("FILE");
  verb.onParsed([o, &common, &action] {
    o->input.outputs = {o->json, o->histogram};
    if (!o->histogram.empty() && !plotTypeOf(o->histogram))
      throw WrongUsage(o->histogram + ": the histogram's ending must be .svg, .pdf or .png");
    if (!o->histogram.empty() && o->header)
      throw WrongUsage(
          "--header reads no voxels, so there is no --histogram: leave one of them out");
    o->input.parse();
    action = [o, &common] { runInfo(*o, common); };
  });
}

}  // namespace vdb_madf::tools
