#include "core/reference/static_equilibrium.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/model/adjacency.hpp"

namespace taut::reference {

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;
using Triplet = Eigen::Triplet<double>;

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-9;

/// Positions at rest [m] if straight lines decide all of them. A vertex is fixed if it is on a
/// shortest path between two fixed vertices that is as long as their distance. A vertex that is as
/// far below a fixed one as their shortest path is long cannot hang lower. Empty if this leaves a
/// vertex undecided or a link with the wrong length (relative tolerance 1e-9).
std::optional<std::vector<Vec3>> hanging_straight(const Scene& scene) {
  const std::size_t n = scene.start.x.size();
  const Adjacency neighbours(scene.links, scene.mesh.size());
  const auto paths_from = [&](int source) {
    return shortest_ways(neighbours, {&source, 1}, [&](int, const Adjacency::End& end) {
      return scene.links[to_index(end.link)].rest;
    });
  };
  std::vector<Vec3> x = scene.start.x;
  std::vector<bool> fixed(n, false);
  std::vector<ShortestPaths<double>> from;
  for (const int pin : scene.pins) fixed[to_index(pin)] = true;
  for (const int pin : scene.pins) from.push_back(paths_from(pin));
  for (std::size_t p = 0; p < scene.pins.size(); ++p)
    for (std::size_t q = 0; q < p; ++q) {
      const int a = scene.pins[p], b = scene.pins[q];
      const double length = from[p].length[to_index(b)];
      const Vec3 along = (x[to_index(b)] - x[to_index(a)]) / length;
      if (!(along.norm() > 1 - kTolerance)) continue;
      for (int i = b; i >= 0 && i != a; i = from[p].before[to_index(i)])
        if (!fixed[to_index(i)]) {
          fixed[to_index(i)] = true;
          x[to_index(i)] = x[to_index(a)] + from[p].length[to_index(i)] * along;
        }
    }
  // A vertex is at its lowest where height - path length is largest over all fixed vertices.
  const Vec3 down = scene.gravity.normalized();
  std::vector<double> lowest(n, kUnreached);
  std::vector<Vec3> place = x;
  for (std::size_t f = 0; f < n; ++f) {
    if (!fixed[f]) continue;
    const ShortestPaths<double> paths = paths_from(static_cast<int>(f));
    for (std::size_t i = 0; i < n; ++i) {
      const double depth = down.dot(x[f]) + paths.length[i];
      if (fixed[i] || !(depth < lowest[i])) continue;
      lowest[i] = depth;
      place[i] = x[f] + paths.length[i] * down;
    }
  }
  for (const Link& l : scene.links)
    if (!(std::abs((place[to_index(l.b)] - place[to_index(l.a)]).norm() - l.rest) <
          kTolerance * l.rest))
      return {};
  for (std::size_t i = 0; i < n; ++i)
    if (!fixed[i] && lowest[i] == kUnreached) return {};
  return place;
}

/// Whether links lead from every vertex to a pin.
bool hangs_whole(const Scene& scene) {
  const Adjacency neighbours(scene.links, scene.mesh.size());
  const auto ways =
      shortest_ways(neighbours, scene.pins, [](int, const Adjacency::End&) { return 1.0; });
  return std::ranges::none_of(ways.start, [](int pin) { return pin < 0; });
}

/// The unknowns of the free vertices and the links between them. C_j = (|d|^2 - r^2) / (2r) [m].
class Problem {
 public:
  explicit Problem(const Scene& scene) : scene_(scene), column_(scene.start.x.size(), -1) {
    const std::vector<double> w = inverse_masses(scene);
    for (std::size_t i = 0; i < w.size(); ++i)
      if (w[i] > 0) column_[i] = 3 * free_++;
    for (const Link& l : scene.links)
      if (column_[to_index(l.a)] >= 0 || column_[to_index(l.b)] >= 0) links_.push_back(l);
    weight_ = Vector::Zero(3 * free_);
    for (std::size_t i = 0; i < w.size(); ++i)
      if (column_[i] >= 0) weight_.segment<3>(column_[i]) = scene.mesh.mass[i] * scene.gravity;
  }

  int unknowns() const { return 3 * free_; }
  int links() const { return static_cast<int>(links_.size()); }
  const Vector& weight() const { return weight_; }
  const Link& link(int j) const { return links_[to_index(j)]; }

