// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/initialize.h"

#include <openvdb/openvdb.h>

#include <mutex>

#include "vdb_madf/segmentation/detail/graph_metadata_type.h"

namespace vdb_madf {

void initialize() {
  static std::once_flag once;
  std::call_once(once, [] {
    openvdb::initialize();
    detail::registerGraphMetadata();
  });
}

}  // namespace vdb_madf
