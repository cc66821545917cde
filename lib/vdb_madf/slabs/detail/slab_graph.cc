// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_graph.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/slabs/detail/point_numbers.h"
#include "vdb_madf/slabs/detail/slab_exits.h"
#include "vdb_madf/slabs/detail/slab_part.h"

namespace vdb_madf::detail {

namespace {

using Edge = ManifoldGraph::Edge;
using FaceVoxel = SlabTerminals::FaceVoxel;

/// To the root: what it has to know of the terminals of a slab.
struct Summary {
  uint64_t terminals;
  int64_t balls;
};

/// Where a ball flows to that another slab asks for.
struct Answer {
  uint32_t terminal;
  uint32_t isOwnBall;  ///< does the slab itself count the ball?
  CriticalPoint point;
};

class PartSteps {
 public:
  PartSteps(SlabWork& work, SegmentCounts& counts)
      : work_(work), counts_(counts), exits_(work.object.cuts) {}

  void run() {
    work_.forEachSlab([&](size_t s) { findContacts(s); }, [&](size_t s) { forgetFaces(s); });
    work_.beginStage("graph");
    if (work_.isRoot()) ask();
    work_.exchange();
    work_.forEachSlab([&](size_t s) { answer(s); }, [&](size_t s) { work_.remove("balls", s); });
    if (work_.isRoot()) takeAnswers();
    work_.exchange();
    work_.forEachSlab([&](size_t s) { sendRoots(s); });
    work_.forEachSlab([&](size_t s) { makePart(s); }, [&](size_t s) { forgetTerminals(s); });
  }

 private:
  bool isFiltered() const { return work_.options.gamma > 1; }

  /// The contacts to the slab below, between the terminals there that have any and those of the slab.
  void findContacts(size_t s) {
    std::vector<Edge> contacts;
    std::vector<uint32_t> touched;
    if (s > 0) {
      contacts = SlabTerminals::contacts(work_.receiveVector<FaceVoxel>("highest", s - 1, s),
                                         work_.readVector<FaceVoxel>("lowest", s));
      for (const Edge& edge : contacts) touched.push_back(edge.first);
      std::sort(touched.begin(), touched.end());
      touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
      for (Edge& edge : contacts)
        edge.first = uint32_t(std::lower_bound(touched.begin(), touched.end(), edge.first) -
                              touched.begin());
      work_.sendVector("touched", s, s - 1, touched);
    }
    work_.writeVector("contacts", s, contacts);
  }
  void forgetFaces(size_t s) {
    work_.removeMessage("highest", s - 1, s);
    work_.remove("lowest", s);
  }

  /// At the root: where do the balls flow to at which paths leave a slab?
  void ask() {
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      ByteReader bytes = work_.receive("exits", s, SlabWork::kRoot);
      const auto summary = bytes.value<Summary>();
      exits_.add(summary.terminals, bytes.vector<SlabExits::Exit>());
      if (!isFiltered()) counts_.medialBalls += summary.balls;
    }
    counts_.criticalPoints = exits_.criticalPoints();
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      std::vector<Coord> places;
      for (const SlabExits::Question& question : exits_.questions(s))
        places.push_back(question.position);
      work_.sendVector("questions", SlabWork::kRoot, s, places);
    }
  }

  void answer(size_t s) {
    const auto places = work_.receiveVector<Coord>("questions", SlabWork::kRoot, s);
    std::vector<Answer> answers;
    if (!places.empty()) {
      const SlabBody slab = work_.body(s);
      const auto flowMap = work_.readVoxels<uint32_t>("flow", s);
      const auto ballWords = work_.readVector<uint64_t>("balls", s);
      const std::vector<CriticalPoint> points = terminals(s).points;
      for (const Coord& place : places) {
        const VoxelId id = *slab.index.findVoxel(place);
        const uint32_t terminal = flowMap[slab.index.rank(id)];
        answers.push_back({terminal, uint32_t(ballWords[id >> 6] >> bitOf(id) & 1),
                           points[(terminal & ~Flow::kOwnCell) - 1]});
      }
    }
    work_.sendVector("answers", s, SlabWork::kRoot, answers);
  }

