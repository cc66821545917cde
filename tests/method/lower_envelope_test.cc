// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/lower_envelope.h"

#include <algorithm>
#include <random>
#include <vector>

#include "support/catch.h"

namespace {

using namespace vdb_madf::detail;

size_t slabIndex(int t, int row) {
  return size_t(t) * kEnvelopeSlab + size_t(row);
}

/// Rows with gaps in the object, sites among the rest, and so few values that ties are common.
template <typename Key>
EnvelopeRows<Key> randomRows(int length, int maxRadius2, uint32_t seed) {
  std::mt19937 random(seed);
  EnvelopeRows<Key> rows;
  rows.resize(size_t(length));
  for (int t = 0; t < length; ++t) {
    for (int row = 0; row < 64; ++row) {
      const bool object = random() % 12 != 0, site = random() % (1 + unsigned(row) % 5) == 0;
      const int radius2 = 1 + int(random() % unsigned(maxRadius2));
      const int power = -1 - int(random() % unsigned(radius2));
      rows.power[slabIndex(t + 1, row)] = !object ? 0 : site ? power : kNotNegative;
      rows.site[slabIndex(t, row)] = uint32_t(t);
      rows.radius2[slabIndex(t + 1, row)] = radius2;
    }
  }
  return rows;
}

/// Voxels where the pass is not what its definition says.
template <typename Key>
int envelopeDifferences(int length, int maxRadius2, int weight, uint32_t seed) {
  const EnvelopeRows<Key> in = randomRows<Key>(length, maxRadius2, seed);
  EnvelopeRows<Key> out = in;
  lowerEnvelopes(length, Key(maxRadius2) + 1, weight, out);
  const auto power = [&](int t, int row) { return in.power[slabIndex(t + 1, row)]; };
  int wrong = 0;
  for (int row = 0; row < 64; ++row) {
    for (int t = 0; t < length; ++t) {
      if (power(t, row) == 0) continue;
      int begin = t, end = t;
      while (begin > 0 && power(begin - 1, row) != 0) --begin;
      while (end < length && power(end, row) != 0) ++end;
      int best = kNotNegative, site = -1;
      for (int s = begin; s < end; ++s) {
        if (power(s, row) >= 0) continue;
        const int value = power(s, row) + weight * (s - t) * (s - t);
        if (value >= 0) continue;
        if (value < best || (value == best && in.radius2[slabIndex(s + 1, row)] >
                                                  in.radius2[slabIndex(site + 1, row)])) {
          best = value;
          site = s;
        }
      }
      wrong += out.power[slabIndex(t + 1, row)] != best;
      if (site >= 0) wrong += out.site[slabIndex(t, row)] != uint32_t(site);
    }
  }
  return wrong;
}

}  // namespace

TEST_CASE("lower_envelope: by its definition, with keys of either width", "[lower_envelope]") {
  for (const int length : {8, 64, 136}) {
    for (const int maxRadius2 : {1, 3, 40, 2000}) {
      for (uint32_t seed = 1; seed <= 10; ++seed) {
        CAPTURE(length, maxRadius2, seed);
        REQUIRE(envelopeDifferences<int64_t>(length, maxRadius2, 1, seed) == 0);
        REQUIRE(envelopeDifferences<__int128>(length, maxRadius2, 1, seed) == 0);
      }
    }
  }
}

TEST_CASE("lower_envelope: by its definition, with weights", "[lower_envelope]") {
  for (const int length : {8, 136}) {
    for (const int weight : {2, 9, 144, 100000}) {
      for (const int reach : {1, 3, 40}) {
        // Radii that reach so many voxels far; the remainder decides ties.
        const int maxRadius2 = weight * reach * reach + weight % 7;
        const bool fits = 2.0 * weight * length * length * (maxRadius2 + 2.0) * length < 9e18;
        for (uint32_t seed = 1; seed <= 5; ++seed) {
          CAPTURE(length, weight, reach, seed);
          if (fits) REQUIRE(envelopeDifferences<int64_t>(length, maxRadius2, weight, seed) == 0);
          REQUIRE(envelopeDifferences<__int128>(length, maxRadius2, weight, seed) == 0);
        }
      }
    }
  }
}
