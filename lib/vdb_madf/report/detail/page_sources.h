// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf::detail {

/// The parts of the page that are the same for all samples.
struct PageSources {
  const char* html;    ///< page/page.html
  const char* style;   ///< page/page.css, made small
  const char* script;  ///< page/main.js with all that it imports, in one
};

/// Made by the build (cmake/ReportPage.cmake); null if it lacked what the script is made with.
const PageSources* pageSources();

}  // namespace vdb_madf::detail
