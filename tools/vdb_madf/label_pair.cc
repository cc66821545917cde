// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "label_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/standard_streams.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/matching/compare.h"

namespace vdb_madf::tools {

void parsePair(InputOptions& first, InputOptions& second, const std::vector<std::string>& outputs) {
  for (InputOptions* input : {&first, &second}) input->outputs = outputs;
  first.parse();
  second.parse();
  second.sampleType = first.sampleType;
  second.bigEndian = first.bigEndian;
  second.bytesToSkip = first.bytesToSkip;
  second.size = first.size;
  for (InputOptions* input : {&first, &second})
    if (!hasRawEnding(input->path) && !isStandardInput(input->path)) input->size.reset();
}

void checkSameVoxels(const InputOptions& first, const Int32Grid& firstLabels,
                     const InputOptions& second, const Int32Grid& secondLabels) {
  constexpr double kTolerance = 1e-3;  // as for the spacings of an image
  const auto a = storedVoxelSize(firstLabels), b = storedVoxelSize(secondLabels);
  if (!a || !b) return;
  std::array<double, 3> ratios;
  for (size_t axis = 0; axis < 3; ++axis) ratios[axis] = b->edges()[axis] / a->edges()[axis];
  if (std::all_of(ratios.begin(), ratios.end(),
                  [](double ratio) { return std::abs(ratio - 1) <= kTolerance; }))
    return;
  std::ostringstream text;
  text.precision(4);
  text << second.path << ": its voxels are " << ratios[0];
  if (!a->isCube() || !b->isCube()) text << ", " << ratios[1] << ", " << ratios[2];
  text << " times as long as those of " << first.path << ": give labels of the same voxels";
  throw InvalidInput(text.str());
}

LabelSlabs loadSlabs(const InputOptions& input, const std::string& gridOption, Progress* progress) {
  return isInSlabs(input) ? openLabelSlabs(input, gridOption, progress)
                          : singleSlab(loadLabels(input, gridOption, progress));
}

}  // namespace vdb_madf::tools
