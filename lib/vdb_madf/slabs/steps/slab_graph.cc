// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_graph.h"

#include <algorithm>
#include <vector>

#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/slabs/cuts/point_numbers.h"
#include "vdb_madf/slabs/cuts/slab_exits.h"
#include "vdb_madf/slabs/cuts/slab_part.h"

namespace vdb_madf::detail {

/// To the root: what it has to know of the terminals of a slab.
struct TerminalExits {
  uint64_t terminals = 0;
  int64_t balls = 0;
  std::vector<SlabExits::Exit> exits;

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.terminals, self.balls, self.exits);
  }
};

/// Where a ball flows to that another slab asks for.
struct BallAnswer {
  uint32_t terminal;
  uint32_t isOwnBall;  ///< does the slab itself count the ball?
  CriticalPoint point;
};

namespace {

using Edge = ManifoldGraph::Edge;

class PartSteps {
 public:
  PartSteps(SlabWork& work, SegmentCounts& counts)
      : work_(work), counts_(counts), exits_(work.plan.object.cuts) {}

  void run() {
    work_.steps.forEachSlab(Step::contacts, [&](size_t s) { findContacts(s); });
    work_.steps.beginStage("graph");
    if (work_.plan.isRoot()) ask();
    work_.steps.exchange();
    work_.steps.forEachSlab(Step::answers, [&](size_t s) { answer(s); });
    if (work_.plan.isRoot()) takeAnswers();
    work_.steps.exchange();
    work_.steps.forEachSlab(Step::roots, [&](size_t s) { sendRoots(s); });
    work_.steps.forEachSlab(Step::parts, [&](size_t s) { makePart(s); });
  }

 private:
  /// The contacts to the slab below, between the terminals there that have any and those of the
  /// slab.
  void findContacts(size_t s) {
    std::vector<Edge> contacts;
    std::vector<uint32_t> touched;
    if (s > 0) {
      contacts = SlabTerminals::contacts(work_.store.receive(kHighest, s - 1, s),
                                         work_.store.read(kLowest, s));
      for (const Edge& edge : contacts) touched.push_back(edge.first);
      sortUnique(touched);
      for (Edge& edge : contacts) edge.first = uint32_t(sortedIndex(touched, edge.first));
      work_.store.send(kTouched, s, s - 1, touched);
    }
    work_.store.write(kContacts, s, contacts);
  }

