// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/invariants.h"

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <tuple>
#include <utility>

namespace vdb_madf::test {

namespace {

const std::array<Coord, 3> kForward = {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)};

template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  (stream << ... << parts);
  return stream.str();
}

/// Calls visit(coord, value) on active voxels, in tiles too, until it returns a violation.
template <typename Grid, typename Visit>
std::string forEachActive(const Grid& grid, const Visit& visit) {
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    CoordBBox box = value.getBoundingBox();
    for (auto p = box.begin(); p; ++p) {
      std::string violation = visit(*p, *value);
      if (!violation.empty()) return violation;
    }
  }
  return {};
}

bool ascending(const Coord& a, const Coord& b) {
  return std::make_tuple(a.x(), a.y(), a.z()) < std::make_tuple(b.x(), b.y(), b.z());
}

}  // namespace

std::string labelsCoverObject(const MaskGrid& object, const Int32Grid& labels, int64_t count) {
  if (labels.background() != 0) return text("the background is ", labels.background());
  const auto label = labels.getConstAccessor();
  std::string violation = forEachActive(object, [&](const Coord& p, bool) {
    return label.isValueOn(p) ? std::string() : text(p, " has no label");
  });
  if (!violation.empty()) return violation;
  for (auto value = labels.cbeginValueOff(); value; ++value)
    if (*value != 0) return text("an inactive ", *value, " at ", value.getCoord());

  const auto inObject = object.getConstAccessor();
  std::vector<bool> used(size_t(count) + 1);
  violation = forEachActive(labels, [&](const Coord& p, int32_t value) {
    if (!inObject.isValueOn(p)) return text("a label outside the object at ", p);
    if (value < 1 || value > count) return text("label ", value, " of ", count, " at ", p);
    used[size_t(value)] = true;
    return std::string();
  });
  if (!violation.empty()) return violation;
  for (int64_t i = 1; i <= count; ++i)
    if (!used[size_t(i)]) return text("label ", i, " of ", count, " is not in use");
  return {};
}

std::string distanceIsLipschitz(const MaskGrid& object, const Int32Grid& distanceSquared,
                                const VoxelWeights& weights) {
  const auto distance = distanceSquared.getConstAccessor();
  return forEachActive(object, [&](const Coord& p, bool) {
    const int64_t d = distance.getValue(p);
    if (d < 1) return text("D = ", d, " at ", p);
    for (const Coord& step : kForward) {
      const int64_t w = step.x() ? weights.x : step.y() ? weights.y : weights.z;
      int32_t value = 0;
      if (!distance.probeValue(p + step, value)) continue;
      // sqrt(e) <= sqrt(d) + sqrt(w), and the other way round, in integers
      const int64_t least = std::min<int64_t>(d, value),
                    excess = std::max<int64_t>(d, value) - least;
      if (excess > w && (excess - w) * (excess - w) > 4 * w * least)
        return text("D = ", d, " at ", p, ", but ", value, " at ", p + step);
    }
    return std::string();
  });
}

std::string powerIsAtMostMinusDistance(const Int32Grid& distanceSquared, const Int32Grid& power) {
  const auto powerAt = power.getConstAccessor();
  return forEachActive(distanceSquared, [&](const Coord& p, int32_t d) {
    const int32_t value = powerAt.getValue(p);
    return value <= -d ? std::string() : text("power ", value, " at ", p, ", where D = ", d);
  });
}

std::string heightsClimb(const Int32Grid& power, const Int32Grid& manifold,
                         const ManifoldGraph& graph) {
  const auto powerAt = power.getConstAccessor();
  return forEachActive(manifold, [&](const Coord& p, int32_t number) {
    if (number < 1 || size_t(number) > graph.nodes.size()) return text("manifold ", number);
    const auto& node = graph.nodes[size_t(number) - 1];
    const int32_t height = -powerAt.getValue(p);
    if (height < node.squaredRadius || (height == node.squaredRadius && p == node.position))
      return std::string();
    return text("height ", height, " at ", p, ", which flows to ", node.position,
                " of D = ", node.squaredRadius);
  });
}