  std::vector<Vec3> positions(const Vector& y) const {
    std::vector<Vec3> x = scene_.start.x;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column_[i] >= 0) x[i] = y.segment<3>(column_[i]);
    return x;
  }
  Vector unknowns(const std::vector<Vec3>& x) const {
    Vector y(unknowns());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column_[i] >= 0) y.segment<3>(column_[i]) = x[i];
    return y;
  }
  Vec3 delta(const Vector& y, int j) const { return end(y, link(j).b) - end(y, link(j).a); }
  double constraint(const Vector& y, int j) const {
    const double r = link(j).rest;
    return (delta(y, j).squaredNorm() - r * r) / (2 * r);
  }
  /// Adds scale * gradient of C_j to `out`.
  void add_gradient(const Vector& y, int j, double scale, Vector& out) const {
    const Vec3 g = scale / link(j).rest * delta(y, j);
    if (const int b = column_[to_index(link(j).b)]; b >= 0) out.segment<3>(b) += g;
    if (const int a = column_[to_index(link(j).a)]; a >= 0) out.segment<3>(a) -= g;
  }
  /// Adds the blocks of pull * Hessian(C_j) + stiff * gradient gradient^T, lower triangle.
  void add_hessian(const Vector& y, int j, double pull, double stiff,
                   std::vector<Triplet>& out) const {
    const double r = link(j).rest;
    const Vec3 n = delta(y, j) / r;
    const Eigen::Matrix3d block =
        pull / r * Eigen::Matrix3d::Identity() + stiff * n * n.transpose();
    const int a = column_[to_index(link(j).a)], b = column_[to_index(link(j).b)];
    const auto put = [&](int row, int col, double sign) {
      if (row < 0 || col < 0 || row < col) return;
      for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q)
          if (row + p >= col + q) out.emplace_back(row + p, col + q, sign * block(p, q));
    };
    put(a, a, 1);
    put(b, b, 1);
    put(a, b, -1);
    put(b, a, -1);
  }
  void add_jacobian(const Vector& y, int j, int row, std::vector<Triplet>& out) const {
    const Vec3 g = delta(y, j) / link(j).rest;
    const int a = column_[to_index(link(j).a)], b = column_[to_index(link(j).b)];
    for (int p = 0; p < 3; ++p) {
      if (b >= 0) out.emplace_back(row, b + p, g[p]);
      if (a >= 0) out.emplace_back(row, a + p, -g[p]);
    }
  }

 private:
  Vec3 end(const Vector& y, int i) const {
    return column_[to_index(i)] >= 0 ? Vec3(y.segment<3>(column_[to_index(i)]))
                                     : scene_.start.x[to_index(i)];
  }
  const Scene& scene_;
  std::vector<int> column_;  ///< first unknown of a vertex; -1: pinned
  std::vector<Link> links_;
  Vector weight_;
  int free_ = 0;
};

struct Point {
  Vector y;       ///< unknown positions [m]
  Vector lambda;  ///< [links] N, >= 0
};

Vector gradient(const Problem& p, const Vector& y, const Vector& pull) {
  Vector g = -p.weight();
  for (int j = 0; j < p.links(); ++j)
    if (pull[j] != 0) p.add_gradient(y, j, pull[j], g);
  return g;
}

/// Minimises the augmented Lagrangian for fixed multipliers by damped Newton steps.
void minimise(const Problem& p, Point& point, double mu, double tolerance) {
  const auto pulls = [&](const Vector& y) {
    Vector pull(p.links());
    for (int j = 0; j < p.links(); ++j)
      pull[j] = std::max(0.0, point.lambda[j] + mu * p.constraint(y, j));
    return pull;
  };
  const auto value = [&](const Vector& y) {
    return -p.weight().dot(y) + pulls(y).squaredNorm() / (2 * mu);
  };
  Eigen::SimplicialLDLT<Matrix> ldlt;
  for (int n = 0; n < 200; ++n) {
    const Vector pull = pulls(point.y), g = gradient(p, point.y, pull);
    if (g.lpNorm<Eigen::Infinity>() < tolerance) return;
    std::vector<Triplet> entries;
    for (int j = 0; j < p.links(); ++j)
      if (pull[j] > 0) p.add_hessian(point.y, j, pull[j], mu, entries);
    const double shift =
        1e-9 * mu + g.lpNorm<Eigen::Infinity>();  // slack vertices have no stiffness
    for (int i = 0; i < p.unknowns(); ++i) entries.emplace_back(i, i, shift);
    Matrix h(p.unknowns(), p.unknowns());
    h.setFromTriplets(entries.begin(), entries.end());
    ldlt.compute(h);
    const Vector step = -ldlt.solve(g);
    const double now = value(point.y), slope = g.dot(step);
    double length = 1;
    while (length > 1e-10 && value(point.y + length * step) > now + 1e-4 * length * slope)
      length /= 2;
    if (length <= 1e-10) return;  // only rounding is left
    point.y += length * step;
  }
}

