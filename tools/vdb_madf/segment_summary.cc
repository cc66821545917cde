// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "segment_summary.h"

#include <fmt/core.h>
#include <openvdb/Metadata.h>

#include <algorithm>
#include <cstdio>

#include "vdb_madf/base/memory.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf::tools {

namespace {

/// What to turn if the grains are hardly true ones.
std::vector<std::string> hints(const SegmentArguments& arguments, const SegmentSummary& summary) {
  const SegmentOptions& options = arguments.segment;
  const int64_t grains = summary.counts.grains;
  const LabelFlaws& flaws = *summary.flaws;
  std::vector<std::string> all;
  const auto share = [&](int64_t part) { return fmt::format("{} of {} grains", part, grains); };
  const MergeMode mode = options.merge.mode;
  const bool neck = mode == MergeMode::both || mode == MergeMode::neck;
  if (2 * flaws.crumbs > grains)
    all.push_back(share(flaws.crumbs) + " are crumbs: " +
                  (mode == MergeMode::score ? "lower --strictness, or try --gamma 20"
                   : neck                   ? "raise --delta or --theta, or try --gamma 20"
                                            : "the angle alone needs --gamma, such as 20 or 160"));
  else if (flaws.slivers >= 10 && 50 * flaws.slivers > grains)
    all.push_back(share(flaws.slivers) + " are slivers: " +
                  (mode == MergeMode::score
                       ? "lower --strictness"
                       : std::string("raise ") +
                             (neck && options.merge.delta < 8 ? "--delta or " : "") + "--theta") +
                  "; see sweep");
  if (flaws.specks >= 10 && 5 * flaws.specks > grains)
    all.push_back(
        share(flaws.specks) +
        " are loose specks under 100 voxels: noise of the scan? --despeckle 100 drops them");
  if (summary.counts.cavities >= 10 && 5 * summary.counts.cavities > grains &&
      summary.fillHoles < 100)
    all.push_back(std::to_string(summary.counts.cavities) +
                  " small cavities: a noisy scan may need --fill-holes 100");
  const bool cubes = !summary.voxelSize || summary.voxelSize->isCube();
  if (!arguments.tables.empty() && cutsGray(arguments.input) && !arguments.necks && cubes)
    all.push_back(
        "areas of bonds are those of the thresholded scan, too large by its blur: "
        "--necks frees them of it");
  return all;
}

}  // namespace

std::optional<double> SegmentSummary::porosity() const {
  if (!domain) return std::nullopt;
  return 1 - double(counts.objectVoxels) / double(domain->voxelCount());
}

namespace {

/// What a segmentation says itself; \p grid has the metadata of its object.
SegmentSummary summaryOf(const SegmentationRecord& record, const std::vector<int64_t>& grainVoxels,
                         const openvdb::GridBase& grid, const Common& common) {
  SegmentSummary summary;
  static_cast<SegmentationRecord&>(summary) = record;
  summary.sizes = grainSizes(grainVoxels);
  summary.voxelSize = storedVoxelSize(grid);
  summary.objectSteps = objectSteps(grid);
  if (const auto threshold = grid.getMetadata<openvdb::DoubleMetadata>(kThresholdKey))
    summary.threshold = threshold->value();
  summary.threads = usedThreads(common.threads);
  return summary;
}

void addTiming(const SegmentArguments& o, const SegmentTiming& timing,
               const std::vector<StageTime>& stages, SegmentSummary& summary) {
  summary.seconds.emplace_back("read", timing.read);
  for (const StageTime& stage : stages) {
    summary.seconds.emplace_back(stage.stage, stage.seconds);
    summary.peakBytesUntil.emplace_back(stage.stage, stage.peakBytes);
    summary.pageFaults.emplace_back(stage.stage, stage.pageFaults);
  }
  summary.pageFaults.emplace_back("total", pageFaults());
  if (!o.tables.empty()) summary.seconds.emplace_back("measure", timing.measure);
  summary.seconds.emplace_back("write", timing.write);
  summary.seconds.emplace_back("total", timing.total);
  summary.peakBytes = peakMemory();
}

}  // namespace

SegmentSummary summarize(const SegmentArguments& o, const Common& common, const Segmentation& s,
                         const SegmentTiming& timing) {
  SegmentSummary summary = summaryOf(s, s.grainVoxels, *s.grain, common);
  summary.flaws = s.flaws;
  summary.stable = s.stable;
  addTiming(o, timing, s.times, summary);
  summary.hints = hints(o, summary);
  return summary;
}

