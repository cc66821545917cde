// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/verify/detail/definition.h"
#include "vdb_madf/verify/detail/dense_box.h"

namespace vdb_madf::detail {

/// What a voxel is. Those from object on are the body.
enum class Voxel : uint8_t { unknown, background, object, cavity };
using Voxels = std::vector<Voxel>;
inline bool isBody(Voxel voxel) {
  return voxel >= Voxel::object;
}

/// Makes background that cavities are, and returns how many there are.
int64_t fillCavities(const DenseBox& space, const Definition& definition, Voxels& voxels);

/// D of each voxel of the body; kFar if there is no background.
constexpr int32_t kFar = INT32_MAX;
std::vector<int32_t> squaredDistance(const DenseBox& space, const Definition& definition,
                                     const Voxels& voxels, Interrupter* interrupter);

/// A voxel of the body, as a number of the box, for each voxel of the body.
using Sites = std::vector<int32_t>;
constexpr int32_t kNone = -1;

struct Flow {
  Sites site;      ///< Pi'
  Sites critical;  ///< the critical point that a voxel reaches
  int64_t medialBalls = 0, keptBalls = 0;
};
Flow flowOf(const DenseBox& space, const Definition& definition, const Voxels& voxels,
            const std::vector<int32_t>& distance, Interrupter* interrupter);

}  // namespace vdb_madf::detail
