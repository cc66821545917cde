// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/read_vdb.h"

#include <fmt/core.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <functional>
#include <ios>
#include <istream>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/files/detail/content_digest.h"
#include "vdb_madf/files/detail/file_buffer.h"
#include "vdb_madf/files/verified_files.h"
#include "vdb_madf/grids/detail/region_metadata.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/grids/domain.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/detail/read_leaves.h"
#include "vdb_madf/vdb/detail/region_grid.h"
#include "vdb_madf/vdb/detail/uuid_digest.h"
#include "vdb_madf/vdb/detail/vdb_tree_check.h"

namespace vdb_madf {

namespace {

namespace io = openvdb::io;
using openvdb::GridBase;

// The file, in OpenVDB's format 222 to 224: a header (magic number, versions, a flag for offsets,
// UUID), metadata, the number of grids; per grid a descriptor (name, type, name of the grid that it
// shares its tree with, three offsets), compression flags, metadata, transform, topology, buffers.
// Here we read what frames the grids, and leave to OpenVDB what it cannot get wrong: values of
// checked length, and trees that checkTree() has walked over.

constexpr uint32_t kOldestFormat = openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;
constexpr char kNameSuffix = '\x1e';  // what follows it only tells grids of the same name apart

/// Printable, on one line and short, whatever a corrupt file made of it.
std::string clipped(const std::string& text, size_t longest = 160) {
  std::string line = text.substr(0, longest);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c < 0x20 || c > 0x7e; }, '?');
  return text.size() > longest ? line + "..." : line;
}

/// What is in the way of reading this file at all.
[[noreturn]] void refuse(const detail::InputBuffer& file, const std::string& reasonAndAdvice) {
  throw IoError("cannot read " + file.path() + ": " + reasonAndAdvice);
}

/// What only a damaged file has.
[[noreturn]] void damaged(const std::string& what) {
  throw std::runtime_error(what);
}

struct Header {
  uint32_t format = 0;
  openvdb::VersionId library;
  bool hasOffsets = false;
  std::string uuid;
};

Header readHeader(detail::InputBuffer& file) {
  if (file.size() == 0) refuse(file, "it is empty; write or copy it again");
  constexpr int64_t kMagicLength = 8;
  if (file.left() < kMagicLength || file.read<int64_t>() != openvdb::OPENVDB_MAGIC)
    refuse(file, "it is not a VDB file; give a file that OpenVDB has written");
  Header header;
  header.format = file.read<uint32_t>();
  if (header.format > openvdb::OPENVDB_FILE_VERSION)
    refuse(file,
           fmt::format("its VDB format {} is newer than {}; save it from an older program, or "
                       "update this one",
                       header.format, int(openvdb::OPENVDB_FILE_VERSION)));
  if (header.format < kOldestFormat)
    refuse(file,
           fmt::format("its VDB format {} is older than {}; save it again from a newer program",
                       header.format, kOldestFormat));
  header.library.first = file.read<uint32_t>();
  header.library.second = file.read<uint32_t>();
  const auto flag = file.read<uint8_t>();
  if (flag > 1) damaged("its header is wrong");
  header.hasOffsets = flag == 1;
  header.uuid.resize(detail::kUuidLength);
  file.read(header.uuid.data(), detail::kUuidLength);
  return header;
}

struct Descriptor {
  std::string name, type, parent;
  int64_t start = 0, buffers = 0, end = 0;
  bool isInstance() const { return !parent.empty(); }
};

Descriptor readDescriptor(detail::InputBuffer& file) {
  Descriptor descriptor;
  descriptor.name = file.readString();
  descriptor.type = file.readString();
  descriptor.parent = file.readString();
  // The suffix repeats what metadata says of the grid.
  static const std::string half = "_HalfFloat";
  std::string& type = descriptor.type;
  if (type.size() > half.size() && type.substr(type.size() - half.size()) == half)
    type.resize(type.size() - half.size());
  descriptor.start = file.read<int64_t>();
  descriptor.buffers = file.read<int64_t>();
  descriptor.end = file.read<int64_t>();
  return descriptor;
}

