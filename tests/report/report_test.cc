// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/report.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/label_slabs.h"
#include "support/report_page.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/gray_planes.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/report/detail/packed_bytes.h"
#include "vdb_madf/report/detail/packed_mesh.h"
#include "vdb_madf/report/detail/page_text.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

uint32_t word(const std::string& bytes, size_t i) {
  uint32_t value = 0;
  for (size_t k = 0; k < 4; ++k) value |= uint32_t(uint8_t(bytes.at(4 * i + k))) << (8 * k);
  return value;
}

/// The volume of each body, read by the description in packed_mesh.h.
std::vector<double> meshVolumes(const Page& page, size_t grains) {
  const std::string bytes = page.bytes("mesh");
  const Json about = page.json("about").at("mesh");
  const size_t points = about.at("points"), triangles = about.at("triangles");
  const double step = about.at("step");
  size_t at = 20 * grains;
  REQUIRE(bytes.size() == at + 6 * points + 12 * triangles);
  std::vector<std::array<double, 3>> places(points);
  for (size_t axis = 0; axis < 3; ++axis, at += 2 * points)
    for (size_t grain = 0, i = 0; grain < grains; ++grain) {
      int64_t place = int32_t(word(bytes, 2 * grains + 3 * grain + axis));
      for (uint32_t k = 0; k < word(bytes, grain); ++k, ++i) {
        const int64_t folded = uint8_t(bytes[at + i]) | uint8_t(bytes[at + points + i]) << 8;
        place += folded % 2 ? -(folded + 1) / 2 : folded / 2;
        places[i][axis] = double(place) * step;
      }
    }
  std::vector<double> volumes;
  size_t first = 0, corner = 0;
  for (size_t grain = 0; grain < grains; ++grain) {
    uint32_t named = 0;
    double sum = 0;
    for (uint32_t i = 0; i < word(bytes, grains + grain); ++i) {
      std::array<double, 3> p[3];
      for (auto& place : p) {
        uint32_t back = 0;
        for (size_t plane = 0; plane < 4; ++plane)
          back |= uint32_t(uint8_t(bytes[at + plane * 3 * triangles + corner])) << (8 * plane);
        ++corner;
        place = places.at(first + named - back);
        if (back == 0) ++named;
      }
      sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
             p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
             p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    CHECK(named == word(bytes, grain));
    first += word(bytes, grain);
    volumes.push_back(sum / 6);
  }
  return volumes;
}

/// Brighter to the right and upward.
class Ramp : public ImageReader {
 public:
  explicit Ramp(const Coord& size) {
    info_.size = {size.x(), size.y(), size.z()};
    info_.type = SampleType::uint8;
    path_ = "folder/ramp.tif";
  }
  void read(int first, int count, void* samples) override {
    auto* to = static_cast<uint8_t*>(samples);
    for (int z = first; z < first + count; ++z)
      for (int y = 0; y < info_.size.y; ++y)
        for (int x = 0; x < info_.size.x; ++x) *to++ = uint8_t(2 * x + y + 3 * z);
  }
};

}  // namespace

TEST_CASE("report: bytes as base64", "[report]") {
  CHECK(detail::base64("") == "");
  CHECK(detail::base64("M") == "TQ==");
  CHECK(detail::base64("Ma") == "TWE=");
  CHECK(detail::base64("Man") == "TWFu");
  CHECK(detail::base64(std::string("\0\xff\xfe?", 4)) == "AP/+Pw==");
}

TEST_CASE("report: packed bytes are those put in, in whatever pieces", "[report]") {
  std::string all;
  detail::PackedBytes packed;
  for (uint32_t i = 0; i < 3000; ++i) {
    const std::string piece(i % 97, char(i * 7));
    packed.bytes(piece.data(), piece.size());
    all += piece;
  }
  packed.variable(0);
  packed.variable(300);
  packed.planes(std::vector<uint16_t>{0x0102, 0x0304});
  all += std::string("\0\xac\x02\x02\x04\x01\x03", 7);
  CHECK(unpacked(packed.text()) == all);
}

