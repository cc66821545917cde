// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "measure_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "command.h"
#include "vdb_madf/base/digits.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/measure/columns.h"
#include "vdb_madf/measure/edge_weights.h"
#include "vdb_madf/measure/size_biases.h"
#include "vdb_madf/measure/table_unit.h"

namespace vdb_madf::tools {

namespace {

void printCorrected(const Measurements& m, double length, const std::string& unit) {
  const EdgeCorrected corrected = edgeCorrected(m.grains);
  std::printf("  at the faces        %s, left out of the corrected sizes\n",
              counted(corrected.leftOut, "grain").c_str());
  if (corrected.grains > 0)
    std::printf("  corrected diameter  d50 %.5g %s by number, %.5g by volume\n",
                length * correctedDiameterPercentile(m.grains, 0.5, false), unit.c_str(),
                length * correctedDiameterPercentile(m.grains, 0.5, true));
  else
    std::printf("  corrected diameter  unknown: no grain is whole\n");
}

void printIntervals(const std::vector<MeanInterval>& intervals, double length,
                    const std::string& unit) {
  for (const MeanInterval& mean : intervals)
    if (mean.low && mean.high)
      std::printf("  %-33s %.4g, 95 %% from %.4g to %.4g\n",
                  (mean.name + unitSuffix(mean.power, unit)).c_str(),
                  scaled(*mean.mean, mean.power, length), scaled(*mean.low, mean.power, length),
                  scaled(*mean.high, mean.power, length));
}

/// How much of it all comes again by other choices.
void printSensitivity(const Measurements& m, double length, const std::string& unit) {
  const Sensitivity& s = *m.sensitivity;
  const int digits = digitsApart(s.threshold.low, s.threshold.high, 5);
  std::printf(
      "  sensitivity         %d runs: threshold %.*g to %.*g, smooth %.2f to %.2f,\n"
      "                      strictness %.4g to %.4g, gamma %.0f to %.0f\n",
      s.runs, digits, s.threshold.low, digits, s.threshold.high, s.smooth.low, s.smooth.high,
      s.strictness.low, s.strictness.high, s.gamma.low, s.gamma.high);
  const auto often = [](const auto& list) {
    return (long long)std::count_if(list.begin(), list.end(),
                                    [](const auto& item) { return item.recurrence->share >= 0.9; });
  };
  std::printf("  in 90 %% of them     %lld of %s, %lld of %s\n", often(m.grains),
              counted(int64_t(m.grains.size()), "grain").c_str(), often(m.bonds),
              counted(int64_t(m.bonds.size()), "bond").c_str());
  printIntervals(s.intervals, length, unit);
}

/// Necks as the labels have them and as the scan shows them.
void printNecks(const Measurements& m, double length, const std::string& unit) {
  const ConfirmedNecks necks = confirmedNecks(m);
  const double share = necks.count ? length * length / double(necks.count) : 0;
  std::printf("  scan                blur %.2f voxel, noise %.1f %% of the contrast\n",
              m.scan->sigma, 100 * m.scan->noise);
  std::printf("  necks in the scan   %lld of %s, mean area %.5g %s2 (%.5g in the labels)\n",
              (long long)necks.count, counted(int64_t(m.bonds.size()), "bond").c_str(),
              necks.area * share, unit.c_str(), necks.labeledArea * share);
  std::printf("  contacts a grain    %.2f with gaps of up to %.3g %s\n", contactCoordination(m),
              kContactGap * length, unit.c_str());
}

/// What leads from face to face, along x, y and z.
void printCrossings(const Crossings& crossings) {
  std::printf("  minimum cut        ");
  for (size_t axis = 0; axis < 3; ++axis) {
    std::printf("%s %c ", axis ? "," : "", "xyz"[axis]);
    if (const auto& area = crossings.along[axis].cutArea)
      std::printf("%.4g %%", 100 * *area / crossings.along[axis].section);
    else
      std::printf("none (a grain reaches across)");
  }
  std::printf(" of the section\n  bonds conduct      ");
  for (size_t axis = 0; axis < 3; ++axis)
    std::printf("%s %c %.4g %%", axis ? "," : "", "xyz"[axis],
                100 * crossings.along[axis].conductivity);
  std::printf(" of the full box\n");
}

void printOnDemand(const Measurements& m, double length, const std::string& unit) {
  if (m.scan)
    printNecks(m, length, unit);
  else if (m.metadata[kThresholdKey])
    std::printf(
        "  areas of bonds      of a thresholded scan, too large by any blur it had (--gray "
        "SCAN)\n");
  if (m.binder)
    std::printf("  binder              %s, %.3g %% of the binder in none\n",
                counted(int64_t(m.binder->bridges.size()), "bridge").c_str(),
                m.binder->volume > 0 ? 100 * m.binder->looseVolume / m.binder->volume : 0.0);
  if (m.crossings) printCrossings(*m.crossings);
  for (const SizeDeviation& deviation : m.sizeDeviations)
    if (std::isnan(deviation.percent))
      std::printf("  %-20sunknown: no grain counts\n", deviation.size.c_str());
    else
      std::printf("  %-20sRMS %.2f %% from the curve\n", deviation.size.c_str(), deviation.percent);
  printIntervals(m.intervals, length, unit);
  if (m.sensitivity) printSensitivity(m, length, unit);
  for (const SizeBias& bias : sizeBiases(m))
    std::printf("  too small for       %s\n", toString(bias).c_str());
}

}  // namespace

void print(const MeasureArguments& o, const Measurements& m) {
  const TableUnit own(m, o.tables.unit);
  const std::string& unit = own.name;
  const double length = own.length;
  std::printf("%s: %s, %s%s\n", o.folder.c_str(),
              counted(int64_t(m.grains.size()), "grain").c_str(),
              counted(int64_t(m.bonds.size()), "bond").c_str(),
              m.grains.size() == 1 ? ": is this a mask? segment it first" : "");
  if (!m.voxelSize)
    std::printf("  voxel size          unknown, so lengths are in %s (give --voxel-size)\n",
                m.edges == openvdb::Vec3d(1) ? "voxels" : "shortest edges of a voxel");
  const std::optional<double>& density = o.tables.density;
  std::printf("  solid fraction      %.4f of the %s", m.sample.objectFraction,
              m.sample.domainKnown ? "domain" : "box of the grains (the domain is unknown)");
  if (density) std::printf(", %.1f kg/m3", *density * m.sample.objectFraction);
  std::printf("\n  specific surface    %.5g /%s", m.sample.specificSurface / length, unit.c_str());
  if (m.voxelSize && density)
    std::printf(" = %.4g m2/kg", m.sample.specificSurface / m.voxelSize->shortestEdge() / *density);
  std::printf("\n  grain diameter      d50 %.5g %s by number, %.5g by volume\n",
              length * diameterPercentile(m.grains, 0.5, false), unit.c_str(),
              length * diameterPercentile(m.grains, 0.5, true));
  if (m.extra.edgeWeights) printCorrected(m, length, unit);
  std::printf("  bonds a grain       %.2f\n", m.sample.meanCoordination);
  if (m.minFaces > 1)
    std::printf("  left out            %s of fewer than %lld faces\n",
                counted(m.sample.contactsLeftOut, "contact").c_str(), (long long)m.minFaces);
  if (m.sample.bondsWithoutCurvature > 0)
    std::printf("  too small to curve  %s (under 10 faces, or all in a row)\n",
                counted(m.sample.bondsWithoutCurvature, "bond").c_str());
  printOnDemand(m, length, unit);
}

}  // namespace vdb_madf::tools
