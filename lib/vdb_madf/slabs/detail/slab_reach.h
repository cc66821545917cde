// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/slab_faces.h"
#include "vdb_madf/slabs/detail/site_offers.h"
#include "vdb_madf/slabs/detail/slab_work.h"

// What reaches from slab to slab before the power map.

namespace vdb_madf::detail {

/// Tells each slab how far the background of its columns is beyond its cuts. Two steps from slab to
/// slab, of tables alone.
void exchangeColumns(SlabWork& work);
/// A slab's cuts, with what was told.
SlabFaces facesOf(const SlabWork& work, size_t slab);
void forgetColumns(SlabWork& work, size_t slab);

/// Offers of balls from slab to slab; the name tells those of all balls from those that a filter kept.
class SlabOffers {
 public:
  SlabOffers(SlabWork& work, const std::string& name)
      : work_(work), up_(name + "-up"), down_(name + "-down") {}

  /// Of an own slab; sites(isUpper): what it offers at a cut, in ColumnOrder.
  void offer(size_t slab, const std::function<std::vector<ForeignSite>(bool isUpper)>& sites);
  /// Two steps: passes all on, from slab to slab, tables alone.
  void passOn();
  /// The balls beyond that may win in a slab. Names their leaves in its index.
  std::shared_ptr<const ForeignSites> received(size_t slab, LeafIndex& index) const;
  void forget(size_t slab);

 private:
  std::vector<ForeignSite> from(const std::string& name, size_t slab, bool below) const;

  SlabWork& work_;
  std::string up_, down_;
};

}  // namespace vdb_madf::detail