/// Into `metadata`, or over it if that is null.
void readMetadata(detail::InputBuffer& file, std::istream& stream, openvdb::MetaMap* metadata) {
  const auto count = file.read<uint32_t>();
  for (uint32_t i = 0; i < count; ++i) {
    const std::string name = file.readString(), type = file.readString();
    const int64_t start = file.position();
    const auto bytes = file.read<uint32_t>();
    file.require(bytes);
    const int64_t end = file.position() + bytes;
    // Two underscores mark values that only serve reading, such as the sizes for delayed loading,
    // whose reader trusts the counts in the file.
    if (metadata && type.compare(0, 2, "__") != 0) {
      if (type == "bool" && (bytes != 1 || file.read<uint8_t>() > 1))
        damaged("metadata is neither true nor false");
      file.moveTo(start);
      const auto value = openvdb::Metadata::isRegisteredType(type)
                             ? openvdb::Metadata::createMetadata(type)
                             : std::make_shared<openvdb::UnknownMetadata>(type);
      value->read(stream);
      if (file.position() != end) damaged("metadata '" + clipped(name) + "' has the wrong size");
      metadata->insertMeta(name, *value);
    }
    file.moveTo(end);
  }
}

/// A frustum holds another transform, to any depth that a corrupt file likes; programs write one.
void readTransform(detail::InputBuffer& file, std::istream& stream, GridBase& grid) {
  constexpr char kFrustum[] = "NonlinearFrustumMap";
  constexpr int64_t kFrustumBytes = 8 * sizeof(double);
  const int64_t start = file.position();
  std::string type = file.readString();
  if (type == kFrustum) {
    file.skip(kFrustumBytes);
    type = file.readString();
    if (type == kFrustum) damaged("a frustum holds a frustum");
  }
  if (!openvdb::math::MapRegistry::isRegistered(type))
    damaged("transform '" + clipped(type) + "' is unknown");
  file.moveTo(start);
  grid.readTransform(stream);
}

void requireBoxes(const detail::InputBuffer& file, const GridBase& grid) {
  if (detail::edgesAlongAxes(grid.transform())) return;
  refuse(file,
         "the voxels of grid '" + clipped(grid.getName()) +
             "' are turned, sheared or of different sizes: resample it to voxels along the axes");
}

class Reader {
 public:
  Reader(detail::InputBuffer& file, const VdbReadOptions& options)
      : file_(file), stream_(&file), options_(options) {
    stream_.exceptions(std::ios_base::badbit | std::ios_base::failbit | std::ios_base::eofbit);
  }

  /// All grids without their trees.
  std::vector<GridBase::Ptr> readHeaders(bool verified) {
    readEntries([](const GridBase&) { return false; });
    if (verified) verify();
    std::vector<GridBase::Ptr> grids;
    for (const Entry& entry : entries_) grids.push_back(entry.grid);
    return grids;
  }

  std::vector<GridBase::Ptr> read() {
    readEntries(options_.wanted ? options_.wanted : [](const GridBase&) { return true; });
    verify();
    for (Entry& entry : entries_) named_[entry.descriptor.name] = &entry;
    std::vector<GridBase::Ptr> grids;
    for (Entry& entry : entries_) {
      if (!entry.wanted) continue;
      grids.push_back(entry.grid);
      if (entry.descriptor.isInstance()) shareTree(entry);
    }
    for (Entry& entry : entries_)
      if (entry.wanted) findRegion(entry);
    return grids;
  }

 private:
  struct Entry {
    Descriptor descriptor;
    GridBase::Ptr grid;
    detail::TreeSettings settings;
    int64_t treeStart = 0;
    bool wanted = false, hasTree = false;
    std::optional<Domain> voxels;  ///< of a region
  };

