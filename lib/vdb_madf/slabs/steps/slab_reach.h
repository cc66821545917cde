// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/detail/slab_faces.h"
#include "vdb_madf/slabs/cuts/site_offers.h"
#include "vdb_madf/slabs/steps/slab_work.h"

// What reaches from slab to slab before the power map.

namespace vdb_madf::detail {

/// Tells each slab how far the background of its columns is beyond its cuts. Two steps from slab to
/// slab, of tables alone.
void exchangeColumns(SlabWork& work);
/// A slab's cuts, with what was told.
SlabFaces facesOf(const SlabWork& work, size_t slab);

/// Where offers of balls are stored, and the steps that pass them on.
struct OfferNames {
  Piece<Values<ForeignSite>> up, down;
  Message<Values<ForeignSite>> fromBelow, fromAbove;
  Step stepUp, stepDown;
};
inline constexpr OfferNames kOffersOfAllBalls{kOffersUp,        kOffersDown,    kOffersFromBelow,
                                              kOffersFromAbove, Step::offersUp, Step::offersDown};
inline constexpr OfferNames kOffersOfKeptBalls{kKeptUp,        kKeptDown,    kKeptFromBelow,
                                               kKeptFromAbove, Step::keptUp, Step::keptDown};

/// Offers of balls from slab to slab.
class SlabOffers {
 public:
  SlabOffers(SlabWork& work, const OfferNames& names) : work_(work), names_(names) {}

  /// Offers the balls of an own slab; sites(isUpper): what it offers at a cut, in ColumnOrder.
  void offer(size_t slab, const std::function<std::vector<ForeignSite>(bool isUpper)>& sites);
  /// Two steps: passes all on, from slab to slab, tables alone.
  void passOn();
  /// The balls beyond that may win in a slab. Names their leaves in its index.
  std::shared_ptr<const ForeignSites> received(size_t slab, LeafIndex& index) const;

 private:
  std::vector<ForeignSite> fromBelow(size_t slab) const;
  std::vector<ForeignSite> fromAbove(size_t slab) const;

  SlabWork& work_;
  const OfferNames& names_;
};

}  // namespace vdb_madf::detail
