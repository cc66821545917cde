// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/hierarchy.h"

#include <array>
#include <cstdio>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "command.h"
#include "input_options.h"
#include "merge_options.h"
#include "outputs.h"
#include "remerge_slabs.h"
#include "text_file.h"
#include "vdb_madf/base/counted.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"

namespace vdb_madf::tools {

namespace {

struct HierarchyArguments {
  InputOptions input;
  std::string out, levelsText;
  std::vector<double> levels;
};

/// The joins as trees: the classes that they begin with are the leaves, and the join of index i is
/// the item leafCount() + i. What is left in the end are the roots.
struct JoinTrees {
  std::vector<Hierarchy::Class> leaves;
  std::vector<JoinedGrains> joins;
  std::vector<std::array<size_t, 2>> parts;  ///< of each join: items
  std::vector<size_t> roots;                 ///< items, ascending

  explicit JoinTrees(const Hierarchy& hierarchy)
      : leaves(hierarchy.classes), joins(joinedGrains(hierarchy)) {
    std::vector<size_t> itemOf(hierarchy.classOfNode.size());  // by representative
    for (size_t i = 0; i < leaves.size(); ++i) itemOf[leaves[i].representative] = i;
    std::vector<char> isPart(leaves.size() + joins.size(), 0);
    for (const JoinedGrains& join : joins) {
      parts.push_back({itemOf[join.first], itemOf[join.second]});
      for (const size_t part : parts.back()) isPart[part] = 1;
      itemOf[join.first] = itemOf[join.second] = leaves.size() + parts.size() - 1;
    }
    for (size_t i = 0; i < isPart.size(); ++i)
      if (!isPart[i]) roots.push_back(i);
  }

