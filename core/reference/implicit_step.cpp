#include "core/reference/implicit_step.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/collider.hpp"
#include "core/model/index.hpp"
#include "core/model/wind.hpp"
#include "core/solver/panel_factor.hpp"

namespace taut::reference {

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;
using Points = std::vector<Vec3>;

/// K of rigid links over the largest m/h^2, at first and at most.
constexpr double kHardness = 1e4, kHardest = 1e8;
/// Multipliers that leave more than this share of the violation grow without end, where links
/// resist at second order alone: a taut row between two pins. Then K grows instead, and what is
/// left of the bend is halved with every factor of 8.
constexpr double kStalls = 0.8;
constexpr double kLocked = 1e-7;     ///< m, of a violation
constexpr double kRounding = 1e-14;  ///< m, of all lengths together
constexpr double kFlat = 1e-13;      ///< of lengths: what is in a plane, or on a line
constexpr double kNothing = 1e-12;   ///< a weight beside those of order 1
constexpr double kTouching = 1e-13;  ///< m, of gaps and slips that contact leaves

using Weights = std::map<std::size_t, double>;

/// sum of weights x = 0 of three vertices with these distances; empty: they are not on a line.
std::vector<double> on_a_line(double ab, double ac, double bc) {
  for (const auto& [sum, relation] :
       {std::pair(ab + bc - ac, std::vector{-bc / ac, 1.0, -ab / ac}),
        std::pair(ab + ac - bc, std::vector{1.0, -ac / bc, -ab / bc}),
        std::pair(ac + bc - ab, std::vector{-bc / ab, -ac / ab, 1.0})})
    if (std::abs(sum) < kFlat * (ab + ac + bc)) return relation;
  return {};
}

/// The same of four with a, b and c on no line; empty: they are not in a plane.
std::vector<double> in_a_plane(double ab, double ac, double ad, double bc, double bd, double cd) {
  const auto place = [&](double from_a, double from_b) {  // a = (0, 0), b = (ab, 0)
    const double along = (ab * ab + from_a * from_a - from_b * from_b) / (2 * ab);
    return std::pair(along, std::sqrt(std::max(0.0, from_a * from_a - along * along)));
  };
  const auto [cx, cy] = place(ac, bc);
  const auto [dx, up] = place(ad, bd);
  for (const double dy : {up, -up})
    if (std::abs(std::hypot(dx - cx, dy - cy) - cd) < kFlat * (ab + ac + ad)) {
      const double c = dy / cy, b = (dx - c * cx) / ab;
      return {1 - b - c, b, c, -1};
    }
  return {};
}

}  // namespace

ImplicitStep::ImplicitStep(const Scene& scene, const State& from, double t, const Stiffness& k)
    : thickness_(scene.thickness), inertia_(scene.mesh.mass), mass_(scene.mesh.mass), y_(from.x) {
  const double h = scene.dt, keep = std::exp(-scene.damping * h);
  for (double& m : inertia_) m /= h * h;
  for (const int pin : scene.pins) inertia_[to_index(pin)] = 0;
  for (const Link& l : scene.links) {
    const double stiffness = k[static_cast<std::size_t>(l.family)];
    const std::size_t a = to_index(l.a), b = to_index(l.b);
    if (stiffness == 0 || (inertia_[a] == 0 && inertia_[b] == 0)) continue;
    links_.push_back({a, b, l.rest, stiffness});
    rigid_ = rigid_ || std::isinf(stiffness);
  }
  Points acceleration(y_.size(), scene.gravity);
  if (scene.wind)
    for (const auto& [a, b, c] : scene.mesh.triangles) {
      const auto mean = (from.v[to_index(a)] + from.v[to_index(b)] + from.v[to_index(c)]) / 3;
      const Vec3 corner = wind_on_corner(*scene.wind, from.x[to_index(a)], from.x[to_index(b)],
                                         from.x[to_index(c)], mean);
      for (const int i : {a, b, c}) acceleration[to_index(i)] += corner / mass_[to_index(i)];
    }
  for (std::size_t i = 0; i < y_.size(); ++i)
    if (inertia_[i] > 0)
      y_[i] += h * keep * from.v[i] + h * h * acceleration[i];
    else
      y_[i] = pin_position(scene, static_cast<int>(i), t + h);
  for (const Collider& c : scene.colliders)
    colliders_.push_back({shape_at(c, t + h), c.friction, carried(c, t, h, from.x)});
  if (rigid_) find_implied(scene, k);
}

