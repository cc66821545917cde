// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "support/images.h"

// Compound files (OLE2), written by the specification [MS-CFB], and scans of Zeiss in them.

namespace vdb_madf::test {

struct CompoundFileBytes {
  std::string bytes;
  size_t sectorBytes = 512;
  std::map<std::string, uint32_t> first;  ///< sector of each large stream; "" is the directory
  std::map<std::string, size_t>
      entry;                    ///< place in the file of each stream's entry; "" is the root
  std::vector<uint32_t> table;  ///< sectors of the table of sectors

  size_t place(uint32_t sector) const { return (size_t(sector) + 1) * sectorBytes; }
  /// The place of the number of the sector that follows.
  size_t placeOfLink(uint32_t sector) const {
    const size_t links = sectorBytes / 4;
    return place(table[sector / links]) + 4 * (sector % links);
  }
  void put(size_t at, uint32_t value) { std::memcpy(&bytes[at], &value, 4); }
  uint32_t get(size_t at) const {
    uint32_t value;
    std::memcpy(&value, &bytes[at], 4);
    return value;
  }
};

class CompoundWriter {
 public:
  /// @param version 3 or 4 @param seed of the order of the sectors; 0: one after the other
  CompoundWriter(int version, unsigned seed) : seed_(seed) {
    file_.sectorBytes = version == 3 ? 512 : 4096;
    version_ = version;
  }

  /// @param streams content by name, "storage/stream"
  CompoundFileBytes write(const std::map<std::string, std::string>& streams) {
    entries_ = {{"Root Entry", 5}};
    std::map<std::string, std::vector<size_t>> members;
    for (const auto& [path, content] : streams) {
      const size_t slash = path.find('/');
      const std::string storage = path.substr(0, slash);
      if (members[storage].empty()) {
        members[""].push_back(entries_.size());
        storages_[storage] = entries_.size();
        entries_.push_back({storage, 1});
      }
      members[storage].push_back(entries_.size());
      entries_.push_back({path.substr(slash + 1), 2, content, path});
    }
    for (auto& [storage, list] : members)
      entries_[storage.empty() ? 0 : storages_[storage]].child = tree(list, 0, list.size());
    layOut();
    return file_;
  }

 private:
  static constexpr uint32_t kNone = 0xffffffff, kEnd = 0xfffffffe, kTable = 0xfffffffd,
                            kPlaces = 0xfffffffc;
  struct Entry {
    std::string name;
    int type;
    std::string content = {}, path = {};
    uint32_t left = kNone, right = kNone, child = kNone, first = 0;
    uint64_t size = 0;
  };

  /// A tree of entries [begin, end) of a list, by its root.
  uint32_t tree(std::vector<size_t>& list, size_t begin, size_t end) {
    if (begin == end) return kNone;
    const size_t middle = (begin + end) / 2, entry = list[middle];
    entries_[entry].left = tree(list, begin, middle);
    entries_[entry].right = tree(list, middle + 1, end);
    return uint32_t(entry);
  }

  size_t sectorsOf(size_t bytes) const {
    return (bytes + file_.sectorBytes - 1) / file_.sectorBytes;
  }

  void layOut() {
    const size_t links = file_.sectorBytes / 4;
    std::string small;
    std::vector<uint32_t> smallLinks;
    size_t sectors = 0;
    for (Entry& entry : entries_) {
      entry.size = entry.content.size();
      if (entry.size >= 4096) sectors += sectorsOf(entry.size);
      if (entry.type != 2 || entry.size >= 4096) continue;
      entry.first = uint32_t(smallLinks.size());
      for (size_t at = 0; at < entry.size; at += 64) {
        small += entry.content.substr(at, 64);
        small.resize((small.size() + 63) / 64 * 64);
        smallLinks.push_back(at + 64 < entry.size ? uint32_t(smallLinks.size() + 1) : kEnd);
      }
    }
    const std::string smallTable(reinterpret_cast<const char*>(smallLinks.data()),
                                 4 * smallLinks.size());
    const size_t directoryBytes = 128 * entries_.size();
    sectors += sectorsOf(small.size()) + sectorsOf(smallTable.size()) + sectorsOf(directoryBytes);
    size_t tables = 0, places = 0;
    while (links * tables < sectors + tables + places) {
      ++tables;
      places = tables > 109 ? (tables - 109 + links - 2) / (links - 1) : 0;
    }
    order_.resize(sectors + tables + places);
    std::iota(order_.begin(), order_.end(), 0u);
    if (seed_) std::shuffle(order_.begin(), order_.end(), std::mt19937(seed_));
    links_.assign(links * tables, kNone);
    file_.bytes.assign(file_.sectorBytes * (order_.size() + 1), '\0');

    for (Entry& entry : entries_)
      if (entry.size >= 4096) entry.first = file_.first[entry.path] = put(entry.content);
    entries_[0].first = put(small);
    entries_[0].size = small.size();
    const uint32_t smallTableAt = put(smallTable), directoryAt = put(directory());
    file_.first[""] = directoryAt;
    uint32_t sector = directoryAt;
    for (size_t i = 0; i < entries_.size(); ++i) {
      const size_t perSector = file_.sectorBytes / 128;
      if (i > 0 && i % perSector == 0) sector = links_[sector];
      file_.entry.emplace(entries_[i].path, file_.place(sector) + 128 * (i % perSector));
    }
    putTables(tables, places);
    putHeader(tables, places, directoryAt, smallTableAt, sectorsOf(smallTable.size()));
  }

