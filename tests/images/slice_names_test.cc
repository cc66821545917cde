// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/slice_names.h"

#include <string>
#include <vector>

#include "support/catch.h"

using vdb_madf::detail::numberingNotes;

namespace {

using Names = std::vector<std::string>;

Names notesOn(Names names) {
  for (std::string& name : names) name = "scan/" + name;
  return numberingNotes("scan", names);
}

/// The only note, which has to name the folder.
std::string noteOn(const Names& names) {
  const Names notes = notesOn(names);
  if (notes.size() != 1) return std::to_string(notes.size()) + " notes";
  CHECK(notes[0].find("scan: ") == 0);
  return notes[0];
}

}  // namespace

TEST_CASE("slice_names: numbers that are left out are said", "[slice_names]") {
  CHECK_THAT(noteOn({"a5.tif", "a6.tif", "a8.tif", "a9.tif"}),
             vdb_madf::test::Contains("1 slice missing between a6.tif and a8.tif"));
  CHECK_THAT(noteOn({"a1_05.tif", "a1_06.tif", "a1_10.tif", "a1_11.tif"}),
             vdb_madf::test::Contains("3 slices missing between a1_06.tif and a1_10.tif"));
  CHECK_THAT(noteOn({"a1.tif", "a2.tif", "a4.tif", "a5.tif", "a9.tif", "a10.tif", "a11.tif"}),
             vdb_madf::test::Contains(
                 "4 slices missing in 2 places, the first between a2.tif and a4.tif"));
  CHECK_THAT(noteOn({"a0.tif", "a2.tif", "a4.tif", "a8.tif"}),
             vdb_madf::test::Contains("1 slice missing between a4.tif and a8.tif"));
  CHECK_THAT(noteOn({"a1_t17.tif", "a2_t23.tif", "a4_t31.tif", "a5_t40.tif"}),
             vdb_madf::test::Contains("1 slice missing between a2_t23.tif"));
}

TEST_CASE("slice_names: numbers without a gap are no news", "[slice_names]") {
  for (const Names& names :
       {Names{}, Names{"a.tif"}, Names{"a.tif", "b.tif", "c.tif"}, Names{"a7.tif"},
        Names{"a7.tif", "a8.tif", "a009.tif", "a10.tif"}, Names{"a10.tif", "a20.tif", "a30.tif"},
        Names{"a3.tif", "a900.tif"},
        // Times of day.
        Names{"a101530.tif", "a101533.tif", "a101541.tif", "a101546.tif", "a101552.tif"},
        Names{"p1_1.tif", "p1_2.tif", "p2_1.tif", "p2_2.tif"},
        Names{"a99999999999999999998.tif", "a99999999999999999999.tif"}}) {
    CAPTURE(names);
    CHECK(notesOn(names) == Names{});
  }
}

TEST_CASE("slice_names: every k-th slice may be higher than the scan's", "[slice_names]") {
  CHECK_THAT(noteOn({"a0.tif", "a4.tif", "a8.tif", "a12.tif"}),
             vdb_madf::test::Contains("numbered by 4, as a0.tif and a4.tif, and taken for "
                                      "neighbors"));
  CHECK(notesOn({"a0.tif", "a4.tif", "a8.tif", "a13.tif"}) == Names{});
}

TEST_CASE("slice_names: what may not belong to the stack is said", "[slice_names]") {
  CHECK_THAT(noteOn({"a06.tif", "a6.tif", "a7.tif"}),
             vdb_madf::test::Contains("1 number of slices there twice, as in a06.tif and a6.tif"));
  CHECK_THAT(noteOn({"a1.tif", "a2.tif", "a3.tif", "mask.tif"}),
             vdb_madf::test::Contains("names of 2 kinds, as a3.tif and mask.tif"));
  CHECK(notesOn({"a1.tif", "a3.tif", "a4.tif", "b1.tif", "b2.tif"}).size() == 2);
}