SegmentSummary summarize(const SegmentArguments& o, const Common& common, const SlabSegmentation& s,
                         const openvdb::GridBase& object, const SegmentTiming& timing) {
  SegmentSummary summary = summaryOf(s, s.grainVoxels, object, common);
  addTiming(o, timing, {}, summary);
  return summary;
}

void addMerging(Json& json, const MergeOptions& options) {
  json["merge"] = toString(options.mode);
  if (options.mode == MergeMode::score) {
    json["strictness"] = options.strictness;
  } else {
    json["theta"] = options.theta;
    json["delta"] = options.delta;
    json["adjacency"] = toString(options.adjacency);
  }
  if (options.minGrain > 0) json["min_grain"] = options.minGrain;
}

Json toJson(const SegmentArguments& o, const SegmentSummary& summary) {
  const SegmentCounts& counts = summary.counts;
  Json json;
  json["input"] = o.input.path;
  json["output"] = o.result();
  json["object_voxels"] = counts.objectVoxels;
  json["cavities"] = counts.cavities;
  json["cavity_voxels"] = counts.cavityVoxels;
  json["medial_balls"] = counts.medialBalls;
  json["kept_balls"] = counts.keptBalls;
  json["critical_points"] = counts.criticalPoints;
  json["grains"] = counts.grains;
  json["largest_squared_distance"] = counts.largestSquaredDistance;
  json["leaves"] = counts.leaves;
  if (const auto& domain = summary.domain) {
    json["domain_min"] = coordJson(domain->box().min());
    json["domain_max"] = coordJson(domain->box().max());
    if (!domain->isBox()) json["region_voxels"] = int64_t(domain->voxelCount());
    json["porosity"] = *summary.porosity();
  }
  if (summary.voxelSize) json["voxel_size_mm"] = inMillimeters(*summary.voxelSize);
  if (summary.weights != VoxelWeights{}) {
    json["weights"] = {summary.weights.x, summary.weights.y, summary.weights.z};
    json["weights_error"] = summary.weightsError;
  }
  json["grains_under_100_voxels"] = summary.sizes.dustGrains;
  json["voxels_in_grains_under_100_voxels"] = summary.sizes.dustVoxels;
  if (summary.flaws) {
    json["crumbs"] = summary.flaws->crumbs;
    json["specks"] = summary.flaws->specks;
    json["slivers"] = summary.flaws->slivers;
    json["grains_in_pieces"] = summary.flaws->inPieces;
  }
  json["grain_diameter_d10_voxels"] = summary.sizes.d10;
  json["grain_diameter_d50_voxels"] = summary.sizes.d50;
  json["grain_diameter_d90_voxels"] = summary.sizes.d90;
  for (const auto& [key, value] : {std::pair<const char*, std::string>{"grid", o.input.gridName},
                                   {"phase", o.input.phase},
                                   {"threshold", o.input.threshold},
                                   {"range", o.input.range},
                                   {"keep", o.keep}})
    if (!value.empty()) json[key] = value;
  if (o.input.invert) json["invert"] = true;
  if (!summary.objectSteps.empty()) json["object"] = summary.objectSteps;
  if (summary.threshold) json["threshold_value"] = *summary.threshold;
  json["gamma"] = o.segment.gamma;
  json["boundary"] = summary.open ? "open" : "closed";
  json["fill_holes"] = summary.fillHoles;
  addMerging(json, o.segment.merge);
  if (const auto& stable = summary.stable) {
    json["strictness_auto"] = true;
    json["strictness_plateau"] =
        stable->plateau ? Json{stable->plateau->first, stable->plateau->second} : Json();
  }
  json["tidy"] = o.segment.tidy;
  json["threads"] = summary.threads;
  for (const auto& [part, seconds] : summary.seconds) json["seconds_" + part] = seconds;
  for (const auto& [stage, bytes] : summary.peakBytesUntil)
    json["peak_memory_bytes_until_" + stage] = bytes;
  for (const auto& [stage, faults] : summary.pageFaults) json["page_faults_" + stage] = faults;
  json["peak_memory_bytes"] = summary.peakBytes;
  json["hints"] = summary.hints;
  return json;
}

