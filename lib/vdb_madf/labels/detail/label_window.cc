// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/label_window.h"

#include <algorithm>
#include <cstring>

namespace vdb_madf::detail {

void addLeaf(const LeafIndex::Mask& mask, int side, const WindowRange& range, WindowRows& rows) {
  const int dx = side / 9 - 1, dy = side / 3 % 3 - 1, dz = side % 3 - 1;
  const int begin = std::max(8 * dx, range.begin), end = std::min(8 * dx + 8, range.end);
  for (int x = begin; x < end; ++x) {
    uint8_t bytes[8];
    std::memcpy(bytes, &mask[size_t(x & 7)], sizeof bytes);
    uint32_t* line = rows.line(x) + 8 * (dy + 1);
    for (int y = 0; y < 8; ++y) line[y] |= uint32_t(bytes[y]) << 8 * (dz + 1);
  }
}

void LabelWindow::labelled(WindowRows& rows) const {
  rows.rows.fill(0);
  for (int side = 0; side < 27; ++side)
    if (const uint32_t leaf = around_[size_t(side)]; leaf != LeafIndex::kNone)
      addLeaf(labels_->index().mask(leaf), side, range_, rows);
}

void LabelWindow::moveTo(size_t leaf) {
  around_ = neighborhood_.around(leaf);
  places_.clear();
  for (int side = 0; side < 27; ++side)
    if (const uint32_t beside = around_[size_t(side)]; beside != LeafIndex::kNone)
      for (const LabelPart& part : labels_->parts(beside))
        places_.push_back({part.label, side, &part});
  sortPlaces();
}

void LabelWindow::sortPlaces() {
  std::sort(places_.begin(), places_.end(),
            [](const Place& a, const Place& b) { return a.label < b.label; });
}

void LabelWindow::labelled(int32_t label, WindowRows& rows) const {
  rows.rows.fill(0);
  auto place = std::lower_bound(places_.begin(), places_.end(), label,
                                [](const Place& p, int32_t wanted) { return p.label < wanted; });
  for (; place != places_.end() && place->label == label; ++place)
    addLeaf(place->part->mask, place->side, range_, rows);
}

std::vector<int32_t> LabelWindow::labels() const {
  std::vector<int32_t> labels;
  for (const Place& place : places_)
    if (labels.empty() || labels.back() != place.label) labels.push_back(place.label);
  return labels;
}

void LabelWindow::join(int32_t kept, int32_t gone) {
  for (Place& place : places_)
    if (place.label == gone) place.label = kept;
  sortPlaces();
}

int32_t LabelWindow::label(int x, int y, int z) const {
  const int side = ((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3 + (z >> 3) + 1;
  return labels_->label(around_[size_t(side)], (x & 7) * 64 + (y & 7) * 8 + (z & 7));
}

}  // namespace vdb_madf::detail
