// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/detail/compound_file.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/lower_case.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kHeaderBytes = 512;
// Byte offsets in the header.
constexpr size_t kVersion = 26, kByteOrder = 28, kSectorShift = 30, kMiniShift = 32,
                 kTableSectors = 44, kFirstOfDirectory = 48, kCutoff = 56, kFirstOfMiniTable = 60,
                 kMiniTableSectors = 64, kFirstOfPlaces = 68, kPlaces = 76;
/// The places of so many sectors of the table stand in the header.
constexpr size_t kPlacesInHeader = 109;
/// Streams of fewer bytes are small: in sectors of 64 bytes within a stream of the root.
constexpr uint64_t kMiniCutoff = 4096, kMiniBytes = 64;
/// What is no sector: the end of a chain, or no entry of the directory.
constexpr uint32_t kEnd = 0xfffffffe, kNone = 0xffffffff;

// Byte offsets in an entry of the directory.
constexpr size_t kEntryBytes = 128, kNameLength = 64, kType = 66, kLeft = 68, kRight = 72,
                 kChild = 76, kFirst = 116, kBytes = 120;
enum Type : uint8_t { storage = 1, stream = 2, root = 5 };
/// More have no volume of a million slices.
constexpr uint64_t kMaxDirectoryBytes = kEntryBytes << 21;

template <typename T>
T at(const std::string& bytes, size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

/// In lower case. UTF-16 is in the file; what is not ASCII is no name that is looked for.
std::string nameOf(const std::string& directory, size_t entry) {
  const size_t length =
      std::min<size_t>(at<uint16_t>(directory, entry + kNameLength), kNameLength) / 2;
  std::string name;
  for (size_t i = 0; i + 1 < length; ++i) {
    const auto c = at<uint16_t>(directory, entry + 2 * i);
    name += c > 0 && c < 128 ? char(c) : '?';
  }
  return lowerCase(name);
}

bool hasTwice(std::vector<uint32_t> sectors) {
  std::sort(sectors.begin(), sectors.end());
  return std::adjacent_find(sectors.begin(), sectors.end()) != sectors.end();
}

}  // namespace

CompoundFile::CompoundFile(std::unique_ptr<InputFile> file) : file_(std::move(file)) {
  readHeader();
  readDirectory();
}

void CompoundFile::fail(const std::string& what) const {
  throw IoError(file_->path() + ": is damaged or cut short: " + what);
}

void CompoundFile::readHeader() {
  const std::string header = file_->head(kHeaderBytes);
  if (header.size() < kHeaderBytes) fail("the header of a compound file is not whole");
  const auto version = at<uint16_t>(header, kVersion);
  const auto shift = at<uint16_t>(header, kSectorShift);
  if (!((version == 3 && shift == 9) || (version == 4 && shift == 12)) ||
      at<uint16_t>(header, kByteOrder) != 0xfffe || at<uint16_t>(header, kMiniShift) != 6 ||
      at<uint32_t>(header, kCutoff) != kMiniCutoff)
    fail("the header of a compound file makes no sense");
  sectorBytes_ = size_t(1) << shift;
  const uint64_t whole = sectorsOf(file_->size());
  sectors_ = whole > 0 ? whole - 1 : 0;
  firstOfDirectory_ = at<uint32_t>(header, kFirstOfDirectory);
  firstOfMiniTable_ = at<uint32_t>(header, kFirstOfMiniTable);
  miniTableSectors_ = at<uint32_t>(header, kMiniTableSectors);
  findTable(header);
}

/// As much of it as the sectors of the file need.
void CompoundFile::findTable(const std::string& header) {
  const uint64_t links = sectorBytes_ / 4;
  const uint64_t count =
      std::min<uint64_t>(at<uint32_t>(header, kTableSectors), (sectors_ + links - 1) / links);
  for (size_t i = 0; i < std::min<uint64_t>(count, kPlacesInHeader); ++i)
    table_.push_back(at<uint32_t>(header, kPlaces + 4 * i));
  // Further places stand in a chain of sectors, each of which ends with the number of the next.
  for (uint32_t next = at<uint32_t>(header, kFirstOfPlaces); table_.size() < count;) {
    if (next >= sectors_) fail("its table of sectors is not whole");
    const std::string places = sectorBytes(next);
    for (size_t i = 0; i + 1 < links && table_.size() < count; ++i)
      table_.push_back(at<uint32_t>(places, 4 * i));
    next = at<uint32_t>(places, sectorBytes_ - 4);
  }
  if (hasTwice(table_)) fail("its table of sectors has a part twice");
}

std::string CompoundFile::sectorBytes(uint32_t sector) const {
  if (sector >= sectors_) fail("a sector lies beyond the end");
  std::string bytes(sectorBytes_, '\0');
  file_->read(placeOf(sector), bytes.data(), bytes.size());
  return bytes;
}

uint32_t CompoundFile::after(uint32_t sector) const {
  const uint64_t links = sectorBytes_ / 4, part = sector / links;
  if (part >= table_.size()) fail("a sector is not in the table of sectors");
  if (part != cached_) {
    part_ = sectorBytes(table_[part]);
    cached_ = part;
  }
  return at<uint32_t>(part_, 4 * (sector % links));
}

