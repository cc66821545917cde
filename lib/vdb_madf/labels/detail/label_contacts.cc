// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/label_contacts.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Faces = std::map<std::pair<int32_t, int32_t>, int64_t>;

/// Each face is counted with the lower of its two voxels.
void addFaces(const LabelHalo& halo, Faces& faces) {
  auto last = faces.end();  // the next face is mostly of the same pair
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const size_t at = haloAt(x, y, z);
        const int32_t a = halo[at];
        if (!a) continue;
        for (const int step : kHaloStride)
          if (const int32_t b = halo[at + size_t(step)]; b && b != a) {
            const std::pair<int32_t, int32_t> pair = std::minmax(a, b);
            if (last == faces.end() || last->first != pair) last = faces.try_emplace(pair, 0).first;
            ++last->second;
          }
      }
}

}  // namespace

std::vector<LabelContact> labelContacts(const Int32Grid& labels, Interrupter* interrupter) {
  const LeafIndex index(*objectMask(labels));
  Faces faces;
  std::mutex mutex;
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    Faces local;
    LabelHalo halo;
    for (size_t leaf = begin; leaf < end; ++leaf) {
      readLabelHalo(labels.tree(), index.origin(leaf), halo);
      addFaces(halo, local);
    }
    // Integer sums: the order in which the parts arrive does not matter.
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [pair, count] : local) faces[pair] += count;
  });
  std::vector<LabelContact> contacts;
  for (const auto& [pair, count] : faces) contacts.push_back({pair.first, pair.second, count});
  return contacts;
}

}  // namespace vdb_madf::detail
