// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <zlib.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/report/report.h"

#define NEEDS_PAGE()                                                                       \
  if (!canWriteReport()) {                                                                 \
    WARN("SKIPPED: reports: built without esbuild, libjs-three, libjs-jquery-datatables"); \
    return;                                                                                \
  }

/// Pages of reports, and what a reader of their text finds in them.
namespace vdb_madf::test {

using Json = nlohmann::json;

inline std::string unbase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    REQUIRE(digits.find(c) != std::string::npos);
    bits = bits << 6 | uint32_t(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += char(bits >> count & 255);
  }
  return bytes;
}

inline std::string unpacked(const std::string& text) {
  const std::string packed = unbase64(text);
  std::string bytes(size_t(1) << 24, '\0');
  uLongf size = bytes.size();
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                     reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK);
  bytes.resize(size);
  return bytes;
}

/// A page as a reader of its text sees it.
struct Page {
  std::string text;

  /// What an element of data holds.
  std::string element(const std::string& id) const {
    const std::string head = "id=\"" + id + "\">";
    const size_t at = text.find(head);
    REQUIRE(at != std::string::npos);
    const size_t begin = at + head.size();
    return text.substr(begin, text.find("</script>", begin) - begin);
  }
  bool has(const std::string& id) const {
    return text.find("id=\"" + id + "\">") != std::string::npos;
  }
  Json json(const std::string& id) const { return Json::parse(element(id)); }
  std::string bytes(const std::string& id) const { return unpacked(element(id)); }
};

inline Page write(const AnyLabels& labels, const ReportOptions& options = {}) {
  const ScratchFolder folder;
  const Report report = writeReport(folder / "page.html", labels, options);
  const Page page{readFile(folder / "page.html")};
  CHECK(report.bytes == page.text.size());
  return page;
}

inline Int32Grid::Ptr balls() {
  const auto labels = labelGrid(twoBalls({10, 12, 14}, 8));
  setDomain(*labels, Domain(CoordBBox({0, 0, 0}, {32, 25, 27})));
  return labels;
}

/// The labels of the slices, x fastest: places in the table from 1 on.
inline std::vector<uint64_t> sliceVoxels(const Page& page) {
  const std::string bytes = page.bytes("labels");
  std::vector<uint64_t> voxels;
  size_t at = 0;
  const auto number = [&] {
    uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const uint8_t byte = uint8_t(bytes.at(at++));
      value |= uint64_t(byte & 127) << shift;
      if (byte < 128) return value;
    }
  };
  while (at < bytes.size()) {
    const uint64_t run = number(), held = number();
    voxels.insert(voxels.end(), run, held);
  }
  return voxels;
}

}  // namespace vdb_madf::test
