// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// This stands in for what cmake/ReportPage.cmake makes, where it cannot.
#include "vdb_madf/report/detail/page_sources.h"

namespace vdb_madf::detail {

const PageSources* pageSources() {
  return nullptr;
}

}  // namespace vdb_madf::detail
