// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/label_digest.h"

#include "vdb_madf/base/detail/checksum.h"

namespace vdb_madf::detail {

void LabelDigest::add(const LabelLeaves& labels) {
  const LeafIndex& index = labels.index();
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    Checksum sum;
    const LabelLeaves::Parts parts = labels.parts(leaf);
    for (int axis = 0; axis < 3; ++axis) sum.add(uint64_t(int64_t(index.origin(leaf)[axis])));
    sum.add(parts.size());
    for (const LabelPart& part : parts) {
      sum.add(uint64_t(part.label));
      for (const uint64_t word : part.mask) sum.add(word);
    }
    for (size_t i = 0; i < sums_.size(); ++i) sums_[i] += sum.value()[i];
  }
}

std::string LabelDigest::text() const {
  return checksumText(sums_);
}

std::string labelDigest(const LabelLeaves& labels) {
  LabelDigest digest;
  digest.add(labels);
  return digest.text();
}

}  // namespace vdb_madf::detail
