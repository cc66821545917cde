// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/image.h"

namespace vdb_madf {

namespace {

struct TypeName {
  SampleType type;
  const char* name;
  size_t size;
};
constexpr TypeName kTypes[] = {
    {SampleType::uint8, "uint8", 1},     {SampleType::int8, "int8", 1},
    {SampleType::uint16, "uint16", 2},   {SampleType::int16, "int16", 2},
    {SampleType::uint32, "uint32", 4},   {SampleType::int32, "int32", 4},
    {SampleType::float32, "float32", 4}, {SampleType::float64, "float64", 8}};

}  // namespace

size_t sampleSize(SampleType type) {
  return kTypes[size_t(type)].size;
}

std::string sampleTypeName(SampleType type) {
  return kTypes[size_t(type)].name;
}

std::optional<SampleType> sampleTypeFromName(const std::string& name) {
  for (const TypeName& known : kTypes)
    if (name == known.name) return known.type;
  return std::nullopt;
}

std::vector<std::string> sampleTypeNames() {
  std::vector<std::string> names;
  for (const TypeName& known : kTypes) names.emplace_back(known.name);
  return names;
}

}  // namespace vdb_madf