  /// The volumes, with the trees of those that are wanted.
  void readEntries(const std::function<bool(const GridBase&)>& wanted) {
    header_ = readHeader(file_);
    if (detail::isDigest(header_.uuid) && filesAreVerified())
      file_.tell(&sum_.emplace(file_.size()));
    // OpenVDB's readers ask the stream for these.
    io::setStreamMetadataPtr(stream_, streamState_, /*transfer=*/false);
    io::setVersion(stream_, header_.library, header_.format);

    readMetadata(file_, stream_, nullptr);
    const auto count = file_.read<int32_t>();
    if (count < 0) damaged("its number of grids is negative");
    for (int32_t i = 0; i < count; ++i) {
      const Descriptor descriptor = readDescriptor(file_);
      if (header_.hasOffsets && descriptor.start != file_.position())
        damaged("a grid is not where its offset says");
      const auto layout = detail::treeLayout(descriptor.type);
      if (layout && GridBase::isRegistered(descriptor.type))
        readEntry(descriptor, *layout, wanted);
      else
        skipGrid(descriptor);
    }
    if (file_.left() != 0) damaged("something follows its last grid");
  }

  /// Compares the content of a file of ours with its digest.
  void verify() {
    if (!sum_) return;
    sum_->addRest(
        [this](uint64_t position, char* to, size_t count) { file_.readAt(position, to, count); },
        nullptr);
    detail::requireDigest(file_.path(), header_.uuid, detail::uuidOf(*sum_));
  }

  void readEntry(const Descriptor& descriptor, const detail::TreeLayout& layout,
                 const std::function<bool(const GridBase&)>& wanted) {
    const auto compression = file_.read<uint32_t>();
    if (compression & ~uint32_t(io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK | io::COMPRESS_BLOSC))
      refuse(file_, "a grid is compressed in an unknown way; save it again without compression");

    const GridBase::Ptr grid = GridBase::createGrid(descriptor.type);
    readMetadata(file_, stream_, grid.get());
    if (grid->getName().empty())
      grid->setName(descriptor.name.substr(0, descriptor.name.find(kNameSuffix)));
    readTransform(file_, stream_, *grid);
    const bool mayBeRegion = grid->getName() == detail::kRegionGrid && grid->isType<BoolGrid>();
    const detail::TreeSettings settings{
        layout, grid->saveFloatAsHalf(), compression,
        mayBeRegion ? std::numeric_limits<int64_t>::max() : options_.maxVoxels,
        options_.maxCoordinate};
    Entry entry{descriptor, grid, settings, file_.position(), wanted(*grid), false, {}};
    if (entry.wanted && !options_.anyVoxelShape) requireBoxes(file_, *grid);
    if (!descriptor.isInstance()) {
      if (entry.wanted)
        readTree(entry);
      else
        skipTree(entry);
    }
    if (header_.hasOffsets && descriptor.end != file_.position())
      damaged("a grid does not end where its offset says");
    entries_.push_back(entry);
  }

  void skipGrid(const Descriptor& descriptor) {
    if (!header_.hasOffsets)
      refuse(file_, "it holds a grid of type '" + clipped(descriptor.type) +
                        "'; save the volumes in a file of their own");
    if (descriptor.end < file_.position()) damaged("a grid does not end where its offset says");
    file_.moveTo(descriptor.end);
  }

  void skipTree(const Entry& entry) {
    const int64_t buffers = entry.descriptor.buffers, end = entry.descriptor.end;
    if (!header_.hasOffsets) {
      file_.moveTo(findExtent(entry).end);
    } else if (buffers < file_.position() || end < buffers) {
      damaged("the voxels of a grid are not where their offset says");
    } else {
      file_.moveTo(end);
    }
  }

