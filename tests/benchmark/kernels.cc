// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The stages one by one on a pack of balls (side: VDB_MADF_BENCHMARK_SIZE, 256 by default), and the
// speed of copying memory, which bounds them all. Threads: VDB_MADF_BENCHMARK_THREADS, all by
// default. Counters: ns per object voxel, and bytes per second that the stage must at least read
// and write.

#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <cstring>
#include <optional>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/flow.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/method/power_map.h"
#include "vdb_madf/method/squared_distance.h"
#include "vdb_madf/samples/pack.h"

namespace {

using namespace vdb_madf;

int fromEnvironment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

/// The pack's mask and index, made once.
struct Bed {
  MaskGrid::Ptr mask;
  LeafIndex index;
  Obstacles obstacles;

  Bed() {
    PackOptions options;
    options.size = Coord(fromEnvironment("VDB_MADF_BENCHMARK_SIZE", 256));
    mask = generatePack(options).object;
    index = LeafIndex(*mask);
    obstacles = {true, CoordBBox(Coord(0), options.size - Coord(1))};
  }
};
const Bed& bed() {
  static const Bed bed;
  return bed;
}

/// Reports per object voxel. `bytes`: moved at least, per object voxel.
void count(benchmark::State& state, double bytes) {
  const double voxels = double(bed().index.voxelCount()) * double(state.iterations());
  state.SetItemsProcessed(int64_t(voxels));
  state.SetBytesProcessed(int64_t(voxels * bytes));
}

void memoryCopy(benchmark::State& state) {
  constexpr size_t kBytes = size_t(1) << 28, kChunk = size_t(1) << 20;
  VoxelArray<char> from(kBytes), to(kBytes);
  std::memset(from.data(), 1, kBytes);
  std::memset(to.data(), 2, kBytes);
  for (auto _ : state)
    detail::parallelFor(kBytes / kChunk, 1, nullptr, [&](size_t begin, size_t end) {
      std::memcpy(to.data() + begin * kChunk, from.data() + begin * kChunk, (end - begin) * kChunk);
    });
  state.SetBytesProcessed(int64_t(2 * kBytes) * int64_t(state.iterations()));  // read and written
}

void leafIndex(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(LeafIndex(*bed().mask));
  count(state, 0);
}

void squaredDistances(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(squaredDistance(bed().index, bed().obstacles).largest);
  count(state, 4 + 8 + 8 + 4);
}

void powerMaps(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    SquaredDistance distance = squaredDistance(bed().index, bed().obstacles);
    state.ResumeTiming();
    benchmark::DoNotOptimize(powerMap(bed().index, std::move(distance)).power[0]);
  }
  count(state, 8 + 12 + 16 + 16);
}

PowerMap powerMapOfBed() {
  return powerMap(bed().index, squaredDistance(bed().index, bed().obstacles));
}

void medialBallSets(benchmark::State& state) {
  const PowerMap map = powerMapOfBed();
  for (auto _ : state) benchmark::DoNotOptimize(medialBalls(bed().index, map).size());
  count(state, 4);
}

void flows(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    PowerMap map = powerMapOfBed();
    const VoxelSet balls = medialBalls(bed().index, map);
    state.ResumeTiming();
    benchmark::DoNotOptimize(
        flow(bed().index, std::move(map.site), map.power, balls).criticalPoints.size());
  }
  count(state, 8);
}

void graphs(benchmark::State& state) {
  PowerMap map = powerMapOfBed();
  const VoxelSet balls = medialBalls(bed().index, map);
  const Flow flowMap = flow(bed().index, std::move(map.site), map.power, balls);
  for (auto _ : state)
    benchmark::DoNotOptimize(manifoldGraph(bed().index, flowMap, map.power).edges.size());
  count(state, 4);
}

void grids(benchmark::State& state) {
  const SquaredDistance distance = squaredDistance(bed().index, bed().obstacles);
  for (auto _ : state) benchmark::DoNotOptimize(toGrid(bed().index, distance.values, "grain"));
  count(state, 4 + 2048.0 * double(bed().index.leafCount()) / double(bed().index.voxelCount()));
}

void addStage(const char* name, void (*function)(benchmark::State&)) {
  benchmark::RegisterBenchmark(name, function)->Unit(benchmark::kMillisecond)->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
  openvdb::initialize();
  std::optional<tbb::global_control> threads;
  if (const int count = fromEnvironment("VDB_MADF_BENCHMARK_THREADS", 0))
    threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(count));
  addStage("memory_copy", memoryCopy);
  addStage("leaf_index", leafIndex);
  addStage("squared_distance", squaredDistances);
  addStage("power_map", powerMaps);
  addStage("medial_balls", medialBallSets);
  addStage("flow", flows);
  addStage("manifold_graph", graphs);
  addStage("to_grid", grids);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