TEST_CASE("report: words of a template are replaced once", "[report]") {
  std::string text;
  detail::fillIn(
      "a@X@b@@YY@c@no@ @Z", [](const std::string& name) { return "<" + name + "@X@>"; },
      [&](const std::string& piece) { text += piece; });
  CHECK(text == "a<X@X@>b@<YY@X@>c@no@ @Z");
}

TEST_CASE("report: the same bytes again, with any number of threads", "[report]") {
  NEEDS_PAGE();
  const auto labels = balls();
  const Page page = write(labels);
  CHECK(write(labels).text == page.text);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  CHECK(write(labels).text == page.text);
}

TEST_CASE("report: a page that may ask for nothing", "[report]") {
  NEEDS_PAGE();
  const Page page = write(balls());
  CHECK(page.text.find("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                       "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: "
                       "blob:\">") != std::string::npos);
  const std::string markup = page.text.substr(0, page.text.find("<script>"));
  for (const char* word : {"<link", "src=\"http", "href=", "@import", "url("})
    CHECK(markup.find(word) == std::string::npos);
}

TEST_CASE("report: titles and paths are text, whatever they hold", "[report]") {
  NEEDS_PAGE();
  ReportOptions options;
  options.title = "a </script><b> & \"c\" <!-- @DATA@";
  options.labels = "/x/</script><script>alert(1)//.vdb";
  const Page page = write(balls(), options);
  CHECK(page.text.find(
            "<title>a &lt;/script&gt;&lt;b&gt; &amp; &quot;c&quot; &lt;!-- @DATA@</title>") !=
        std::string::npos);
  CHECK(page.text.find("</script><b>") == std::string::npos);
  CHECK(page.text.find("<script>alert") == std::string::npos);
  CHECK(page.json("about").at("title") == options.title);
  CHECK(page.json("sample").at("labels") == options.labels);
}

TEST_CASE("report: its tables are those of the measures", "[report]") {
  NEEDS_PAGE();
  const auto labels = balls();
  setVoxelSize(*labels, VoxelSize(1e-5));
  ReportOptions options;
  options.density = 917;
  const Page page = write(labels, options);
  const MeasurementTexts texts = measurementTexts(measure(*labels), {"", "", 917.0});
  CHECK(page.bytes("grains") == texts.grains);
  CHECK(page.bytes("bonds") == texts.bonds);
  CHECK(page.json("sample") == Json::parse(texts.sample));
  CHECK(page.json("about").at("unit") == "mm");
  const GrainColors colors = grainColors(*labels);
  std::string bytes;
  for (const int32_t label : {3, 7})
    for (const uint8_t channel : colors.colorOf(label)) bytes += char(channel);
  CHECK(page.bytes("colors") == bytes);
}

TEST_CASE("report: slices hold every voxel, or each block's most frequent label", "[report]") {
  NEEDS_PAGE();
  const auto labels = balls();
  for (const int side : {256, 12}) {
    ReportOptions options;
    options.maxSlice = side;
    const Page page = write(labels, options);
    const Json about = page.json("about").at("slices");
    const int factor = side == 256 ? 1 : 3;
    REQUIRE(about.at("factor") == factor);
    const auto reduced = reduceLabels(*labels, factor);
    const Coord min(about["min"][0], about["min"][1], about["min"][2]),
        size(about["size"][0], about["size"][1], about["size"][2]);
    std::vector<uint64_t> expected;
    for (int z = 0; z < size.z(); ++z)
      for (int y = 0; y < size.y(); ++y)
        for (int x = 0; x < size.x(); ++x) {
          const int32_t label = reduced->tree().getValue(min + Coord(x, y, z));
          expected.push_back(label == 0 ? 0 : label == 3 ? 1 : 2);
        }
    CHECK(sliceVoxels(page) == expected);
  }
}

