// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/oracle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "vdb_madf/method/boundary.h"

namespace vdb_madf::test {

namespace {

/// A ball as one voxel p sees it: pi_x(p), D(x), x.
struct Candidate {
  int64_t power = 0;
  int64_t squaredRadius = 0;
  Coord center;
};

/// Step 2: least power; equal: the larger D; equal too: the lexicographically smaller
/// coordinate.
bool better(const Candidate& a, const Candidate& b) {
  if (a.power != b.power) return a.power < b.power;
  if (a.squaredRadius != b.squaredRadius) return a.squaredRadius > b.squaredRadius;
  return std::make_tuple(a.center.x(), a.center.y(), a.center.z()) <
         std::make_tuple(b.center.x(), b.center.y(), b.center.z());
}

inline Candidate candidate(const Coord& p, const Coord& center, int64_t squaredRadius,
                           const VoxelWeights& weights) {
  return {squaredLength(p - center, weights) - squaredRadius, squaredRadius, center};
}

}  // namespace

// ------------------------------------------------------------------------------- The boundary

bool oracleBoundary(const ObjectVolume& object, Boundary boundary,
                    const std::optional<OracleDomain>& domain) {
  if (domain)
    for (int i = 0; i < object.size(); ++i)
      if (object[i] && !domain->isInside(object.coord(i)))
        throw Undefined("the object leaves the domain");
  if (boundary == Boundary::open && !domain) throw Undefined("an open boundary needs a domain");
  if (boundary == Boundary::automatic) return domain.has_value();
  return boundary == Boundary::open;
}

// -------------------------------------------------------------------------------- Cavities

int64_t oracleFillHoles(const SegmentOptions& options, const std::optional<OracleDomain>& domain) {
  if (options.fillHoles) return *options.fillHoles;
  if (domain)
    for (int axis = 0; axis < 3; ++axis)
      if (domain->box().dim()[axis] == 1) return 0;
  return 27;
}

OracleBody oracleBody(const ObjectVolume& object, const std::optional<OracleDomain>& domain,
                      bool open, int64_t fillHoles) {
  OracleBody body{object, 0};
  if (countObject(object) == 0) return body;
  // Without a domain: one layer more, which belongs to the unbounded outside.
  CoordBBox space = object.box();
  if (domain)
    space = domain->box();
  else
    space.expand(1);
  const auto isInside = [&](const Coord& p) {
    return domain ? domain->isInside(p) : space.isInside(p);
  };
  ObjectVolume background(space);
  for (int i = 0; i < background.size(); ++i) {
    const Coord p = background.coord(i);
    background[i] = isInside(p) && !object.get(p, 0);
  }
  std::vector<Coord> filled;
  const DenseVolume<int> component = sixComponents(background);
  std::map<int, std::vector<Coord>> components;
  for (int i = 0; i < background.size(); ++i)
    if (background[i]) components[component[i]].push_back(background.coord(i));
  for (const auto& [number, voxels] : components) {
    if (int64_t(voxels.size()) >= fillHoles) continue;
    bool reachesFace = false;
    for (const Coord& p : voxels)
      for (const Coord& step : kSixNeighbors) reachesFace = reachesFace || !isInside(p + step);
    if (!open && reachesFace) continue;
    ++body.cavities;
    filled.insert(filled.end(), voxels.begin(), voxels.end());
  }
  if (open && int64_t(filled.size()) == countObject(background)) return {object, 0};
  CoordBBox box = object.box();
  for (const Coord& p : filled) box.expand(p);
  body.voxels = withBox(object, box);
  for (const Coord& p : filled) body.voxels[p] = 1;
  return body;
}

// ------------------------------------------------------------------------------------- Step 1

DenseVolume<int64_t> oracleDistance(const ObjectVolume& object, bool open,
                                    const OracleDomain& domain, const VoxelWeights& weights) {
  // Only the background voxels that have a 6-neighbour that is none can be nearest to a p in X:
  // from the nearest one, q, a step along an axis in which q and p differ leads nearer to p, so
  // what lies there is not background; then it is in X, or outside the domain.
  CoordBBox around = object.box();
  if (!around.empty()) around.expand(1);
  if (!around.empty() && open) around = domain.box();
  const ObjectVolume space(around);
  const auto isBackground = [&](const Coord& q) {
    return !object.get(q, 0) && (!open || domain.isInside(q));
  };
  std::vector<Coord> background;
  for (int i = 0; i < space.size(); ++i) {
    const Coord q = space.coord(i);
    if (!isBackground(q)) continue;
    for (const Coord& step : kSixNeighbors)
      if (!isBackground(q + step)) {
        background.push_back(q);
        break;
      }
  }
  const int shortest = std::min({weights.x, weights.y, weights.z});
  DenseVolume<int64_t> distance(object.box());
  for (int i = 0; i < object.size(); ++i) {
    if (!object[i]) continue;
    if (background.empty()) throw Undefined("there is no background");
    const Coord p = object.coord(i);
    int64_t least = squaredLength(p - background.front(), weights);
    for (const Coord& q : background) {
      least = std::min(least, squaredLength(p - q, weights));
      if (least <= shortest) break;  // nothing is nearer
    }
    distance[i] = least;
  }
  return distance;
}

// ------------------------------------------------------------------------------ Steps 2 and 3

OraclePower oraclePower(const ObjectVolume& object, const DenseVolume<int64_t>& distance,
                        const ObjectVolume& sites, const VoxelWeights& weights) {
  // A negative power means |p - x|^2 < D(x), so x lies within `reach` of p along each axis.
  // (For the power map itself nothing is lost: the ball at p is a candidate, of power -D(p) < 0.)
  int64_t largest = 0;
  for (int i = 0; i < sites.size(); ++i)
    if (sites[i]) largest = std::max(largest, distance[i]);
  Coord reach(0);
  const auto grow = [&](int& along, int64_t weight) {
    while (weight * (along + 1) * (along + 1) < largest) ++along;
  };
  grow(reach.x(), weights.x);
  grow(reach.y(), weights.y);
  grow(reach.z(), weights.z);

  OraclePower result{SiteMap(object.box(), kNoSite), DenseVolume<int64_t>(object.box())};
  for (int i = 0; i < object.size(); ++i) {
    if (!object[i]) continue;
    const Coord p = object.coord(i);
    CoordBBox window(p - reach, p + reach);
    window.intersect(object.box());
    Candidate best;  // of power 0: only a negative one beats it
    for (int x = window.min().x(); x <= window.max().x(); ++x)
      for (int y = window.min().y(); y <= window.max().y(); ++y) {
        int site = object.index(Coord(x, y, window.min().z()));
        for (int z = window.min().z(); z <= window.max().z(); ++z, ++site) {
          if (!sites[site]) continue;
          const Candidate other = candidate(p, Coord(x, y, z), distance[site], weights);
          if (other.power >= 0 || other.power > best.power || !better(other, best)) continue;
          best = other;
          result.site[i] = site;
        }
      }
    result.power[i] = best.power;
  }
  return result;
}

std::vector<MedialBall> oracleBalls(const OraclePower& power,
                                    const DenseVolume<int64_t>& distance) {
  std::map<int, int64_t> cellSize;
  for (int i = 0; i < power.site.size(); ++i)
    if (power.site[i] != kNoSite) ++cellSize[power.site[i]];
  std::vector<MedialBall> balls;
  for (const auto& [site, size] : cellSize)
    balls.push_back({distance.coord(site), int32_t(distance[site]), size});
  return balls;
}

// ------------------------------------------------------------------------------------- Step 4

DenseVolume<int> sixComponents(const ObjectVolume& object) {
  DenseVolume<int> component(object.box());
  int count = 0;
  for (int i = 0; i < object.size(); ++i) {
    if (!object[i] || component[i]) continue;
    component[i] = ++count;
    std::vector<Coord> front{object.coord(i)};
    while (!front.empty()) {
      const Coord p = front.back();
      front.pop_back();
      for (const Coord& step : kSixNeighbors) {
        const Coord q = p + step;
        if (!object.get(q, 0) || component[q]) continue;
        component[q] = count;
        front.push_back(q);
      }
    }
  }
  return component;
}

ObjectVolume oracleKeptBalls(const ObjectVolume& object, const OraclePower& power,
                             const std::vector<MedialBall>& balls, int64_t gamma) {
  ObjectVolume kept(object.box());
  const DenseVolume<int> component = sixComponents(object);
  std::map<int, MedialBall> best;  // of each component: largest D, then smaller coordinate
  std::set<int> served;            // components with a kept ball
  for (const MedialBall& ball : balls) {
    const int number = component[ball.center];
    // Balls come in lexicographic order, so an equal one is not better.
    const auto known = best.find(number);
    if (known == best.end() || ball.squaredRadius > known->second.squaredRadius)
      best[number] = ball;
    if (ball.cellSize < gamma) continue;
    kept[ball.center] = 1;
    served.insert(number);
  }
  // Components without a ball, whose voxels all map to others across what is unknown: the best of
  // the balls that they map to.
  std::map<int, MedialBall> ballAt;  // by site
  for (const MedialBall& ball : balls) ballAt[object.index(ball.center)] = ball;
  std::map<int, MedialBall> bestElsewhere;
  for (int i = 0; i < object.size(); ++i) {
    const int number = component[i];
    if (!object[i] || best.count(number)) continue;
    const MedialBall& ball = ballAt.at(power.site[i]);
    const auto known = bestElsewhere.find(number);
    if (known == bestElsewhere.end() || ball.squaredRadius > known->second.squaredRadius ||
        (ball.squaredRadius == known->second.squaredRadius && ball.center < known->second.center))
      bestElsewhere[number] = ball;
  }
  best.insert(bestElsewhere.begin(), bestElsewhere.end());
  for (const auto& [number, ball] : best)
    if (!served.count(number)) kept[ball.center] = 1;
  return kept;
}

OraclePower oracleFilteredPower(const ObjectVolume& object, const DenseVolume<int64_t>& distance,
                                const ObjectVolume& kept, const VoxelWeights& weights) {
  // Covered voxels, those that get a site here.
  OraclePower result = oraclePower(object, distance, kept, weights);
  std::vector<int> uncovered;
  for (int i = 0; i < object.size(); ++i)
    if (object[i] && result.site[i] == kNoSite) uncovered.push_back(i);

  // The completion: synchronous rounds, all from the sites at the end of the round before.
  for (bool changed = true; changed;) {
    changed = false;
    const SiteMap before = result.site;
    for (const int i : uncovered) {
      const Coord p = object.coord(i);
      std::vector<int> offered;
      if (before[i] != kNoSite) offered.push_back(before[i]);
      for (const Coord& step : kSixNeighbors) {
        const Coord q = p + step;
        if (object.get(q, 0) && before[q] != kNoSite) offered.push_back(before[q]);
      }
      if (offered.empty()) continue;
      int bestSite = offered.front();
      Candidate best = candidate(p, object.coord(bestSite), distance[bestSite], weights);
      for (const int site : offered) {
        const Candidate other = candidate(p, object.coord(site), distance[site], weights);
        if (!better(other, best)) continue;
        best = other;
        bestSite = site;
      }
      changed = changed || bestSite != before[i];
      result.site[i] = bestSite;
      result.power[i] = best.power;
    }
  }
  return result;
}

// ------------------------------------------------------------------------------------- Step 5

SiteMap oracleFlow(const SiteMap& site) {
  SiteMap critical(site.box(), kNoSite);
  for (int i = 0; i < site.size(); ++i) {
    if (site[i] == kNoSite) continue;
    int c = i;
    for (int steps = 0; site[c] != c; ++steps) {
      if (steps > site.size()) throw std::logic_error("the flow has a cycle");
      c = site[c];
    }
    critical[i] = c;
  }
  return critical;
}

// ------------------------------------------------------------------------------- Steps 6 to 8

ManifoldGraph oracleGraph(const ObjectVolume& object, const DenseVolume<int64_t>& distance,
                          const OraclePower& power, const SiteMap& critical) {
  std::map<int, int64_t> voxels;  // by critical point, in lexicographic order
  for (int i = 0; i < object.size(); ++i)
    if (object[i]) ++voxels[critical[i]];
  ManifoldGraph graph;
  std::map<int, uint32_t> node;
  for (const auto& [c, count] : voxels) {
    node[c] = uint32_t(graph.nodes.size());
    graph.nodes.push_back({object.coord(c), int32_t(distance[c]), count});
  }

  std::map<std::pair<uint32_t, uint32_t>, ManifoldGraph::Edge> edges;
  for (int i = 0; i < object.size(); ++i) {
    if (!object[i]) continue;
    const Coord p = object.coord(i);
    for (const Coord& step : {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)}) {
      const Coord q = p + step;
      if (!object.get(q, 0) || critical[p] == critical[q]) continue;
      const uint32_t a = node[critical[p]], b = node[critical[q]];
      const auto pair = std::minmax(a, b);
      // H(p) = -pi'(p)
      const auto height = int32_t(std::min(-power.power[p], -power.power[q]));
      auto [entry, isNew] = edges.insert({pair, {pair.first, pair.second, 0, height, false}});
      ManifoldGraph::Edge& edge = entry->second;
      ++edge.contactFaces;
      edge.saddleHeight = std::max(edge.saddleHeight, height);
      // Adjacency of cells: p and q map to the critical points in one step
      if (power.site[p] == critical[p] && power.site[q] == critical[q]) edge.cellsTouch = true;
    }
  }
  for (const auto& entry : edges) graph.edges.push_back(entry.second);
  return graph;
}