  /// At the root: where do the balls flow to at which paths leave a slab?
  void ask() {
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
      const TerminalExits of = work_.store.receive(kExits, s, kRoot);
      exits_.add(of.terminals, of.exits);
      if (!work_.isFiltered()) counts_.medialBalls += of.balls;
    }
    counts_.criticalPoints = exits_.criticalPoints();
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
      std::vector<Coord> places;
      for (const SlabExits::Question& question : exits_.questions(s))
        places.push_back(question.position);
      work_.store.send(kQuestions, kRoot, s, places);
    }
  }

  void answer(size_t s) {
    const auto places = work_.store.receive(kQuestions, kRoot, s);
    std::vector<BallAnswer> answers;
    if (!places.empty()) {
      const SlabBody slab = work_.body(s);
      const auto flowMap = work_.store.read(kFlow, s);
      const auto ballWords = work_.store.read(kBalls, s);
      const std::vector<CriticalPoint> points = work_.store.read(kTerminals, s).points;
      for (const Coord& place : places) {
        const VoxelId id = *slab.index.findVoxel(place);
        const uint32_t terminal = flowMap[slab.index.rank(id)];
        answers.push_back({terminal, uint32_t(ballWords[id >> 6] >> bitOf(id) & 1),
                           points[(terminal & ~Flow::kOwnCell) - 1]});
      }
    }
    work_.store.send(kAnswers, s, kRoot, answers);
  }

  /// At the root: tells the slabs where these balls lead to.
  void takeAnswers() {
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
      const auto& questions = exits_.questions(s);
      const auto answers = work_.store.receive(kAnswers, s, kRoot);
      for (size_t i = 0; i < questions.size(); ++i) {
        exits_.answer(s, questions[i], answers[i].terminal, answers[i].point);
        const bool isRepeated = i > 0 && questions[i - 1].position == questions[i].position;
        if (!work_.isFiltered() && !answers[i].isOwnBall && !isRepeated) ++counts_.medialBalls;
      }
    }
    if (!work_.isFiltered()) counts_.keptBalls = counts_.medialBalls;
    exits_.finish();
    if (work_.options.keepManifold) numberPoints();
    for (size_t s = 0; s < work_.plan.slabCount(); ++s)
      work_.store.send(kLeads, kRoot, s, exits_.leads(s));
  }

  /// At the root: the numbers of the critical points of all slabs, by terminal; 0: lies in another
  /// slab.
  void numberPoints() {
    PointNumbers numbers;
    const auto points = [&](size_t s) { return work_.store.receive(kPoints, s, kRoot); };
    const auto criticalPoints = [&](size_t s) {
      std::vector<Coord> critical = points(s);
      critical.erase(std::remove_if(critical.begin(), critical.end(),
                                    [&](const Coord& p) { return work_.plan.slabOf(p.z()) != s; }),
                     critical.end());
      return critical;
    };
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) numbers.count(criticalPoints(s));
    numbers.finish();
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
      const std::vector<uint32_t> own = numbers.next(criticalPoints(s));
      auto next = own.begin();
      std::vector<uint32_t> ofTerminal;
      for (const Coord& p : points(s))
        ofTerminal.push_back(work_.plan.slabOf(p.z()) == s ? *next++ : 0);
      exits_.tellNumbers(s, ofTerminal);
      work_.store.send(kNumbers, kRoot, s, ofTerminal);
    }
  }

  std::vector<SlabRoot> roots(size_t s, const SlabTerminals& terminals) const {
    return slabRoots(s, terminals.points, work_.store.receive(kNumbers, kRoot, s),
                     work_.store.receive(kLeads, kRoot, s));
  }

  /// To the slab above: where the terminals lead to that it has contacts to.
  void sendRoots(size_t s) {
    if (s + 1 == work_.plan.slabCount()) return;
    const std::vector<SlabRoot> all = roots(s, work_.store.read(kTerminals, s));
    std::vector<SlabRoot> touched;
    for (const uint32_t terminal : work_.store.receive(kTouched, s + 1, s))
      touched.push_back(all[terminal]);
    work_.store.send(kRootsBelow, s, s + 1, touched);
  }

  void makePart(size_t s) {
    const SlabTerminals own = work_.store.read(kTerminals, s);
    SlabPart part = slabPart(s, own, roots(s, own), work_.store.read(kContacts, s),
                             work_.store.receive(kRootsBelow, s - 1, s),
                             work_.store.receive(kTouched, s + 1, s));
    const SlabFacts& facts = work_.facts;
    part.graph.weights = facts.weights;
    if (facts.domain) placeGraph(part.graph, *facts.domain, facts.obstacles.open);
    work_.store.write(kGraphPart, s, part);
  }
  SlabWork& work_;
  SegmentCounts& counts_;
  SlabExits exits_;
};

}  // namespace

void giveTerminals(SlabWork& work, size_t slab, const SlabTerminals& terminals,
                   const LeafIndex& index, const VoxelSet& balls) {
  work.store.write(kTerminals, slab, terminals);
  work.store.write(kLowest, slab, terminals.lowest);
  if (slab + 1 < work.plan.slabCount())
    work.store.send(kHighest, slab, slab + 1, terminals.highest);

  std::vector<uint64_t> ballWords;
  for (size_t i = 0; i < index.leafCount() * 8; ++i) ballWords.push_back(balls.word(i));
  work.store.write(kBalls, slab, ballWords);

  std::vector<Coord> points;
  TerminalExits to{terminals.points.size(), terminals.balls, {}};
  for (uint32_t i = 0; i < terminals.points.size(); ++i) {
    points.push_back(terminals.points[i].position);
    if (work.plan.slabOf(points.back().z()) != slab) to.exits.push_back({i, points.back()});
  }
  work.store.send(kExits, slab, kRoot, to);
  if (work.options.keepManifold) work.store.send(kPoints, slab, kRoot, points);
}

void makeParts(SlabWork& work, SegmentCounts& counts) {
  PartSteps(work, counts).run();
}

}  // namespace vdb_madf::detail
