// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/detail/stored_type.h"

#include <cstring>
#include <string_view>

#include "vdb_madf/base/detail/byte_order.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

struct NumpyName {
  const char* name;  ///< kind and bytes
  SampleType type;
  bool is64Bit;
};
constexpr NumpyName kNames[] = {
    {"u1", SampleType::uint8, false},   {"i1", SampleType::int8, false},
    {"u2", SampleType::uint16, false},  {"i2", SampleType::int16, false},
    {"u4", SampleType::uint32, false},  {"i4", SampleType::int32, false},
    {"f4", SampleType::float32, false}, {"f8", SampleType::float64, false},
    {"b1", SampleType::uint8, false},   {"u8", SampleType::uint32, true},
    {"i8", SampleType::int32, true}};

template <typename Wide, typename Narrow>
void narrow(const std::string& path, bool bigEndian, const void* from, size_t count,
            void* samples) {
  const char* in = static_cast<const char*>(from);
  char* out = static_cast<char*>(samples);
  for (size_t i = 0; i < count; ++i) {
    Wide value;
    std::memcpy(&value, in + i * sizeof value, sizeof value);
    if (bigEndian) swapBytes(&value, 1, sizeof value);
    const auto sample = Narrow(value);
    if (Wide(sample) != value)
      throw IoError(path + ": the value " + std::to_string(value) +
                    " is beyond 32 bits: renumber its labels or write a smaller type");
    std::memcpy(out + i * sizeof sample, &sample, sizeof sample);
  }
}

}  // namespace

void toSamples(const std::string& path, const StoredType& stored, const void* from, size_t count,
               void* samples) {
  if (stored.is64Bit && stored.type == SampleType::uint32)
    return narrow<uint64_t, uint32_t>(path, stored.bigEndian, from, count, samples);
  if (stored.is64Bit) return narrow<int64_t, int32_t>(path, stored.bigEndian, from, count, samples);
  if (from != samples) std::memcpy(samples, from, count * stored.bytes());
  if (stored.bigEndian) swapBytes(samples, count, stored.bytes());
}

std::optional<StoredType> storedTypeFromNumpy(const std::string& name) {
  if (name.size() != 3 || std::string_view("<>|=").find(name[0]) == std::string_view::npos)
    return std::nullopt;
  for (const NumpyName& known : kNames)
    if (name.compare(1, 2, known.name) == 0) {
      const StoredType stored{known.type, known.is64Bit, name[0] == '>'};
      if (name[0] == '|' && stored.bytes() > 1) return std::nullopt;
      return stored;
    }
  return std::nullopt;
}

std::string numpyName(SampleType type) {
  for (const NumpyName& known : kNames)
    if (known.type == type) return (sampleSize(type) > 1 ? "<" : "|") + std::string(known.name);
  return {};
}

}  // namespace vdb_madf::detail
