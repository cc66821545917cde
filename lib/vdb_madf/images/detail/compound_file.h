// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "vdb_madf/files/detail/input_file.h"

namespace vdb_madf::detail {

/// A compound file (OLE2, structured storage), version 3 or 4: streams in storages, like files in
/// folders. Of these only the streams of the root and of the storages in it are seen.
/// The table of sectors stays in the file, so memory goes with the number of streams.
/// Every number is checked before it is used: a damaged file ends in an IoError.
/// Source: [MS-CFB], Compound File Binary File Format, Microsoft.
///
/// (libgsf, the library for such files, would bring GLib and libxml2 along.)
class CompoundFile {
 public:
  struct Stream {
    uint32_t first;  ///< of its sectors
    uint64_t bytes;
  };

  /// @throw IoError
  explicit CompoundFile(std::unique_ptr<InputFile> file);

  const InputFile& file() const { return *file_; }
  /// "imageinfo/pixelsize": names in lower case. Null if there is no such stream.
  const Stream* find(const std::string& name) const;
  /// The first bytes of a stream, at most as many as it has. @throw IoError
  void read(const Stream& stream, void* to, uint64_t count) const;

 private:
  [[noreturn]] void fail(const std::string& what) const;
  void readHeader();
  void findTable(const std::string& header);
  void readDirectory();
  std::string sectorBytes(uint32_t sector) const;
  uint64_t placeOf(uint32_t sector) const { return (uint64_t(sector) + 1) * sectorBytes_; }
  uint64_t sectorsOf(uint64_t bytes) const { return (bytes + sectorBytes_ - 1) / sectorBytes_; }
  uint32_t after(uint32_t sector) const;
  uint32_t miniAfter(uint32_t miniSector) const;
  std::vector<uint32_t> chain(uint32_t first, uint64_t count) const;
  std::vector<uint32_t> wholeChain(uint32_t first, uint64_t most) const;
  void readMini(uint32_t first, char* to, uint64_t count) const;

  std::unique_ptr<InputFile> file_;
  size_t sectorBytes_ = 0;
  uint64_t sectors_ = 0;  ///< in the file
  uint32_t firstOfDirectory_ = 0, firstOfMiniTable_ = 0, miniTableSectors_ = 0;
  std::vector<uint32_t> table_;                    ///< sectors of the table of sectors
  std::vector<uint32_t> miniTable_, miniSectors_;  ///< of the table, and of what is small
  std::map<std::string, Stream> streams_;
  mutable uint64_t cached_ = UINT64_MAX;  ///< which part of the table of sectors is at hand
  mutable std::string part_;
};

}  // namespace vdb_madf::detail
