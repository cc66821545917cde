// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/report.h"

#include <tbb/global_control.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/files.h"
#include "support/label_shapes.h"
#include "support/label_slabs.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/measurement_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/labels/reduced_labels.h"
#include "vdb_madf/report/detail/packed_bytes.h"
#include "vdb_madf/report/detail/packed_mesh.h"
#include "vdb_madf/report/detail/page_text.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/remerge.h"
#include "vdb_madf/segmentation/segment.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

using Json = nlohmann::json;

#define NEEDS_PAGE()                                                                       \
  if (!canWriteReport()) {                                                                 \
    WARN("SKIPPED: reports: built without esbuild, libjs-three, libjs-jquery-datatables"); \
    return;                                                                                \
  }

std::string unbase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    REQUIRE(digits.find(c) != std::string::npos);
    bits = bits << 6 | uint32_t(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += char(bits >> count & 255);
  }
  return bytes;
}

std::string unpacked(const std::string& text) {
  const std::string packed = unbase64(text);
  std::string bytes(size_t(1) << 24, '\0');
  uLongf size = bytes.size();
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                     reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK);
  bytes.resize(size);
  return bytes;
}

/// A page as a reader of its text sees it.
struct Page {
  std::string text;

  /// What an element of data holds.
  std::string element(const std::string& id) const {
    const std::string head = "id=\"" + id + "\">";
    const size_t at = text.find(head);
    REQUIRE(at != std::string::npos);
    const size_t begin = at + head.size();
    return text.substr(begin, text.find("</script>", begin) - begin);
  }
  bool has(const std::string& id) const {
    return text.find("id=\"" + id + "\">") != std::string::npos;
  }
  Json json(const std::string& id) const { return Json::parse(element(id)); }
  std::string bytes(const std::string& id) const { return unpacked(element(id)); }
};

Page write(const AnyLabels& labels, const ReportOptions& options = {}) {
  const ScratchFolder folder;
  const Report report = writeReport(folder / "page.html", labels, options);
  const Page page{readFile(folder / "page.html")};
  CHECK(report.bytes == page.text.size());
  return page;
}

Int32Grid::Ptr balls() {
  const auto labels = labelGrid(twoBalls({10, 12, 14}, 8));
  setDomain(*labels, Domain(CoordBBox({0, 0, 0}, {32, 25, 27})));
  return labels;
}

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

/// The labels of the slices, x fastest: places in the table from 1 on.
std::vector<uint64_t> sliceVoxels(const Page& page) {
  const std::string bytes = page.bytes("labels");
  std::vector<uint64_t> voxels;
  size_t at = 0;
  const auto number = [&] {
    uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const uint8_t byte = uint8_t(bytes.at(at++));
      value |= uint64_t(byte & 127) << shift;
      if (byte < 128) return value;
    }
  };
  while (at < bytes.size()) {
    const uint64_t run = number(), held = number();
    voxels.insert(voxels.end(), run, held);
  }
  return voxels;
}

/// What a page says of the grains at the strictnesses of its slider, read by the descriptions in
/// grain_levels.h.
class PageLevels {
 public:
  explicit PageLevels(const Page& page)
      : about_(page.json("about").at("levels")), joins_(page.bytes("joins")) {
    const std::string leaves = page.bytes("leaves");
    REQUIRE(about_["columns"]["grains"][0] == Json{{"name", "voxels"}, {"exact", true}});
    for (size_t leaf = 0; leaf < leafCount(); ++leaf) {
      uint64_t bits = 0;
      for (size_t plane = 0; plane < 8; ++plane)
        bits |= uint64_t(uint8_t(leaves.at(plane * leafCount() + leaf))) << (8 * plane);
      double voxels = 0;
      std::memcpy(&voxels, &bits, sizeof voxels);
      voxels_.push_back(int64_t(voxels));
    }
    REQUIRE(joins_.size() == 4 * leafCount() + 12 * joinCount());
  }

  size_t leafCount() const { return about_.at("leaves"); }
  /// Among the labels, of a leaf from 1 on.
  int32_t ownGrain(size_t leaf) const { return int32_t(number(0, leafCount(), leaf - 1)); }

  /// By number; made join by join.
  std::vector<int64_t> grainVoxels(double strictness) const {
    std::map<uint32_t, int64_t> grains;  // by name
    uint32_t place = 0;
    for (const int64_t voxels : voxels_) {
      while (isEmpty(place)) grains[place++] = 0;
      grains[place++] = voxels;
    }
    for (const uint32_t empty : about_.at("empty")) grains.emplace(empty, 0);
    const size_t kept = 4 * leafCount(), gone = kept + 4 * joinCount();
    for (size_t i = 0; i < joinCount(); ++i) {
      const auto least = int32_t(number(gone + 4 * joinCount(), joinCount(), i));
      if (least < std::lround(512 * strictness)) break;
      const auto from = grains.find(number(gone, joinCount(), i));
      REQUIRE(from != grains.end());
      grains.at(number(kept, joinCount(), i)) += from->second;
      grains.erase(from);
    }
    std::vector<int64_t> result;
    for (const auto& [name, voxels] : grains)
      if (voxels > 0) result.push_back(voxels);
    return result;
  }