  bool isLeaf(size_t item) const { return item < leaves.size(); }
  const JoinedGrains& joinOf(size_t item) const { return joins[item - leaves.size()]; }
  /// Leaves have the number of their critical point, joins a j before that of their line.
  std::string name(size_t item) const {
    return isLeaf(item) ? std::to_string(leaves[item].representative + 1)
                        : "j" + std::to_string(item - leaves.size() + 1);
  }
  /// The strictness below which it is there as such; of leaves that of the first join.
  double strictness(size_t item) const {
    return isLeaf(item) ? joins.front().strictness : joinOf(item).strictness;
  }
};

constexpr int kDigits = 12;

std::string joinTable(const ManifoldGraph& graph, const JoinTrees& trees) {
  const std::vector<JoinedGrains>& joins = trees.joins;
  std::ostringstream csv;
  csv.precision(kDigits);
  csv << "join,score,strictness,grains,first,first_x,first_y,first_z,first_voxels,second,second_x,"
         "second_y,second_z,second_voxels\n";
  const auto side = [&](uint32_t node, int64_t voxels) {
    const Coord& at = graph.nodes[node].position;
    csv << ',' << node + 1 << ',' << at.x() << ',' << at.y() << ',' << at.z() << ',' << voxels;
  };
  for (size_t i = 0; i < joins.size(); ++i) {
    const JoinedGrains& join = joins[i];
    csv << i + 1 << ',' << join.score << ',' << join.strictness << ',' << join.grains;
    side(join.first, join.firstVoxels);
    side(join.second, join.secondVoxels);
    csv << '\n';
  }
  return csv.str();
}

/// A tree a line. The length of a branch is the strictness that lies between its ends.
std::string newick(const ManifoldGraph&, const JoinTrees& trees) {
  struct Step {
    size_t item;
    double above;      ///< strictness of what it is part of
    size_t parts = 0;  ///< that are written
  };
  std::ostringstream text;
  text.precision(kDigits);
  for (const size_t root : trees.roots) {
    std::vector<Step> path{{root, 0}};
    while (!path.empty()) {
      Step& step = path.back();
      if (!trees.isLeaf(step.item) && step.parts < 2) {
        text << (step.parts == 0 ? '(' : ',');
        const size_t part = trees.parts[step.item - trees.leaves.size()][step.parts++];
        path.push_back({part, trees.strictness(step.item)});
        continue;
      }
      if (!trees.isLeaf(step.item)) text << ')';
      text << trees.name(step.item);
      if (step.item != root) text << ':' << trees.strictness(step.item) - step.above;
      path.pop_back();
    }
    text << ";\n";
  }
  return text.str();
}

/// Leaves and joins are nodes, an edge goes from a join to each of its parts.
std::string graphml(const ManifoldGraph& graph, const JoinTrees& trees) {
  std::ostringstream xml;
  xml.precision(kDigits);
  xml << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n";
  for (const auto& [name, type] :
       {std::pair("x", "int"), std::pair("y", "int"), std::pair("z", "int"),
        std::pair("voxels", "long"), std::pair("score", "double"),
        std::pair("strictness", "double"), std::pair("grains", "long")})
    xml << "<key id=\"" << name << "\" for=\"node\" attr.name=\"" << name << "\" attr.type=\""
        << type << "\"/>\n";
  const auto data = [&](const char* key, const auto& value) {
    xml << "<data key=\"" << key << "\">" << value << "</data>";
  };
  xml << "<graph id=\"hierarchy\" edgedefault=\"directed\">\n";
  for (size_t i = 0; i < trees.leaves.size(); ++i) {
    const Coord& at = graph.nodes[trees.leaves[i].representative].position;
    xml << "<node id=\"" << trees.name(i) << "\">";
    data("x", at.x());
    data("y", at.y());
    data("z", at.z());
    data("voxels", trees.leaves[i].voxels);
    xml << "</node>\n";
  }
  for (size_t i = 0; i < trees.joins.size(); ++i) {
    const JoinedGrains& join = trees.joins[i];
    const std::string name = trees.name(trees.leaves.size() + i);
    xml << "<node id=\"" << name << "\">";
    data("voxels", join.firstVoxels + join.secondVoxels);
    data("score", join.score);
    data("strictness", join.strictness);
    data("grains", join.grains);
    xml << "</node>\n";
    for (const size_t part : trees.parts[i])
      xml << "<edge source=\"" << name << "\" target=\"" << trees.name(part) << "\"/>\n";
  }
  xml << "</graph>\n</graphml>\n";
  return xml.str();
}

using Writer = std::string (*)(const ManifoldGraph&, const JoinTrees&);

/// By the ending of the file. @throw WrongUsage
Writer writerOf(const std::string& path) {
  const std::string ending = path == "-" ? ".csv" : fileEnding(path);
  if (ending == ".csv") return joinTable;
  if (ending == ".nwk") return newick;
  if (ending == ".graphml") return graphml;
  throw WrongUsage(path + ": the output's ending must be .csv, .nwk or .graphml");
}

/// The grains at the first level, and what they are part of at the others.
std::string parents(const Hierarchy& hierarchy, const std::vector<double>& levels) {
  std::vector<Merging> mergings;
  std::ostringstream csv;
  csv.precision(kDigits);
  for (const double level : levels) {
    csv << "grain_at_" << level << ',';
    mergings.push_back(cut(hierarchy, level));
  }
  csv << "voxels\n";
  const Merging& finest = mergings.front();
  const std::vector<int64_t> voxels = grainVoxels(hierarchy, finest);
  for (size_t g = 0; g < voxels.size(); ++g) {
    for (const Merging& merging : mergings)
      csv << merging.grainOfNode[finest.representative[g]] << ',';
    csv << voxels[g] << '\n';
  }
  return csv.str();
}

/// Of --levels. @throw WrongUsage
std::vector<double> parseLevels(const std::string& text) {
  std::vector<double> levels;
  std::stringstream list(text);
  for (std::string level; std::getline(list, level, ',');) {
    levels.push_back(parseStrictness(level, "--levels"));
    if (levels.size() > 1 && !(levels.back() < levels[levels.size() - 2]))
      throw WrongUsage("--levels " + text + ": each has to be smaller than the one before");
  }
  return levels;
}

void runHierarchy(const HierarchyArguments& o, const Common& common) {
  TextFile file(o.out);
  common.progress->start("read");
  const ManifoldGraph graph =
      withFileName(o.input.path, [&] { return keptGraph(o.input, common.progress); });
  common.progress->start("join");
  const Hierarchy hierarchy = mergeHierarchy(graph);
  const JoinTrees trees(hierarchy);
  file.write(o.levels.empty() ? writerOf(o.out)(graph, trees) : parents(hierarchy, o.levels));
  common.progress->end();
  if (!common.quiet)
    std::printf("%s: %s of %s\n", o.out.c_str(),
                counted(int64_t(trees.joins.size()), "join").c_str(),
                counted(int64_t(graph.nodes.size()), "manifold").c_str());
}

}  // namespace

void addHierarchy(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<HierarchyArguments>();
  Verb verb = addVerb(command, common, "hierarchy",
                      "the sequence of joins that --merge score cuts: what, at which score",
                      "vdb_madf hierarchy grains.vdb joins.csv");
  verb.option("SEG.vdb", o->input.path, "made by segment with --keep manifold").required();
  verb.option(
          "OUT", o->out,
          ".csv: a line per join, the best first; .nwk: trees (Newick); .graphml: these as a graph")
      .required();
  verb.option("--levels", o->levelsText,
              "instead, of each grain at the first strictness what it is part of at the others")
      .typeName("K,K...");
  verb.onParsed([o, &common, &action] {
    o->input.outputs = {o->out};
    o->input.parse();
    o->levels = parseLevels(o->levelsText);
    if (writerOf(o->out) != joinTable && !o->levels.empty())
      throw WrongUsage(o->out + ": --levels makes a table: choose a name like OUT.csv");
    action = [o, &common] { runHierarchy(*o, besideOutput(common, o->out)); };
  });
}

}  // namespace vdb_madf::tools