/// So many sectors, no two the same.
std::vector<uint32_t> CompoundFile::chain(uint32_t first, uint64_t count) const {
  if (count > sectors_) fail("a stream is larger than the file");
  std::vector<uint32_t> sectors;
  while (sectors.size() < count) {
    sectors.push_back(sectors.empty() ? first : after(sectors.back()));
    if (sectors.back() >= sectors_) fail("a chain of sectors ends too early");
  }
  if (hasTwice(sectors)) fail("a chain of sectors runs in a circle");
  return sectors;
}

/// To its end.
std::vector<uint32_t> CompoundFile::wholeChain(uint32_t first, uint64_t most) const {
  std::vector<uint32_t> sectors;
  for (uint32_t sector = first; sector != kEnd; sector = after(sector)) {
    if (sector >= sectors_) fail("a chain of sectors leads nowhere");
    if (sectors.size() == std::min(most, sectors_)) fail("a chain of sectors has no end");
    sectors.push_back(sector);
  }
  return sectors;
}

void CompoundFile::readDirectory() {
  std::string directory;
  for (const uint32_t sector : wholeChain(firstOfDirectory_, kMaxDirectoryBytes / sectorBytes_))
    directory += sectorBytes(sector);
  const size_t count = directory.size() / kEntryBytes;
  if (count == 0 || directory[kType] != root) fail("its directory has no root");
  const auto contentOf = [&](size_t entry) {
    auto bytes = at<uint64_t>(directory, entry + kBytes);
    if (sectorBytes_ == kHeaderBytes) bytes &= 0xffffffff;  // version 3 has 32 bits, and rubbish
    return Stream{at<uint32_t>(directory, entry + kFirst), bytes};
  };
  const Stream small = contentOf(0);
  miniSectors_ = chain(small.first, sectorsOf(small.bytes));
  miniTable_ = chain(firstOfMiniTable_, miniTableSectors_);

  struct Place {
    uint32_t entry;
    std::string storage;
  };
  std::vector<bool> seen(count);
  seen[0] = true;
  std::vector<Place> open = {{at<uint32_t>(directory, kChild), ""}};
  while (!open.empty()) {  // the entries of a storage are a tree
    const Place place = open.back();
    open.pop_back();
    if (place.entry == kNone) continue;
    if (place.entry >= count || seen[place.entry]) fail("its directory is no tree");
    seen[place.entry] = true;
    const size_t entry = place.entry * kEntryBytes;
    const std::string name = place.storage + nameOf(directory, entry);
    for (const size_t side : {kLeft, kRight})
      open.push_back({at<uint32_t>(directory, entry + side), place.storage});
    if (directory[entry + kType] == storage && place.storage.empty())
      open.push_back({at<uint32_t>(directory, entry + kChild), name + "/"});
    if (directory[entry + kType] != stream) continue;
    const Stream content = contentOf(entry);
    if (content.bytes > file_->size()) fail("the stream " + name + " is larger than the file");
    streams_[name] = content;
  }
}

const CompoundFile::Stream* CompoundFile::find(const std::string& name) const {
  const auto found = streams_.find(name);
  return found == streams_.end() ? nullptr : &found->second;
}

void CompoundFile::read(const Stream& stream, void* to, uint64_t count) const {
  char* next = static_cast<char*>(to);
  if (stream.bytes < kMiniCutoff) return readMini(stream.first, next, count);
  const std::vector<uint32_t> sectors = chain(stream.first, sectorsOf(count));
  uint64_t left = count;
  for (size_t i = 0; i < sectors.size();) {
    size_t run = 1;  // of sectors one after the other
    while (i + run < sectors.size() && sectors[i + run] == sectors[i] + run) ++run;
    const size_t bytes = size_t(std::min<uint64_t>(left, run * sectorBytes_));
    file_->read(placeOf(sectors[i]), next, bytes);
    next += bytes;
    left -= bytes;
    i += run;
  }
}

uint32_t CompoundFile::miniAfter(uint32_t miniSector) const {
  const uint64_t links = sectorBytes_ / 4, part = miniSector / links;
  if (part >= miniTable_.size()) fail("a small stream is not in its table");
  uint32_t next;
  file_->read(placeOf(miniTable_[part]) + 4 * (miniSector % links), &next, sizeof next);
  return next;
}

void CompoundFile::readMini(uint32_t first, char* to, uint64_t count) const {
  uint32_t miniSector = first;
  for (uint64_t done = 0; done < count; done += kMiniBytes) {
    if (done > 0) miniSector = miniAfter(miniSector);
    const uint64_t place = uint64_t(miniSector) * kMiniBytes;
    if (place / sectorBytes_ >= miniSectors_.size()) fail("a small stream is not whole");
    file_->read(placeOf(miniSectors_[place / sectorBytes_]) + place % sectorBytes_, to + done,
                size_t(std::min(kMiniBytes, count - done)));
  }
}

}  // namespace vdb_madf::detail
