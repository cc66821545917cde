// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/edits.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/size_text.h"

namespace vdb_madf {

namespace {

using Kind = Edit::Kind;

struct Word {
  Kind kind;
  const char* name;
  enum class Takes { grains, voxels, length, number, nothing } takes;
  size_t least = 0, most = 0;  // grains
};

constexpr size_t kAny = std::numeric_limits<size_t>::max();
using Takes = Word::Takes;
constexpr std::array<Word, 12> kWords{{{Kind::split, "split", Takes::grains, 1, 1},
                                       {Kind::merge, "merge", Takes::grains, 2, kAny},
                                       {Kind::drop, "drop", Takes::grains, 1, kAny},
                                       {Kind::keep, "keep", Takes::grains, 1, kAny},
                                       {Kind::minVoxels, "min-voxels", Takes::voxels},
                                       {Kind::maxVoxels, "max-voxels", Takes::voxels},
                                       {Kind::minDiameter, "min-diameter", Takes::length},
                                       {Kind::maxDiameter, "max-diameter", Takes::length},
                                       {Kind::joinBelow, "join-below", Takes::voxels},
                                       {Kind::dropAtFaces, "drop-at-faces", Takes::nothing},
                                       {Kind::renumber, "renumber", Takes::nothing},
                                       {Kind::strictness, "strictness", Takes::number}}};

const Word& wordOf(Kind kind) {
  return *std::find_if(kWords.begin(), kWords.end(),
                       [&](const Word& word) { return word.kind == kind; });
}

const Word& wordOf(const std::string& name) {
  const auto word = std::find_if(kWords.begin(), kWords.end(),
                                 [&](const Word& known) { return name == known.name; });
  if (word != kWords.end()) return *word;
  std::string all;
  for (const Word& known : kWords) all += (all.empty() ? "" : ", ") + std::string(known.name);
  throw InvalidInput(detail::inQuotes(name) + " is no edit: there are " + all);
}

int32_t grainFrom(const std::string& text) {
  const auto number = detail::integers(text);
  if (!number || number->size() != 1)
    throw InvalidInput(detail::inQuotes(text) + " is no number of a grain");
  const int64_t grain = number->front();
  if (grain < 1 || grain > std::numeric_limits<int32_t>::max())
    throw InvalidInput(
        fmt::format("grain {} cannot be: they are numbered from 1 to 2147483647", grain));
  return int32_t(grain);
}

int64_t voxelsFrom(const std::string& text) {
  const auto number = detail::integers(text);
  if (!number || number->size() != 1 || number->front() < 0)
    throw InvalidInput(detail::inQuotes(text) + " is no number of voxels");
  return number->front();
}

double lengthFrom(const std::string& text) {
  const VoxelSize size = voxelSizeFromText(text);
  if (!size.isCube()) throw InvalidInput(text + ": a diameter is one length");
  return size.edge();
}

double numberFrom(const std::string& text) {
  const auto number = detail::reals(text);
  if (!number || number->size() != 1 || !std::isfinite(number->front()))
    throw InvalidInput(detail::inQuotes(text) + " is no number");
  return number->front();
}

const char* takenBy(const Word& word) {
  switch (word.takes) {
    case Takes::voxels:
      return "one number of voxels";
    case Takes::length:
      return "one length with its unit, as 100um";
    case Takes::number:
      return "one number";
    default:
      return "nothing";
  }
}

std::vector<std::string> wordsOf(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace

const char* toString(Kind kind) {
  return wordOf(kind).name;
}

std::string toString(const Edit& edit) {
  const Word& word = wordOf(edit.kind);
  std::string text = word.name;
  for (const int32_t grain : edit.grains) text += " " + std::to_string(grain);
  if (word.takes == Takes::voxels) text += " " + std::to_string(edit.voxels);
  if (word.takes == Takes::length) text += " " + lengthIn(1e6, edit.diameter) + "um";
  if (word.takes == Takes::number) text += " " + detail::shortestDecimal(edit.strictness);
  return text;
}

void checkEdit(const Edit& edit) {
  if (!std::isfinite(edit.diameter) || !std::isfinite(edit.strictness))
    throw InvalidInput(fmt::format("{} takes finite numbers", toString(edit.kind)));
  const Word& word = wordOf(edit.kind);
  if (word.takes != Takes::grains) return;
  std::vector<int32_t> sorted = edit.grains;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) throw InvalidInput(fmt::format("grain {} is named twice", *twice));
  if (sorted.size() < word.least || sorted.size() > word.most)
    throw InvalidInput(fmt::format(
        "{} takes {}, and is given {}", word.name,
        word.most == 1 ? "one grain" : std::to_string(word.least) + " or more", sorted.size()));
}

Edit parseEdit(const std::string& text) {
  std::vector<std::string> words = wordsOf(text);
  if (words.empty()) throw InvalidInput("there is no edit");
  const Word& word = wordOf(words.front());
  words.erase(words.begin());
  Edit edit;
  edit.kind = word.kind;
  if (word.takes == Takes::grains) {
    for (const std::string& number : words) edit.grains.push_back(grainFrom(number));
    checkEdit(edit);
    return edit;
  }
  const size_t wanted = word.takes == Takes::nothing ? 0 : 1;
  if (words.size() != wanted)
    throw InvalidInput(
        fmt::format("{} takes {}, and is given {}", word.name, takenBy(word), words.size()));
  if (word.takes == Takes::voxels) edit.voxels = voxelsFrom(words.front());
  if (word.takes == Takes::length) edit.diameter = lengthFrom(words.front());
  if (word.takes == Takes::number) edit.strictness = numberFrom(words.front());
  return edit;
}

std::vector<Edit> parseEdits(const std::string& text) {
  std::vector<Edit> edits;
  std::istringstream stream(text);
  size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::string edit = detail::trimmed(line.substr(0, line.find('#')));
    if (edit.empty()) continue;
    try {
      edits.push_back(parseEdit(edit));
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("line {}: {}", number, error.what()));
    }
  }
  return edits;
}

}  // namespace vdb_madf