  /// Leaves the file somewhere in the tree.
  detail::TreeExtent findExtent(const Entry& entry) {
    io::setDataCompression(stream_, entry.settings.compression);
    io::setGridClass(stream_, entry.grid->getGridClass());
    io::setHalfFloat(stream_, entry.settings.half);
    io::setGridBackgroundValuePtr(stream_, nullptr);
    file_.moveTo(entry.treeStart);
    return checkTree(file_, stream_, entry.settings);
  }

  void readTree(Entry& entry) {
    const detail::TreeExtent extent = findExtent(entry);
    if (header_.hasOffsets && entry.descriptor.buffers != extent.topologyEnd)
      damaged("the voxels of a grid are not where their offset says");
    if (extent.memoryBytes > memoryLimit())
      refuse(file_, fmt::format("it takes {} of memory, and there are {}; crop it, or use a larger "
                                "computer",
                                readableBytes(extent.memoryBytes), readableBytes(memoryLimit())));
    file_.moveTo(entry.treeStart);
    entry.grid->readTopology(stream_);
    if (file_.position() != extent.topologyEnd) damaged("its nodes have the wrong size");
    detail::readLeaves(file_, stream_, extent, *entry.grid);
    entry.hasTree = true;
  }

  void shareTree(Entry& entry) {
    const auto found = named_.find(entry.descriptor.parent);
    if (found == named_.end()) damaged("a grid shares the tree of a grid that is missing");
    Entry& parent = *found->second;
    if (!parent.hasTree && !parent.descriptor.isInstance()) readTree(parent);
    entry.grid->setTree(parent.grid->baseTreePtr());
  }

  /// Puts the domain of a grid together again, if another grid holds its voxels.
  void findRegion(Entry& entry) {
    const std::string name = regionName(*entry.grid);
    if (name.empty()) return;
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& other) {
      return other.grid->getName() == name && other.grid->isType<BoolGrid>();
    });
    if (found == entries_.end())
      refuse(file_, "the domain of grid '" + clipped(entry.grid->getName()) +
                        "' is a region, and the Bool grid '" + clipped(name) +
                        "' that should hold it is missing: keep them in one file");
    if (!found->voxels) {
      if (found->descriptor.isInstance())
        shareTree(*found);
      else if (!found->hasTree)
        readTree(*found);
      found->voxels = Domain(objectMask(*found->grid)->tree());
    }
    detail::takeRegion(*entry.grid, *found->voxels);
  }

  detail::InputBuffer& file_;
  std::istream stream_;
  io::StreamMetadata::Ptr streamState_ = std::make_shared<io::StreamMetadata>();
  const VdbReadOptions& options_;
  Header header_;
  std::vector<Entry> entries_;
  std::optional<detail::VdbSum> sum_;  ///< of a file of ours
  std::map<std::string, Entry*> named_;
};

/// f(Reader) with one line for whatever is wrong with the file.
template <typename F>
std::vector<GridBase::Ptr> readWith(const std::string& path, const VdbReadOptions& options,
                                    Interrupter* interrupter, const F& f) {
  initialize();
  detail::InputBuffer file(path, interrupter);
  const auto refuseDamaged = [&file](const std::string& what) {
    refuse(file, "it is damaged (" + what + "); make or copy it again");
  };
  try {
    Reader reader(file, options);
    return f(reader);
  } catch (const IoError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const detail::BeyondLimits& error) {
    refuse(file, error.what() + std::string("; crop it, or make it again if it is not so large"));
  } catch (const std::bad_alloc&) {
    refuse(file, "there is not enough memory; close other programs, or crop it");
  } catch (const std::ios_base::failure&) {
    refuseDamaged(detail::EarlyEnd().what());
  } catch (const std::exception& error) {
    refuseDamaged(clipped(error.what()));
  }
  return {};
}

std::vector<GridBase::Ptr> readFile(const std::string& path, const VdbReadOptions& options,
                                    Interrupter* interrupter) {
  return readWith(path, options, interrupter, [](Reader& reader) { return reader.read(); });
}

