// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/report.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/report/detail/page_sources.h"
#include "vdb_madf/report/detail/page_text.h"
#include "vdb_madf/report/detail/report_parts.h"

namespace vdb_madf {

namespace {

/// What is the page's own.
struct PageText {
  std::string title, picture, data;
};

void checkOptions(const ReportOptions& options) {
  if (options.maxSlice < 1) throw InvalidInput("slices must have at least one voxel a side");
  if (options.pictureEdge < 16 || options.pictureEdge > 8192)
    throw InvalidInput("the picture must have from 16 to 8192 pixels a side");
  if (!options.sweep.empty() && !isSweepTable(options.sweep))
    throw InvalidInput("the table of a sweep has other columns than the verb sweep writes");
}

const detail::PageSources& sourcesFor(const std::string& path) {
  if (const detail::PageSources* sources = detail::pageSources()) return *sources;
  throw IoError(path +
                ": reports cannot be written by this program: install esbuild, libjs-three and "
                "libjs-jquery-datatables, then configure and build it again");
}

/// What is wrong with a sample names it.
std::unique_ptr<detail::ReportParts> partsOf(const AnyLabels& labels, const ReportOptions& options,
                                             const std::string& suffix, Interrupter* interrupter) {
  try {
    return std::make_unique<detail::ReportParts>(labels, options, suffix, interrupter);
  } catch (const InvalidInput& error) {
    throw InvalidInput(options.labels + ": " + error.what(), error.hint());
  }
}

/// @return bytes
uint64_t write(detail::OutputStream& file, const detail::PageSources& sources,
               const PageText& page) {
  uint64_t bytes = 0;
  detail::fillIn(
      sources.html,
      [&](const std::string& name) -> std::string {
        if (name == "TITLE") return detail::markupEscaped(page.title);
        if (name == "STYLE") return sources.style;
        if (name == "PICTURE") return page.picture;
        if (name == "DATA") return page.data;
        if (name == "SCRIPT") return sources.script;
        throw std::logic_error("the page has an unknown part: " + name);
      },
      [&](const std::string& text) {
        file.text(text);
        bytes += text.size();
      });
  file.commit();
  return bytes;
}

Report written(Report report, uint64_t bytes) {
  report.bytes = bytes;
  return report;
}

/// Options without what is of one sample.
ReportOptions ofSeveral(ReportOptions options) {
  checkOptions(options);
  options.manifold.reset();
  options.scan = nullptr;
  options.sweep.clear();
  options.given.clear();
  return options;
}

/// A page of several samples.
class SeveralPage {
 public:
  /// Refuses what is wrong before any work is done.
  SeveralPage(const std::string& path, const ReportOptions& options, const std::string& usualTitle,
              Interrupter* interrupter)
      : options_(ofSeveral(options)),
        sources_(sourcesFor(path)),
        file_(path, interrupter),
        page_{options.title.empty() ? usualTitle : options.title, "", ""},
        interrupter_(interrupter) {}

  /// \p add: what the page has of a sample, whose ids end with its position. \p countId: of the
  /// element that says how many there are.
  template <typename Add>
  Report write(const std::vector<ReportSample>& samples, const std::string& countId,
               const Add& add) {
    Report whole;
    std::string unit;
    for (size_t i = 0; i < samples.size(); ++i) {
      const AnyLabels labels = samples[i].labels();
      options_.title = samples[i].name;
      options_.labels = samples[i].path;
      const auto parts = partsOf(labels, options_, "-" + std::to_string(i), interrupter_);
      if (i > 0 && parts->unit() != unit)
        throw InvalidInput("lengths of " + samples[0].path + " are in " + unit + ", those of " +
                               samples[i].path + " in " + parts->unit() +
                               ": give all samples a voxel size",
                           Hint::voxelSize);
      unit = parts->unit();
      page_.data += add(*parts, page_);
      const Report report = parts->report();
      whole.grains += report.grains;
      whole.bonds += report.bonds;
      whole.triangles += report.triangles;
      whole.sliceReduction = std::max(whole.sliceReduction, report.sliceReduction);
    }
    page_.data += detail::jsonElement(countId, std::to_string(samples.size()));
    return written(whole, vdb_madf::write(file_, sources_, page_));
  }

 private:
  ReportOptions options_;
  const detail::PageSources& sources_;
  detail::OutputStream file_;
  PageText page_;
  Interrupter* interrupter_;
};

}  // namespace

bool canWriteReport() {
  return detail::pageSources() != nullptr;
}

bool isSweepTable(const std::string& text) {
  const std::string head = "gamma,merge,strictness,delta,theta,grains,median_voxels,";
  return text.compare(0, head.size(), head) == 0;
}

Report writeReport(const std::string& path, const AnyLabels& labels, const ReportOptions& options,
                   Interrupter* interrupter) {
  checkOptions(options);
  const detail::PageSources& sources = sourcesFor(path);
  detail::OutputStream file(path, interrupter);
  detail::ReportParts parts(labels, options, "", interrupter);
  const GrainColors colors =
      applied(labels, [&](const auto& all) { return grainColors(all, interrupter); });
  PageText page{parts.title(), parts.picture(colors), ""};
  page.data = parts.tables() + parts.colors(colors) + parts.sweep() + parts.slices();
  page.data += parts.gray();
  page.data += parts.mesh();
  page.data += parts.levels();
  page.data += parts.about();
  return written(parts.report(), write(file, sources, page));
}

Report writeComparison(const std::string& path, const std::vector<ReportSample>& samples,
                       const ReportOptions& options, Interrupter* interrupter) {
  SeveralPage page(path, options, "Samples side by side", interrupter);
  return page.write(samples, "samples", [](const detail::ReportParts& parts, const PageText&) {
    return parts.tables() + parts.picture() + parts.about();
  });
}

Report writeSeries(const std::string& path, const std::vector<ReportSample>& scans,
                   const ReportOptions& options, Interrupter* interrupter) {
  SeveralPage page(path, options, "Through time", interrupter);
  GrainColoring coloring;
  for (const ReportSample& scan : scans)
    applied(scan.labels(), [&](const auto& labels) { coloring.add(labels, interrupter); });
  const GrainColors colors = coloring.colors();
  return page.write(scans, "scans", [&](detail::ReportParts& parts, PageText& text) {
    if (text.picture.empty()) text.picture = parts.picture(colors);
    std::string data = parts.tables() + parts.colors(colors) + parts.slices();
    data += parts.mesh();
    return data + parts.about();
  });
}

}  // namespace vdb_madf
