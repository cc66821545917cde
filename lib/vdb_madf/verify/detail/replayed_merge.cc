// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/verify/detail/replayed_merge.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace vdb_madf::detail {

namespace {

using Wide = __int128;
using Edge = Manifolds::Edge;

/// The largest x in [0, limit] that `holds`, which 0 does and no number above one that does not.
template <typename Holds>
int64_t largest(int64_t limit, const Holds& holds) {
  int64_t low = 0, high = limit;
  while (low < high) {
    const int64_t middle = low + (high - low + 1) / 2;
    if (holds(Wide(middle)))
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

int64_t squareRoot(Wide n) {
  return largest(int64_t(1) << 48, [&](Wide x) { return x * x <= n; });
}

/// 256 log2(n), rounded down: each squaring of n / 2^k, which is in [1, 2), gives one bit more.
int64_t lg(int64_t n) {
  int64_t bits = 0;
  while (n >> (bits + 1)) ++bits;
  auto fraction = (unsigned __int128)n << (62 - bits);
  for (int i = 0; i < 8; ++i) {
    fraction = fraction * fraction >> 62;
    bits = 2 * bits + int64_t(fraction >> 63);
    if (fraction >> 63) fraction >>= 1;
  }
  return bits;
}

/// What a score sees of a class.
struct Sizes {
  int64_t voxels, top, sureTop;
};

/// The score of two classes, a of the smaller top, in units of 1/512.
class Score {
 public:
  Score(const Definition& definition) : w_(definition.weights) {
    least_ = std::min({w_[0], w_[1], w_[2]});
    if (definition.domain)
      for (size_t axis = 3; axis-- > 0;)
        if (definition.domain->box().dim()[int(axis)] == 1) flat_ = int(axis);
    if (flat_ >= 0) w_[size_t(flat_)] = w_[flat_ == 0 ? 1 : 0];
    if (flat_ >= 0) least_ = std::min({w_[0], w_[1], w_[2]});
    factor_ = std::gcd(w_[0], std::gcd(w_[1], w_[2]));
  }

  int64_t operator()(Sizes a, Sizes b, int64_t faces, int64_t height) const {
    const int64_t va = std::max<int64_t>(1, a.voxels), vb = std::max<int64_t>(1, b.voxels);
    if (a.sureTop < a.top)
      a.top = std::max({a.sureTop, std::min(a.top, b.sureTop), height, 9 * a.top / 10});
    if (b.sureTop < b.top && vb <= va) b.top = std::max(b.sureTop, a.top);
    const int64_t rho = squareRoot(65536 * a.top / b.top),
                  d = squareRoot(65536 * a.top / least_) - squareRoot(65536 * height / least_),
                  m = std::max<int64_t>(1, a.top / factor_);
    if (flat_ >= 0) {
      const int64_t w1 = w_[flat_ == 0 ? 1 : 0], w2 = w_[flat_ == 2 ? 1 : 2],
                    disc = 338 + lg(m) - (lg(w1 / factor_) + lg(w2 / factor_)) / 2,
                    u = std::max(lg(va) - 512, std::min(lg(va), std::max<int64_t>(0, disc))),
                    ball = squareRoot(Wide(100) * b.top * b.top / (Wide(w1) * w2)),
                    w = std::max(vb, std::min(4 * vb, std::max<int64_t>(1, ball))),
                    f = largest(8191, [&](Wide x) {
                      return x * x * w <= Wide(512 * faces) * (512 * faces);
                    });
      return 3 * (lg(vb) - u) + 16 * rho + 6 * f - 5 * d + 2 * std::max<int64_t>(0, 1536 - lg(va));
    }
    const int64_t ball = 1067 + 3 * lg(m) - lg(w_[0] / factor_) - lg(w_[1] / factor_) -
                         lg(w_[2] / factor_),
                  u = std::max(2 * lg(va) - 1024, std::min(2 * lg(va), std::max<int64_t>(0, ball)));
    const Wide square = Wide(vb) * vb, cube = Wide(256 * faces) * (256 * faces) * (256 * faces),
               largestBall = Wide(18) * b.top * b.top * b.top / (Wide(w_[0]) * w_[1] * w_[2]),
               w = std::max(square / 16, std::min(square, std::max<Wide>(1, largestBall)));
    const int64_t f = largest(8191, [&](Wide x) { return x * x * x * w <= cube; });
    return 2 * lg(vb) - u + 18 * rho + 5 * f - 8 * d + 3 * std::max<int64_t>(0, 1792 - lg(va));
  }

 private:
  std::array<int64_t, 3> w_;
  int64_t least_ = 1, factor_ = 1;
  int flat_ = -1;
};

/// Classes of nodes, each named by its representative: of largest D, then the first.
class Classes {
 public:
  explicit Classes(const std::vector<Manifolds::Node>& nodes) : nodes_(nodes), name_(nodes.size()) {
    std::iota(name_.begin(), name_.end(), 0);
  }
  int32_t of(int32_t node) {
    while (name_[size_t(node)] != node)
      node = name_[size_t(node)] = name_[size_t(name_[size_t(node)])];
    return node;
  }
  int64_t top(int32_t node) { return nodes_[size_t(of(node))].top; }
  /// Returns the name of both together.
  int32_t join(int32_t x, int32_t y) {
    const int32_t a = std::min(of(x), of(y)), b = std::max(of(x), of(y));
    const int32_t name = nodes_[size_t(b)].top > nodes_[size_t(a)].top ? b : a;
    return name_[size_t(a)] = name_[size_t(b)] = name;
  }

 private:
  const std::vector<Manifolds::Node>& nodes_;
  std::vector<int32_t> name_;
};

void mergeByAngle(const DenseBox& space, const Definition& definition, const Manifolds& manifolds,
                  Classes& classes) {
  for (const Edge& edge : manifolds.edges) {
    if (definition.cell && !edge.cellsTouch) continue;
    const auto &a = manifolds.nodes[size_t(edge.first)], &b = manifolds.nodes[size_t(edge.second)];
    const int64_t numerator = space.squaredLength(a.at, b.at, definition.weights) - a.top - b.top;
    if (double(numerator) / (2 * std::sqrt(double(a.top * b.top))) < definition.theta)
      classes.join(edge.first, edge.second);
  }
}

void mergeByNeck(const Definition& definition, double theta, int64_t delta,
                 const Manifolds& manifolds, Classes& classes) {
  std::vector<Edge> edges = manifolds.edges;
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(b.height, a.first, a.second) < std::tie(a.height, b.first, b.second);
  });
  const int64_t unit = *std::min_element(definition.weights.begin(), definition.weights.end());
  for (const Edge& edge : edges) {
    const int64_t h = edge.height;
    if (h <= 0 || classes.of(edge.first) == classes.of(edge.second)) continue;
    const int64_t m = std::min(classes.top(edge.first), classes.top(edge.second));
    const Wide k = delta, l = Wide(64) * (m - h) - k * k * unit;
    if (double(h) >= ((1 - theta) / 2) * double(m) ||
        (delta > 0 && (l < 0 || l * l < 256 * k * k * unit * h)))
      classes.join(edge.first, edge.second);
  }
}

void mergeByScore(const Definition& definition, const Manifolds& manifolds, Classes& classes) {
  mergeByNeck(definition, -1, 0, manifolds, classes);
  struct Touch {
    int64_t faces = 0, height = INT64_MIN, score = INT64_MIN;
  };
  const int64_t least = std::llround(512 * definition.strictness);
  const Score score(definition);
  std::vector<Sizes> sizes(manifolds.nodes.size(), Sizes{0, 0, 0});
  std::vector<std::map<int32_t, Touch>> neighbors(manifolds.nodes.size());
  for (size_t i = 0; i < sizes.size(); ++i) {
    const Manifolds::Node& node = manifolds.nodes[i];
    Sizes& all = sizes[size_t(classes.of(int32_t(i)))];
    all.voxels += node.voxels;
    if (node.isSure) all.sureTop = std::max(all.sureTop, node.top);
    sizes[i].top = node.top;
  }
  std::set<std::tuple<int64_t, int32_t, int32_t>> queue;  // -score, the pair
  const auto addTouch = [](Touch& to, int64_t faces, int64_t height) {
    to.faces += faces;
    to.height = std::max(to.height, height);
  };
  const auto key = [](int32_t x, int32_t y, const Touch& touch) {
    return std::make_tuple(-touch.score, std::min(x, y), std::max(x, y));
  };
  const auto drop = [&](int32_t x, int32_t y, const Touch& touch) {
    if (touch.score >= least) queue.erase(key(x, y, touch));
  };
  const auto put = [&](int32_t x, int32_t y) {
    Touch& touch = neighbors[size_t(x)][y];
    if (touch.height <= 0) return;
    const Sizes &a = sizes[size_t(x)], &b = sizes[size_t(y)];
    const auto order = [](const Sizes& s, int32_t name) {
      return std::make_tuple(s.top, s.voxels, -name);
    };
    const bool inOrder = order(a, x) < order(b, y);
    touch.score = score(inOrder ? a : b, inOrder ? b : a, touch.faces, touch.height);
    neighbors[size_t(y)][x].score = touch.score;
    if (touch.score >= least) queue.insert(key(x, y, touch));
  };
  for (const Edge& edge : manifolds.edges) {
    const int32_t a = classes.of(edge.first), b = classes.of(edge.second);
    if (a == b) continue;
    addTouch(neighbors[size_t(a)][b], edge.faces, edge.height);
    addTouch(neighbors[size_t(b)][a], edge.faces, edge.height);
  }
  for (size_t a = 0; a < neighbors.size(); ++a)
    for (const auto& entry : neighbors[a])
      if (entry.first > int32_t(a)) put(int32_t(a), entry.first);
  while (!queue.empty()) {
    const auto [ignored, x, y] = *queue.begin();
    const int32_t name = classes.join(x, y), gone = name == x ? y : x;
    for (const int32_t side : {x, y})
      for (const auto& [other, touch] : neighbors[size_t(side)]) drop(side, other, touch);
    sizes[size_t(name)].voxels += sizes[size_t(gone)].voxels;
    sizes[size_t(name)].sureTop =
        std::max(sizes[size_t(name)].sureTop, sizes[size_t(gone)].sureTop);
    for (const auto& [other, touch] : neighbors[size_t(gone)]) {
      neighbors[size_t(other)].erase(gone);
      if (other == name) continue;
      addTouch(neighbors[size_t(name)][other], touch.faces, touch.height);
      addTouch(neighbors[size_t(other)][name], touch.faces, touch.height);
    }
    neighbors[size_t(gone)].clear();
    for (const auto& entry : neighbors[size_t(name)]) put(name, entry.first);
  }
}

/// Numbers classes, of nodes that have the same class, in the order of their representatives.
Grains numbered(const Manifolds& manifolds, const std::vector<int32_t>& classOf) {
  const auto& nodes = manifolds.nodes;
  struct Found {
    int32_t representative = 0;
    int64_t objectVoxels = 0;
  };
  std::map<int32_t, Found> found;
  for (size_t i = 0; i < nodes.size(); ++i) {
    Found& one = found.insert({classOf[i], {int32_t(i), 0}}).first->second;
    one.objectVoxels += nodes[i].objectVoxels;
    if (nodes[i].top > nodes[size_t(one.representative)].top) one.representative = int32_t(i);
  }
  Grains grains;
  for (const auto& entry : found)
    if (entry.second.objectVoxels > 0) grains.representative.push_back(entry.second.representative);
  std::sort(grains.representative.begin(), grains.representative.end());
  std::map<int32_t, int32_t> number;
  for (const int32_t node : grains.representative)
    number.insert({classOf[size_t(node)], int32_t(number.size()) + 1});
  for (const int32_t c : classOf) grains.ofNode.push_back(number.count(c) ? number[c] : 0);
  return grains;
}

/// Grains that are too small join what they share most faces with, the smallest first.
void joinSmall(const Manifolds& manifolds, int64_t least, Grains& grains) {
  const size_t count = grains.representative.size() + 1;
  std::vector<int64_t> voxels(count, 0);
  std::vector<std::map<int32_t, int64_t>> faces(count);
  std::vector<int32_t> now(count);
  std::iota(now.begin(), now.end(), 0);
  for (size_t i = 0; i < manifolds.nodes.size(); ++i)
    voxels[size_t(grains.ofNode[i])] += manifolds.nodes[i].objectVoxels;
  for (const Edge& edge : manifolds.edges) {
    const int32_t a = grains.ofNode[size_t(edge.first)], b = grains.ofNode[size_t(edge.second)];
    if (a == b || a == 0 || b == 0) continue;
    faces[size_t(a)][b] += edge.faces;
    faces[size_t(b)][a] += edge.faces;
  }
  std::set<std::pair<int64_t, int32_t>> small;
  for (size_t g = 1; g < count; ++g)
    if (voxels[g] < least) small.emplace(voxels[g], int32_t(g));
  while (!small.empty()) {
    const int32_t grain = small.begin()->second;
    small.erase(small.begin());
    if (faces[size_t(grain)].empty()) continue;
    int32_t to = faces[size_t(grain)].begin()->first;
    for (const auto& [other, shared] : faces[size_t(grain)])  // ascending
      if (shared > faces[size_t(grain)][to]) to = other;
    for (const auto& [other, shared] : faces[size_t(grain)]) {
      faces[size_t(other)].erase(grain);
      if (other == to) continue;
      faces[size_t(other)][to] += shared;
      faces[size_t(to)][other] += shared;
    }
    small.erase({voxels[size_t(to)], to});
    voxels[size_t(to)] += voxels[size_t(grain)];
    if (voxels[size_t(to)] < least) small.emplace(voxels[size_t(to)], to);
    now[size_t(grain)] = to;
  }
  for (int32_t& g : grains.ofNode)
    while (now[size_t(g)] != g) g = now[size_t(g)];
}

}  // namespace