/// Of a critical point: is a voxel that is not in the domain, but in its plane if it is flat,
/// nearer than its D?
void oracleDoubt(const OracleDomain& domain, const VoxelWeights& weights,
                 const std::optional<int>& flatAxis, CriticalPoint& node) {
  Coord reach;
  for (int axis = 0; axis < 3; ++axis)
    if (flatAxis != axis)
      reach[axis] = int(std::sqrt(double(node.squaredRadius) / weights[axis])) + 1;
  for (auto q = CoordBBox(-reach, reach).begin(); q; ++q)
    if (squaredLength(*q, weights) < node.squaredRadius && !domain.isInside(node.position + *q)) {
      node.doubt = node.squaredRadius;
      return;
    }
}

// ------------------------------------------------------------------------------------ All

OracleResult oracleSegment(const ObjectVolume& object, const std::optional<OracleDomain>& domain,
                           const SegmentOptions& options) {
  if (options.gamma < 0) throw Undefined("gamma is negative");
  if (options.fillHoles.value_or(0) < 0) throw Undefined("fill-holes is negative");
  const VoxelWeights weights = options.weights.value_or(VoxelWeights{});
  OracleResult result;
  result.open = oracleBoundary(object, options.boundary, domain);
  const OracleBody filled =
      oracleBody(object, domain, result.open, oracleFillHoles(options, domain));
  const ObjectVolume& body = filled.voxels;
  result.distance = oracleDistance(body, result.open, domain.value_or(OracleDomain()), weights);
  result.unfiltered = oraclePower(body, result.distance, body, weights);
  result.balls = oracleBalls(result.unfiltered, result.distance);

  result.filtered = result.unfiltered;
  if (options.gamma > 0) {
    const ObjectVolume kept = oracleKeptBalls(body, result.unfiltered, result.balls, options.gamma);
    for (const MedialBall& ball : result.balls)
      if (kept[ball.center]) result.kept.push_back(ball.center);
    result.filtered = oracleFilteredPower(body, result.distance, kept, weights);
  } else {
    for (const MedialBall& ball : result.balls) result.kept.push_back(ball.center);
  }

  const SiteMap critical = oracleFlow(result.filtered.site);
  result.graph = oracleGraph(body, result.distance, result.filtered, critical);
  result.graph.weights = weights;
  if (domain)
    for (int axis = 2; axis >= 0; --axis)
      if (domain->box().dim()[axis] == 1) result.graph.flatAxis = axis;
  if (domain && result.open)
    for (CriticalPoint& node : result.graph.nodes)
      oracleDoubt(*domain, weights, result.graph.flatAxis, node);
  std::map<Coord, size_t> node;
  for (size_t i = 0; i < result.graph.nodes.size(); ++i) {
    node[result.graph.nodes[i].position] = i;
    std::swap(result.graph.nodes[i].voxels, result.graph.nodes[i].cavityVoxels);
  }
  result.manifold = DenseVolume<int64_t>(body.box());
  for (int i = 0; i < body.size(); ++i) {
    if (!body[i]) continue;
    const size_t n = node.at(body.coord(critical[i]));
    result.manifold[i] = int64_t(n) + 1;
    if (!object.get(body.coord(i), 0)) continue;  // a cavity's
    ++result.graph.nodes[n].voxels;
    --result.graph.nodes[n].cavityVoxels;
  }
  result.merging = oracleMerge(result.graph, options.merge);

  result.grain = DenseVolume<int64_t>(body.box());
  std::set<Coord> blocks;
  SegmentCounts& counts = result.counts;
  for (int i = 0; i < body.size(); ++i) {
    if (!body[i]) continue;
    counts.largestSquaredDistance = std::max(counts.largestSquaredDistance, result.distance[i]);
    if (result.filtered.site[i] == i) ++counts.criticalPoints;
    if (!object.get(body.coord(i), 0)) continue;
    result.grain[i] = result.merging.grainOfNode[size_t(result.manifold[i] - 1)];
    ++counts.objectVoxels;
    blocks.insert(body.coord(i) & ~7);
  }
  std::vector<Coord> representatives;
  for (const uint32_t n : result.merging.representative)
    representatives.push_back(result.graph.nodes[n].position);
  result.grain = oracleTidy(result.grain, representatives, options.tidy, weights);
  counts.leaves = int64_t(blocks.size());
  counts.cavities = filled.cavities;
  counts.cavityVoxels = countObject(body) - counts.objectVoxels;
  counts.medialBalls = int64_t(result.balls.size());
  counts.keptBalls = int64_t(result.kept.size());
  counts.grains = int64_t(result.merging.representative.size());
  result.flaws = oracleFlaws(result.grain, counts.grains, domain);
  return result;
}

}  // namespace vdb_madf::test
