// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/power_windows.h"

#include <cstdint>
#include <random>
#include <vector>

#include "support/catch.h"
#include "vdb_madf/method/kernels/lower_envelope.h"

namespace {

using namespace vdb_madf::detail;

/// A position of a row, also before its first and behind its last one.
struct Place {
  int32_t power = 0;  // as PowerMap has it; 0: no object voxel
  int32_t squaredRadius = 0;
  uint32_t site = 0;
};

/// 64 rows with what lies up to `reach` beyond their ends.
struct Rows {
  int length, reach;
  std::vector<Place> places;
  Place& at(int row, int t) { return places[size_t(row * (length + 2 * reach) + reach + t)]; }
};

/// Gaps, sites among the rest, and so few values that ties are common; sites beyond the ends along
/// z.
Rows randomLines(int stride, int length, int largest, int weight, uint32_t seed) {
  std::mt19937 random(seed);
  Rows rows{length, keyReach(largest, weight), {}};
  rows.places.resize(size_t(64 * (length + 2 * rows.reach)));
  uint32_t site = 0;
  for (int row = 0; row < 64; ++row)
    for (int t = -rows.reach; t < length + rows.reach; ++t) {
      const bool inside = t >= 0 && t < length;
      if (!inside && stride != 1) continue;
      Place& place = rows.at(row, t);
      if (random() % (inside ? 12 : 2) == 0) continue;
      place.squaredRadius = 1 + int(random() % unsigned(largest));
      const bool isSite = !inside || random() % (1 + unsigned(row) % 5) == 0;
      // Beyond its end a row holds balls at their centers.
      const int power =
          inside ? -1 - int(random() % unsigned(place.squaredRadius)) : -place.squaredRadius;
      place.power = isSite ? power : kNotNegative;
      place.site = ++site;
    }
  return rows;
}

size_t placeOf(const KeyLines& lines, int row, int t) {
  return lines.stride() == 1 ? lines.at(row, t)
                             : lines.at(row / lines.stride(), t) + size_t(row % lines.stride());
}

/// Voxels where the pass is not what its definition says.
int windowDifferences(KeyLines& lines, int stride, int length, int largest, int weight,
                      uint32_t seed) {
  Rows rows = randomLines(stride, length, largest, weight, seed);
  const int shift = keyShift(largest);
  lines.resize(stride, length, rows.reach);
  for (int row = 0; row < 64; ++row)
    for (int t = -rows.reach; t < length + rows.reach; ++t) {
      const Place& place = rows.at(row, t);
      if ((t < 0 || t >= length) && place.power == 0) continue;
      const size_t at = placeOf(lines, row, t);
      lines.key[at] = place.power < 0 ? (place.power << shift) - place.squaredRadius : place.power;
      lines.site[at] = place.site;
    }
  leastKeys(shift, weight, lines);
  int wrong = 0;
  for (int row = 0; row < 64; ++row)
    for (int t = 0; t < length; ++t) {
      if (rows.at(row, t).power == 0) continue;
      int64_t power = kNotNegative;
      const Place* best = nullptr;
      for (int s = -rows.reach; s < length + rows.reach; ++s) {
        const Place& other = rows.at(row, s);
        const int64_t value = other.power + int64_t(weight) * (s - t) * (s - t);
        if (other.power >= 0 || value >= 0) continue;
        if (value > power || (value == power && other.squaredRadius <= best->squaredRadius))
          continue;
        power = value;
        best = &other;
      }
      const size_t at = placeOf(lines, row, t);
      if (!best) {
        wrong += lines.leastKey[at] != kNotNegative;
      } else {
        wrong += powerOfKey(lines.leastKey[at], shift) != power;
        wrong += lines.leastSite[at] != best->site;
      }
    }
  return wrong;
}

}  // namespace

TEST_CASE("power_windows: keys tell powers, and come in the order of powers and radii",
          "[power_windows]") {
  for (const int largest : {1, 2, 3, 4, 100, 4095, 4096, kLargestKeyedSquaredRadius}) {
    const int shift = keyShift(largest);
    CAPTURE(largest);
    CHECK(powerOfKey(keyOfBall(largest, shift), shift) == -largest);
    CHECK(powerOfKey(keyOfBall(1, shift), shift) == -1);
    CHECK(keyOfBall(largest, shift) > -(1 << 30) - (1 << 15));
    if (largest > 1) CHECK(keyOfBall(largest, shift) < keyOfBall(largest - 1, shift));
  }
  CHECK(keyReach(1, 1) == 0);
  CHECK(keyReach(4, 1) == 1);
  CHECK(keyReach(5, 1) == 2);
  CHECK(keyReach(5, 4) == 1);
  CHECK(keyReach(5, 1 << 30) == 0);
  CHECK(keyReach(kLargestKeyedSquaredRadius, 1) == 181);
}

TEST_CASE("power_windows: by its definition", "[power_windows]") {
  KeyLines lines;  // the same for all, so that what is left over would be seen
  for (const int stride : {1, 16})
    for (const int length : {8, 64, 136})
      for (const int largest : {1, 3, 40, 2000, kLargestKeyedSquaredRadius})
        for (const int weight : {1, 2, 9, 144, 100000})
          for (uint32_t seed = 1; seed <= 4; ++seed) {
            CAPTURE(stride, length, largest, weight, seed);
            REQUIRE(windowDifferences(lines, stride, length, largest, weight, seed) == 0);
          }
}