/// Relations of rigidly linked vertices, each solved for one that moves.
void ImplicitStep::find_implied(const Scene& scene, const Stiffness& stiffness) {
  std::vector<std::map<std::size_t, double>> beside(y_.size());  // later neighbours, distance
  for (const Link& l : scene.links)                              // between pins too
    if (std::isinf(stiffness[static_cast<std::size_t>(l.family)]))
      beside[to_index(std::min(l.a, l.b))][to_index(std::max(l.a, l.b))] = l.rest;
  std::vector<Weights> of_others(y_.size());
  for (std::size_t i = 0; i < y_.size(); ++i) of_others[i][i] = 1;
  bool any = false;
  const auto take = [&](const std::vector<std::size_t>& vertices, const std::vector<double>& c) {
    Weights sum;
    for (std::size_t k = 0; k < c.size(); ++k)
      for (const auto& [v, weight] : of_others[vertices[k]]) sum[v] += c[k] * weight;
    std::size_t solved = y_.size();
    for (const auto& [v, weight] : sum)
      if (inertia_[v] > 0 && std::abs(weight) > kNothing &&
          (solved == y_.size() || std::abs(weight) >= (1 - kNothing) * std::abs(sum[solved])))
        solved = v;
    if (solved == y_.size()) return;  // said already
    any = true;
    const double own = sum[solved];
    sum.erase(solved);
    for (Weights& one : of_others)
      if (const auto at = one.find(solved); at != one.end()) {
        const double share = at->second / own;
        one.erase(at);
        for (const auto& [v, weight] : sum)
          if (std::abs(one[v] -= share * weight) < kNothing) one.erase(v);
      }
  };
  for (std::size_t a = 0; a < y_.size(); ++a)
    for (const auto& [b, ab] : beside[a])
      for (const auto& [c, bc] : beside[b]) {
        const auto ac = beside[a].find(c);
        if (ac == beside[a].end()) continue;
        if (const auto line = on_a_line(ab, ac->second, bc); !line.empty()) {
          take({a, b, c}, line);
          continue;
        }
        for (const auto& [d, cd] : beside[c]) {
          const auto ad = beside[a].find(d), bd = beside[b].find(d);
          if (ad == beside[a].end() || bd == beside[b].end()) continue;
          take({a, b, c, d}, in_a_plane(ab, ac->second, ad->second, bc, bd->second, cd));
        }
      }
  if (any) of_others_ = std::move(of_others);
}

/// G with rigid links as springs K that a multiplier [N] has shifted: l C + K/2 C^2.
struct ImplicitStep::Multiplied {
  const ImplicitStep& step;
  std::vector<double> stiffness, multiplier;
  std::vector<Eigen::Index> column;
  Eigen::Index size = 0;
  Matrix basis = {};  ///< of the vertices in those that have no relation; empty: unity
  Eigen::SimplicialLDLT<Matrix> ldlt = {};  ///< with relations
  bool analysed = false;
  PanelFactor panels = {};             ///< without, where it is several times faster
  std::vector<std::size_t> rank = {};  ///< of each vertex that moves, in the order of elimination
  /// Of vertex i at collider k, [i][k]: the forces that shift its part of the energy [N].
  struct Touch {
    double push = 0, bound = 0;
    Vec3 rub = Vec3::Zero();
  };
  std::vector<Touch> touches = {};
  /// Of vertex i at collider k, [i][k]: the surface's tangent plane where it is nearest, fixed
  /// while G is minimised, for with planes that turn its gradient is not that of an energy.
  struct TangentPlane {
    Vec3 normal = Vec3::Zero();
    double offset = 0;  ///< m, of the scene's thickness above the surface
  };
  std::vector<TangentPlane> planes = {};
  double hardness = 0;  ///< N/m, of contact

