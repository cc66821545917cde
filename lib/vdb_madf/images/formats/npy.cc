// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/formats.h"

#include <algorithm>
#include <map>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/stored_samples.h"
#include "vdb_madf/images/detail/stored_type.h"

namespace vdb_madf::detail {

namespace {

const std::string kNpyMagic = "\x93NUMPY";
/// Only records of many fields have longer headers.
constexpr size_t kMaxNpyHeaderBytes = size_t(1) << 16;
/// The samples begin at a multiple of this.
constexpr size_t kAlignment = 64;

/// The dictionary of the header, a Python literal: {'descr': '<u2', 'shape': (3, 4, 5), ...}.
/// The values are kept as text, strings without their quotes and tuples without their brackets.
class Dictionary {
 public:
  Dictionary(const std::string& path, const std::string& text) : path_(path), text_(text) {
    expect('{');
    while (!take('}')) {
      const std::string key = quotedText();
      expect(':');
      values_[key] = value();
      if (!take(',') && !next('}')) fail();
    }
    if (place_ != text_.find_last_not_of(" \n") + 1) fail();
  }

  std::string require(const std::string& key) const {
    const auto found = values_.find(key);
    if (found == values_.end()) throw IoError(path_ + ": the npy header lacks " + key);
    return found->second;
  }

 private:
  [[noreturn]] void fail() const {
    throw IoError(path_ + ": the npy header " + inQuotes(trimmed(text_)) + " cannot be read");
  }
  bool next(char c) {
    place_ = std::min(text_.find_first_not_of(' ', place_), text_.size());
    return place_ < text_.size() && text_[place_] == c;
  }
  bool take(char c) {
    const bool found = next(c);
    place_ += found;
    return found;
  }
  void expect(char c) {
    if (!take(c)) fail();
  }
  std::string upTo(char c) {
    const size_t end = text_.find(c, place_);
    if (end == std::string::npos) fail();
    const std::string found = text_.substr(place_, end - place_);
    place_ = end + 1;
    return found;
  }
  std::string quotedText() {
    const bool doubleQuoted = next('"');
    if (!doubleQuoted && !next('\'')) fail();
    ++place_;
    return upTo(doubleQuoted ? '"' : '\'');
  }
  std::string value() {
    if (next('\'') || next('"')) return quotedText();
    if (take('(')) return upTo(')');
    const size_t end = std::min(text_.find_first_of(",}", place_), text_.size());
    const std::string word = trimmed(text_.substr(place_, end - place_));
    if (word != "True" && word != "False") fail();  // a list of a record's fields, say
    place_ = end;
    return word;
  }

  std::string path_, text_;
  size_t place_ = 0;
  std::map<std::string, std::string> values_;
};

/// The text of the header, and where the samples begin.
std::pair<std::string, uint64_t> npyHeader(const InputFile& file) {
  const std::string head = file.head(kMaxNpyHeaderBytes);
  const auto byte = [&](size_t i) { return size_t(static_cast<unsigned char>(head[i])); };
  if (!isNpyHeader(head) || head.size() < 12)
    throw IoError(file.name() + ": is not a whole npy file");
  const bool longForm = byte(6) > 1;
  if (byte(6) < 1 || byte(6) > 3)
    throw IoError(file.name() + ": is of npy version " + std::to_string(byte(6)) +
                  "; only 1 to 3 can be read");
  const size_t begin = longForm ? 12 : 10;
  const size_t length =
      byte(8) + (byte(9) << 8) + (longForm ? (byte(10) << 16) + (byte(11) << 24) : size_t(0));
  if (length > head.size() - begin)
    throw IoError(file.name() + ": the npy header of " + std::to_string(length) +
                  " bytes is cut short or no volume's");
  return {head.substr(begin, length), begin + length};
}

std::vector<int64_t> shapeOf(const std::string& path, std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  const auto shape = integers(text);
  if (!shape) throw IoError(path + ": the shape " + detail::inQuotes(text) + " cannot be read");
  return {shape->rbegin(), shape->rend()};
}

std::string headerText(const ImageInfo& info) {
  std::string text = "{'descr': '" + numpyName(info.type) + "', 'fortran_order': False, 'shape': (";
  text += std::to_string(info.size.z) + ", " + std::to_string(info.size.y) + ", " +
          std::to_string(info.size.x) + "), }";
  const size_t before = kNpyMagic.size() + 4, unpadded = before + text.size() + 1;
  text.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
  text += '\n';
  return kNpyMagic + '\1' + '\0' + char(text.size() & 255) + char(text.size() >> 8) + text;
}

}  // namespace

bool isNpyHeader(const std::string& head) {
  return head.compare(0, kNpyMagic.size(), kNpyMagic) == 0;
}

std::unique_ptr<ImageReader> openNpy(std::unique_ptr<InputFile> file) {
  const std::string path = file->path();
  const auto [text, offset] = npyHeader(*file);
  const Dictionary header(path, text);
  const std::string type = header.require("descr");
  const auto stored = storedTypeFromNumpy(type);
  if (!stored)
    throw IoError(path + ": its type " + inQuotes(type) +
                  " cannot be read: save integers, bool, float32 or float64");
  ImageInfo info;
  info.format = "npy";
  info.size = checkedSize(path, shapeOf(path, header.require("shape")));
  info.type = stored->type;
  if (header.require("fortran_order") != "False")
    throw IoError(path + ": is in Fortran order: save numpy.ascontiguousarray() of it");
  SampleLayout layout;
  layout.offset = offset;
  layout.bigEndian = stored->bigEndian;
  layout.is64Bit = stored->is64Bit;
  return openSamples(path, info, std::move(file), layout);
}

std::unique_ptr<ImageWriter> createNpy(const std::string& path, const ImageInfo& info) {
  return createSamples(path, info, headerText(info));
}

}  // namespace vdb_madf::detail
