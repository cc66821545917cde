// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/exports/detail/vtk_file.h"
#include "vdb_madf/exports/musen_file.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/files/detail/output_stream.h"
#include "vdb_madf/files/file_name.h"

#include <fmt/core.h>

namespace vdb_madf {

namespace {

using detail::OutputStream;
using Column = GrainNetwork::Column;

void addColumn(detail::VtkFile& file, const Column& column) {
  file.array("Float64", column.name, 1, 8 * column.values.size(), [&column](OutputStream& out) {
    out.bytes(column.values.data(), 8 * column.values.size());
  });
}

void writeVtp(const std::string& path, const GrainNetwork& network, Interrupter* interrupter) {
  const size_t grains = network.grains.size(), bonds = network.bonds.size();
  detail::VtkFile file("PolyData");
  file.xml(fmt::format(
      "<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData Scalars=\"grain_id\">\n",
      grains, bonds));
  file.array("Int32", "grain_id", 1, 4 * grains,
             [&](OutputStream& out) { out.bytes(network.grains.data(), 4 * grains); });
  file.array("UInt8", "color", 3, 3 * grains, [&](OutputStream& out) {
    for (const Rgb& color : network.colors) out.value(color);
  });
  for (const Column& column : network.grainColumns) addColumn(file, column);
  file.xml("</PointData>\n<CellData>\n");
  for (const size_t end : {size_t(0), size_t(1)})
    file.array("Int32", end == 0 ? "first" : "second", 1, 4 * bonds,
               [&network, end](OutputStream& out) {
                 for (const auto& bond : network.bonds) out.value(network.grains[bond[end]]);
               });
  for (const Column& column : network.bondColumns) addColumn(file, column);
  file.xml("</CellData>\n<Points>\n");
  file.array("Float64", "Points", 3, 24 * grains, [&](OutputStream& out) {
    for (const openvdb::Vec3d& p : network.centers) out.value(p);
  });
  file.xml("</Points>\n<Lines>\n");
  file.array("Int64", "connectivity", 1, 16 * bonds, [&](OutputStream& out) {
    for (const auto& bond : network.bonds)
      for (const uint32_t end : bond) out.value(int64_t(end));
  });
  file.array("Int64", "offsets", 1, 8 * bonds, [&](OutputStream& out) {
    for (size_t i = 1; i <= bonds; ++i) out.value(int64_t(2 * i));
  });
  file.xml("</Lines>\n</Piece>\n</PolyData>\n");
  file.write(path, interrupter);
}

void writeGraphml(const std::string& path, const GrainNetwork& network, Interrupter* interrupter) {
  OutputStream out(path, interrupter);
  out.text(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n");
  const auto key = [&](const std::string& of, const std::string& name, const char* type) {
    out.text("<key id=\"" + of + "_" + name + "\" for=\"" + of + "\" attr.name=\"" + name +
             "\" attr.type=\"" + type + "\"/>\n");
  };
  key("node", "grain_id", "int");
  for (const char* axis : {"x", "y", "z"}) key("node", axis, "double");
  for (const Column& column : network.grainColumns) key("node", column.name, "double");
  for (const Column& column : network.bondColumns) key("edge", column.name, "double");
  out.text("<graph id=\"grains\" edgedefault=\"undirected\">\n");
  const auto data = [&](const std::string& id, auto value) {
    if (std::isnan(double(value))) return;
    out.text("<data key=\"" + id + "\">");
    out.number(value);
    out.text("</data>");
  };
  for (size_t i = 0; i < network.grains.size(); ++i) {
    out.text(fmt::format("<node id=\"n{}\">", network.grains[i]));
    data("node_grain_id", network.grains[i]);
    data("node_x", network.centers[i].x());
    data("node_y", network.centers[i].y());
    data("node_z", network.centers[i].z());
    for (const Column& column : network.grainColumns) data("node_" + column.name, column.values[i]);
    out.text("</node>\n");
  }
  for (size_t i = 0; i < network.bonds.size(); ++i) {
    out.text(fmt::format("<edge source=\"n{}\" target=\"n{}\">",
                         network.grains[network.bonds[i][0]], network.grains[network.bonds[i][1]]));
    for (const Column& column : network.bondColumns) data("edge_" + column.name, column.values[i]);
    out.text("</edge>\n");
  }
  out.text("</graph>\n</graphml>\n");
  out.commit();
}

/// What OpenPNM and PoreSpy call a column of ours, or a multiple of it.
struct OtherName {
  const char *theirs, *ours;
  double factor;
};
constexpr OtherName kPoreNames[] = {{"diameter", "equivalent_diameter", 1},
                                    {"inscribed_diameter", "inscribed_radius", 2},
                                    {"surface_area", "area", 1},
                                    {"region_volume", "volume", 1}};
constexpr OtherName kThroatNames[] = {{"diameter", "radius", 2},
                                      {"equivalent_diameter", "radius", 2},
                                      {"inscribed_diameter", "inscribed_radius", 2},
                                      {"cross_sectional_area", "area", 1},
                                      {"direct_length", "length", 1}};

template <size_t Count>
std::vector<Column> withOtherNames(std::vector<Column> columns, const OtherName (&names)[Count]) {
  for (const OtherName& name : names) {
    const auto own = std::find_if(columns.begin(), columns.end(),
                                  [&](const Column& column) { return column.name == name.ours; });
    if (own == columns.end()) continue;
    Column column{name.theirs, own->values, own->isCount};
    for (double& value : column.values) value *= name.factor;
    columns.push_back(std::move(column));
  }
  return columns;
}

void writeCsv(const std::string& path, const GrainNetwork& network, Interrupter* interrupter) {
  const std::vector<Column> pores = withOtherNames(network.grainColumns, kPoreNames),
                            throats = withOtherNames(network.bondColumns, kThroatNames);
  OutputStream out(path, interrupter);
  out.text("pore.coords[0],pore.coords[1],pore.coords[2],pore.grain_id,pore.region_label");
  for (const Column& column : pores) out.text(",pore." + column.name);
  out.text(",throat.conns[0],throat.conns[1]");
  for (const Column& column : throats) out.text(",throat." + column.name);
  out.text("\n");
  const auto cell = [&](double value) {
    out.text(",");
    if (!std::isnan(value)) out.number(value);
  };
  const std::string noGrain(pores.size() + 4, ','), noBond(throats.size() + 2, ',');
  for (size_t i = 0; i < std::max(network.grains.size(), network.bonds.size()); ++i) {
    if (i < network.grains.size()) {
      for (int axis = 0; axis < 3; ++axis) {
        out.number(network.centers[i][axis]);
        out.text(",");
      }
      out.number(network.grains[i]);
      out.number(",", network.grains[i]);
      for (const Column& column : pores) cell(column.values[i]);
    } else {
      out.text(noGrain);
    }
    if (i < network.bonds.size()) {
      for (const uint32_t end : network.bonds[i]) out.number(",", end);
      for (const Column& column : throats) cell(column.values[i]);
    } else {
      out.text(noBond);
    }
    out.text("\n");
  }
  out.commit();
}

}  // namespace

bool isNetworkEnding(const std::string& path) {
  const std::string end = fileEnding(path);
  return end == ".vtp" || end == ".graphml" || end == ".csv" || end == ".txt";
}

void writeNetwork(const std::string& path, const GrainNetwork& network, Interrupter* interrupter) {
  const std::string end = fileEnding(path);
  if (end == ".vtp")
    writeVtp(path, network, interrupter);
  else if (end == ".graphml")
    writeGraphml(path, network, interrupter);
  else if (end == ".csv")
    writeCsv(path, network, interrupter);
  else if (end == ".txt")
    writeMusen(path, network, interrupter);
  else
    throw InvalidInput(path +
                       ": no network format has this ending; use .vtp, .graphml, .csv or .txt");
}

}  // namespace vdb_madf
