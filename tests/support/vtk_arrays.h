// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"

namespace vdb_madf::test {

/// A VTK XML file with appended raw data, decoded by the definition of the format.
class VtkArrays {
 public:
  explicit VtkArrays(const std::string& file) {
    const std::string mark = "<AppendedData encoding=\"raw\">\n_";
    const size_t data = file.find(mark);
    REQUIRE(data != std::string::npos);
    xml_ = file.substr(0, data);
    data_ = file.substr(data + mark.size());
    REQUIRE(xml_.find("byte_order=\"LittleEndian\" header_type=\"UInt64\"") != std::string::npos);
    isCompressed_ = xml_.find("compressor=\"vtkZLibDataCompressor\"") != std::string::npos;
  }

  /// The text of an attribute of an element, as `attribute("ImageData", "Origin")`.
  std::string attribute(const std::string& element, const std::string& name) const {
    return attributeAt(xml_.find("<" + element + " "), name);
  }

  /// The n-th array of a name.
  template <typename T>
  std::vector<T> values(const std::string& name, int n = 0) const {
    size_t at = 0;
    for (int i = 0; i <= n; ++i) {
      at = xml_.find("Name=\"" + name + "\"", at + 1);
      REQUIRE(at != std::string::npos);
    }
    const std::string bytes = bytesAt(std::stoul(attributeAt(xml_.rfind('<', at), "offset")));
    REQUIRE(bytes.size() % sizeof(T) == 0);
    std::vector<T> result(bytes.size() / sizeof(T));
    std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }

 private:
  std::string attributeAt(size_t element, const std::string& name) const {
    REQUIRE(element != std::string::npos);
    const size_t at = xml_.find(" " + name + "=\"", element);
    REQUIRE(at < xml_.find('>', element));
    const size_t begin = at + name.size() + 3;
    return xml_.substr(begin, xml_.find('"', begin) - begin);
  }
  uint64_t number(size_t& at) const {
    uint64_t value = 0;
    REQUIRE(at + sizeof value <= data_.size());
    std::memcpy(&value, &data_[at], sizeof value);
    at += sizeof value;
    return value;
  }
  std::string bytesAt(size_t at) const {
    if (!isCompressed_) {
      const uint64_t count = number(at);
      return data_.substr(at, count);
    }
    const uint64_t blocks = number(at), whole = number(at), last = number(at);
    std::vector<uint64_t> sizes;
    for (uint64_t i = 0; i < blocks; ++i) sizes.push_back(number(at));
    std::string result;
    for (uint64_t i = 0; i < blocks; ++i) {
      std::string block(i + 1 == blocks && last ? last : whole, '\0');
      uLongf length = block.size();
      REQUIRE(uncompress(reinterpret_cast<Bytef*>(block.data()), &length,
                         reinterpret_cast<const Bytef*>(&data_[at]), sizes[i]) == Z_OK);
      REQUIRE(length == block.size());
      result += block;
      at += sizes[i];
    }
    return result;
  }

  std::string xml_, data_;
  bool isCompressed_ = false;
};

}  // namespace vdb_madf::test