std::string nodesMatchManifolds(const ManifoldGraph& graph, const Int32Grid& manifold,
                                const Int32Grid& power) {
  const auto& nodes = graph.nodes;
  std::vector<int64_t> voxels(nodes.size());
  std::string violation = forEachActive(manifold, [&](const Coord& p, int32_t number) {
    if (number < 1 || size_t(number) > nodes.size()) return text("manifold ", number, " at ", p);
    ++voxels[size_t(number) - 1];
    return std::string();
  });
  if (!violation.empty()) return violation;
  const auto manifoldAt = manifold.getConstAccessor();
  const auto powerAt = power.getConstAccessor();
  for (size_t i = 0; i < nodes.size(); ++i) {
    const auto& node = nodes[i];
    if (i > 0 && !ascending(nodes[i - 1].position, node.position))
      return text("node ", i, " at ", node.position, " is out of order");
    if (manifoldAt.getValue(node.position) != int32_t(i) + 1)
      return text("node ", i, " lies in manifold ", manifoldAt.getValue(node.position));
    if (powerAt.getValue(node.position) != -node.squaredRadius)
      return text("node ", i, " of D = ", node.squaredRadius, " has power ",
                  powerAt.getValue(node.position));
    if (node.voxels != voxels[i])
      return text("node ", i, " has ", node.voxels, " voxels, counted ", voxels[i]);
  }
  return {};
}

std::string edgesMatchManifolds(const ManifoldGraph& graph, const Int32Grid& manifold,
                                const Int32Grid& power) {
  using Pair = std::pair<uint32_t, uint32_t>;
  struct Contact {
    int64_t faces = 0;
    int32_t height = 0;
  };
  std::map<Pair, Contact> recount;
  const auto manifoldAt = manifold.getConstAccessor();
  const auto powerAt = power.getConstAccessor();
  forEachActive(manifold, [&](const Coord& p, int32_t a) {
    for (const Coord& step : kForward) {
      const Coord q = p + step;
      int32_t b = 0;
      if (!manifoldAt.probeValue(q, b) || a == b) continue;
      const int32_t height = std::min(-powerAt.getValue(p), -powerAt.getValue(q));
      Contact& contact = recount[std::minmax(uint32_t(a) - 1, uint32_t(b) - 1)];
      contact.height = contact.faces ? std::max(contact.height, height) : height;
      ++contact.faces;
    }
    return std::string();
  });

  Pair last;
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const auto& edge = graph.edges[i];
    const Pair pair(edge.first, edge.second);
    if (edge.first >= edge.second) return text("edge ", i, ": first >= second");
    if (edge.second >= graph.nodes.size()) return text("edge ", i, ": no node ", edge.second);
    if (i > 0 && pair <= last) return text("edge ", i, " is out of order");
    last = pair;
    const auto contact = recount.find(pair);
    if (contact == recount.end()) return text("edge ", i, ": the manifolds do not touch");
    if (edge.contactFaces != contact->second.faces)
      return text("edge ", i, " has ", edge.contactFaces, " faces, counted ",
                  contact->second.faces);
    if (edge.saddleHeight != contact->second.height)
      return text("edge ", i, " has h = ", edge.saddleHeight, ", found ", contact->second.height);
    if (edge.saddleHeight >
        std::min(graph.nodes[edge.first].squaredRadius, graph.nodes[edge.second].squaredRadius))
      return text("edge ", i, " has h = ", edge.saddleHeight, ", more than its balls");
  }
  if (graph.edges.size() != recount.size())
    return text(graph.edges.size(), " edges, counted ", recount.size());
  return {};
}