/// Does the domain hold each voxel that is nearer to a point than its squared radius? (If it is
/// flat, each of its plane.)
bool isWithin(const Domain& domain, const Coord& center, int64_t squaredRadius,
              const std::array<int64_t, 3>& weights) {
  Coord reach;
  bool isPlane = false;
  for (size_t axis = 0; axis < 3; ++axis)
    if (isPlane || domain.box().dim()[int(axis)] > 1)
      reach[int(axis)] = int(std::ceil(std::sqrt(double(squaredRadius) / double(weights[axis]))));
    else
      isPlane = true;
  for (auto p = CoordBBox(center - reach, center + reach).begin(); p; ++p) {
    int64_t squared = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      const int64_t steps = (*p)[int(axis)] - center[int(axis)];
      squared += weights[axis] * steps * steps;
    }
    if (squared < squaredRadius && !domain.isInside(*p)) return false;
  }
  return true;
}

Manifolds manifoldsOf(const DenseBox& space, const Definition& definition, const Voxels& voxels,
                      const std::vector<int32_t>& distance, Flow& flow) {
  Manifolds manifolds;
  std::vector<int32_t> nodeOf(voxels.size(), kNone);
  for (size_t i = 0; i < voxels.size(); ++i)
    if (isBody(voxels[i]) && flow.site[i] == int32_t(i)) {
      nodeOf[i] = int32_t(manifolds.nodes.size());
      manifolds.nodes.push_back({int32_t(i), distance[i], 0, 0});
      if (definition.open && definition.domain)
        manifolds.nodes.back().isSure =
            isWithin(*definition.domain, space.coord(int64_t(i)), distance[i], definition.weights);
    }
  for (size_t i = 0; i < voxels.size(); ++i) {
    if (!isBody(voxels[i])) continue;
    Manifolds::Node& node = manifolds.nodes[size_t(nodeOf[size_t(flow.critical[i])])];
    ++node.voxels;
    node.objectVoxels += voxels[i] == Voxel::object;
  }
  std::unordered_map<uint64_t, size_t> known;
  const auto height = [&](int64_t p) {
    const int32_t s = flow.site[size_t(p)];
    return distance[size_t(s)] - space.squaredLength(p, s, definition.weights);
  };
  for (int64_t p = 0; p < space.count(); ++p) {
    if (!isBody(voxels[size_t(p)])) continue;
    space.forNeighbors(p, [&](int64_t q) {
      if (q < p || !isBody(voxels[size_t(q)])) return;
      const int32_t cp = flow.critical[size_t(p)], cq = flow.critical[size_t(q)];
      if (cp == cq) return;
      const auto [a, b] = std::minmax({nodeOf[size_t(cp)], nodeOf[size_t(cq)]});
      const auto entry = known.insert({(uint64_t(a) << 32) | uint64_t(b), manifolds.edges.size()});
      if (entry.second) manifolds.edges.push_back({a, b});
      Edge& edge = manifolds.edges[entry.first->second];
      ++edge.faces;
      edge.height = std::max(edge.height, std::min(height(p), height(q)));
      edge.cellsTouch |= flow.site[size_t(p)] == cp && flow.site[size_t(q)] == cq;
    });
  }
  for (int32_t& c : flow.critical)
    if (c != kNone) c = nodeOf[size_t(c)];
  return manifolds;
}

Grains grainsOf(const DenseBox& space, const Definition& definition, const Manifolds& manifolds) {
  Classes classes(manifolds.nodes);
  if (definition.merge == "score") mergeByScore(definition, manifolds, classes);
  if (definition.merge == "both" || definition.merge == "angle")
    mergeByAngle(space, definition, manifolds, classes);
  if (definition.merge == "both" || definition.merge == "neck")
    mergeByNeck(definition, definition.theta, definition.delta, manifolds, classes);
  std::vector<int32_t> classOf;
  for (size_t i = 0; i < manifolds.nodes.size(); ++i) classOf.push_back(classes.of(int32_t(i)));
  Grains grains = numbered(manifolds, classOf);
  if (definition.minGrain == 0) return grains;
  joinSmall(manifolds, definition.minGrain, grains);
  return numbered(manifolds, grains.ofNode);
}

}  // namespace vdb_madf::detail
