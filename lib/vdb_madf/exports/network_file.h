// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/measure/grain_network.h"

namespace vdb_madf {

/// Writes the network, whole or not at all, by ending:
/// - .vtp: VTK points with the grains' columns and Int32 `grain_id`, lines with the bonds' columns
///   and Int32 `first`, `second`; points have UInt8 `color`, too
/// - .graphml: nodes `n<label>` with `grain_id`, x, y, z and the columns; undirected edges
/// - .csv: a table in OpenPNM's naming: `pore.coords[0..2]`, `pore.<column>`,
///   `throat.conns[0..1]`, `throat.<column>`, and once more by its and PoreSpy's names:
///   `pore.region_label`, `pore.diameter` (of equal volume), `pore.inscribed_diameter`,
///   `pore.surface_area`, `pore.region_volume`, `throat.diameter`, `throat.equivalent_diameter` (of
///   equal area), `throat.inscribed_diameter`, `throat.cross_sectional_area`,
///   `throat.direct_length`; the shorter of the two lists is filled up with empty cells
/// - .txt: a bonded-particle model for MUSEN (musen_file.h)
/// A NaN is NaN in .vtp, no entry in .graphml, an empty cell in .csv.
/// @throw InvalidInput for another ending, or as writeMusen(); IoError; Interrupted.
void writeNetwork(const std::string& path, const GrainNetwork& network,
                  Interrupter* interrupter = nullptr);
/// True if writeNetwork knows the ending.
bool isNetworkEnding(const std::string& path);

}  // namespace vdb_madf
