// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/preview_volume.h"

#include <memory>
#include <vector>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/reduction.h"
#include "vdb_madf/labels/grain_colors.h"

namespace vdb_madf {

using openvdb::Vec3f;

namespace {

LabelPreview preview(const Int32Grid& labels, const GrainColors& colors, int factor,
                     Interrupter* interrupter) {
  const detail::Reduction reduction(labels, factor, storedDomain(labels));
  std::vector<std::unique_ptr<FloatGrid::TreeType::LeafNodeType>> densities(reduction.leafCount());
  std::vector<std::unique_ptr<ColorGrid::TreeType::LeafNodeType>> shades(reduction.leafCount());
  reduction.run(
      [&](size_t n, const Coord& origin, const detail::Cells& cells) {
        densities[n] = detail::leafAt<FloatGrid>(origin);
        shades[n] = detail::leafAt<ColorGrid>(origin);
        for (openvdb::Index i = 0; i < Int32Tree::LeafNodeType::SIZE; ++i) {
          if (!cells[i].labelled) continue;
          const Rgb rgb = colors.colorOf(cells[i].label);
          densities[n]->setValueOn(i, float(cells[i].labelled) / float(cells[i].all));
          shades[n]->setValueOn(
              i, Vec3f(linearChannel(rgb[0]), linearChannel(rgb[1]), linearChannel(rgb[2])));
        }
      },
      interrupter);
  LabelPreview made;
  made.density = detail::gather<FloatGrid>(densities, labels, factor, "density");
  made.density->setGridClass(openvdb::GRID_FOG_VOLUME);
  made.color = detail::gather<ColorGrid>(shades, labels, factor, "color");
  made.color->setVectorType(openvdb::VEC_INVARIANT);
  return made;
}

}  // namespace

LabelPreview previewLabels(const Int32Grid& labels, int factor, Interrupter* interrupter) {
  return preview(labels, grainColors(labels, interrupter), factor, interrupter);
}

LabelPreview previewLabels(const LabelSlabs& labels, int factor, Interrupter* interrupter) {
  const GrainColors colors = grainColors(labels, interrupter);
  const LabelPreview whole = preview(*labels.about, colors, factor, interrupter);
  const auto add = [&](const Int32Grid& labelsOfPart) {
    const LabelPreview part = preview(labelsOfPart, colors, factor, interrupter);
    whole.density->tree().merge(part.density->tree());
    whole.color->tree().merge(part.color->tree());
  };
  detail::forEachPart(labels, factor, add, interrupter);
  return whole;
}

}  // namespace vdb_madf