 private:
  size_t joinCount() const { return about_.at("joins"); }
  bool isEmpty(uint32_t place) const {
    const auto empty = about_.at("empty").get<std::vector<uint32_t>>();
    return std::find(empty.begin(), empty.end(), place) != empty.end();
  }
  /// Of planes of 32 bits.
  uint32_t number(size_t at, size_t count, size_t i) const {
    uint32_t value = 0;
    for (size_t plane = 0; plane < 4; ++plane)
      value |= uint32_t(uint8_t(joins_.at(at + plane * count + i))) << (8 * plane);
    return value;
  }

  Json about_;
  std::string joins_;
  std::vector<int64_t> voxels_;
};

Segmentation withManifolds(double strictness) {
  Rng rng(5);
  const CoordBBox box = boxAt({-10, 3, 5}, {44, 40, 36});
  SegmentOptions options;
  options.keepManifold = true;
  options.merge.strictness = strictness;
  return segment(*toMask(randomVolume(VolumeKind::blurredNoise, box, rng)), options);
}

/// Without what takes time here.
Page writePlain(const Int32Grid::ConstPtr& labels, const Int32Grid::ConstPtr& manifold) {
  ReportOptions options;
  options.manifold = manifold;
  options.maxTriangles = 0;
  options.pictureEdge = 16;
  return write(labels, options);
}

std::vector<int64_t> voxelsOfLabels(const Int32Grid& labels) {
  std::map<int32_t, int64_t> voxels;
  for (auto value = labels.cbeginValueOn(); value; ++value)
    voxels[*value] += int64_t(value.getVoxelCount());
  std::vector<int64_t> result;
  for (const auto& [label, count] : voxels) {
    REQUIRE(label == int32_t(result.size()) + 1);
    result.push_back(count);
  }
  return result;
}

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

TEST_CASE("report: with manifolds, its grains at any strictness are those of remerge", "[report]") {
  NEEDS_PAGE();
  for (const double own : {11.0, 15.25}) {
    const Segmentation grains = withManifolds(own);
    const Page page = writePlain(grains.grain, grains.manifold);
    const PageLevels levels(page);
    const double highest = std::max(own, 14.0);
    CHECK(levels.leafCount() == levels.grainVoxels(highest).size());
    CHECK(levels.grainVoxels(highest).size() > levels.grainVoxels(8).size());
    for (const double strictness : {8.0, 9.1, 10.0, 11.0, 12.7, 14.0, highest}) {
      MergeOptions merge;
      merge.strictness = strictness;
      CHECK(levels.grainVoxels(strictness) == voxelsOfLabels(*remerge(*grains.manifold, merge, 0)));
    }
    CHECK(page.bytes("grains") == measurementTexts(measure(*grains.grain)).grains);

    // The leaves of the slices make the grains of the labels, before these are tidied.
    MergeOptions merge;
    merge.strictness = own;
    const auto untidied = remerge(*grains.manifold, merge, 0);
    const Json about = page.json("about").at("slices");
    const Coord min(about["min"][0], about["min"][1], about["min"][2]),
        size(about["size"][0], about["size"][1], about["size"][2]);
    size_t i = 0, wrong = 0;
    const std::vector<uint64_t> voxels = sliceVoxels(page);
    for (int z = 0; z < size.z(); ++z)
      for (int y = 0; y < size.y(); ++y)
        for (int x = 0; x < size.x(); ++x, ++i) {
          const int32_t label = untidied->tree().getValue(min + Coord(x, y, z));
          wrong += label != (voxels[i] == 0 ? 0 : levels.ownGrain(voxels[i]));
        }
    CHECK(i == voxels.size());
    CHECK(wrong == 0);
  }
}

TEST_CASE("report: a piece in a cavity, which has no voxels, joins and names a grain", "[report]") {
  NEEDS_PAGE();
  const auto manifold = Int32Grid::create(0);
  manifold->setName("manifold");
  manifold->fill({{0, 0, 0}, {4, 9, 9}}, 1);
  manifold->fill({{0, 20, 0}, {3, 29, 9}}, 2);
  ManifoldGraph graph;
  graph.nodes = {{{0, 0, 0}, 90, 500}, {{0, 20, 0}, 80, 400}, {{0, 40, 0}, 100, 0, 300}};
  graph.edges = {{0, 2, 100, 81, true}};
  setGraph(*manifold, graph);
  const auto labels = remerge(*manifold);
  const PageLevels levels(writePlain(labels, manifold));
  CHECK(levels.grainVoxels(14) == std::vector<int64_t>{500, 400});
  CHECK(levels.grainVoxels(11) == std::vector<int64_t>{400, 500});
  CHECK(levels.ownGrain(1) == 2);
  CHECK(levels.ownGrain(2) == 1);
}

TEST_CASE("report: manifolds that are not those of the labels change nothing", "[report]") {
  NEEDS_PAGE();
  const Segmentation grains = withManifolds(11);
  MergeOptions both;
  both.mode = MergeMode::both;
  const auto otherwise = remerge(*grains.manifold, both);
  const auto edited = grains.grain->deepCopy();
  edited->insertMeta(kEditsKey, openvdb::StringMetadata("merge 1 2"));
  const auto others = balls();
  describeMerging(*others, {}, 2, 2);
  for (const auto& labels : {otherwise, edited, others, balls()})
    CHECK(writePlain(labels, grains.manifold).text == writePlain(labels, nullptr).text);
  CHECK(writePlain(grains.grain, grains.manifold).has("joins"));
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
  CHECK_THROWS_AS(writeReport(folder / "none/p.html", balls()), IoError);
  CHECK(folder.fileCount() == 0);
}
