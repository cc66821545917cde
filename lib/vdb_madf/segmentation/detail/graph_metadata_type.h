// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf::detail {

/// Part of initialize(): lets files hold graphs. Further calls do nothing.
void registerGraphMetadata();

}  // namespace vdb_madf::detail
