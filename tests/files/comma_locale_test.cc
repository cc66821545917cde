// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <array>
#include <cstdio>
#include <string>

#include "support/catch.h"
#include "support/comma_locale.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/size_text.h"

using namespace vdb_madf;
using test::CommaLocale;

TEST_CASE("comma_locale: sizes are read with a point", "[comma_locale]") {
  const CommaLocale locale;
  if (!locale.isSet()) return;
  char text[8];
  std::snprintf(text, sizeof text, "%.1f", 8.5);
  REQUIRE(std::string(text) == "8,5");  // or the locale shows nothing

  REQUIRE(voxelSizeFromText("8.5um").edge() == 8.5e-6);
  REQUIRE(voxelSizeFromText("0.5x0.5x1.25 um").edges() ==
          std::array<double, 3>{5e-7, 5e-7, 1.25e-6});
  REQUIRE(bytesFromText("1.5 KiB") == 1536);
  REQUIRE(numberFromText("-0.85") == -0.85);
  REQUIRE(numberFromText(" +1e3") == 1000);
  for (const char* wrong : {"", " ", "8,5", "1.5.5", "nan", "1e999", "+-1", "x"}) {
    CAPTURE(wrong);
    REQUIRE_THROWS_AS(numberFromText(wrong), InvalidInput);
  }
  REQUIRE_THROWS_WITH(voxelSizeFromText("8,5um"),
                      vdb_madf::test::Contains("write a point, not a comma"));
}

TEST_CASE("comma_locale: numbers are written with a point", "[comma_locale]") {
  const CommaLocale locale;
  if (!locale.isSet()) return;
  REQUIRE(readableBytes(1536) == "1.5 KiB");
  REQUIRE(readableBytes(int64_t(150) << 20) == "150 MiB");
  REQUIRE(readableBytes(7) == "7 bytes");
  REQUIRE(lengthIn(1e6, 8.5e-6) == "8.5");
}
