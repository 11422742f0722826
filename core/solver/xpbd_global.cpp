#include "core/solver/xpbd_global.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/solver/contact/augmented_contacts.hpp"
#include "core/solver/damped_links.hpp"
#include "core/solver/global_system.hpp"
#include "core/solver/panel_factor.hpp"
#include "core/solver/springs.hpp"

namespace taut {

namespace {

using Eigen::Matrix3d;

/// Regularisation of rigid links: their compliance as a share of the matrix' mean diagonal.
constexpr double kSoftnessOfRigid = 1e-9;
/// Compliance of rigid links in contact, as a share of the matrix' mean diagonal. With
/// kSoftnessOfRigid, contact would be so stiff that rounding left nothing else of the matrix.
constexpr double kSoftnessInContact = 1e-3;
/// Sufficient decrease of the line search (Armijo), as a share of the slope.
constexpr double kFalls = 1e-4;
/// Tolerance of the gradient with primal=on, as a share of the forces of inertia.
constexpr double kTolerance = 1e-9;
/// Most halvings of a step in the line search.
constexpr int kMostHalvings = 40;

template <class Real>
class GlobalLinks final : public Pass<Real> {
 public:
  GlobalLinks(const loop::Setup& s, std::vector<Spring> springs, bool primal)
      : springs_(stiffened(std::move(springs), link_damping(s))),
        damped_(link_damping(s), springs_),
        w_(s.w.begin(), s.w.end()),
        mobility_(w_),
        primal_(primal),
        links_(springs_.size()),
        right_(springs_.size()),
        contacts_(primal ? AugmentedContacts(s.scene, s.params) : AugmentedContacts()) {
    analyse(s.simd);
  }

  void restart() override { contacts_.forget(); }
  void take_over(const Pass<Real>& before) override {
    contacts_.take_over(static_cast<const GlobalLinks&>(before).contacts_);
  }
  Points<Real>* target() override { return primal_ ? &y_ : nullptr; }
  bool leaves_colliders() const override { return contacts_.any(); }
  std::optional<bool> converged() const override {
    return primal_ ? std::optional(converged_) : std::nullopt;
  }
  void end(Particles<Real>& p, double, double) override { contacts_.leave(p); }

  void begin(Particles<Real>& p, double t, double h) override {
    y_ = p.x;
    damped_.begin(springs_, p.previous);
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const double k = springs_[j].stiffness;
      links_[j].softness = std::isinf(k) ? kSoftnessOfRigid * mean_diagonal_ : 1 / (k * h * h);
      links_[j].lambda = 0;
    }
    if (contacts_.any()) begin_contacts(p, t, h);
    if (primal_) set_tolerance(p, h);
    converged_ = false;
    ended_at_.clear();
  }

  void apply(Particles<Real>& p, double, double h) override {
    std::vector<Vec3> x = positions(p);
    if (primal_ && x == ended_at_) return;
    look_at(x);
    if (primal_) resist_across();
    if (contacts_.any()) look_at_contacts(p, x, h);
    const std::vector<Vec3> astray = primal_ ? away_from_forces(x) : std::vector<Vec3>();
    fill();
    if (!factor_.factor()) {
      x.assign(x.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
    } else {
      solve(astray);
      const std::vector<Vec3> way = way_of_solution(astray);
      const double share = primal_ ? share_that_falls(x, way, h) : 1;
      for (std::size_t j = 0; j < links_.size(); ++j) links_[j].lambda += share * right_[rank_[j]];
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += share * way[i];
    }
    for (std::size_t i = 0; i < x.size(); ++i)
      if (w_[i] > 0) p.x.set(i, x[i].template cast<Real>());
    const bool changed = contacts_.any() && contacts_.update(p, x, h, left_, enough_);
    if (!primal_) return;
    const std::vector<Vec3> g = gradient(x, h);
    converged_ = !changed && std::sqrt(dot(g, g)) <= h * h * enough_;
    if (converged_) ended_at_ = positions(p);
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "links, all at once",
             .items = springs_.size(),
             .bytes = springs_.size() * (sizeof(Spring) + sizeof(Linked) + sizeof(double)) +
                      damped_.bytes() + y_.bytes() + 2 * w_.size() * sizeof(double)},
            {.pass = "LDLT of the links, entries of its factor",
             .items = factor_.entries(),
             .bytes = factor_.bytes() + beside_.size() * sizeof beside_[0] +
                      diagonal_.size() * sizeof diagonal_[0] + rank_.size() * sizeof rank_[0]}};
  }

