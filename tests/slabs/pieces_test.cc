// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What slabs keep in scratch: its types, and how long it lives.

#include "vdb_madf/slabs/store/pieces.h"

#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "support/catch.h"
#include "support/random_case.h"
#include "support/slab_objects.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/slabs/segment_slabs.h"
#include "vdb_madf/slabs/store/slab_store.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::detail;
using namespace vdb_madf::test;

template <typename P, typename T, typename = void>
struct CanWrite : std::false_type {};
template <typename P, typename T>
struct CanWrite<P, T,
                std::void_t<decltype(std::declval<SlabStore&>().write(
                    std::declval<P>(), size_t(0), std::declval<T>()))>> : std::true_type {};

template <typename M, typename T, typename = void>
struct CanSend : std::false_type {};
template <typename M, typename T>
struct CanSend<M, T,
               std::void_t<decltype(std::declval<SlabStore&>().send(
                   std::declval<M>(), size_t(0), size_t(1), std::declval<T>()))>> : std::true_type {
};

/// Scratch that tells the names of what is in it.
class ListedScratch : public MemoryScratch {
 public:
  void writeBytes(const std::string& name, const char* bytes, size_t size) override {
    names.insert(name);
    written.insert(name);
    MemoryScratch::writeBytes(name, bytes, size);
  }
  void remove(const std::string& name) override {
    names.erase(name);
    MemoryScratch::remove(name);
  }

  std::set<std::string> names, written;
};

/// The name of a piece or message without the numbers at its end.
std::string withoutNumbers(std::string name) {
  while (name.find_last_not_of("0123456789") + 1 < name.size() &&
         name[name.find_last_not_of("0123456789")] == '-')
    name.resize(name.find_last_not_of("0123456789"));
  return name;
}

}  // namespace

TEST_CASE("pieces: no value of another type compiles", "[pieces]") {
  STATIC_REQUIRE(CanWrite<Piece<Values<ForeignSite>>, Values<ForeignSite>>::value);
  STATIC_REQUIRE_FALSE(CanWrite<Piece<Values<ForeignSite>>, Values<Coord>>::value);
  STATIC_REQUIRE(CanWrite<decltype((kFlow)), VoxelArray<uint32_t>>::value);
  STATIC_REQUIRE_FALSE(CanWrite<decltype((kFlow)), VoxelArray<int32_t>>::value);
  STATIC_REQUIRE_FALSE(CanWrite<decltype((kFlow)), Values<uint32_t>>::value);
  STATIC_REQUIRE(CanSend<decltype((kRescued)), Values<Coord>>::value);
  STATIC_REQUIRE_FALSE(CanSend<decltype((kRescued)), Values<FacePiece>>::value);
  // A piece is no message, and a name is neither.
  STATIC_REQUIRE_FALSE(CanSend<decltype((kContacts)), Values<ManifoldGraph::Edge>>::value);
  STATIC_REQUIRE_FALSE(CanWrite<decltype((kRescued)), Values<Coord>>::value);
  STATIC_REQUIRE_FALSE(CanWrite<const char*, Values<Coord>>::value);
}

TEST_CASE("pieces: at the end there is what no step forgets", "[pieces]") {
  std::set<std::string> forgotten, kept;
  forEachForgotten([&](const StoredName& piece) { forgotten.insert(piece.name); },
                   [&](const StoredName& message, From) { forgotten.insert(message.name); });
  const auto keep = [&](const StoredName& name) {
    CAPTURE(name.name);
    REQUIRE(name.last == Step::never);
    kept.insert(name.name);
  };
  for (const StoredName& piece :
       {StoredName(kDone), StoredName(kPut), StoredName(kCavities), StoredName(kLargest),
        StoredName(kGraphPart), StoredName(kPartFacts), StoredName(kClasses), StoredName(kGrains),
        StoredName(kMergeOpen), StoredName(kMergeDecided), StoredName(kMergeNumbers),
        StoredName(kMergeGrains)})
    keep(piece);
  for (const StoredName& message :
       {StoredName(kHoles), StoredName(kComponents), StoredName(kJoinedComponents),
        StoredName(kRescued), StoredName(kBallCounts), StoredName(kExits), StoredName(kPoints),
        StoredName(kQuestions), StoredName(kAnswers), StoredName(kLeads), StoredName(kNumbers),
        StoredName(kClassGraph), StoredName(kAnchors), StoredName(kPieces),
        StoredName(kJoinedPieces), StoredName(kHeld), StoredName(kLoose), StoredName(kRefilled),
        StoredName(kCounts)})
    keep(message);
  std::set<std::string> left, written;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    RandomCase c = randomCase(seed);
    if (seed % 4 == 3) drawRegion(c);
    SegmentOptions options = optionsOf(c);
    options.domain = domainOf(c);
    options.keepDistance = options.keepPower = options.keepBalls = false;
    options.keepManifold = seed % 2 == 0;
    options.tidy = seed % 3 ? 2 : 0;
    options.gamma = seed % 8 < 4 ? 0 : 20;
    const MaskGrid::Ptr mask = maskOf(c);
    const CoordBBox box = c.domain ? *c.domain : mask->evalActiveVoxelBoundingBox();
    if (box.empty()) continue;
    const int first = box.min().z() & ~7, last = (box.max().z() | 7) + 1;
    std::vector<int> cuts{first};
    while (cuts.back() < last) cuts.push_back(cuts.back() + 8);
    ListedScratch scratch;
    try {
      segmentSlabs(cutObject(*mask, cuts), options, scratch, [](size_t, const SlabGrids&) {});
    } catch (const InvalidInput&) {
      continue;  // such as an object without background
    }
    for (const std::string& name : scratch.names) left.insert(withoutNumbers(name));
    for (const std::string& name : scratch.written) written.insert(withoutNumbers(name));
  }
  CAPTURE(left);
  for (const std::string& name : left) {
    CAPTURE(name);
    CHECK(forgotten.count(name) == 0);
    CHECK(kept.count(name) == 1);  // or forEachForgotten() leaves out what has a last step
  }
  for (const std::string& name : forgotten) {
    CAPTURE(name);
    CHECK(written.count(name) == 1);  // so that there was something to forget
  }
  for (const char* name : {kCompletion.name, kChanges.name}) CHECK(left.count(name) == 0);
  CHECK(left.count(kDone.name) == 1);
}