std::string grainsAreUnionsOfManifolds(const Int32Grid& manifold, const Int32Grid& grain) {
  const auto grainAt = grain.getConstAccessor();
  std::map<int32_t, int32_t> grainOf;
  return forEachActive(manifold, [&](const Coord& p, int32_t number) {
    const int32_t label = grainAt.getValue(p);
    const int32_t known = grainOf.insert({number, label}).first->second;
    return known == label
               ? std::string()
               : text("manifold ", number, " has labels ", known, " and ", label, " (", p, ")");
  });
}

std::string grainsAreInCanonicalOrder(const ManifoldGraph& graph, const Int32Grid& grain) {
  const auto grainAt = grain.getConstAccessor();
  std::map<int32_t, ManifoldGraph::Node> representative;
  for (const auto& node : graph.nodes) {
    const auto [known, isNew] = representative.insert({grainAt.getValue(node.position), node});
    auto& best = known->second;
    if (node.squaredRadius > best.squaredRadius ||
        (node.squaredRadius == best.squaredRadius && ascending(node.position, best.position)))
      best = node;
  }
  const Coord* last = nullptr;
  for (const auto& [label, node] : representative) {
    if (last && !ascending(*last, node.position))
      return text("grain ", label, " at ", node.position, " comes after ", *last);
    last = &node.position;
  }
  return {};
}

std::string grainsStayInOneComponent(const MaskGrid& object, const Int32Grid& grain) {
  const auto grainAt = grain.getConstAccessor();
  const MaskGrid::Ptr left = object.deepCopy();
  auto leftAt = left->getAccessor();
  std::map<int32_t, Coord> seed;  // of the component that a grain was seen in
  std::vector<Coord> front;
  return forEachActive(object, [&](const Coord& start, bool) {
    if (!leftAt.isValueOn(start)) return std::string();
    leftAt.setValueOff(start);
    front.push_back(start);
    while (!front.empty()) {
      const Coord p = front.back();
      front.pop_back();
      const Coord& known = seed.insert({grainAt.getValue(p), start}).first->second;
      if (known != start)
        return text("grain ", grainAt.getValue(p), " is in the components of ", known, " and ", p);
      for (const Coord& step : kForward)
        for (const Coord& q : {p + step, p - step})
          if (leftAt.isValueOn(q)) {
            leftAt.setValueOff(q);
            front.push_back(q);
          }
    }
    return std::string();
  });
}

std::string ballsFillObject(const std::vector<MedialBall>& balls,
                            const Int32Grid& distanceSquared) {
  const auto distance = distanceSquared.getConstAccessor();
  int64_t voxels = 0;
  for (size_t i = 0; i < balls.size(); ++i) {
    const MedialBall& ball = balls[i];
    if (i > 0 && !ascending(balls[i - 1].center, ball.center))
      return text("ball ", i, " at ", ball.center, " is out of order");
    if (ball.squaredRadius != distance.getValue(ball.center))
      return text("ball ", i, " at ", ball.center, " has D = ", ball.squaredRadius, ", not ",
                  distance.getValue(ball.center));
    if (ball.cellSize < 1) return text("ball ", i, " has an empty cell");
    voxels += ball.cellSize;
  }
  const auto active = int64_t(distanceSquared.activeVoxelCount());
  return voxels == active ? std::string() : text("the cells hold ", voxels, " voxels of ", active);
}

std::string grainsAreConnected(const Int32Grid& grain) {
  const auto grainAt = grain.getConstAccessor();
  const Int32Grid::Ptr left = grain.deepCopy();
  auto leftAt = left->getAccessor();
  std::map<int32_t, Coord> seed;
  std::vector<Coord> front;
  return forEachActive(grain, [&](const Coord& start, int32_t label) {
    if (!leftAt.isValueOn(start)) return std::string();
    const auto [known, isNew] = seed.insert({label, start});
    if (!isNew) return text("grain ", label, " has pieces at ", known->second, " and ", start);
    leftAt.setValueOff(start);
    front.push_back(start);
    while (!front.empty()) {
      const Coord p = front.back();
      front.pop_back();
      for (const Coord& step : kForward)
        for (const Coord& q : {p + step, p - step})
          if (leftAt.isValueOn(q) && grainAt.getValue(q) == label) {
            leftAt.setValueOff(q);
            front.push_back(q);
          }
    }
    return std::string();
  });
}