 private:
  struct Linked {
    double softness = 0;    ///< a [1/kg], of this substep
    double lambda = 0;      ///< kg m
    double excess = 0;      ///< C [m], at x
    Vec3 u = Vec3::Zero();  ///< unit direction at x; 0 if the ends meet
  };
  /// Entry of the matrix to which a vertex shared by two links adds its mobility times u.u.
  struct Shared {
    double* at;
    std::uint32_t one, other, vertex;
    double sign;  ///< -1 where one link ends and the other begins, otherwise 1
  };

  /// A vertex in contact, in kg and m: forces and stiffnesses are multiplied by h^2.
  struct Held {
    bool touches = false;
    Vec3 force = Vec3::Zero();              ///< kg m, at x
    Matrix3d stiffness = Matrix3d::Zero();  ///< kg, minus the derivative of the force by x
    Matrix3d less = Matrix3d::Zero();       ///< 1/kg, mobility that the vertex loses by contact
  };

  void analyse(Simd simd) {
    std::vector<std::vector<std::size_t>> at(w_.size());  // links of each vertex that moves
    for (std::size_t j = 0; j < springs_.size(); ++j)
      for (const std::size_t v : {springs_[j].a, springs_[j].b}) {
        mean_diagonal_ += w_[v] / static_cast<double>(springs_.size());
        if (w_[v] > 0) at[v].push_back(j);
      }
    std::vector<PanelFactor::Pair> pairs;
    const auto each_pair = [&](const auto& add) {
      for (std::size_t v = 0; v < at.size(); ++v)
        for (std::size_t k = 0; k < at[v].size(); ++k)
          for (std::size_t l = 0; l < k; ++l) add(v, at[v][k], at[v][l]);
    };
    each_pair([&](std::size_t, std::size_t one, std::size_t other) {
      pairs.push_back({static_cast<int>(one), static_cast<int>(other)});
    });
    factor_ = PanelFactor(springs_.size(), pairs, 1, simd);
    rank_.resize(springs_.size());
    for (std::size_t k = 0; k < rank_.size(); ++k) rank_[to_index(factor_.order()[k])] = k;
    for (const std::size_t rank : rank_) diagonal_.push_back(factor_.at(rank, rank));
    each_pair([&](std::size_t v, std::size_t one, std::size_t other) {
      const auto [low, high] = std::minmax(rank_[one], rank_[other]);
      const bool same_end = (springs_[one].a == v) == (springs_[other].a == v);
      beside_.push_back({factor_.at(high, low), static_cast<std::uint32_t>(one),
                         static_cast<std::uint32_t>(other), static_cast<std::uint32_t>(v),
                         same_end ? 1.0 : -1.0});
    });
  }

  /// The tolerance of implicit.cpp, with the rounding of Real.
  void set_tolerance(const Particles<Real>& p, double h) {
    std::vector<double> stiffness(w_.size(), 0.0);  // N/m
    for (std::size_t j = 0; j < links_.size(); ++j)
      for (const std::size_t v : {springs_[j].a, springs_[j].b})
        stiffness[v] += 1 / (links_[j].softness * h * h);
    Vec3 frame = Vec3::Zero();
    double pins = 0;
    const auto way = [&](std::size_t i) {
      return Vec3((p.x[i] - p.previous[i]).template cast<double>());
    };
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (w_[i] == 0) {
        frame += way(i);
        ++pins;
      }
    if (pins > 0) frame /= pins;
    double inertia2 = 0, rounding2 = 0;
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (w_[i] > 0) {
        const double m = 1 / (w_[i] * h * h);
        inertia2 += m * m * (way(i) - frame).squaredNorm();
        const Vec3 x = p.x[i].template cast<double>();
        rounding2 += std::pow((stiffness[i] + m) * x.cwiseAbs().maxCoeff(), 2);
      }
    constexpr auto kUnit = static_cast<double>(std::numeric_limits<Real>::epsilon());
    enough_ = std::max(kTolerance * std::sqrt(inertia2), kUnit * std::sqrt(rounding2));
  }

  void begin_contacts(const Particles<Real>& p, double t, double h) {
    std::vector<double> elastic(w_.size(), 0.0);  // N/m
    for (std::size_t j = 0; j < links_.size(); ++j)
      for (const std::size_t v : {springs_[j].a, springs_[j].b})
        elastic[v] += 1 /
                      (std::isinf(springs_[j].stiffness) ? kSoftnessInContact * mean_diagonal_
                                                         : links_[j].softness) /
                      (h * h);
    contacts_.begin(t, h);
    contacts_.set_stiffness(p, elastic, h);
    contacts_.predict_new(p, h);
  }

