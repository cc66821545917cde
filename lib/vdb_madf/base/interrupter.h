// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/util/NullInterrupter.h>

namespace vdb_madf {

/// Asks a running computation to stop, and hears how far it is. Virtual; a null pointer: nobody
/// asks. The one header of OpenVDB that rooms without grids include: it includes nothing itself.
using Interrupter = openvdb::util::NullInterrupter;

}  // namespace vdb_madf