TEST_CASE("report: the scan lies under the slices, by its mean where these are reduced",
          "[report]") {
  NEEDS_PAGE();
  const auto labels = balls();
  GrayScan scan{std::make_unique<Ramp>(Coord(35, 26, 28)), Coord(0)};
  CHECK_FALSE(write(labels).has("gray"));
  for (const int side : {256, 12}) {
    ReportOptions options;
    options.maxSlice = side;
    options.scan = &scan;
    const Page page = write(labels, options);
    const Json slices = page.json("about").at("slices"), gray = page.json("about").at("gray");
    CHECK(gray == Json{{"scan", "ramp.tif"}, {"levels", 32}});
    const Coord min(slices["min"][0], slices["min"][1], slices["min"][2]),
        size(slices["size"][0], slices["size"][1], slices["size"][2]);
    std::string expected;
    const CoordBBox blocks(min, min + size.offsetBy(-1));
    for (const uint8_t value : readGrayBlocks(scan, blocks, slices["factor"]))
      expected += char(value / 8);
    CHECK(page.bytes("gray") == expected);
    CHECK(page.text == write(inSlabs(labels, {0, 8, 32}), options).text);
  }
}

TEST_CASE("report: every grain has a body of about its volume", "[report]") {
  NEEDS_PAGE();
  const auto labels = balls();
  const auto volumes = meshVolumes(write(labels), 2);
  const Measurements measured = measure(*labels);
  for (size_t i = 0; i < 2; ++i)
    CHECK(volumes[i] == Approx(double(measured.grains[i].voxels)).epsilon(0.02));
}

TEST_CASE("report: labels above 16 bits, and grains of one voxel", "[report]") {
  NEEDS_PAGE();
  const auto labels = labelGrid(marker());
  const Page page = write(labels);
  CHECK(page.bytes("grains").find("\n70000,2,") != std::string::npos);
  const auto volumes = meshVolumes(page, 4);
  for (const double volume : volumes) CHECK(volume > 0.2);
}

TEST_CASE("report: a grain that is lost where labels are reduced is an octahedron of its volume",
          "[report]") {
  const Measurements measured = measure(*labelGrid({{{1, 2, 3}, 5}, {{2, 2, 3}, 5}}));
  const detail::PackedMesh packed = detail::packMesh({}, measured.grains, 1.0 / 32);
  CHECK(packed.points == 6);
  CHECK(packed.triangles == 8);
  const Json about = {{"points", 6}, {"triangles", 8}, {"step", packed.step}};
  const Page page{detail::dataElement("mesh", packed.text) +
                  detail::jsonElement("about", Json{{"mesh", about}}.dump())};
  CHECK(meshVolumes(page, 1)[0] == Approx(2).epsilon(0.1));
}

TEST_CASE("report: labels in slabs have the page of the whole, reduced or not", "[report]") {
  NEEDS_PAGE();
  ReportOptions options;
  options.maxSlice = 20;
  const std::string page = write(balls(), options).text;
  CHECK(write(inSlabs(balls(), {0, 8, 16, 32}), options).text == page);
  CHECK(write(inSlabs(balls(), {0, 24, 32})).text == write(balls()).text);
  // So many faces that the labels are reduced before they are meshed.
  const auto labels = Int32Grid::create(0);
  const CoordBBox box(Coord(0), Coord(39));
  for (auto voxel = box.begin(); voxel; ++voxel)
    labels->tree().setValue(*voxel, 1 + ((*voxel).x() / 2 + (*voxel).y() + (*voxel).z() / 3) % 3);
  setDomain(*labels, Domain(box));
  const Page whole = write(labels);
  CHECK(write(inSlabs(labels, {0, 16, 40})).text == whole.text);
  CHECK(whole.json("about").at("mesh").at("step") > 0.05);
}

TEST_CASE("report: no more triangles than asked for", "[report]") {
  NEEDS_PAGE();
  ReportOptions options;
  options.maxTriangles = 200;
  CHECK(write(balls(), options).json("about").at("mesh").at("triangles") <= 200);
}

TEST_CASE("report: no grains, one, none that touch", "[report]") {
  NEEDS_PAGE();
  const auto none = Int32Grid::create(0);
  CHECK_THROWS_AS(write(none), InvalidInput);
  setDomain(*none, Domain(CoordBBox({0, 0, 0}, {9, 8, 7})));
  const Page empty = write(none);
  CHECK(!empty.has("mesh"));
  CHECK(empty.json("sample").at("grains") == 0);
  CHECK(sliceVoxels(empty) == std::vector<uint64_t>(720, 0));

  const Page one = write(labelGrid({{{1, 1, 1}, 5}, {{2, 1, 1}, 5}}));
  CHECK(one.json("sample").at("grains") == 1);
  CHECK(one.json("about").at("unit") == "voxel");
  CHECK(one.json("about").at("voxelSizeKnown") == false);

  const Page apart = write(labelGrid({{{1, 1, 1}, 5}, {{4, 1, 1}, 6}}));
  CHECK(apart.json("sample").at("bonds") == 0);
  const std::string bonds = apart.bytes("bonds");
  CHECK(std::count(bonds.begin(), bonds.end(), '\n') == 1);
}

