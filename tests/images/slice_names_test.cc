// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/slice_names.h"

#include <string>
#include <vector>

#include "support/catch.h"

using vdb_madf::detail::numberingNotes;
using vdb_madf::test::Contains;

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
             Contains("1 slice missing between a6.tif and a8.tif"));
  CHECK_THAT(noteOn({"a1_05.tif", "a1_06.tif", "a1_10.tif", "a1_11.tif"}),
             Contains("3 slices missing between a1_06.tif and a1_10.tif"));
  CHECK_THAT(noteOn({"a1.tif", "a2.tif", "a4.tif", "a5.tif", "a9.tif", "a10.tif", "a11.tif"}),
             Contains("4 slices missing in 2 places, the first between a2.tif and a4.tif"));
  CHECK_THAT(noteOn({"a0.tif", "a2.tif", "a4.tif", "a8.tif"}),
             Contains("1 slice missing between a4.tif and a8.tif"));
  CHECK_THAT(noteOn({"a1_t17.tif", "a2_t23.tif", "a4_t31.tif", "a5_t40.tif"}),
             Contains("1 slice missing between a2_t23.tif"));
}

TEST_CASE("slice_names: numbers without a gap are no news", "[slice_names]") {
  for (const Names& names :
       {Names{}, Names{"a.tif"}, Names{"a.tif", "b.tif", "c.tif"}, Names{"a7.tif"},
        Names{"a7.tif", "a8.tif", "a009.tif", "a10.tif"}, Names{"a10.tif", "a20.tif", "a30.tif"},
        Names{"a3.tif", "a900.tif"},
        // Times of day.
        Names{"a101530.tif", "a101533.tif", "a101541.tif", "a101546.tif", "a101552.tif"},
        Names{"p1_1.tif", "p1_2.tif", "p2_3.tif", "p2_4.tif"},
        Names{"rec_0001_0234.tif", "rec_0001_0235.tif", "rec_0001_0236.tif"},
        Names{"a0_r12.tif", "a1_r39.tif", "a2_r7.tif"},
        Names{"z0.09.tif", "z0.18.tif", "z0.27.tif"}, Names{"v1.9.tif", "v1.10.tif", "v1.11.tif"},
        Names{"z-1.tif", "z-2.tif"}, Names{"z0.tif", "z12.5.tif", "z25.tif"},
        Names{"a99999999999999999998.tif", "a99999999999999999999.tif"}}) {
    CAPTURE(names);
    CHECK(notesOn(names) == Names{});
  }
}

TEST_CASE("slice_names: every k-th slice may be higher than the scan's", "[slice_names]") {
  CHECK_THAT(noteOn({"a0.tif", "a4.tif", "a8.tif", "a12.tif"}),
             Contains("numbered by 4, as a0.tif and a4.tif, and taken for "
                      "neighbors"));
  CHECK(notesOn({"a0.tif", "a4.tif", "a8.tif", "a13.tif"}) == Names{});
}

TEST_CASE("slice_names: what may not belong to the stack is said", "[slice_names]") {
  CHECK_THAT(noteOn({"a06.tif", "a6.tif", "a7.tif"}),
             Contains("1 number of slices there twice, as in a06.tif and a6.tif"));
  CHECK_THAT(noteOn({"a1.tif", "a2.tif", "a3.tif", "mask.tif"}),
             Contains("names of 2 kinds, as a3.tif and mask.tif"));
  CHECK(notesOn({"a1.tif", "a3.tif", "a4.tif", "b1.tif", "b2.tif"}).size() == 2);
}

TEST_CASE("slice_names: an order by two numbers is said", "[slice_names]") {
  const auto order = [](const std::string& names) {
    return Contains("ordered by the first of them, as " + names);
  };
  CHECK_THAT(noteOn({"p1_1.tif", "p1_2.tif", "p2_1.tif", "p2_2.tif"}),
             order("p1_2.tif and p2_1.tif"));
  const Names two = notesOn({"s1_z6.tif", "s1_z7.tif", "s2_z5.tif", "s2_z6.tif", "s2_z8.tif"});
  REQUIRE(two.size() == 2);
  CHECK_THAT(two[0], order("s1_z7.tif and s2_z5.tif"));
  CHECK_THAT(two[1], Contains("1 slice missing between s2_z6.tif and s2_z8.tif"));
  // Each slice has a time of its own, and so has one that is missing.
  CHECK_THAT(noteOn({"t02_z3.tif", "t11_z1.tif", "t37_z0.tif", "t40_z4.tif"}),
             order("t02_z3.tif and t11_z1.tif"));
}

TEST_CASE("slice_names: numbers that have no order as whole ones are refused", "[slice_names]") {
  const auto refused = [](const Names& names, const std::string& why) {
    CHECK_THROWS_WITH(notesOn(names), vdb_madf::test::StartsWith("scan: ") && Contains(why) &&
                                          Contains(": rename them"));
  };
  refused({"z-1.tif", "z-2.tif", "z0.tif", "z1.tif"}, "below 0, as in z-1.tif and z0.tif");
  refused({"z+00.tif", "z+01.tif", "z-01.tif"}, "below 0, as in z-01.tif and z+00.tif");
  refused({"z0.5.tif", "z0.25.tif", "z0.75.tif"},
          "decimals of unequal digits, as z0.5.tif and z0.25");
  refused({"z1.tif", "z0.5um.tif", "z0.25um.tif", "z0.75um.tif", "z1.5um.tif", "z1.25um.tif"},
          "z0.5um.tif and z0.25um");
  refused({"z0.5.tif", "z0.tif", "z1.5.tif", "z1.tif"}, "as z0.5.tif and z0.tif");
}
