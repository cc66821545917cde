// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_completion.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/geodesic_completion.h"

namespace vdb_madf::detail {

/// A voxel beside a cut gets another site.
struct FaceChange {
  int32_t round;  ///< of the window, 1, 2, ...; 0: before the first window
  int32_t x, y;
  Coord site;
  int32_t power;

  bool operator==(const FaceChange& other) const {
    return round == other.round && x == other.x && y == other.y && site == other.site &&
           power == other.power;
  }
};
using FaceChanges = std::vector<FaceChange>;  // by round, then x, y

/// What a slab is after a window.
struct CompletionState {
  struct Voxel {
    VoxelId id;
    int32_t power;
    Coord site;
    int32_t kind;  ///< bits: has a site; may change in the next round
  };
  static constexpr int32_t kHasSite = 1, kIsInFront = 2;

  std::vector<Voxel> uncovered;
  FaceChanges below,
      above;             ///< the voxels beyond the cuts, as far as the slab has to know; round 0
  int32_t isActive = 0;  ///< may any voxel change?

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.uncovered, self.below, self.above, self.isActive);
  }
};

/// All that a slab knows of what happens beyond its cuts in a window.
struct Inbox {
  FaceChanges below, above;

  bool operator==(const Inbox& other) const { return below == other.below && above == other.above; }
  int lastRound() const {
    return std::max(below.empty() ? 0 : below.back().round, above.empty() ? 0 : above.back().round);
  }
};

/// A window that a slab has played, and with what.
struct PlayedWindow {
  int32_t window = 0;
  Inbox inbox;

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.window, self.inbox.below, self.inbox.above);
  }
};

namespace {

/// The names of sites in an index, also of those elsewhere.
class SiteNames {
 public:
  explicit SiteNames(LeafIndex& index) : index_(index) {
    for (size_t leaf = index.leafCount(); leaf < index.namedLeafCount(); ++leaf)
      foreign_.emplace(index.origin(leaf), uint32_t(leaf));
  }

  VoxelId idOf(const Coord& site) {
    const Coord origin = site & ~7;
    std::optional<uint32_t> leaf = index_.findLeaf(origin);
    if (!leaf) {
      const auto [named, isNew] = foreign_.emplace(origin, uint32_t(index_.namedLeafCount()));
      if (isNew) index_.nameForeignLeaves({origin});
      leaf = named->second;
    }
    return voxelId(*leaf, offsetOf(site));
  }

 private:
  LeafIndex& index_;
  std::map<Coord, uint32_t> foreign_;
};

/// A slab while it plays.
class Player {
 public:
  Player(LeafIndex& index, PowerMap& map, int begin, int end)
      : begin_(begin),
        end_(end),
        index_(index),
        map_(map),
        names_(index),
        completion_(index, map) {}

  void start(Interrupter* interrupter) { completion_.start(interrupter); }
  void resume(const CompletionState& state) {
    for (const CompletionState::Voxel& voxel : state.uncovered) {
      const bool hasSite = voxel.kind & CompletionState::kHasSite;
      completion_.set({voxel.id, {hasSite ? names_.idOf(voxel.site) : kNoSite, voxel.power}},
                      voxel.kind & CompletionState::kIsInFront);
    }
    for (const FaceChange& change : state.below) see(change, false);
    for (const FaceChange& change : state.above) see(change, true);
  }

  /// The changes of a round beyond a cut, before the next one.
  void see(const FaceChanges& changes, int round, bool above) {
    const auto byRound = [](const FaceChange& change, int r) { return change.round < r; };
    for (auto change = std::lower_bound(changes.begin(), changes.end(), round, byRound);
         change != changes.end() && change->round == round; ++change)
      see(*change, above);
  }

  /// One round; adds what changes beside the cuts.
  void play(int round, FaceChanges& lowest, FaceChanges& highest, Interrupter* interrupter) {
    completion_.round(interrupter);
    const size_t low = lowest.size(), high = highest.size();
    for (const auto& chunk : completion_.changes())
      for (const GeodesicCompletion::Change& change : chunk) {
        const Coord p = index_.coord(change.voxel);
        const FaceChange seen{round, p.x(), p.y(), index_.coord(change.state.site),
                              change.state.power};
        if (p.z() == begin_) lowest.push_back(seen);
        if (p.z() == end_ - 1) highest.push_back(seen);
      }
    sort(lowest, low);
    sort(highest, high);
  }