  /// Finds what touches at x, and how much mobility the vertices lose by it.
  void look_at_contacts(const Particles<Real>& p, const std::vector<Vec3>& x, double h) {
    contacts_.find(p);
    held_.assign(contacts_.touch() ? w_.size() : 0, {});
    contacts_.each(x, [&](std::size_t v, const AugmentedContacts::Part& part) {
      held_[v].touches = true;
      held_[v].force += h * h * part.force;
      held_[v].stiffness += h * h * part.hessian;
    });
    for (std::size_t v = 0; v < held_.size(); ++v)
      if (Held& at = held_[v]; at.touches)
        at.less = mobility_[v] * Matrix3d::Identity() -
                  (Matrix3d::Identity() / mobility_[v] + at.stiffness).inverse();
  }

  bool touches(std::size_t v) const { return !held_.empty() && held_[v].touches; }

  /// V f: the mobility of vertex v, less what contact takes, times f.
  Vec3 mobile(std::size_t v, const Vec3& f) const {
    const Vec3 free = mobility_[v] * f;
    return touches(v) ? Vec3(free - held_[v].less * f) : free;
  }

  void look_at(const std::vector<Vec3>& x) {
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const Vec3 d = x[springs_[j].b] - x[springs_[j].a];
      const double length = d.norm();
      links_[j].excess = length - springs_[j].rest;
      links_[j].u = length > 0 ? Vec3(d / length) : Vec3(Vec3::Zero());
    }
  }

  void fill() {
    factor_.clear();
    for (std::size_t j = 0; j < links_.size(); ++j)
      *diagonal_[j] = mobility_[springs_[j].a] + mobility_[springs_[j].b] + links_[j].softness;
    for (const Shared& s : beside_)
      *s.at += s.sign * mobility_[s.vertex] * links_[s.one].u.dot(links_[s.other].u);
    if (held_.empty()) return;
    for (std::size_t j = 0; j < links_.size(); ++j)
      for (const std::size_t v : {springs_[j].a, springs_[j].b})
        if (held_[v].touches) *diagonal_[j] -= links_[j].u.dot(held_[v].less * links_[j].u);
    for (const Shared& s : beside_)
      if (const Held& at = held_[s.vertex]; at.touches)
        *s.at -= s.sign * links_[s.one].u.dot(at.less * links_[s.other].u);
  }

  /// Sets the masses of the primal step.
  void resist_across() {
    std::vector<double> across(w_.size(), 0.0);  // kg
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const double length = links_[j].excess + rest;
      if (!(length > 0 && links_[j].lambda < 0)) continue;
      across[a] -= links_[j].lambda / length;
      across[b] -= links_[j].lambda / length;
    }
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (w_[i] > 0) mobility_[i] = 1 / (1 / w_[i] + across[i]);
  }

  /// V M p, where p [m] is the distance of x from the position to which the forces, in the
  /// directions at x, take y.
  std::vector<Vec3> away_from_forces(const std::vector<Vec3>& x) const {
    std::vector<Vec3> p = x;
    for (std::size_t i = 0; i < p.size(); ++i) p[i] -= y_[i].template cast<double>();
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 push = links_[j].lambda * links_[j].u;
      p[a] += w_[a] * push;
      p[b] -= w_[b] * push;
    }
    for (std::size_t i = 0; i < p.size(); ++i)
      if (touches(i))
        p[i] = mobile(i, p[i] / w_[i] - held_[i].force);
      else if (w_[i] > 0)
        p[i] *= mobility_[i] / w_[i];
    return p;
  }

  /// Solves for dlambda in right_, in the order of elimination.
  void solve(const std::vector<Vec3>& astray) {
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const Linked& l = links_[j];
      double& right = right_[rank_[j]];
      right = -(l.excess + l.softness * l.lambda);
      if (primal_) right += l.u.dot(astray[springs_[j].b] - astray[springs_[j].a]);
    }
    factor_.solve_one(right_.data());
  }

  /// V J^T dlambda, minus `astray`.
  std::vector<Vec3> way_of_solution(const std::vector<Vec3>& astray) const {
    std::vector<Vec3> way(w_.size(), Vec3::Zero());
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 push = right_[rank_[j]] * links_[j].u;
      way[a] -= mobile(a, push);
      way[b] += mobile(b, push);
    }
    for (std::size_t i = 0; i < astray.size(); ++i)
      if (w_[i] > 0) way[i] -= astray[i];
    return way;
  }

  /// Implicit Euler's energy times h^2 [kg m^2].
  double energy(const std::vector<Vec3>& x, double h) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (w_[i] > 0) sum += (x[i] - y_[i].template cast<double>()).squaredNorm() / (2 * w_[i]);
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const double c = (x[b] - x[a]).norm() - rest;
      sum += c * c / (2 * links_[j].softness);
    }
    contacts_.each(
        x, [&](std::size_t, const AugmentedContacts::Part& part) { sum += h * h * part.energy; });
    return sum;
  }
  /// Gradient of energy() at x [kg m]; 0 for pins.
  std::vector<Vec3> gradient(const std::vector<Vec3>& x, double h) const {
    std::vector<Vec3> g(x.size(), Vec3::Zero());
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 d = x[b] - x[a];
      const double length = d.norm();
      if (length == 0) continue;
      const Vec3 pull = (length - rest) / (links_[j].softness * length) * d;
      g[a] -= pull;
      g[b] += pull;
    }
    contacts_.each(
        x, [&](std::size_t v, const AugmentedContacts::Part& part) { g[v] -= h * h * part.force; });
    for (std::size_t i = 0; i < x.size(); ++i)
      g[i] = w_[i] > 0 ? Vec3(g[i] + (x[i] - y_[i].template cast<double>()) / w_[i])
                       : Vec3(Vec3::Zero());
    return g;
  }
  static double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
  }

  /// Step length: the first of 1, 1/2, 1/4, ... with which the energy falls (Armijo), or 0 if only
  /// rounding is left. Sets left_ to the gradient there.
  double share_that_falls(const std::vector<Vec3>& x, const std::vector<Vec3>& way, double h) {
    const std::vector<Vec3> g = gradient(x, h);
    const double before = energy(x, h), slope = dot(g, way);
    double share = 1;
    std::vector<Vec3> trial(x.size());
    for (int halvings = 0; halvings < kMostHalvings; ++halvings, share /= 2) {
      for (std::size_t i = 0; i < x.size(); ++i) trial[i] = x[i] + share * way[i];
      const double now = energy(trial, h);
      const bool falls = now <= before + kFalls * share * slope;
      // near the minimum, differences of the energy are mere rounding: the gradient decides
      if (!falls && now > before * (1 + 1e-12)) continue;
      if (falls && !contacts_.any()) return share;
      const std::vector<Vec3> g_now = gradient(trial, h);
      left_ = std::sqrt(dot(g_now, g_now)) / (h * h);
      if (falls || dot(g_now, g_now) < dot(g, g)) return share;
    }
    left_ = 0;
    return 0;
  }

  std::vector<Spring> springs_;
  DampedSprings damped_;
  std::vector<double> w_;         ///< [n] 1/kg
  std::vector<double> mobility_;  ///< [n] 1/kg, in the matrix: V with primal=on, otherwise W
  bool primal_;
  Points<Real> y_;  ///< m
  std::vector<Linked> links_;
  double mean_diagonal_ = 0;  ///< 1/kg
  PanelFactor factor_;
  std::vector<std::size_t> rank_;  ///< [links] in the order of elimination
  std::vector<double*> diagonal_;  ///< [links]
  std::vector<Shared> beside_;
  /// Right-hand side [m], then solution [kg m], in the order of elimination.
  std::vector<double> right_;
  AugmentedContacts contacts_;
  double left_ = 0;             ///< N, the gradient after an iteration that descends the energy
  double enough_ = 0;           ///< N, tolerance of the gradient in this substep
  bool converged_ = false;      ///< this substep
  std::vector<Vec3> ended_at_;  ///< m, where this substep converged; empty: it has not yet
  std::vector<Held> held_;      ///< [n]; empty: nothing touches
};

}  // namespace

template <class Real>
loop::Links<Real> make_global_links(const loop::Setup& s,
                                    const std::array<double, kFamilies.size()>& stiffness,
                                    bool primal) {
  std::vector<Spring> springs = make_springs(s.scene, s.w, stiffness);
  loop::Links<Real> links{.layout = Layout::packed(s.w.size()), .contacts = primal};
  if (!springs.empty())
    links.pass = std::make_unique<GlobalLinks<Real>>(s, std::move(springs), primal);
  return links;
}
template loop::Links<float> make_global_links(const loop::Setup&,
                                              const std::array<double, kFamilies.size()>&, bool);
template loop::Links<double> make_global_links(const loop::Setup&,
                                               const std::array<double, kFamilies.size()>&, bool);

}  // namespace taut
