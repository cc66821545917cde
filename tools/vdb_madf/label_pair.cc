// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "label_pair.h"

#include "outputs.h"
#include "vdb_madf/files/standard_streams.h"
#include "vdb_madf/images/open_image.h"

namespace vdb_madf::tools {

void parsePair(InputOptions& first, InputOptions& second, const std::vector<std::string>& outputs) {
  for (InputOptions* input : {&first, &second}) input->outputs = outputs;
  first.parse();
  second.parse();
  second.sampleType = first.sampleType;
  second.bigEndian = first.bigEndian;
  second.bytesToSkip = first.bytesToSkip;
  second.size = first.size;
  if (!first.dataset.empty()) {
    // It is for those that have datasets; if none has, reading says so.
    const bool hasFirst = hasDatasets(first.path), hasSecond = hasDatasets(second.path);
    second.dataset = first.dataset;
    if (hasFirst && !hasSecond) second.dataset.clear();
    if (hasSecond && !hasFirst) first.dataset.clear();
  }
  for (InputOptions* input : {&first, &second})
    if (!hasRawEnding(input->path) && !isStandardInput(input->path)) input->size.reset();
}

PairNames namesOf(const InputOptions& first, const InputOptions& second) {
  return {first.path, second.path, "--shift", "--max-shift"};
}

LabelSlabs loadSlabs(const InputOptions& input, const std::string& gridOption, Progress* progress) {
  return isInSlabs(input) ? openLabelSlabs(input, gridOption, progress)
                          : singleSlab(loadLabels(input, gridOption, progress));
}

}  // namespace vdb_madf::tools
