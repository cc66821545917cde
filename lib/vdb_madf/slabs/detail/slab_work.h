// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/slabs/detail/bytes.h"
#include "vdb_madf/slabs/detail/slab_body.h"
#include "vdb_madf/slabs/ranks.h"
#include "vdb_madf/slabs/segment_slabs.h"

namespace vdb_madf::detail {

/// What all steps of segmentSlabs() work with. A step is a function of a slab: of the pieces that the
/// steps before left of this slab, and of the messages that other slabs sent to it. Each slab notes in
/// scratch which step it has done, so that a run that goes on skips those.
class SlabWork {
 public:
  SlabWork(const SlabObject& object, const SegmentOptions& options, Scratch& scratch, Ranks& ranks,
           Interrupter* interrupter);

  const SlabObject& object;
  const SegmentOptions& options;
  Scratch& scratch;
  Ranks& ranks;
  Interrupter* interrupter;
  std::optional<Domain> domain;
  Obstacles obstacles{};
  VoxelWeights weights;
  bool fillsNone = false;              ///< would the cavities be all background?
  int32_t largestSquaredDistance = 0;  ///< known in regions

  /// Are there unknown voxels that sweeps pass?
  bool inRegion() const { return obstacles.open && !obstacles.domain.isBox(); }

  size_t slabCount() const { return object.slabCount(); }
  int begin(size_t slab) const { return object.cuts[slab]; }
  int end(size_t slab) const { return object.cuts[slab + 1]; }
  size_t slabOf(int z) const;
  Cut cut(size_t slab, bool isUpper) const { return {begin(slab), end(slab), isUpper}; }

  /// Slabs of this rank: firstOwn() <= s < endOwn().
  size_t firstOwn() const { return ranks.firstSlab(ranks.rank(), slabCount()); }
  size_t endOwn() const { return ranks.firstSlab(ranks.rank() + 1, slabCount()); }
  /// What concerns the whole is done by one rank, the owner of slab kRoot.
  static constexpr size_t kRoot = 0;
  bool isRoot() const { return ranks.rank() == 0; }

  /// A step: f(s) for all own slabs, if they have not done it; then messages are exchanged. What a slab
  /// does not need once it has done the step goes in forget(s).
  template <typename F, typename G>
  void forEachSlab(const F& f, const G& forget) {
    ++step_;
    for (size_t s = firstOwn(); s < endOwn(); ++s) {
      run(s, f);
      forget(s);
    }
    exchange();
  }
  template <typename F>
  void forEachSlab(const F& f) {
    forEachSlab(f, [](size_t) {});
  }
  /// Has a slab done the next step in a run before?
  bool isBeyond(size_t slab) const { return done_[slab] > step_; }
  /// A step of one slab after another, from the lowest or the highest one on: each has the messages of
  /// the one before. For short steps: other ranks wait.
  template <typename F>
  void upward(const F& f) {
    ++step_;
    for (int rank = 0; rank < ranks.count(); ++rank) {
      if (rank == ranks.rank())
        for (size_t s = firstOwn(); s < endOwn(); ++s) run(s, f);
      exchange();
    }
  }
  template <typename F>
  void downward(const F& f) {
    ++step_;
    for (int rank = ranks.count(); rank-- > 0;) {
      if (rank == ranks.rank())
        for (size_t s = endOwn(); s-- > firstOwn();) run(s, f);
      exchange();
    }
  }

  /// Messages so far get to their slabs.
  void exchange() {
    ++exchanges_;
    ranks.exchange(scratch);
  }

  /// The next part of the work begins.
  void beginStage(const char* name);
  /// What all parts took, by all ranks; after the last.
  void endStages(SlabSegmentation& result);

  /// What is told of a step on a slab: all own slabs go from `begin` to `end` per cent of the whole.
  WorkPart part(int begin, int end, size_t slab) const {
    const double each = double(end - begin) / double(endOwn() - firstOwn());
    const auto i = double(slab - firstOwn());
    return {interrupter, int(begin + each * i), int(begin + each * (i + 1))};
  }

