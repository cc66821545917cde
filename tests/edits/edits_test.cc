// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/edits.h"

#include "support/catch.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;

TEST_CASE("edits: a text says what it is of", "[edits]") {
  const Edit merge = parseEdit("merge 12,17  3");
  CHECK(merge.kind == Edit::Kind::merge);
  CHECK(merge.grains == std::vector<int32_t>{12, 17, 3});
  CHECK(parseEdit("split 2147483647").grains == std::vector<int32_t>{2147483647});
  CHECK(parseEdit("min-voxels 0").voxels == 0);
  CHECK(parseEdit("max-diameter 1mm").diameter == 1e-3);
  for (const std::string text :
       {"split 9", "merge 12 17 3", "drop 5", "keep 1 2 3", "min-voxels 100", "max-voxels 5000",
        "join-below 27", "min-diameter 8.5um", "max-diameter 1000um", "drop-at-faces", "renumber",
        "strictness 10.5", "strictness -3"})
    CHECK(toString(parseEdit(text)) == text);
}

TEST_CASE("edits: a line an edit", "[edits]") {
  const auto edits =
      parseEdits("# of the left half\r\n\r\nmerge 12 17   # touch\n\t drop 5,6\n\nrenumber");
  REQUIRE(edits.size() == 3);
  CHECK(toString(edits[0]) == "merge 12 17");
  CHECK(toString(edits[1]) == "drop 5 6");
  CHECK(toString(edits[2]) == "renumber");
  CHECK(parseEdits("").empty());
  CHECK(parseEdits("# nothing\n\n").empty());
}

TEST_CASE("edits: what is none is refused, by its line", "[edits]") {
  const std::pair<const char*, const char*> wrong[] = {
      {"mrege 1 2", "'mrege' is no edit: there are split, merge, drop"},
      {"merge 12", "merge takes 2 or more, and is given 1"},
      {"split 1 2", "split takes one grain, and is given 2"},
      {"drop", "drop takes 1 or more, and is given 0"},
      {"drop 5 7 5", "grain 5 is named twice"},
      {"keep 0", "grain 0 cannot be"},
      {"keep -3", "grain -3 cannot be"},
      {"keep 2147483648", "grain 2147483648 cannot be"},
      {"keep 99999999999999999999", "'99999999999999999999' is no number of a grain"},
      {"keep 1.5", "'1.5' is no number of a grain"},
      {"keep x", "'x' is no number of a grain"},
      {"min-voxels", "min-voxels takes one number of voxels, and is given 0"},
      {"min-voxels -1", "'-1' is no number of voxels"},
      {"join-below -1", "'-1' is no number of voxels"},
      {"join-below 2.5", "'2.5' is no number of voxels"},
      {"max-voxels 1 2", "max-voxels takes one number of voxels, and is given 2"},
      {"min-diameter 100", "100: "},
      {"min-diameter 1x2x3um", "a diameter is one length"},
      {"min-diameter nanum", "nanum: "},
      {"renumber 1", "renumber takes nothing, and is given 1"},
      {"strictness", "strictness takes one number, and is given 0"},
      {"strictness 11um", "'11um' is no number"},
      {"strictness nan", "'nan' is no number"},
      {"\x01", "'?' is no edit"}};
  for (const auto& [text, says] : wrong) {
    CAPTURE(text);
    CHECK_THROWS_WITH(parseEdit(text), vdb_madf::test::Contains(says));
    CHECK_THROWS_WITH(parseEdits("drop 1\n\n" + std::string(text) + "\n"),
                      vdb_madf::test::StartsWith("line 3: ") && vdb_madf::test::Contains(says));
  }
  CHECK_THROWS_AS(parseEdit(""), InvalidInput);
  CHECK_THROWS_WITH(parseEdits(std::string("drop 1\0 2", 9)),
                    vdb_madf::test::StartsWith("line 1: "));
  CHECK_THROWS_WITH(parseEdits(std::string(100000, 'x')),
                    vdb_madf::test::StartsWith("line 1: 'xxx"));
}