  /// A chain of sectors; returns the first.
  uint32_t put(const std::string& content) {
    if (content.empty()) return kEnd;
    const uint32_t first = order_[next_];
    for (size_t at = 0; at < content.size(); at += file_.sectorBytes) {
      const uint32_t sector = order_[next_++];
      const bool isLast = at + file_.sectorBytes >= content.size();
      const std::string part = content.substr(at, file_.sectorBytes);
      std::copy(part.begin(), part.end(), file_.bytes.begin() + long(file_.place(sector)));
      links_[sector] = isLast ? kEnd : order_[next_];
    }
    return first;
  }

  std::string directory() const {
    std::string all;
    for (const Entry& entry : entries_) {
      std::string bytes(128, '\0');
      for (size_t i = 0; i < entry.name.size(); ++i) bytes[2 * i] = entry.name[i];
      bytes[64] = char(2 * entry.name.size() + 2);
      bytes[66] = char(entry.type);
      const uint32_t numbers[] = {entry.left, entry.right, entry.child};
      std::memcpy(&bytes[68], numbers, 12);
      std::memcpy(&bytes[116], &entry.first, 4);
      std::memcpy(&bytes[120], &entry.size, 8);
      all += bytes;
    }
    return all;
  }

  void putTables(size_t tables, size_t places) {
    const size_t links = file_.sectorBytes / 4;
    for (size_t i = 0; i < tables; ++i) {
      file_.table.push_back(order_[next_++]);
      links_[file_.table.back()] = kTable;
    }
    for (size_t i = 0; i < places; ++i) {
      const uint32_t sector = order_[next_ + i];
      links_[sector] = kPlaces;
      for (size_t k = 0; k + 1 < links; ++k) {
        const size_t table = 109 + i * (links - 1) + k;
        file_.put(file_.place(sector) + 4 * k, table < tables ? file_.table[table] : kNone);
      }
      file_.put(file_.place(sector) + 4 * (links - 1),
                i + 1 < places ? order_[next_ + i + 1] : kEnd);
    }
    for (size_t i = 0; i < links_.size(); ++i) file_.put(file_.placeOfLink(uint32_t(i)), links_[i]);
  }

  void putHeader(size_t tables, size_t places, uint32_t directoryAt, uint32_t smallTableAt,
                 size_t smallTables) {
    const std::string magic = "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1";
    std::copy(magic.begin(), magic.end(), file_.bytes.begin());
    file_.put(24, uint32_t(0x3e | version_ << 16));
    file_.put(28, uint32_t(0xfffe | (version_ == 3 ? 9 : 12) << 16));
    file_.put(32, 6);
    if (version_ == 4) file_.put(40, uint32_t(sectorsOf(128 * entries_.size())));
    file_.put(44, uint32_t(tables));
    file_.put(48, directoryAt);
    file_.put(56, 4096);
    file_.put(60, smallTableAt);
    file_.put(64, uint32_t(smallTables));
    file_.put(68, places ? order_[next_] : kEnd);
    file_.put(72, uint32_t(places));
    for (size_t i = 0; i < 109; ++i) file_.put(76 + 4 * i, i < tables ? file_.table[i] : kNone);
  }

  int version_ = 3;
  unsigned seed_;
  CompoundFileBytes file_;
  std::vector<Entry> entries_;
  std::map<std::string, size_t> storages_;
  std::vector<uint32_t> order_, links_;
  size_t next_ = 0;
};

template <typename T>
std::string bytesOf(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// The streams of a scan of Zeiss.
inline std::map<std::string, std::string> txmStreams(const ImageSize& size, int32_t type,
                                                     const std::string& samples) {
  std::map<std::string, std::string> streams = {{"ImageInfo/ImageWidth", bytesOf(int32_t(size.x))},
                                                {"ImageInfo/ImageHeight", bytesOf(int32_t(size.y))},
                                                {"ImageInfo/NoOfImages", bytesOf(int32_t(size.z))},
                                                {"ImageInfo/DataType", bytesOf(type)},
                                                {"ImageInfo/PixelSize", bytesOf(2.0493f)},
                                                {"ImageInfo/AcquisitionMode", bytesOf(int32_t(10))},
                                                {"ReferenceData/Image", std::string(5000, 'r')}};
  const size_t slice = samples.size() / size_t(size.z);
  for (int z = 0; z < size.z; ++z)
    streams["ImageData" + std::to_string(z / 100 + 1) + "/Image" + std::to_string(z + 1)] =
        samples.substr(slice * size_t(z), slice);
  return streams;
}

}  // namespace vdb_madf::test
