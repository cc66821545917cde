// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/written_together.h"

#include <string>

#include "support/catch.h"
#include "support/temporary_folder.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("written_together: a companion is replaced with its file, not by itself",
          "[written_together]") {
  const TemporaryFolder folder;
  const std::string file = folder.file("a.tif"), other = folder.file("a.truth.tif");
  CHECK_NOTHROW(checkWrittenTogether(file, {other}));
  writeBytes(other, "of someone else");
  try {
    checkWrittenTogether(file, {folder.file("absent"), other});
    FAIL("not noticed");
  } catch (const IoError& error) {
    CHECK_THAT(error.what(), vdb_madf::test::Contains(file) && vdb_madf::test::Contains(other));
  }
  writeBytes(file, "an earlier output");
  CHECK_NOTHROW(checkWrittenTogether(file, {other}));
}
