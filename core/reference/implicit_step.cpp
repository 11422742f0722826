#include "core/reference/implicit_step.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/collider.hpp"
#include "core/model/index.hpp"
#include "core/model/link_damping.hpp"
#include "core/model/wind.hpp"
#include "core/reference/multiplied_step.hpp"
#include "core/reference/rigid_relations.hpp"
#include "core/solver/panel_factor.hpp"

namespace taut::reference {

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

/// Largest K of rigid links, as a multiple of the largest m/h^2.
constexpr double kHardest = 1e8;
/// A round of multipliers stalls if it leaves more than this share of the violation. Multipliers
/// then grow without end, where links resist at second order alone: a taut row between two pins. K
/// grows instead, and every factor of 8 halves what is left of the bend.
constexpr double kStalls = 0.8;
constexpr double kLocked = 1e-7;     ///< m, largest violation of a minimum
constexpr double kRounding = 1e-14;  ///< m, rounding of all lengths together
constexpr double kTouching = 1e-13;  ///< m, gaps and slips that contact may leave

}  // namespace

ImplicitStep::ImplicitStep(const Scene& scene, const State& from, double t, const Stiffness& k)
    : thickness_(scene.thickness),
      membrane_(make_membrane(scene, scene.dt)),
      inertia_(scene.mesh.mass),
      mass_(scene.mesh.mass),
      y_(from.x) {
  const double h = scene.dt, keep = std::exp(-scene.damping * h);
  const LinkDamping damping(scene, h);
  membrane_.begin([&](std::size_t v) { return from.x[v]; });
  for (double& m : inertia_) m /= h * h;
  for (const int pin : scene.pins) inertia_[to_index(pin)] = 0;
  for (const Link& l : scene.links) {
    const double stiffness = k[static_cast<std::size_t>(l.family)];
    const std::size_t a = to_index(l.a), b = to_index(l.b);
    if (stiffness == 0 || (inertia_[a] == 0 && inertia_[b] == 0)) continue;
    if (damping.on() && !std::isinf(stiffness))
      links_.push_back({a, b, damping.rest(l.rest, (from.x[b] - from.x[a]).norm()),
                        damping.stiffer() * stiffness});
    else
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
  if (rigid_) of_others_ = rigid_relations(scene, k, inertia_);
}

/// Newton's method for the step. Its unknowns are the positions of the vertices without a relation.
struct ImplicitStep::Newton final : Multiplied {
  /// Positions of all vertices from those without a relation; empty: the identity.
  Matrix basis = {};
  Eigen::SimplicialLDLT<Matrix> ldlt = {};  ///< used if there are relations
  bool analysed = false;
  /// Used if there are no relations, where it is several times faster.
  PanelFactor panels = {};
  std::vector<std::size_t> rank = {};  ///< order of elimination of each vertex that moves

  Newton(const ImplicitStep& s, double rigid) : Multiplied(s, rigid) {
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
  /// Sets vertices with a relation to where the other vertices put them.
  Points related(Points x) const {
    if (!reduced()) return x;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column[i] >= 0 && !step.of_others_[i].contains(i)) {
        x[i].setZero();
        for (const auto& [v, weight] : step.of_others_[i]) x[i] += weight * x[v];
      }
    return x;
  }
  Vector gradient_of_own(const Points& x) const {
    const Vector g = gradient(x);
    return reduced() ? Vector(basis.transpose() * g) : g;
  }
  /// Factors the Hessian. Returns whether it is positive definite.
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
              a < b ? m(static_cast<int>(c), static_cast<int>(r))
                    : m(static_cast<int>(r), static_cast<int>(c));
    });
    return panels.factor();
  }
  void analyse_panels() {
    std::vector<PanelFactor::Pair> pairs;
    for (const Member& l : step.links_)
      if (column[l.a] >= 0 && column[l.b] >= 0)
        pairs.push_back({static_cast<int>(column[l.a] / 3), static_cast<int>(column[l.b] / 3)});
    for (const MembraneElement& e : step.membrane_.elements)
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Index a = column[to_index(e.vertex[k])],
                           b = column[to_index(e.vertex[(k + 1) % 3])];
        if (a >= 0 && b >= 0) pairs.push_back({static_cast<int>(a / 3), static_cast<int>(b / 3)});
      }
    rank.resize(static_cast<std::size_t>(size / 3));
    panels = PanelFactor(rank.size(), pairs, 3, widest());
    for (std::size_t k = 0; k < rank.size(); ++k) rank[to_index(panels.order()[k])] = k;
  }
  /// Minus the inverse of the factored matrix, times g.
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

  /// Descends to a gradient below `enough` [N] or to rounding.
  Points minimise(Points x, double enough) {
    for (int k = 0; k < 100; ++k) {
      const Vector g = gradient_of_own(x);
      if (g.norm() < enough || size == 0) break;
      if (!factor(x, false) && !factor(x, true)) break;
      const Vector p = newton_step(g);
      const double before = energy(x), slope = g.dot(p);
      double share = 1;
      Points next = moved(x, p, share);
      const auto worse = [&] {
        return !(energy(next) <= before + 1e-4 * share * slope) &&
               !(energy(next) <= before + 1e-12 * std::abs(before) &&
                 gradient_of_own(next).norm() < g.norm());
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
  Newton at(*this, 0);
  at.lay_planes(x);
  return at.gradient_of_own(x).norm();
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
  std::vector<double> of_membrane(x.size(), 0.0);
  membrane_.add_stiffness(of_membrane);
  for (const double k : of_membrane) stiffest = std::max(stiffest, k);
  double hardness = kHardness * heaviest;
  const auto rounding = [&] { return kRounding * (hardness + 10 * stiffest); };  // N
  Newton problem(*this, hardness);
  x = problem.related(std::move(x));
  problem.lay_planes(x);
  Minimum found;
  double before = 1e300;
  const int rounds = in_contact() ? 400 : rigid_ ? 60 : 1;
  double contact = 0;  // m, distance from settled contact
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
  // Undo the last update: these multipliers are the ones for which x is the minimum.
  for (std::size_t j = 0; j < links_.size(); ++j)
    if (std::isinf(links_[j].stiffness))
      problem.multiplier[j] -= problem.stiffness[j] * problem.stretch(x, j);
  found.residual = problem.gradient_of_own(x).norm();
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