/// Solves to about six digits; Newton on the KKT system does the rest.
void augmented_lagrangian(const Problem& p, Point& point, double mu) {
  const double force = p.weight().lpNorm<Eigen::Infinity>();
  double tolerance = force;
  for (int n = 0; n < 60; ++n) {
    minimise(p, point, mu, tolerance);
    double change = 0;
    for (int j = 0; j < p.links(); ++j) {
      const double next = std::max(0.0, point.lambda[j] + mu * p.constraint(point.y, j));
      change = std::max(change, std::abs(next - point.lambda[j]));
      point.lambda[j] = next;
    }
    if (tolerance <= 1e-8 * force && change < 1e-6 * point.lambda.maxCoeff()) return;
    tolerance = std::max(tolerance / 10, 1e-8 * force);
  }
}

/// Newton on gradient = 0 and C = 0 of the pulling links. [H J^T; J -delta] is quasi-definite, so
/// an LDLT exists in every order; iterative refinement removes the effect of delta.
bool polish(const Problem& p, const std::vector<int>& pulling, Point& point) {
  const int n = p.unknowns(), m = static_cast<int>(pulling.size());
  const double scale = point.lambda.maxCoeff(), delta = 1e-12;
  for (int iteration = 0; iteration < 12; ++iteration) {
    Vector residual(n + m);
    residual.head(n) = gradient(p, point.y, point.lambda);
    std::vector<Triplet> entries, exact;
    for (int i = 0; i < m; ++i) {
      const int j = pulling[to_index(i)];
      residual[n + i] = p.constraint(point.y, j);
      p.add_hessian(point.y, j, point.lambda[j], 0, entries);
      p.add_jacobian(point.y, j, n + i, entries);
    }
    Matrix kkt(n + m, n + m), regular(n + m, n + m);
    kkt.setFromTriplets(entries.begin(), entries.end());
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, delta * scale);
    for (int i = 0; i < m; ++i) entries.emplace_back(n + i, n + i, -delta / scale);
    regular.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Matrix> ldlt(regular);
    if (ldlt.info() != Eigen::Success) return false;
    Vector step = Vector::Zero(n + m);
    for (int refine = 0; refine < 8; ++refine)
      step += ldlt.solve(Vector(-residual - kkt.selfadjointView<Eigen::Lower>() * step));
    if (!step.allFinite()) return false;
    point.y += step.head(n);
    for (int i = 0; i < m; ++i) point.lambda[pulling[to_index(i)]] += step[n + i];
    if (step.head(n).lpNorm<Eigen::Infinity>() < 1e-15) break;
  }
  return true;
}

/// Polishes, drops links that turn out to push and adds links that turn out too long, until the set
/// of pulling links no longer changes.
bool polish_active(const Problem& p, std::vector<int>& pulling, Point& point) {
  for (int round = 0; round < 20; ++round) {
    if (!polish(p, pulling, point)) return false;
    const double strongest = point.lambda.maxCoeff();
    std::vector<int> next;
    for (int j = 0; j < p.links(); ++j) {
      const bool was = std::binary_search(pulling.begin(), pulling.end(), j);
      const bool pulls = point.lambda[j] > 1e-10 * strongest;
      if (was ? pulls : p.constraint(point.y, j) > 1e-10 * p.link(j).rest)
        next.push_back(j);
      else
        point.lambda[j] = 0;
    }
    if (next == pulling) return true;
    pulling = std::move(next);
  }
  return true;  // solve() judges the result
}

struct Solution {
  Point point;
  std::string reason;  ///< why it is not a solution; "": it is one
};

Solution solve(const Problem& p, const std::vector<Vec3>& start, double mu_factor) {
  Solution s{{p.unknowns(start), Vector::Zero(p.links())}, {}};
  const double total = p.weight().lpNorm<1>();
  double length = 0;
  for (int j = 0; j < p.links(); ++j) length = std::max(length, p.link(j).rest);
  augmented_lagrangian(p, s.point, mu_factor * total / length);
  const double strongest = s.point.lambda.maxCoeff();
  std::vector<int> pulling;
  for (int j = 0; j < p.links(); ++j) {
    if (s.point.lambda[j] > 1e-6 * strongest)
      pulling.push_back(j);
    else
      s.point.lambda[j] = 0;
  }
  if (!polish_active(p, pulling, s.point)) {
    s.reason = "the KKT system is singular";
    return s;
  }
  for (int j = 0; j < p.links(); ++j) {
    const Link& l = p.link(j);
    const double gap = p.constraint(s.point.y, j);
    if (gap < -1e-9 * l.rest || s.point.lambda[j] < 0) {
      s.reason = "link " + std::to_string(l.a) + "-" + std::to_string(l.b) +
                 " would have to push: the sheet folds or locks, in more than one way";
      return s;
    }
    if (!(gap < 1e-9 * l.rest)) {
      s.reason = "link " + std::to_string(l.a) + "-" + std::to_string(l.b) +
                 " cannot keep its length: the pins are too far apart, or Newton did not converge";
      return s;
    }
  }
  return s;
}