  Multiplied(const ImplicitStep& s, double rigid) : step(s), multiplier(s.links_.size(), 0) {
    harden(rigid);
    touches.resize(s.inertia_.size() * s.colliders_.size());
    for (const double m : s.inertia_) hardness = std::max(hardness, kHardness * m);
    for (const double k : stiffness) hardness = std::max(hardness, 10 * k);
    for (const double m : s.inertia_) column.push_back(m > 0 ? std::exchange(size, size + 3) : -1);
    if (step.of_others_.empty()) return;
    std::vector<Eigen::Index> own(column.size(), -1);
    Eigen::Index count = 0;
    for (std::size_t i = 0; i < own.size(); ++i)
      if (column[i] >= 0 && step.of_others_[i].contains(i))
        own[i] = std::exchange(count, count + 3);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < own.size(); ++i)
      for (const auto& [v, weight] : step.of_others_[i])
        for (int c = 0; c < 3 && column[i] >= 0 && own[v] >= 0; ++c)
          entries.emplace_back(static_cast<int>(column[i]) + c, static_cast<int>(own[v]) + c,
                               weight);
    basis.resize(size, count);
    basis.setFromTriplets(entries.begin(), entries.end());
  }
  bool reduced() const { return !step.of_others_.empty(); }
  /// Where the vertices are by those that have no relation.
  Points related(Points x) const {
    if (!reduced()) return x;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column[i] >= 0 && !step.of_others_[i].contains(i)) {
        x[i].setZero();
        for (const auto& [v, weight] : step.of_others_[i]) x[i] += weight * x[v];
      }
    return x;
  }
  /// The K of rigid links from now on [N/m].
  void harden(double rigid) {
    stiffness.clear();
    for (const Member& l : step.links_)
      stiffness.push_back(std::isinf(l.stiffness) ? rigid : l.stiffness);
  }
  double stretch(const Points& x, std::size_t j) const {
    const auto& [a, b, rest, k] = step.links_[j];
    return (x[b] - x[a]).norm() - rest;
  }
  double energy(const Points& x) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += step.inertia_[i] / 2 * (x[i] - step.y_[i]).squaredNorm();
    for (std::size_t j = 0; j < stiffness.size(); ++j) {
      const double c = stretch(x, j);
      sum += (multiplier[j] + stiffness[j] / 2 * c) * c;
    }
    each_held(x, [&](std::size_t, std::size_t, const Held& now) { sum += now.energy; });
    return sum;
  }
  /// What a collider does to a vertex: the energy of (push - k gap)+ and of rub - k slip, which is
  /// no longer than the bound, its force and its Hessian.
  struct Held {
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    double push = 0;
    Vec3 rub = Vec3::Zero();
    double gap = 0, slip = 0;  ///< m; the slip that friction has to take back
  };
  Held held(std::size_t i, std::size_t k, const Vec3& x) const {
    const Obstacle& obstacle = step.colliders_[k];
    const Touch& touch = touches[i * step.colliders_.size() + k];
    const TangentPlane& at = planes[i * step.colliders_.size() + k];
    Held out;
    out.gap = at.normal.dot(x) - at.offset;
    out.push = touch.push - hardness * out.gap;
    if (out.push <= 0) return {.gap = out.gap};
    const Eigen::Matrix3d along = at.normal * at.normal.transpose(),
                          across = Eigen::Matrix3d::Identity() - along;
    out.energy = out.push * out.push / (2 * hardness);
    out.force = out.push * at.normal;
    out.hessian = hardness * along;
    const Vec3 slip = across * (x - obstacle.from[i]);
    out.rub = across * touch.rub - hardness * slip;
    const double length = out.rub.norm();
    if (touch.bound == 0) {
      out.rub.setZero();
    } else if (length <= touch.bound) {
      out.slip = slip.norm();
      out.energy += length * length / (2 * hardness);
      out.hessian += hardness * across;
    } else {
      const Vec3 u = out.rub / length;
      out.energy += touch.bound / hardness * (length - touch.bound / 2);
      out.hessian += hardness * touch.bound / length * (across - u * u.transpose());
      out.rub = touch.bound * u;
    }
    out.force += out.rub;
    return out;
  }
  /// visit(i, k, what collider k does to vertex i).
  template <class Visit>
  void each_held(const Points& x, const Visit& visit) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0; column[i] >= 0 && k < step.colliders_.size(); ++k)
        visit(i, k, held(i, k, x[i]));
  }
  /// The tangent planes at x.
  void lay_planes(const Points& x) {
    planes.clear();
    for (const Vec3& at : x)
      for (const Obstacle& obstacle : step.colliders_) {
        const Surface s = surface(obstacle.shape, at);
        planes.push_back({s.normal, s.normal.dot(at) - s.distance + step.thickness_});
      }
  }
  /// The planes and the forces become those at x; how far that is from contact's conditions [m].
  double update_contact(const Points& x) {
    double left = 0;
    std::vector<Vec3> on_old_planes;
    each_held(
        x, [&](std::size_t, std::size_t, const Held& now) { on_old_planes.push_back(now.force); });
    lay_planes(x);
    auto old = on_old_planes.begin();
    each_held(x, [&](std::size_t i, std::size_t k, const Held& now) {
      left = std::max(left, (now.force - *old++).norm() / hardness);
      Touch& touch = touches[i * step.colliders_.size() + k];
      const double bound = step.colliders_[k].friction * now.push;
      if (now.push > 0) left = std::max({left, std::abs(now.gap), now.slip});
      left = std::max(left, std::abs(bound - touch.bound) / hardness);
      touch = {now.push, bound, now.rub};
    });
    return left;
  }
  Vec3 contact_force(const Points& x) const {
    Vec3 sum = Vec3::Zero();
    each_held(x, [&](std::size_t, std::size_t, const Held& now) { sum += now.force; });
    return sum;
  }
  Vector gradient(const Points& x) const {
    Vector g(size);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column[i] >= 0) g.segment<3>(column[i]) = step.inertia_[i] * (x[i] - step.y_[i]);
    for (std::size_t j = 0; j < stiffness.size(); ++j) {
      const auto& [a, b, rest, k] = step.links_[j];
      const Vec3 pull = (multiplier[j] + stiffness[j] * stretch(x, j)) * (x[b] - x[a]).normalized();
      if (column[a] >= 0) g.segment<3>(column[a]) -= pull;
      if (column[b] >= 0) g.segment<3>(column[b]) += pull;
    }
    each_held(x, [&](std::size_t i, std::size_t, const Held& now) {
      g.segment<3>(column[i]) -= now.force;
    });
    return reduced() ? Vector(basis.transpose() * g) : g;
  }
  /// The Hessian: add(row, column, block) of three rows and columns, in its lower triangle; each
  /// block is symmetric.
  template <class Add>
  void each_block(const Points& x, bool clamped, const Add& add) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column[i] >= 0) add(column[i], column[i], step.inertia_[i] * Eigen::Matrix3d::Identity());
    for (std::size_t j = 0; j < stiffness.size(); ++j) {
      const auto& [a, b, rest, k] = step.links_[j];
      const double length = (x[b] - x[a]).norm();
      const Vec3 u = (x[b] - x[a]) / length;
      const double pull = multiplier[j] + stiffness[j] * (length - rest);
      const double across = clamped ? std::max(0.0, pull / length) : pull / length;
      const Eigen::Matrix3d along = u * u.transpose();
      const Eigen::Matrix3d part =
          stiffness[j] * along + across * (Eigen::Matrix3d::Identity() - along);
      for (const std::size_t v : {a, b})
        if (column[v] >= 0) add(column[v], column[v], part);
      if (column[a] >= 0 && column[b] >= 0)
        add(std::max(column[a], column[b]), std::min(column[a], column[b]), -part);
    }
    each_held(x, [&](std::size_t i, std::size_t, const Held& now) {
      if (now.push > 0) add(column[i], column[i], now.hessian);
    });
  }
  /// Whether the Hessian is positive definite.
  bool factor(const Points& x, bool clamped) {
    return reduced() ? factor_reduced(x, clamped) : factor_panels(x, clamped);
  }
  bool factor_reduced(const Points& x, bool clamped) {
    std::vector<Eigen::Triplet<double>> entries;
    each_block(x, clamped, [&](Eigen::Index row, Eigen::Index col, const Eigen::Matrix3d& m) {
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (row + r >= col + c)
            entries.emplace_back(static_cast<int>(row) + r, static_cast<int>(col) + c, m(r, c));
    });
    Matrix lower(size, size);
    lower.setFromTriplets(entries.begin(), entries.end());
    const Matrix h(basis.transpose() * Matrix(lower.selfadjointView<Eigen::Lower>()) * basis);
    if (!std::exchange(analysed, true)) ldlt.analyzePattern(h);
    ldlt.factorize(h);
    return ldlt.info() == Eigen::Success && ldlt.vectorD().minCoeff() > 0;
  }
  bool factor_panels(const Points& x, bool clamped) {
    if (rank.empty()) analyse_panels();
    panels.clear();
    each_block(x, clamped, [&](Eigen::Index row, Eigen::Index col, const Eigen::Matrix3d& m) {
      const std::size_t a = rank[static_cast<std::size_t>(row / 3)],
                        b = rank[static_cast<std::size_t>(col / 3)];
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < (a == b ? r + 1 : 3); ++c)
          *panels.at(std::max(a, b), std::min(a, b), r, c) +=
              m(static_cast<int>(r), static_cast<int>(c));
    });
    return panels.factor();
  }
  void analyse_panels() {
    std::vector<PanelFactor::Pair> pairs;
    for (const Member& l : step.links_)
      if (column[l.a] >= 0 && column[l.b] >= 0)
        pairs.push_back({static_cast<int>(column[l.a] / 3), static_cast<int>(column[l.b] / 3)});
    rank.resize(static_cast<std::size_t>(size / 3));
    panels = PanelFactor(rank.size(), pairs, 3, widest());
    for (std::size_t k = 0; k < rank.size(); ++k) rank[to_index(panels.order()[k])] = k;
  }
  /// The inverse of what was factored, times -g.
  Vector newton_step(const Vector& g) const {
    if (reduced()) return ldlt.solve(-g);
    std::vector<double> rows(static_cast<std::size_t>(size));
    for (std::size_t k = 0; k < rank.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c)
        rows[3 * rank[k] + c] = -g[static_cast<Eigen::Index>(3 * k + c)];
    panels.solve_one(rows.data());
    Vector p(size);
    for (std::size_t k = 0; k < rank.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c)
        p[static_cast<Eigen::Index>(3 * k + c)] = rows[3 * rank[k] + c];
    return p;
  }
  Points moved(Points x, const Vector& step_of_own, double share) const {
    const Vector p = reduced() ? Vector(basis * step_of_own) : step_of_own;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column[i] >= 0) x[i] += share * p.segment<3>(column[i]);
    return x;
  }

  /// Down to a gradient below `enough` [N] or to rounding.
  Points minimise(Points x, double enough) {
    for (int k = 0; k < 100; ++k) {
      const Vector g = gradient(x);
      if (g.norm() < enough || size == 0) break;
      if (!factor(x, false) && !factor(x, true)) break;
      const Vector p = newton_step(g);
      const double before = energy(x), slope = g.dot(p);
      double share = 1;
      Points next = moved(x, p, share);
      const auto worse = [&] {
        return !(energy(next) <= before + 1e-4 * share * slope) &&
               !(energy(next) <= before + 1e-12 * std::abs(before) &&
                 gradient(next).norm() < g.norm());
      };
      while (worse() && share > 1e-12) next = moved(x, p, share /= 2);
      if (share <= 1e-12) break;
      x = std::move(next);
    }
    return x;
  }
};