TEST_CASE("report: the table of a sweep goes along", "[report]") {
  NEEDS_PAGE();
  ReportOptions options;
  options.sweep =
      "gamma,merge,strictness,delta,theta,grains,median_voxels,more\n0,score,11,,,9,8,6\n";
  const Page page = write(balls(), options);
  CHECK(page.bytes("sweep") == options.sweep);
}

TEST_CASE("report: without a view in three dimensions there is no mesh", "[report]") {
  NEEDS_PAGE();
  ReportOptions options;
  options.maxTriangles = 0;
  const Page page = write(balls(), options);
  CHECK(!page.has("mesh"));
  CHECK(page.json("about").at("mesh").is_null());
  CHECK(page.text.find("src=\"data:image/png;base64,iVBOR") != std::string::npos);
}

TEST_CASE("report: samples side by side have their tables and pictures", "[report]") {
  NEEDS_PAGE();
  const ScratchFolder folder;
  const auto first = balls(), second = labelGrid(marker());
  const auto sample = [](const std::string& name, const Int32Grid::Ptr& labels) {
    return ReportSample{name, name + ".vdb", [labels] { return labels; }};
  };
  ReportOptions options;
  options.title = "a & b";
  const Report report =
      writeComparison(folder / "c.html", {sample("<one>", first), sample("two", second)}, options);
  CHECK(report.grains == 6);
  const Page page{readFile(folder / "c.html")};
  CHECK(page.text.find("<title>a &amp; b</title>") != std::string::npos);
  CHECK(page.json("samples") == 2);
  CHECK(page.json("about-0").at("title") == "<one>");
  CHECK(page.bytes("grains-0") == measurementTexts(measure(*first)).grains);
  CHECK(page.bytes("bonds-1") == measurementTexts(measure(*second)).bonds);
  CHECK(page.json("sample-1").at("labels") == "two.vdb");
  CHECK(page.text.find("<img id=\"picture-1\"") != std::string::npos);
  CHECK(!page.has("mesh-0"));

  setVoxelSize(*first, VoxelSize(1e-5));
  CHECK_THROWS_WITH(
      writeComparison(folder / "d.html", {sample("one", first), sample("two", second)}),
      "lengths of one.vdb are in mm, those of two.vdb in voxel: give all samples a voxel size");
  CHECK_THROWS_WITH(writeComparison(folder / "d.html",
                                    {sample("one", first), sample("two", Int32Grid::create(0))}),
                    "two.vdb: has no labels and no domain: nothing to show");
  CHECK(folder.fileCount() == 1);
}

TEST_CASE("report: what is refused leaves no file", "[report]") {
  const ScratchFolder folder;
  ReportOptions options;
  options.maxSlice = 0;
  CHECK_THROWS_AS(writeReport(folder / "p.html", balls(), options), InvalidInput);
  options = {};
  options.pictureEdge = 8;
  CHECK_THROWS_AS(writeReport(folder / "p.html", balls(), options), InvalidInput);
  options = {};
  options.sweep = "a,b\n1,2\n";
  CHECK_THROWS_AS(writeReport(folder / "p.html", balls(), options), InvalidInput);
  GrayScan small{std::make_unique<Ramp>(Coord(33, 26, 27)), Coord(0)};
  options = {};
  options.scan = &small;
  if (canWriteReport())
    CHECK_THROWS_WITH(writeReport(folder / "p.html", balls(), options),
                      "folder/ramp.tif: has 33x26x27 voxels, and the labels are those of a scan of "
                      "33x26x28 voxels: give the one that they were made of, whole or cropped "
                      "as they were");
  CHECK_THROWS_AS(writeReport(folder / "none/p.html", balls()), IoError);
  CHECK(folder.fileCount() == 0);
}