  bool isActive() const {
    const VoxelSet& front = completion_.front();
    for (size_t word = 0; word < front.wordCount(); ++word)
      if (front.word(word)) return true;
    return false;
  }

  /// Of a face, the voxels that have a site.
  FaceChanges faceStates(bool highest) const {
    FaceChanges states;
    const int leafZ = highest ? end_ - 8 : begin_;
    for (uint32_t leaf = 0; leaf < index_.leafCount(); ++leaf) {
      if (index_.origin(leaf).z() != leafZ) continue;
      forEachBit(layersAlongZ(index_.mask(leaf))[highest ? 7 : 0], [&](int row) {
        const VoxelId id = voxelId(leaf, size_t(row) * 8 + (highest ? 7 : 0));
        const size_t rank = index_.rank(id);
        if (map_.site[rank] == kNoSite) return;
        const Coord p = index_.coord(id);
        states.push_back({0, p.x(), p.y(), index_.coord(map_.site[rank]), map_.power[rank]});
      });
    }
    sort(states, 0);
    return states;
  }

  CompletionState state() const {
    CompletionState state;
    const VoxelSet& uncovered = completion_.uncovered();
    for (size_t word = 0; word < uncovered.wordCount(); ++word)
      forEachBit(uncovered.word(word), [&](int bit) {
        const VoxelId id = VoxelId(word) * 64 + VoxelId(bit);
        const size_t rank = index_.rank(id);
        const bool hasSite = map_.site[rank] != kNoSite;
        const bool isInFront = completion_.front().contains(id);
        state.uncovered.push_back({id, map_.power[rank],
                                   hasSite ? index_.coord(map_.site[rank]) : Coord(0),
                                   (hasSite ? CompletionState::kHasSite : 0) |
                                       (isInFront ? CompletionState::kIsInFront : 0)});
      });
    for (const auto& [place, change] : below_) state.below.push_back(change);
    for (const auto& [place, change] : above_) state.above.push_back(change);
    state.isActive = isActive();
    return state;
  }

 private:
  static void sort(FaceChanges& changes, size_t first) {
    std::sort(changes.begin() + std::ptrdiff_t(first), changes.end(),
              [](const FaceChange& a, const FaceChange& b) {
                return std::make_pair(a.x, a.y) < std::make_pair(b.x, b.y);
              });
  }
  /// Only uncovered voxels look beyond.
  void see(const FaceChange& change, bool above) {
    const auto voxel = index_.findVoxel(Coord(change.x, change.y, above ? end_ - 1 : begin_));
    if (!voxel || !completion_.uncovered().contains(*voxel)) return;
    FaceChange known = change;
    known.round = 0;
    (above ? above_ : below_)[{change.x, change.y}] = known;
    completion_.setBeyond(*voxel, above, {names_.idOf(change.site), change.power});
  }

  int begin_, end_;
  LeafIndex& index_;
  PowerMap& map_;
  SiteNames names_;
  GeodesicCompletion completion_;
  std::map<std::pair<int, int>, FaceChange> below_, above_;
};

constexpr int kFirstWindow = 64, kMostWindows = 24;

void tellBoth(SlabWork& work, const Message<FaceChanges>& what, size_t slab,
              const FaceChanges& lowest, const FaceChanges& highest) {
  if (slab > 0) work.store.send(what, slab, slab - 1, lowest);
  if (slab + 1 < work.plan.slabCount()) work.store.send(what, slab, slab + 1, highest);
}

Inbox toldBy(const SlabWork& work, const Message<FaceChanges>& what, size_t slab) {
  return {work.store.receive(what, slab - 1, slab), work.store.receive(what, slab + 1, slab)};
}

/// Rounds 1 ... rounds, and what is told of the last one.
void playWindow(Player& player, const Inbox& inbox, int rounds, FaceChanges& lowest,
                FaceChanges& highest, Interrupter* interrupter) {
  const int last = std::min(inbox.lastRound(), rounds);
  const auto see = [&](int round) {
    player.see(inbox.below, round, false);
    player.see(inbox.above, round, true);
  };
  for (int round = 1; round <= rounds; ++round) {
    if (player.isActive()) player.play(round, lowest, highest, interrupter);
    see(round);
    if (round >= last && !player.isActive()) break;
  }
}

}  // namespace