void measure(const Scene& scene, Equilibrium& e) {
  for (const Link& l : scene.links)
    e.violation =
        std::max(e.violation, std::abs((e.x[to_index(l.b)] - e.x[to_index(l.a)]).norm() - l.rest));
}

Equilibrium refused(const std::string& reason) {
  Equilibrium e;
  e.reason = reason;
  return e;
}

}  // namespace

std::vector<std::string> refuse_rest(const Scene& scene) {
  std::vector<std::string> reasons;
  const auto refuse = [&](bool applies, const char* why) {
    if (applies) reasons.emplace_back(why);
  };
  refuse(!scene.colliders.empty(), "contact: where the cloth comes to rest depends on its history");
  refuse(scene.self_collision.has_value(), "self-collision: it depends on its history");
  refuse(scene.wind.has_value(), "wind follows the faces: it has no potential to minimise");
  refuse(std::any_of(scene.pin_motions.begin(), scene.pin_motions.end(),
                     [](const PinMotion& m) { return !m.motion.at_rest(); }),
         "the pins move");
  refuse(scene.gravity.isZero(0), "without gravity nothing decides where it rests");
  refuse(std::ranges::any_of(scene.links, is_seam), "a seam: its length is 0");
  refuse(!scene.releases.empty(), "its pins let go");
  refuse(scene.pins.empty(), "without pins it falls for ever");
  refuse(scene.membrane.has_value(), "a membrane: a net of links rests here");
  refuse(!scene.membrane && !scene.pins.empty() && !hangs_whole(scene),
         "a piece without a pin falls for ever");
  return reasons;
}

std::vector<std::string> refuse_static(const Scene& scene) {
  std::vector<std::string> reasons = refuse_rest(scene);
  const auto refuse = [&](bool applies, const char* why) {
    if (applies) reasons.emplace_back(why);
  };
  refuse(std::any_of(scene.links.begin(), scene.links.end(),
                     [](const Link& l) { return l.family == Family::bend; }),
         "bending links push: the sheet buckles, in more than one way");
  refuse(scene.bending.has_value(), "bending: rods have none");
  refuse(!elastic_links(scene).empty(), "links are elastic: rods are not");
  return reasons;
}

Equilibrium static_equilibrium(const Scene& scene) {
  if (const auto reasons = refuse_static(scene); !reasons.empty()) return refused(reasons.front());
  Equilibrium e;
  if (auto hung = hanging_straight(scene)) {
    e.unique = true;
    e.derivation = "every vertex is fixed by a straight path between pins or hangs straight below";
    e.x = std::move(*hung);
    measure(scene, e);
    e.floor = e.violation;
    return e;
  }
  const Problem p(scene);
  // Solve from two starts with two penalties: the distance between the solutions is the floor.
  const Solution s = solve(p, scene.start.x, 1);
  if (!s.reason.empty()) return refused(s.reason);
  std::vector<Vec3> other = scene.start.x;
  for (std::size_t i = 0; i < other.size(); ++i)
    other[i] += 0.3 * extent(scene) *
                Vec3(0.1 * std::sin(static_cast<double>(i)), -1,
                     0.5 * std::cos(3.0 * static_cast<double>(i)));
  const Solution t = solve(p, other, 10);
  if (!t.reason.empty()) return refused("from another start: " + t.reason);
  e.unique = true;
  e.derivation = "augmented Lagrangian, then KKT Newton with a sparse LDLT and refinement";
  e.x = p.positions(s.point.y);
  const std::vector<Vec3> again = p.positions(t.point.y);
  for (std::size_t i = 0; i < e.x.size(); ++i)
    e.floor = std::max(e.floor, (e.x[i] - again[i]).norm());
  e.unbalanced = gradient(p, s.point.y, s.point.lambda).lpNorm<Eigen::Infinity>();
  const std::vector<double> w = inverse_masses(scene);
  int j = 0;
  for (const Link& l : scene.links)
    e.tension.push_back(w[to_index(l.a)] + w[to_index(l.b)] > 0 ? s.point.lambda[j++] : 0.0);
  measure(scene, e);
  return e;
}

}  // namespace taut::reference
