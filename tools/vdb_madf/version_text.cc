// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "version_text.h"

#include <openvdb/version.h>

#include "vdb_madf/base/simd_level.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/report/report.h"

namespace vdb_madf::tools {

std::string versionText() {
  return std::string(kVersion) + "\nOpenVDB " + openvdb::getLibraryVersionString() +
         "\nSIMD level " + simdLevel() +
         (readsHdf5() ? "\nHDF5 is read and written"
                      : "\nHDF5 is not read or written: install libhdf5-dev, then configure and "
                        "build again") +
         (canWriteReport() ? "\nReports are written"
                           : "\nReports are not written: install esbuild, libjs-three and "
                             "libjs-jquery-datatables, then configure and build again");
}

}  // namespace vdb_madf::tools