void SlabCompletion::begin(size_t slab, LeafIndex& index, PowerMap& map, Interrupter* interrupter) {
  Player player(index, map, work_.plan.begin(slab), work_.plan.end(slab));
  player.start(interrupter);
  writeMap(work_, slab, index, map);
  work_.store.write(kCompletion.at(0), slab, player.state());
  tellBoth(work_, kFaceStates, slab, player.faceStates(false), player.faceStates(true));
}

void SlabCompletion::run() {
  window_ = firstWindow();
  const auto sum = [&](auto f) {
    std::vector<int64_t> total{0};
    for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s)
      if (!work_.steps.isBeyond(s)) total[0] += f(s);
    work_.team.sum(total);
    return total[0];
  };
  while (sum([&](size_t s) { return work_.store.read(kCompletion.at(window_), s).isActive; }) > 0) {
    if (window_ == kMostWindows)
      throw InvalidInput("the completion after the filter by gamma does not end: lower gamma");
    int64_t played = 0;
    do {
      played = sum([&](size_t s) { return play(s); });
      work_.steps.exchange();
    } while (played > 0);
    for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s) forgetWindow(s);
    ++window_;
  }
}

/// The state before a window goes when all slabs have agreed on the window, so that of slabs which
/// have two the later one counts if another slab has no other, or has gone on.
int SlabCompletion::firstWindow() const {
  std::vector<int64_t> found{
      0, 0, 0};  // first state of the slab that has gone furthest; last; is one beyond?
  for (size_t s = work_.plan.firstOwn(); s < work_.plan.endOwn(); ++s) {
    if (work_.steps.isBeyond(s)) {
      found[2] = 1;
      continue;
    }
    int first = 0;
    while (!work_.store.has(kCompletion.at(first), s)) ++first;
    const bool hasNext = work_.store.has(kCompletion.at(first + 1), s);
    found[0] = std::max<int64_t>(found[0], first);
    found[1] = std::max<int64_t>(found[1], first + hasNext);
  }
  work_.team.max(found);
  return int(found[2] ? found[1] : found[0]);
}

/// False if the slab has played this window with what it knows.
bool SlabCompletion::play(size_t slab) {
  const Inbox inbox = toldBy(work_, kChanges.at(window_), slab);
  if (work_.store.has(kPlayed, slab)) {
    const PlayedWindow played = work_.store.read(kPlayed, slab);
    if (played.window == window_ && played.inbox == inbox) return false;
  }
  CompletionState state = work_.store.read(kCompletion.at(window_), slab);
  FaceChanges lowest, highest;
  if (!state.uncovered.empty() && (state.isActive || inbox.lastRound() > 0)) {
    SlabBody body = work_.body(slab);
    PowerMap map = readMap(work_, slab, body.index);
    Player player(body.index, map, work_.plan.begin(slab), work_.plan.end(slab));
    player.resume(state);
    if (window_ == 0) {
      const Inbox faces = toldBy(work_, kFaceStates, slab);
      player.see(faces.below, 0, false);
      player.see(faces.above, 0, true);
    }
    playWindow(player, inbox, kFirstWindow << window_, lowest, highest, work_.interrupter);
    state = player.state();
  }
  work_.store.write(kCompletion.at(window_ + 1), slab, state);
  tellBoth(work_, kChanges.at(window_), slab, lowest, highest);
  work_.store.write(kPlayed, slab, {window_, inbox});
  return true;
}

void SlabCompletion::forgetWindow(size_t slab) {
  work_.store.removeMessage(kChanges.at(window_), slab - 1, slab);
  work_.store.removeMessage(kChanges.at(window_), slab + 1, slab);
  work_.store.remove(kCompletion.at(window_), slab);
}

PowerMap SlabCompletion::completed(size_t slab, LeafIndex& index) const {
  PowerMap map = readMap(work_, slab, index);
  Player(index, map, work_.plan.begin(slab), work_.plan.end(slab))
      .resume(work_.store.read(kCompletion.at(window_), slab));
  return map;
}

void SlabCompletion::forget(size_t slab) {
  work_.store.remove(kCompletion.at(window_), slab);
}

}  // namespace vdb_madf::detail