std::vector<GridBase::Ptr> readHeaders(const std::string& path, Interrupter* interrupter,
                                       bool verified = false) {
  return readWith(path, {}, interrupter,
                  [&](Reader& reader) { return reader.readHeaders(verified); });
}

int64_t memoryOf(const std::vector<GridBase::Ptr>& grids) {
  int64_t bytes = 0;
  for (const auto& grid : grids) bytes += int64_t(grid->memUsage());
  return bytes;
}

/// Of each grid of a folder of slabs, the parts of its graph.
class GraphParts {
 public:
  void add(const std::vector<GridBase::Ptr>& grids) {
    parts_.resize(grids.size());
    for (size_t i = 0; i < grids.size(); ++i)
      if (auto part = storedGraphPart(*grids[i])) parts_[i].push_back(std::move(*part));
  }
  /// Gives the grids of all slabs the graph of the whole.
  void join(const std::vector<GridBase::Ptr>& grids, size_t slabs) {
    for (size_t i = 0; i < grids.size(); ++i) {
      if (parts_[i].empty()) continue;
      if (parts_[i].size() != slabs)
        throw InvalidInput("a slab has no part of the graph of grid '" + grids[i]->getName() +
                           "': segment again");
      setGraph(*grids[i], joinedGraph(parts_[i]));
    }
  }

 private:
  std::vector<std::vector<GraphPart>> parts_;
};

}  // namespace

std::vector<GridBase::Ptr> readVdb(const std::string& path, const VdbReadOptions& options,
                                   Interrupter* interrupter) {
  if (!isSlabFolder(path)) return readFile(path, options, interrupter);
  const SlabFolder folder = openSlabFolder(path);
  std::vector<GridBase::Ptr> grids = readVdbSlab(folder, 0, options, interrupter);
  int64_t bytes = memoryOf(grids);
  GraphParts parts;
  parts.add(grids);
  for (size_t slab = 1; slab < folder.slabCount(); ++slab) {
    const std::vector<GridBase::Ptr> next = readVdbSlab(folder, slab, options, interrupter);
    bytes += memoryOf(next);
    if (bytes > memoryLimit() / 4 * 3)  // something has to be done with them, too
      throw IoError("cannot read " + path + ": its slabs take " + readableBytes(bytes) +
                    " of memory and more together, of " + readableBytes(memoryLimit()) +
                    "; use what takes them one by one, or a larger computer");
    parts.add(next);
    addSlab(grids, next, folder.files[slab]);
  }
  try {
    parts.join(grids, folder.slabCount());
  } catch (const InvalidInput& error) {
    throw IoError(path + ": " + error.what());
  }
  return grids;
}

std::vector<GridBase::Ptr> readVdbSlab(const SlabFolder& folder, size_t slab,
                                       const VdbReadOptions& options, Interrupter* interrupter) {
  std::vector<GridBase::Ptr> grids = readFile(folder.files[slab], options, interrupter);
  std::vector<GridBase::Ptr> lowest = slab > 0 ? readHeaders(folder.files[0], interrupter) : grids;
  if (options.wanted && slab > 0)
    lowest.erase(std::remove_if(lowest.begin(), lowest.end(),
                                [&](const auto& grid) { return !options.wanted(*grid); }),
                 lowest.end());
  checkSlab(grids, folder, slab, lowest);
  return grids;
}

std::vector<GridBase::Ptr> readVdbHeaders(const std::string& path, Interrupter* interrupter,
                                          bool verified) {
  if (!isSlabFolder(path)) return readHeaders(path, interrupter, verified);
  const SlabFolder folder = openSlabFolder(path);
  const std::vector<GridBase::Ptr> grids = readHeaders(folder.files[0], interrupter, verified);
  checkSlab(grids, folder, 0, grids);
  return grids;
}

}  // namespace vdb_madf
