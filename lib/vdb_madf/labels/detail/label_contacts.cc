// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/label_contacts.h"

#include <algorithm>
#include <mutex>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

/// Each face is counted with the lower of its two voxels.
void addFaces(const LabelHalo& halo, ContactFaces& faces) {
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

void addContactFaces(const Int32Tree& labels, const std::vector<Coord>& origins,
                     ContactFaces& faces, Interrupter* interrupter) {
  std::mutex mutex;
  parallelFor(origins.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    ContactFaces local;
    LabelHalo halo;
    for (size_t n = begin; n < end; ++n) {
      readLabelHalo(labels, origins[n], halo);
      addFaces(halo, local);
    }
    // Integer sums: the order in which the parts arrive does not matter.
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [pair, count] : local) faces[pair] += count;
  });
}

std::vector<LabelContact> contactsOf(const ContactFaces& faces) {
  std::vector<LabelContact> contacts;
  for (const auto& [pair, count] : faces) contacts.push_back({pair.first, pair.second, count});
  return contacts;
}

std::vector<LabelContact> labelContacts(const Int32Grid& labels, Interrupter* interrupter) {
  const LeafIndex index(*objectMask(labels));
  std::vector<Coord> origins;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) origins.push_back(index.origin(leaf));
  ContactFaces faces;
  addContactFaces(labels.tree(), origins, faces, interrupter);
  return contactsOf(faces);
}

}  // namespace vdb_madf::detail