std::string countsAgree(const Segmentation& segmentation, const MaskGrid& object, int64_t gamma) {
  const SegmentCounts& counts = segmentation.counts;
  if (counts.objectVoxels != int64_t(object.activeVoxelCount()))
    return text(counts.objectVoxels, " object voxels of ", object.activeVoxelCount());
  if (counts.criticalPoints != int64_t(segmentation.graph.nodes.size()))
    return text(counts.criticalPoints, " critical points, ", segmentation.graph.nodes.size(),
                " nodes");
  if (counts.objectVoxels + counts.cavityVoxels < counts.medialBalls ||
      counts.medialBalls < counts.keptBalls || counts.keptBalls < counts.criticalPoints ||
      counts.criticalPoints < counts.grains || (counts.objectVoxels > 0) != (counts.grains > 0))
    return text("voxels, balls, kept balls, critical points, grains: ", counts.objectVoxels, " ",
                counts.medialBalls, " ", counts.keptBalls, " ", counts.criticalPoints, " ",
                counts.grains);
  if (gamma <= 1 && counts.keptBalls != counts.medialBalls)
    return text("no filter, but ", counts.keptBalls, " of ", counts.medialBalls, " balls kept");
  int32_t largest = 0;
  for (const auto& node : segmentation.graph.nodes) largest = std::max(largest, node.squaredRadius);
  // The voxel of largest D is critical: no ball is larger, and its own has the least power there.
  if (gamma <= 1 && largest != counts.largestSquaredDistance)
    return text("largest D ", counts.largestSquaredDistance, ", of critical points ", largest);
  return {};
}

std::string anyViolation(const Segmentation& s, const MaskGrid& object, int64_t gamma) {
  std::ostringstream all;
  const auto add = [&](const char* what, const std::string& violation) {
    if (!violation.empty()) all << what << ": " << violation << '\n';
  };
  add("labels", labelsCoverObject(object, *s.grain, s.counts.grains));
  const bool filled = s.counts.cavities > 0, tidied = s.tidy > 0;
  if (!filled && !tidied) add("order of grains", grainsAreInCanonicalOrder(s.graph, *s.grain));
  // Balls reach across what is unknown.
  const bool gaps = s.open && !s.domain->isBox();
  if (!filled && !gaps) add("components", grainsStayInOneComponent(object, *s.grain));
  if (!filled && !gaps && tidied) add("pieces", grainsAreConnected(*s.grain));
  add("counts", countsAgree(s, object, gamma));
  if (s.distanceSquared)
    add("distance", distanceIsLipschitz(object, *s.distanceSquared, s.weights));
  if (s.distanceSquared && s.power && gamma <= 1)
    add("power", powerIsAtMostMinusDistance(*s.distanceSquared, *s.power));
  if (s.distanceSquared && !s.balls.empty() && !filled)
    add("balls", ballsFillObject(s.balls, *s.distanceSquared));
  if (s.manifold) {
    if (!filled) add("manifolds", labelsCoverObject(object, *s.manifold, s.counts.criticalPoints));
    if (!tidied) add("unions", grainsAreUnionsOfManifolds(*s.manifold, *s.grain));
  }
  if (s.manifold && s.power) {
    add("heights", heightsClimb(*s.power, *s.manifold, s.graph));
    if (filled) return all.str();
    add("nodes", nodesMatchManifolds(s.graph, *s.manifold, *s.power));
    add("edges", edgesMatchManifolds(s.graph, *s.manifold, *s.power));
  }
  return all.str();
}

}  // namespace vdb_madf::test