  // Pieces of an own slab.
  bool has(const char* what, size_t slab) const { return scratch.has(name(what, slab)); }
  void write(const char* what, size_t slab, const ByteWriter& bytes) {
    scratch.write(name(what, slab), bytes.bytes());
  }
  ByteReader read(const char* what, size_t slab) const {
    return ByteReader(scratch.read(name(what, slab)));
  }
  void remove(const char* what, size_t slab) { scratch.remove(name(what, slab)); }
  template <typename T>
  void writeVector(const char* what, size_t slab, const std::vector<T>& values) {
    ByteWriter bytes;
    bytes.add(values);
    write(what, slab, bytes);
  }
  template <typename T>
  std::vector<T> readVector(const char* what, size_t slab) const {
    return read(what, slab).vector<T>();
  }

  /// Values of the voxels of a slab, without a copy of them.
  template <typename T>
  void writeVoxels(const char* what, size_t slab, const VoxelArray<T>& values) {
    scratch.writeBytes(name(what, slab), reinterpret_cast<const char*>(values.data()),
                       values.size() * sizeof(T));
  }
  template <typename T>
  VoxelArray<T> readVoxels(const char* what, size_t slab) const {
    VoxelArray<T> values;
    scratch.readBytes(name(what, slab), [&](size_t size) {
      if (size % sizeof(T) != 0) throw IoError("the scratch data is damaged");
      values = VoxelArray<T>(size / sizeof(T));
      return reinterpret_cast<char*>(values.data());
    });
    return values;
  }

  // Messages from slab to slab. Vectors that were not sent are empty.
  void send(const char* what, size_t from, size_t to, const ByteWriter& bytes);
  /// A piece of a slab, for another rank.
  void sendTo(int rank, const char* what, size_t slab, const ByteWriter& bytes);
  bool hasMessage(const char* what, size_t from, size_t to) const {
    return scratch.has(name(what, from, to));
  }
  ByteReader receive(const char* what, size_t from, size_t to) const {
    return ByteReader(scratch.read(name(what, from, to)));
  }
  template <typename T>
  void sendVector(const char* what, size_t from, size_t to, const std::vector<T>& values) {
    ByteWriter bytes;
    bytes.add(values);
    send(what, from, to, bytes);
  }
  template <typename T>
  std::vector<T> receiveVector(const char* what, size_t from, size_t to) const {
    if (!hasMessage(what, from, to)) return {};
    return receive(what, from, to).vector<T>();
  }
  void removeMessage(const char* what, size_t from, size_t to) {
    scratch.remove(name(what, from, to));
  }

  /// What the root has.
  Bytes broadcast(const ByteWriter& bytes) {
    Bytes result = bytes.bytes();
    ranks.broadcast(result);
    return result;
  }

  std::vector<LeafIndex::LeafVoxels> cavities(size_t slab) const {
    if (fillsNone) return {};
    return readVector<LeafIndex::LeafVoxels>("cavities", slab);
  }
  SlabBody body(size_t slab) const { return SlabBody(object.leaves(slab), cavities(slab)); }

  static std::string name(const char* what, size_t slab) {
    return std::string(what) + "-" + std::to_string(slab);
  }

 private:
  static std::string name(const char* what, size_t from, size_t to) {
    return name(what, from) + "-" + std::to_string(to);
  }
  template <typename F>
  void run(size_t slab, const F& f) {
    if (done_[slab] >= step_) return;
    f(slab);
    writeVector("step", slab, std::vector<int>{step_});
    done_[slab] = step_;
  }

  using Clock = std::chrono::steady_clock;
  void endStage();

  int step_ = 0;
  int64_t exchanges_ = 0;
  std::vector<SlabStage> stages_;
  Clock::time_point stageStart_;
  std::vector<int> done_;  // the last step of each own slab
};

}  // namespace vdb_madf::detail
