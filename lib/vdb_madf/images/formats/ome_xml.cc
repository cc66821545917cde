// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/ome_xml.h"

#include <algorithm>
#include <array>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/images/detail/header_checks.h"

namespace vdb_madf::detail {

namespace {

/// Of a name, with its colon: what is longer is none, and is not searched.
constexpr size_t kMaxPrefix = 64;
const std::string kSpace = " \t\r\n";

bool isSpace(char c) {
  return kSpace.find(c) != std::string::npos;
}

/// Where the next element of a name has its attributes; npos if there is none. (A prefix of a
/// namespace, "ome:", may precede the name.)
size_t nextElement(const std::string& xml, const std::string& name, size_t from) {
  for (size_t place = from; (place = xml.find(name, place)) != std::string::npos; ++place) {
    const size_t end = place + name.size(), begin = place - std::min(place, kMaxPrefix);
    const std::string before = xml.substr(begin, place - begin);
    const size_t open = before.rfind('<');
    if (end >= xml.size() || !isSpace(xml[end]) || open == std::string::npos) continue;
    const std::string prefix = before.substr(open + 1);
    if (prefix.empty() ||
        (prefix.back() == ':' && prefix.find_first_of(kSpace + ">") == prefix.npos))
      return end;
  }
  return std::string::npos;
}

/// name="value" and name='value' up to the end of the element.
std::map<std::string, std::string> attributesAt(const std::string& xml, size_t place) {
  std::map<std::string, std::string> found;
  for (;;) {
    place = xml.find_first_not_of(kSpace, place);
    if (place == std::string::npos || xml[place] == '>' || xml[place] == '/') return found;
    const size_t equals = xml.find('=', place);
    if (equals == std::string::npos) return found;
    const size_t quote = xml.find_first_not_of(kSpace, equals + 1);
    if (quote == std::string::npos || (xml[quote] != '"' && xml[quote] != '\'')) return found;
    const size_t end = xml.find(xml[quote], quote + 1);
    if (end == std::string::npos) return found;
    found[trimmed(xml.substr(place, equals - place))] = xml.substr(quote + 1, end - quote - 1);
    place = end + 1;
  }
}

/// The micro sign is the one letter of a unit that XML may have to escape.
std::string unescaped(std::string unit) {
  for (const char* micro :
       {"&#181;", "&#xB5;", "&#xb5;", "&#956;", "&#x3BC;", "&#x3bc;", "&micro;"})
    if (const size_t place = unit.find(micro); place != std::string::npos)
      unit.replace(place, std::string(micro).size(), "u");
  return unit;
}

}  // namespace

OmePixels::OmePixels(const std::string& description) {
  if (description.find("<OME") == std::string::npos &&
      description.find(":OME") == std::string::npos)
    return;
  for (size_t place = 0; (place = nextElement(description, "Pixels", place)) != std::string::npos;)
    if (++images_ == 1) attributes_ = attributesAt(description, place);
  for (size_t place = 0;
       (place = nextElement(description, "TiffData", place)) != std::string::npos;) {
    const auto planes = attributesAt(description, place);
    const auto page = planes.find("IFD"), slice = planes.find("FirstZ");
    if (page == planes.end()) continue;
    const auto numbers = integers(page->second),
               slices = integers(slice == planes.end() ? "0" : slice->second);
    isInOrder_ = isInOrder_ && numbers && numbers == slices;
  }
}

int64_t OmePixels::size(const std::string& axis) const {
  const auto values = integers(attribute("Size" + axis, "1"));
  return values && values->size() == 1 ? values->front() : 1;
}

std::optional<VoxelSize> OmePixels::voxelSize(const std::string& path) const {
  std::array<double, 3> edges{};
  std::array<std::optional<double>, 3> units;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = std::string("PhysicalSize") + "XYZ"[axis];
    const auto values = reals(attribute(name, ""));
    if (!values || values->size() != 1) return std::nullopt;
    edges[size_t(axis)] = values->front();
    units[size_t(axis)] = unitsPerMetre(unescaped(attribute(name + "Unit", "um")));
  }
  if (units[0] == units[1] && units[0] == units[2]) return checkedVoxelSize(path, edges, units[0]);
  for (size_t axis = 0; axis < 3; ++axis) {
    if (!units[axis]) return std::nullopt;
    edges[axis] /= *units[axis];
  }
  return checkedVoxelSize(path, edges, 1.0);
}

std::string OmePixels::attribute(const std::string& name, const std::string& otherwise) const {
  const auto found = attributes_.find(name);
  return found == attributes_.end() ? otherwise : found->second;
}

}  // namespace vdb_madf::detail
