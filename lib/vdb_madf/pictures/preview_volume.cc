// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/preview_volume.h"

#include <memory>
#include <vector>

#include "vdb_madf/labels/detail/reduction.h"
#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf {

using openvdb::Vec3f;

LabelPreview previewLabels(const Int32Grid& labels, int factor, Interrupter* interrupter) {
  const detail::Reduction reduction(labels, factor);
  const GrainColors colors = grainColors(labels, interrupter);
  const float whole = float(int64_t(factor) * factor * factor);
  std::vector<std::unique_ptr<FloatGrid::TreeType::LeafNodeType>> densities(reduction.leafCount());
  std::vector<std::unique_ptr<ColorGrid::TreeType::LeafNodeType>> shades(reduction.leafCount());
  reduction.run(
      [&](size_t n, const Coord& origin, const detail::Cells& cells) {
        densities[n] = detail::leafAt<FloatGrid>(origin);
        shades[n] = detail::leafAt<ColorGrid>(origin);
        for (openvdb::Index i = 0; i < Int32Tree::LeafNodeType::SIZE; ++i) {
          if (!cells[i].labelled) continue;
          const Rgb rgb = colors.colorOf(cells[i].label);
          densities[n]->setValueOn(i, float(cells[i].labelled) / whole);
          shades[n]->setValueOn(
              i, Vec3f(linearChannel(rgb[0]), linearChannel(rgb[1]), linearChannel(rgb[2])));
        }
      },
      interrupter);
  LabelPreview preview;
  preview.density = detail::gather<FloatGrid>(densities, labels, factor, "density");
  preview.density->setGridClass(openvdb::GRID_FOG_VOLUME);
  preview.color = detail::gather<ColorGrid>(shades, labels, factor, "color");
  preview.color->setVectorType(openvdb::VEC_INVARIANT);
  return preview;
}

}  // namespace vdb_madf
