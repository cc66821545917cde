// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/label_digest.h"

#include "vdb_madf/labels/detail/label_digest.h"

namespace vdb_madf {

std::string labelDigest(const Int32Grid& labels, Interrupter* interrupter) {
  return detail::labelDigest(detail::LabelLeaves(labels, interrupter));
}

}  // namespace vdb_madf