  /// At the root: tells the slabs where these balls lead to.
  void takeAnswers() {
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto& questions = exits_.questions(s);
      const auto answers = work_.receiveVector<Answer>("answers", s, SlabWork::kRoot);
      for (size_t i = 0; i < questions.size(); ++i) {
        exits_.answer(s, questions[i], answers[i].terminal, answers[i].point);
        const bool isRepeated = i > 0 && questions[i - 1].position == questions[i].position;
        if (!isFiltered() && !answers[i].isOwnBall && !isRepeated) ++counts_.medialBalls;
      }
    }
    if (!isFiltered()) counts_.keptBalls = counts_.medialBalls;
    exits_.finish();
    if (work_.options.keepManifold) numberPoints();
    for (size_t s = 0; s < work_.slabCount(); ++s)
      work_.sendVector("leads", SlabWork::kRoot, s, exits_.leads(s));
  }

  /// At the root: the numbers of the critical points of all slabs, by terminal; 0: lies in another slab.
  void numberPoints() {
    PointNumbers numbers;
    const auto points = [&](size_t s) {
      return work_.receiveVector<Coord>("points", s, SlabWork::kRoot);
    };
    const auto criticalPoints = [&](size_t s) {
      std::vector<Coord> critical = points(s);
      critical.erase(std::remove_if(critical.begin(), critical.end(),
                                    [&](const Coord& p) { return work_.slabOf(p.z()) != s; }),
                     critical.end());
      return critical;
    };
    for (size_t s = 0; s < work_.slabCount(); ++s) numbers.count(criticalPoints(s));
    numbers.finish();
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const std::vector<uint32_t> own = numbers.next(criticalPoints(s));
      auto next = own.begin();
      std::vector<uint32_t> ofTerminal;
      for (const Coord& p : points(s)) ofTerminal.push_back(work_.slabOf(p.z()) == s ? *next++ : 0);
      exits_.tellNumbers(s, ofTerminal);
      work_.sendVector("numbers", SlabWork::kRoot, s, ofTerminal);
    }
  }

  std::vector<SlabRoot> roots(size_t s, const SlabTerminals& terminals) const {
    return slabRoots(s, terminals.points,
                     work_.receiveVector<uint32_t>("numbers", SlabWork::kRoot, s),
                     work_.receiveVector<SlabLead>("leads", SlabWork::kRoot, s));
  }

  /// To the slab above: where the terminals lead to that it has contacts to.
  void sendRoots(size_t s) {
    if (s + 1 == work_.slabCount()) return;
    const std::vector<SlabRoot> all = roots(s, terminals(s));
    std::vector<SlabRoot> touched;
    for (const uint32_t terminal : work_.receiveVector<uint32_t>("touched", s + 1, s))
      touched.push_back(all[terminal]);
    work_.sendVector("roots", s, s + 1, touched);
  }

  void makePart(size_t s) {
    const SlabTerminals own = terminals(s);
    ByteWriter bytes;
    slabPart(s, own, roots(s, own), work_.readVector<Edge>("contacts", s),
             work_.receiveVector<SlabRoot>("roots", s - 1, s),
             work_.receiveVector<uint32_t>("touched", s + 1, s))
        .writeTo(bytes);
    work_.write(kGraphPart, s, bytes);
  }
  void forgetTerminals(size_t s) {
    work_.remove("terminals", s);
    work_.remove("contacts", s);
    work_.removeMessage("roots", s - 1, s);
    work_.removeMessage("touched", s + 1, s);
  }

  SlabTerminals terminals(size_t s) const {
    ByteReader bytes = work_.read("terminals", s);
    return SlabTerminals::readFrom(bytes);
  }

  SlabWork& work_;
  SegmentCounts& counts_;
  SlabExits exits_;
};

}  // namespace

void giveTerminals(SlabWork& work, size_t slab, const SlabTerminals& terminals,
                   const LeafIndex& index, const VoxelSet& balls) {
  ByteWriter all, summary;
  terminals.writeTo(all);
  work.write("terminals", slab, all);
  work.writeVector("lowest", slab, terminals.lowest);
  if (slab + 1 < work.slabCount()) work.sendVector("highest", slab, slab + 1, terminals.highest);

  std::vector<uint64_t> ballWords;
  for (size_t i = 0; i < index.leafCount() * 8; ++i) ballWords.push_back(balls.word(i));
  work.writeVector("balls", slab, ballWords);

  std::vector<Coord> points;
  std::vector<SlabExits::Exit> exits;
  for (uint32_t i = 0; i < terminals.points.size(); ++i) {
    points.push_back(terminals.points[i].position);
    if (work.slabOf(points.back().z()) != slab) exits.push_back({i, points.back()});
  }
  summary.add(Summary{terminals.points.size(), terminals.balls});
  summary.add(exits);
  work.send("exits", slab, SlabWork::kRoot, summary);
  if (work.options.keepManifold) work.sendVector("points", slab, SlabWork::kRoot, points);
}

void makeParts(SlabWork& work, SegmentCounts& counts) {
  PartSteps(work, counts).run();
}

}  // namespace vdb_madf::detail
