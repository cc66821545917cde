// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/measure/binder.h"
#include "vdb_madf/measure/extra_measures.h"
#include "vdb_madf/measure/measure_bonds.h"
#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf {

/// A column of the table of grains or of bonds: the one list that the files of tables and networks
/// are written from.
struct MeasureColumn {
  enum class Kind {
    number,
    count,  ///< whole numbers
    label,  ///< whole numbers that name a grain
    flag,   ///< 0 or 1; bools in Python
    place   ///< a coordinate of a place, along `axis`
  };
  std::string name;  ///< letters, digits, underscores; without the unit
  Kind kind = Kind::number;
  int power = 0;               ///< of the length that it is measured in: 2 is an area; -2 to 3
  int axis = 0;                ///< 0, 1, 2: x, y, z; of places
  std::vector<double> values;  ///< a row each, in voxels (Measurements); NaN: not known

  /// True if the values are whole numbers, without a unit.
  bool isWhole() const { return kind != Kind::number && kind != Kind::place; }
};

/// `id`, `voxels`, `volume`, `equivalent_diameter`, `centroid_x`, `_y`, `_z`, `representative_x`,
/// `_y`, `_z`, `inscribed_radius`, `area`, `free_area`, `shared_area`, `cut_area`, `sphericity`,
/// `axis1_length` to `axis3_length`, `aspect_2_to_1`, `aspect_3_to_2`, `axis1_x`, `_y`, `_z` to
/// `axis3...`, `box_min_x` ..., `box_max_x` ... (index coordinates), `coordination`,
/// `at_domain_face` (0 or 1). With the shape also `feret_max`, `feret_min`, `convex_volume`,
/// `solidity`, `zingg_class` (1 to 4: zinggClass()); with gray values `gray_voxels`, `gray_mean`,
/// `gray_sd`, `gray_min`, `gray_max`, `gray_median`; with edge weights `edge_weight`; with cells
/// `cell_volume`, `local_solid_fraction`, `cell_neighbors`, `cell_at_domain_face` (0 or 1); with
/// sizes `projected_diameter`; with recurrences `p_grain`, `volume_sd`; with the stability `born`,
/// `dies`, `stability`. What is given comes last; if a column is called so already, with or
/// without its unit, as givenName(), or not at all if it has the same numbers
/// to five digits, with a unit in its name also if all are as many times larger.
std::vector<MeasureColumn> grainColumns(const std::vector<GrainMeasures>& grains,
                                        const ExtraMeasures& extra = {});

/// The name of what is given where there is another column of this name: `given_` and the name.
std::string givenName(const std::string& name);

/// `first`, `second`, `faces` (shared voxel faces), `area`, `radius`, `centroid_x`, `_y`, `_z`
/// (mean of the centers of the faces), `normal_x`, `_y`, `_z`, `distance`, `cos_alpha`, `flatness`,
/// `patches`, `curvature_points`, `mean_curvature`, `mean_curvature_sd`, `gaussian_curvature`,
/// `gaussian_curvature_sd`, `curvature_residual`. A bond without a curvature has 0
/// `curvature_points` and none of the four. With radii of bonds `inscribed_radius`; with gray
/// values the columns that grains have; with necks `neck_area`, `neck_radius`, `neck_error`,
/// `neck_gap`, `neck_confirmed` (0 or 1), `neck_normal_x`, `_y`, `_z`; with the stability
/// `vanishes`; with recurrences `p_bond`, `area_sd`; with crossings `cut_x`, `_y`, `_z` (0 or 1),
/// `current_x`, `_y`, `_z`.
std::vector<MeasureColumn> bondColumns(const std::vector<BondMeasures>& bonds,
                                       const ExtraMeasures& extra = {});

/// `first`, `second`, `bonded` (0 or 1), `voxels`, `volume`, `section_area`, `section_radius`,
/// `first_cover_area`, `second_cover_area`, `first_cover_share`, `second_cover_share`.
std::vector<MeasureColumn> bridgeColumns(const std::vector<Bridge>& bridges);

/// What a power of a length appends to a name: "" (0), "_mm", "_mm2", "_per_mm", "_per_mm2" ...
std::string unitSuffix(int power, const std::string& unit);

/// A number in voxels, of that power of a length, where voxels have this edge; the shortest, if
/// they are no cubes.
double scaled(double value, int power, double edge);

/// A number of a column where voxels have these edges: places are index coordinates, all else is in
/// the shortest edge.
double scaled(const MeasureColumn& column, double value, const openvdb::Vec3d& edges);

}  // namespace vdb_madf