namespace {

void printSettings(const SegmentOptions& options, const SegmentSummary& summary) {
  const auto gamma = (long long)options.gamma, fillHoles = (long long)summary.fillHoles;
  const MergeOptions& merge = options.merge;
  const char* const boundary = summary.open ? "open" : "closed";
  const std::string minGrain =
      merge.minGrain > 0 ? fmt::format(", min-grain {}", merge.minGrain) : "";
  if (merge.mode == MergeMode::score) {
    std::printf("  settings         gamma %lld, merge %s, strictness %g, boundary %s,\n", gamma,
                toString(merge.mode), merge.strictness, boundary);
    std::printf("                   fill-holes %lld%s, tidy %d\n", fillHoles, minGrain.c_str(),
                options.tidy);
    return;
  }
  std::printf("  settings         gamma %lld, theta %g, merge %s, adjacency %s, boundary %s,\n",
              gamma, merge.theta, toString(merge.mode), toString(merge.adjacency), boundary);
  std::printf("                   fill-holes %lld, delta %d%s, tidy %d\n", fillHoles, merge.delta,
              minGrain.c_str(), options.tidy);
}

}  // namespace

void print(const SegmentArguments& o, const Common& common, const SegmentSummary& summary) {
  const SegmentCounts& counts = summary.counts;
  const GrainSizes& sizes = summary.sizes;
  const auto count = [](int64_t number) { return (long long)number; };
  std::printf("%s: %s\n", o.result().c_str(), counted(counts.grains, "grain").c_str());
  std::printf("  object           %lld voxels in %lld leaf nodes%s\n", count(counts.objectVoxels),
              count(counts.leaves), hintIfEmpty(counts.objectVoxels));
  if (!summary.objectSteps.empty())
    std::printf("                   %s\n", summary.objectSteps.c_str());
  if (summary.domain && !summary.domain->isBox())
    std::printf("  region           %s\n", regionText(*summary.domain).c_str());
  if (summary.domain) std::printf("  porosity         %.2f %%\n", 100 * *summary.porosity());
  const double um = summary.voxelSize ? 1e3 * (summary.voxelSize->meanEdge() * 1e3) : 0;
  if (summary.voxelSize && !summary.voxelSize->isCube())
    std::printf("  voxel size       %g x %g x %g um\n", 1e6 * summary.voxelSize->edges()[0],
                1e6 * summary.voxelSize->edges()[1], 1e6 * summary.voxelSize->edges()[2]);
  else if (summary.voxelSize)
    std::printf("  voxel size       %g um\n", um);
  else
    std::printf("  voxel size       unknown, so no physical sizes (give --voxel-size)\n");
  if (summary.weights != VoxelWeights{})
    std::printf("  squared edges    taken as %s, to %.1g %%\n", summary.weights.toString().c_str(),
                100 * summary.weightsError);
  if (counts.grains > 0) {
    std::printf("  grain diameter   d10 %.1f, d50 %.1f, d90 %.1f voxels", sizes.d10, sizes.d50,
                sizes.d90);
    if (summary.voxelSize)
      std::printf(" = %.4g, %.4g, %.4g um", um * sizes.d10, um * sizes.d50, um * sizes.d90);
    std::printf(" (equal volume, by volume)\n");
  }
  std::printf("  dust             %s under 100 voxels, %.3f %% of the object\n",
              counted(sizes.dustGrains, "grain").c_str(),
              100 * double(sizes.dustVoxels) / std::max(1.0, double(counts.objectVoxels)));
  if (summary.flaws)
    std::printf("  flaws            %s, %s, %s, %s in pieces\n",
                counted(summary.flaws->crumbs, "crumb").c_str(),
                counted(summary.flaws->specks, "speck").c_str(),
                counted(summary.flaws->slivers, "sliver").c_str(),
                counted(summary.flaws->inPieces, "grain").c_str());
  if (summary.fillHoles > 1)
    std::printf("  cavities         %lld under %lld voxels filled for the distance, %lld voxels\n",
                count(counts.cavities), count(summary.fillHoles), count(counts.cavityVoxels));
  std::printf("  medial balls     %lld, kept %lld; critical points %lld\n",
              count(counts.medialBalls), count(counts.keptBalls), count(counts.criticalPoints));
  printSettings(o.segment, summary);
  if (summary.stable)
    std::printf("  strictness       %s\n", textOf(*summary.stable, std::string(19, ' ')).c_str());
  std::printf("  time, memory     %.2f s with %d threads, %.0f MiB at the peak\n",
              summary.seconds.back().second, summary.threads,
              double(summary.peakBytes) / (1 << 20));
  for (const std::string& hint : summary.hints)
    std::printf("  hint             %s\n", hint.c_str());
  if (!common.verbose) return;
  for (const auto& [part, seconds] : summary.seconds)
    std::printf("    %-24s %8.3f s\n", part.c_str(), seconds);
}

}  // namespace vdb_madf::tools