double ImplicitStep::energy(const Points& x) const {
  Multiplied at(*this, 0);
  at.lay_planes(x);
  return at.energy(x);
}
double ImplicitStep::residual(const Points& x) const {
  Multiplied at(*this, 0);
  at.lay_planes(x);
  return at.gradient(x).norm();
}

double ImplicitStep::stretch(const Points& x) const {
  double sum = 0;
  for (const auto& [a, b, rest, k] : links_) sum += std::pow((x[b] - x[a]).norm() - rest, 2);
  return links_.empty() ? 0 : std::sqrt(sum / static_cast<double>(links_.size()));
}

double ImplicitStep::square_distance(const Points& x, const Points& to) const {
  double sum = 0, mass = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (inertia_[i] > 0) {
      sum += mass_[i] * (x[i] - to[i]).squaredNorm();
      mass += mass_[i];
    }
  return mass > 0 ? sum / mass : 0;
}

double ImplicitStep::distance(const Points& x, const Points& to) const {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - to[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(x.size()));
}

ImplicitStep::Minimum ImplicitStep::minimum(const Points& start) const {
  Points x = start;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (inertia_[i] == 0) x[i] = y_[i];
  double heaviest = 0, stiffest = 0;
  for (const double m : inertia_) heaviest = std::max(heaviest, m);
  for (const Member& l : links_)
    if (std::isfinite(l.stiffness)) stiffest = std::max(stiffest, l.stiffness);
  double hardness = kHardness * heaviest;
  const auto rounding = [&] { return kRounding * (hardness + 10 * stiffest); };  // N
  Multiplied problem(*this, hardness);
  x = problem.related(std::move(x));
  problem.lay_planes(x);
  Minimum found;
  double before = 1e300;
  const int rounds = in_contact() ? 400 : rigid_ ? 60 : 1;
  double contact = 0;  // m, by which it is not yet settled
  for (int round = 0; round < rounds; ++round) {
    const Points last = x;
    x = problem.minimise(std::move(x), 1e-10 + rounding());
    if (round > 0) found.moved = distance(x, last);
    contact = problem.update_contact(x);
    if (!rigid_ && contact < kTouching) break;
    found.stretch = 0;
    for (std::size_t j = 0; j < links_.size(); ++j)
      if (std::isinf(links_[j].stiffness)) {
        const double c = problem.stretch(x, j);
        found.stretch = std::max(found.stretch, std::abs(c));
        problem.multiplier[j] += problem.stiffness[j] * c;
      }
    if (!rigid_) continue;
    if (contact < kTouching &&
        (found.stretch < 1e-14 || (found.stretch < 1e-12 && found.stretch >= before)))
      break;
    if (found.stretch > kStalls * before && round + 1 < rounds) {
      if (hardness >= kHardest * heaviest) break;
      problem.harden(hardness *= 8);
    }
    before = found.stretch;
  }
  // with the multipliers as they were for this x
  for (std::size_t j = 0; j < links_.size(); ++j)
    if (std::isinf(links_[j].stiffness))
      problem.multiplier[j] -= problem.stiffness[j] * problem.stretch(x, j);
  found.residual = problem.gradient(x).norm();
  found.contact = problem.contact_force(x);
  found.x = std::move(x);
  if (contact > kLocked)
    found.problem = "contact did not come to rest";
  else if (found.stretch > kLocked)
    found.problem = "the links cannot all have their length near this state";
  else if (!(found.residual < 1e-6 + rounding()))
    found.problem = "Newton's method did not converge";
  return found;
}

}  // namespace taut::reference
