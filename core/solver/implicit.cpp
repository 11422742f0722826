// Implicit Euler by Newton's method. A step from x_t, v_t with y = x_t + h v_t + h^2 a is the
// minimum of
//
//     G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2 C^2,     C = |d| - r,  d = x_b - x_a,  u = d/|d|
//
// and each iteration solves H p = -g for the gradient g [N] and the Hessian of the springs
//
//     K [ u u^T + c (I - u u^T) ],     c = 1 - r/|d|
//
// with c clamped to at least 0, which keeps H positive definite (Choi, Ko: Stable but Responsive
// Cloth, SIGGRAPH 2002). Where full steps no longer bring the gradient down fast, the Hessian is
// taken as it is, if it is positive definite. The step is halved until G falls (Armijo). From x_t,
// one iteration without line search is the linearised step of Baraff, Witkin: Large Steps in Cloth
// Simulation (SIGGRAPH 1998).
//
// With multipliers=keep each link has a tension f [N] that outlives the step. From x = y on,
//
//     H = M/h^2 + sum K u u^T + max(0, f)/|d| (I - u u^T),   f <- K (C + u.(p_b - p_a)),   x <- x +
//     p
//
// for K C of an iterate is K times its error, which where K is large locks the motion across links,
// and f, of the linear system's solution, is not. A step whose gradient, in the norm of 1/M, has
// grown in the end is computed again as above.
//
// integrator=bdf2 and midpoint are steps of the same form, with another y and h:
//
//     BDF2      h' = 2h/3,  y = (4 x_t - x_t-1)/3 + h' (4 v_t - v_t-1)/3 + h'^2 g,
//               v = (x - (4 x_t - x_t-1)/3)/h'; the first step is implicit Euler's
//     midpoint  h' = h/2,   y = x_t + h' v_t + h'^2 g;   x <- 2x - x_t,  v = 2 (x - x_t)/h - v_t
//
// Contact is an augmented Lagrangian at each vertex that touches (Alart, Curnier, Computer Methods
// in Applied Mechanics and Engineering 92, 1991): with the force of the last iteration, push along
// the normal n and rub across it, and a stiffness k,
//
//     push' = max(0, push - k gap),   rub' = rub - k slip, no longer than mu push
//
// act, k n n^T + k (I - n n^T) join the Hessian where they hold and stick. They become the forces
// once the gradient that is left is less than a share of their change: sooner, and contacts would
// take turns at sticking and slipping without end.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/model/bending.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/global_system.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/panel_factor.hpp"
#include "core/solver/springs.hpp"

namespace taut::solver::implicit {

namespace {

using Vector = Eigen::VectorXd;
using Eigen::Matrix3d;

/// Iterations end where |g| [N] is below this share of |M/h^2 (y - x_t)|, all that drives the step,
/// or below what rounding of the places makes of the springs: the first one only if that, too, is
/// below a share, for a light cloth is moved by less.
constexpr double kTolerance = 1e-9, kFirstTolerance = 1e-6;
/// Up to so many vertices that move, the factor is taken. It is faster than conjugate gradients at
/// any size that was tried (methods.md) and is bound by its memory, 6 kB a vertex there.
constexpr std::size_t kFactorPays = 100000;
/// Of the stiffness of all else at a vertex, that of its contact; and of a change of the forces of
/// contact, the gradient that is left before they take it.
constexpr double kContactStiffness = 3, kSettled = 0.3;

constexpr ParamSpec kOwn[] = {
    loop::iterations("50", "Newton iterations, at most; they end at 1e-9 of the forces of inertia"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kStiffness[0],
    kStiffness[1],
    kStiffness[2],
    kMaterial,
    ParamSpec::choice(
        "integrator", "euler", "euler|bdf2|midpoint",
        "implicit Euler, BDF2 or the implicit midpoint rule, which lose less; the last "
        "two in free motion alone: without wind, damping and contact"),
    ParamSpec::choice("multipliers", "off", "off|keep",
                      "keep each link's tension from step to step, and with it what links resist "
                      "across: three iterations are then enough, from the prediction on and "
                      "without a line search, which ends steps that go astray"),
    ParamSpec::choice("line-search", "on", "on|off",
                      "halve steps until the energy falls; iterations=1,line-search=off is Baraff "
                      "and Witkin's step"),
    ParamSpec::choice("linear", "auto", "auto|ldlt|cg",
                      "the linear systems by a sparse LDLT, by conjugate gradients with a block "
                      "Jacobi preconditioner, or by the number of vertices"),
};
constexpr auto kParams = loop::with_common(kOwn);

bool factors(const Params& params, std::size_t moving) {
  return params.is("linear", "auto") ? moving <= kFactorPays : params.is("linear", "ldlt");
}

/// A spring's part of the Hessian: isotropic I + axial u u^T [N/m].
struct SpringHessian {
  double isotropic = 0, axial = 0;
  Vec3 u = Vec3::UnitX();
  Matrix3d matrix() const { return isotropic * Matrix3d::Identity() + axial * u * u.transpose(); }
  Vec3 times(const Vec3& v) const { return isotropic * v + axial * u.dot(v) * u; }
};

/// M/h^2 + the springs, over the vertices that move.
class Hessian {
 public:
  Hessian(const std::vector<Spring>& springs, const std::vector<BendingElement>& bending,
          std::span<const double> w, bool factored, Simd simd)
      : springs_(springs), bending_(bending), column_(w.size(), kPinned), blocks_(springs.size()) {
    for (std::size_t i = 0; i < w.size(); ++i)
      if (w[i] > 0) column_[i] = 3 * static_cast<int>(mass_.size()), mass_.push_back(1 / w[i]);
    if (factored) analyse(simd);
  }

  int size() const { return 3 * static_cast<int>(mass_.size()); }
  /// Where the vertex is in vectors; kPinned: it does not move.
  int column(std::size_t vertex) const { return column_[vertex]; }
  double mass(std::size_t vertex) const { return mass_[to_index(column_[vertex]) / 3]; }
  SpringHessian& block(std::size_t spring) { return blocks_[spring]; }
  /// What contact adds at a vertex that moves [N/m].
  void clear_contacts() { contacts_.clear(); }
  void add_contact(std::size_t vertex, const Matrix3d& block) {
    contacts_.emplace_back(column_[vertex], block);
  }
  bool factored() const { return !diagonal_.empty(); }
  static constexpr int kPinned = -1;

  /// p of H p = right, by the factor; false: H is not positive definite.
  bool solve(double h, const Vector& right, Vector& p) {
    if (!factored()) return conjugate_gradients(h, right, p);
    fill(h);
    if (!factor_.factor()) return false;
    for (std::size_t k = 0; k < mass_.size(); ++k)
      in_order_.segment<3>(3 * static_cast<Eigen::Index>(k)) =
          right.segment<3>(3 * factor_.order()[k]);
    factor_.solve_one(in_order_.data());
    p.resize(right.size());
    for (std::size_t k = 0; k < mass_.size(); ++k)
      p.segment<3>(3 * factor_.order()[k]) = in_order_.segment<3>(3 * static_cast<Eigen::Index>(k));
    return true;
  }

  /// H v without the masses' part; pins do not move.
  Vector elastic_times(const Vector& v) const {
    return elastic_times(v, [](std::size_t) { return Vec3(Vec3::Zero()); });
  }
  /// pin(vertex): its way [m].
  template <class Pin>
  Vector elastic_times(const Vector& v, const Pin& pin) const {
    Vector out = Vector::Zero(v.size());
    const auto at = [&](std::size_t vertex) -> Vec3 {
      return column_[vertex] < 0 ? pin(vertex) : Vec3(v.segment<3>(column_[vertex]));
    };
    for (std::size_t j = 0; j < springs_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 pull = blocks_[j].times(at(b) - at(a));
      if (column_[a] >= 0) out.segment<3>(column_[a]) -= pull;
      if (column_[b] >= 0) out.segment<3>(column_[b]) += pull;
    }
    for (const BendingElement& e : bending_) {
      const Vec3 pull = e.stiffness * e.value(at);
      for (std::size_t i = 0; i < e.size; ++i)
        if (const int c = column_[to_index(e.vertex[i])]; c >= 0)
          out.segment<3>(c) += e.weight[i] * pull;
    }
    for (const auto& [column, block] : contacts_)
      out.segment<3>(column) += block * v.segment<3>(column);
    return out;
  }

  std::size_t factor_entries() const { return factor_.entries(); }
  std::size_t bytes() const {
    return factor_.bytes() + bent_.size() * sizeof bent_[0] + blocks_.size() * sizeof blocks_[0] +
           (diagonal_.size() + beside_.size()) * sizeof diagonal_[0] +
           static_cast<std::size_t>(in_order_.size()) * sizeof(double);
  }

 private:
  /// Of 3 x 3 numbers in the matrix; null: an end is pinned.
  struct Block {
    double* first = nullptr;
    std::size_t stride = 0;
    double& operator()(int r, int c) const { return first[to_index(r) * stride + to_index(c)]; }
  };

  void analyse(Simd simd) {
    std::vector<PanelFactor::Pair> pairs;
    const auto join = [&](std::size_t a, std::size_t b) {
      if (a != b && column_[a] >= 0 && column_[b] >= 0)
        pairs.push_back({column_[a] / 3, column_[b] / 3});
    };
    for (const Spring& s : springs_) join(s.a, s.b);
    for (const BendingElement& e : bending_)
      for (std::size_t i = 0; i < e.size; ++i)
        for (std::size_t j = 0; j < i; ++j) join(to_index(e.vertex[i]), to_index(e.vertex[j]));
    factor_ = PanelFactor(mass_.size(), pairs, 3, simd);
    in_order_.resize(size());
    std::vector<std::size_t> rank(mass_.size());
    for (std::size_t k = 0; k < rank.size(); ++k) rank[to_index(factor_.order()[k])] = k;
    const auto place = [&](int a, int b) -> Block {
      if (a < 0 || b < 0) return {};
      const auto [low, high] = std::minmax({rank[to_index(a) / 3], rank[to_index(b) / 3]});
      double* const first = factor_.at(high, low);
      return {first, static_cast<std::size_t>(factor_.at(high, low, 1) - first)};
    };
    for (int i = 0; i < size(); i += 3) diagonal_.push_back(place(i, i));
    for (const Spring& s : springs_) beside_.push_back(place(column_[s.a], column_[s.b]));
    each_bending([&](int row, int column, double k) {
      if (row % 3 == 0) bent_.emplace_back(place(row, column), k);
    });
  }

  /// add(row, column, k [N/m]) for every entry in the lower triangle of the bending elements, whose
  /// Hessian is constant.
  template <class Add>
  void each_bending(const Add& add) const {
    for (const BendingElement& e : bending_)
      for (std::size_t i = 0; i < e.size; ++i)
        for (std::size_t j = 0; j < e.size; ++j) {
          const int row = column_[to_index(e.vertex[i])], column = column_[to_index(e.vertex[j])];
          for (int c = 0; c < 3 && row >= column && column >= 0; ++c)
            add(row + c, column + c, e.stiffness * e.weight[i] * e.weight[j]);
        }
  }

  void add_diagonal(int column, const Matrix3d& block) {
    const Block& at = diagonal_[to_index(column) / 3];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c <= r; ++c) at(r, c) += block(r, c);
  }
  void fill(double h) {
    factor_.clear();
    for (const auto& [at, k] : bent_)
      for (int c = 0; c < 3; ++c) at(c, c) += k;
    for (std::size_t i = 0; i < mass_.size(); ++i)
      for (int c = 0; c < 3; ++c) diagonal_[i](c, c) += mass_[i] / (h * h);
    for (std::size_t j = 0; j < springs_.size(); ++j) {
      const Matrix3d block = blocks_[j].matrix();
      for (const std::size_t v : {springs_[j].a, springs_[j].b})
        if (column_[v] >= 0) add_diagonal(column_[v], block);
      if (const Block& at = beside_[j]; at.first)
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) at(r, c) -= block(r, c);
    }
    for (const auto& [column, block] : contacts_) add_diagonal(column, block);
  }

  Vector times(double h, const Vector& v) const {
    Vector out = elastic_times(v);
    for (std::size_t i = 0; i < mass_.size(); ++i)
      out.segment<3>(3 * static_cast<int>(i)) +=
          mass_[i] / (h * h) * v.segment<3>(3 * static_cast<int>(i));
    return out;
  }

  /// To a residual of 1e-6 of the right-hand side; blocks of vertices inverted as preconditioner.
  /// False: a direction along which the energy curves down was met.
  bool conjugate_gradients(double h, const Vector& right, Vector& p) const {
    std::vector<Matrix3d> inverse(mass_.size());
    for (std::size_t i = 0; i < mass_.size(); ++i)
      inverse[i] = mass_[i] / (h * h) * Matrix3d::Identity();
    for (std::size_t j = 0; j < springs_.size(); ++j)
      for (const std::size_t v : {springs_[j].a, springs_[j].b})
        if (column_[v] >= 0) inverse[to_index(column_[v]) / 3] += blocks_[j].matrix();
    each_bending([&](int row, int column, double k) {
      if (row == column) inverse[to_index(row) / 3](row % 3, row % 3) += k;
    });
    for (const auto& [column, block] : contacts_) inverse[to_index(column) / 3] += block;
    for (Matrix3d& m : inverse) m = Matrix3d(m.inverse());
    const auto preconditioned = [&](const Vector& r) {
      Vector z(r.size());
      for (std::size_t i = 0; i < inverse.size(); ++i)
        z.segment<3>(3 * static_cast<int>(i)) = inverse[i] * r.segment<3>(3 * static_cast<int>(i));
      return z;
    };
    p = Vector::Zero(right.size());
    Vector r = right, z = preconditioned(r), d = z;
    double rz = r.dot(z);
    const double enough = 1e-6 * right.norm();
    for (Eigen::Index k = 0; k < 2 * right.size() && r.norm() > enough; ++k) {
      const Vector hd = times(h, d);
      const double curvature = d.dot(hd);
      if (!(curvature > 0) || !(rz > 0)) return false;
      const double step = rz / curvature;
      p += step * d, r -= step * hd;
      z = preconditioned(r);
      const double before = rz;
      rz = r.dot(z);
      d = z + rz / before * d;
    }
    return true;
  }

  const std::vector<Spring>& springs_;
  const std::vector<BendingElement>& bending_;
  std::vector<int> column_;
  std::vector<double> mass_;  ///< kg, of those that move
  std::vector<SpringHessian> blocks_;
  std::vector<std::pair<int, Matrix3d>> contacts_;
  PanelFactor factor_;                          ///< empty: conjugate gradients
  std::vector<Block> diagonal_;                 ///< [those that move]
  std::vector<Block> beside_;                   ///< [springs]
  std::vector<std::pair<Block, double>> bent_;  ///< [N/m] of bending, times unity
  Vector in_order_;                             ///< in the order of elimination
};

class NewtonPass final : public Pass<double> {
 public:
  explicit NewtonPass(const loop::Setup& s)
      : springs_(make_springs(s.scene, s.w, stiffnesses(s.scene, s.params))),
        bending_(make_bending(s.scene)),
        line_search_(s.params.is("line-search", "on")),
        iterations_(s.params.integer("iterations")),
        integrator_(s.params.is("integrator", "bdf2")       ? Integrator::bdf2
                    : s.params.is("integrator", "midpoint") ? Integrator::midpoint
                                                            : Integrator::euler),
        gravity_(s.scene.gravity),
        tension_(s.params.is("multipliers", "keep") ? springs_.size() : 0),
        hessian_(springs_, bending_, s.w,
                 factors(s.params, to_index(static_cast<int>(std::ranges::count_if(
                                       s.w, [](double w) { return w > 0; })))),
                 s.simd),
        stiffness_(s.w.size()),
        contacts_(make_contacts(s.scene, s.params)),
        contact_stiffness_(contacts_ ? s.w.size() : 0) {
    for (const Spring& spring : springs_)
      stiffness_[spring.a] += spring.stiffness, stiffness_[spring.b] += spring.stiffness;
    for (const BendingElement& e : bending_)
      for (std::size_t i = 0; i < e.size; ++i)
        for (std::size_t j = 0; j < e.size; ++j)
          stiffness_[to_index(e.vertex[i])] += e.stiffness * std::abs(e.weight[i] * e.weight[j]);
  }

  void restart() override {
    if (contacts_) contacts_->restart();
    std::ranges::fill(tension_, 0);
    before_.clear();
  }

  void take_over(const Pass<double>& before) override {
    const auto& old = static_cast<const NewtonPass&>(before);
    if (contacts_) contacts_->take_over(*old.contacts_);
    std::size_t j = 0;  // springs keep their order; more of them can move now
    for (std::size_t k = 0; keeps() && k < old.springs_.size(); ++k) {
      while (springs_[j].a != old.springs_[k].a || springs_[j].b != old.springs_[k].b) ++j;
      tension_[j] = old.tension_[k];
    }
  }

  Points<double>* target() override { return &y_; }

  void begin(Particles<double>& p, double t, double step) override {
    y_ = p.x;
    if (integrator_ != Integrator::euler) predict(p, step);
    const double h = own_step(step);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, p.previous[i]);
    if (contacts_) contacts_->begin(t, h);
    clamped_ = first_ = true;
    ended_at_.clear();
    set_tolerances(p, h);
    if (!keeps()) return;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, y_[i]);
    first_ = false;
    touching_.clear();
    at_first_ = in_norm_of_masses(gradient(positions(p), h));
  }

  void end(Particles<double>& p, double t, double h) override {
    if (keeps() && went_astray(p, own_step(h))) go_again(p, t, h);
    if (integrator_ != Integrator::euler) finish(p, h);
  }

  void apply(Particles<double>& p, double, double step) override {
    const double h = own_step(step);
    std::vector<Vec3> x = positions(p);
    if (x == ended_at_) return;
    if (contacts_) contacts_->find(p, touching_);
    const bool first = std::exchange(first_, false);
    const Vector g = gradient(x, h);
    if (g.norm() <= (first ? enough_at_first_ : enough_) ||
        !(first                      ? first_iteration(x, p, g, h)
          : keeps() && !keep_paused_ ? iterate_kept(x, g, h)
                                     : iterate(x, g, h))) {
      // the minimum for these forces of contact; the end if theirs is no other one
      left_ = 0;
      if (!contacts_ || !update_contacts(p, h)) ended_at_ = std::move(x);
      return;
    }
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, x[i]);
    if (contacts_) update_contacts(p, h);
  }

  std::vector<PassCost> cost() const override {
    const std::size_t bytes =
        y_.bytes() + springs_.size() * sizeof(Spring) + bending_.size() * sizeof(BendingElement);
    return {{.pass = "spring Hessians", .items = springs_.size(), .bytes = bytes},
            {.pass = hessian_.factored() ? "LDLT" : "conjugate gradients",
             .items = hessian_.factored() ? hessian_.factor_entries() : to_index(hessian_.size()),
             .bytes = hessian_.bytes()}};
  }

 private:
  void go_again(Particles<double>& p, double t, double h) {
    keep_paused_ = true;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.set(i, p.previous[i]);
    first_ = clamped_ = true;
    ended_at_.clear();
    for (int k = 0; k < iterations_; ++k) apply(p, t, h);
    keep_paused_ = false;
    std::ranges::fill(tension_, 0);
  }

  /// h' of a step of h.
  double own_step(double h) const {
    if (integrator_ == Integrator::midpoint) return h / 2;
    return integrator_ == Integrator::bdf2 && !before_.empty() ? 2 * h / 3 : h;
  }
  /// y_, which is implicit Euler's, becomes the integrator's, and pins go where its h' ends.
  void predict(Particles<double>& p, double h) {
    const double own = own_step(h);
    start_.resize(p.size());
    v_start_.resize(p.size());
    pins_at_end_ = positions(p);
    for (std::size_t i = 0; i < p.size(); ++i) {
      start_[i] = p.previous[i];
      v_start_[i] = (y_[i] - start_[i] - h * h * gravity_) / h;
      if (p.w[i] == 0) {
        if (integrator_ != Integrator::midpoint) continue;
        p.x.set(i, (start_[i] + y_[i]) / 2);
        y_.set(i, p.x[i]);
      } else if (integrator_ == Integrator::midpoint) {
        y_.set(i, start_[i] + own * v_start_[i] + own * own * gravity_);
      } else if (!before_.empty()) {
        y_.set(i, (4 * start_[i] - before_[i]) / 3 + own * (4 * v_start_[i] - v_before_[i]) / 3 +
                      own * own * gravity_);
      }
    }
  }
  /// Places and velocities at the end of the step; the loop takes a velocity from p.previous.
  void finish(Particles<double>& p, double h) {
    const double own = own_step(h);
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (p.w[i] == 0) {
        p.x.set(i, pins_at_end_[i]);
        continue;
      }
      Vec3 x = p.x[i], v;
      if (integrator_ == Integrator::midpoint) {
        v = 2 * (x - start_[i]) / own - v_start_[i];
        x = 2 * x - start_[i];
      } else if (before_.empty()) {
        v = (x - start_[i]) / h;
      } else {
        v = (x - (4 * start_[i] - before_[i]) / 3) / own;
      }
      p.x.set(i, x);
      p.previous.set(i, x - h * v);
    }
    if (integrator_ != Integrator::bdf2) return;
    before_ = start_;
    v_before_ = v_start_;
  }

  /// The step from x_t, linearised with the pins still there: their way to t + h is on the
  /// right-hand side, so that a frame that moves steadily is as one at rest. It is solved for x -
  /// y, so that rounding in stiff links moves no centre of mass; where a factor breaks down in
  /// double precision its places are NaN, which ends a case as exploded.
  bool first_iteration(std::vector<Vec3>& x, const Particles<double>& p, const Vector& g,
                       double h) {
    std::vector<Vec3> start(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) start[i] = p.previous[i];
    linearise(start, clamped_);
    const auto way_of_pin = [&](std::size_t v) { return Vec3(x[v] - start[v]); };
    Vector direction;
    if (hessian_.factored()) {
      const Vector to_y = way_to_y(x);
      if (!hessian_.solve(h, -elastic(start) - hessian_.elastic_times(to_y, way_of_pin),
                          direction)) {
        x.assign(x.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
        return true;
      }
      direction += to_y;
    } else {
      const Vector still = Vector::Zero(hessian_.size());
      if (!hessian_.solve(h, -gradient(start, h) - hessian_.elastic_times(still, way_of_pin),
                          direction))
        return false;
    }
    return take(x, direction, g, h);
  }

  /// One Newton step; false: rounding does not let the energy fall any further.
  bool iterate(std::vector<Vec3>& x, const Vector& g, double h) {
    linearise(x, clamped_);
    Vector direction;
    if (!hessian_.solve(h, -g, direction)) {
      linearise(x, clamped_ = true);
      if (!hessian_.solve(h, -g, direction)) return false;
    }
    return take(x, direction, g, h);
  }

  bool keeps() const { return !tension_.empty(); }
  double in_norm_of_masses(const Vector& g) const {
    double sum = 0;
    for (std::size_t i = 0; i < stiffness_.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0)
        sum += g.segment<3>(c).squaredNorm() / hessian_.mass(i);
    return std::sqrt(sum);
  }
  bool went_astray(const Particles<double>& p, double h) {
    const double now = in_norm_of_masses(gradient(positions(p), h));
    const double rounding = enough_ * std::sqrt(*std::ranges::max_element(p.w));
    return !(now <= std::max(at_first_, rounding));
  }
  /// One iteration with the tensions that were kept; false: there is no factor.
  bool iterate_kept(std::vector<Vec3>& x, const Vector& g, double h) {
    linearise(x, true);
    std::vector<double> excess(springs_.size());
    for (std::size_t j = 0; j < springs_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 d = x[b] - x[a];
      const double length = d.norm();
      if (length == 0) continue;
      excess[j] = length - rest;
      const double across = std::max(0.0, tension_[j]) / length;
      hessian_.block(j) = {across, stiffness - across, d / length};
    }
    Vector direction;
    if (!hessian_.solve(h, -g, direction)) return false;
    const auto way = [&](std::size_t v) -> Vec3 {
      const int c = hessian_.column(v);
      return c < 0 ? Vec3(Vec3::Zero()) : Vec3(direction.segment<3>(c));
    };
    for (std::size_t j = 0; j < springs_.size(); ++j) {
      const Spring& s = springs_[j];
      tension_[j] = s.stiffness * (excess[j] + hessian_.block(j).u.dot(way(s.b) - way(s.a)));
    }
    left_ = 0;
    x = moved(x, direction, 1);
    return true;
  }

  /// Moves x along the direction, by halves of it until the energy falls; false: it does not.
  bool take(std::vector<Vec3>& x, const Vector& direction, const Vector& g, double h) {
    if (!line_search_) {
      left_ = 0;
      x = moved(x, direction, 1);
      return true;
    }
    const double energy_before = energy(x, h), slope = g.dot(direction);
    double step = 1;
    const int most_halvings = g.norm() <= enough_ ? 1 : 50;
    for (int halvings = 0; halvings < most_halvings; ++halvings, step /= 2) {
      std::vector<Vec3> trial = moved(x, direction, step);
      const double now = energy(trial, h);
      const Vector g_now = gradient(trial, h);
      const bool falls = now <= energy_before + 1e-4 * step * slope;
      // near the minimum, differences of the energy are rounding: the gradient decides
      const bool rounds = now <= energy_before * (1 + 1e-12) && g_now.norm() < g.norm();
      if (!falls && !rounds) continue;
      left_ = g_now.norm();
      clamped_ = clamped_ && (step < 1 || left_ < 0.25 * g.norm());
      x = std::move(trial);
      return true;
    }
    return false;
  }

  /// A contact's part of the augmented Lagrangian at x: energy [J], force [N], Hessian [N/m].
  struct AugmentedContact {
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Matrix3d hessian = Matrix3d::Zero();
  };
  AugmentedContact augmented(const TouchingVertex& at, const Vec3& x) const {
    const ContactForce& held = contacts_->force(at.vertex, at.collider);
    const double k = contact_stiffness_[at.vertex], push = held.push - k * at.gap(x);
    const Matrix3d along = at.normal * at.normal.transpose();
    AugmentedContact out;
    if (push > 0) out = {push * push / (2 * k), push * at.normal, k * along};
    const Vec3 rub = held.rub - k * at.slip(x);
    const double length = rub.norm(), most = at.friction * held.push;
    if (most == 0) return out;
    const Matrix3d across = Matrix3d::Identity() - along;
    if (length <= most) {
      out.energy += length * length / (2 * k);
      out.force += rub;
      out.hessian += k * across;
    } else {
      const Vec3 u = rub / length;
      out.energy += most / k * (length - most / 2);
      out.force += most * u;
      out.hessian += k * most / length * (across - u * u.transpose());
    }
    return out;
  }

  /// The forces become what acts at p.x, if the gradient that is left is less; what has
  /// newly come inside is held from now on, at first by what its own inertia asks for. Whether a
  /// force changes by more than rounding.
  bool update_contacts(const Particles<double>& p, double h) {
    contacts_->find(p, touching_);
    acting_.clear();
    double change2 = 0;
    for (const TouchingVertex& at : touching_) {
      ContactForce& held = contacts_->force(at.vertex, at.collider);
      const Vec3 x = p.x[at.vertex];
      const double gap = at.gap(x);
      ContactForce now = held;
      if (!held.holds()) {
        held.push = now.push = std::max(0.0, -gap) / (p.w[at.vertex] * h * h);
        change2 += now.push * now.push;
      } else {
        const double k = contact_stiffness_[at.vertex];
        now.push = std::max(0.0, held.push - k * gap);
        now.rub -= k * at.slip(x);
        const double length = now.rub.norm(), most = at.friction * now.push;
        if (length > most) now.rub *= most / length;
        change2 += (at.total(now) - at.total(held)).squaredNorm();
      }
      acting_.push_back(now);
    }
    const double change = std::sqrt(change2);
    if (left_ <= kSettled * change)
      for (std::size_t c = 0; c < acting_.size(); ++c)
        contacts_->force(touching_[c].vertex, touching_[c].collider) = acting_[c];
    return change > enough_;
  }

  /// A cloth moves with its pins before anything drives it [m].
  Vec3 mean_way_of_pins(const Particles<double>& p) const {
    Vec3 sum = Vec3::Zero();
    int pins = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (hessian_.column(i) < 0) {
        sum += p.x[i] - p.previous[i];
        ++pins;
      }
    return pins > 0 ? Vec3(sum / pins) : sum;
  }

  /// p.x is x_t, of pins where they are at its end.
  void set_tolerances(const Particles<double>& p, double h) {
    double inertia2 = 0, rounding2 = 0;
    const Vec3 frame = mean_way_of_pins(p);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (hessian_.column(i) >= 0) {
        const double m = hessian_.mass(i) / (h * h);
        inertia2 += m * m * (y_[i] - p.x[i] - frame).squaredNorm();
        rounding2 += std::pow((stiffness_[i] + m) * p.x[i].cwiseAbs().maxCoeff(), 2);
      }
    enough_ = std::max(kTolerance * std::sqrt(inertia2),
                       std::numeric_limits<double>::epsilon() * std::sqrt(rounding2));
    enough_at_first_ = std::min(enough_, kFirstTolerance * std::sqrt(inertia2));
    for (std::size_t i = 0; i < contact_stiffness_.size(); ++i)
      if (p.w[i] > 0)
        contact_stiffness_[i] = kContactStiffness * (stiffness_[i] + 1 / (p.w[i] * h * h));
  }

  void linearise(const std::vector<Vec3>& x, bool clamped) {
    for (std::size_t j = 0; j < springs_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 d = x[b] - x[a];
      const double length = d.norm();
      if (length == 0) {
        hessian_.block(j) = {stiffness, 0, Vec3::UnitX()};
        continue;
      }
      const double across = 1 - rest / length;
      const double c = clamped ? std::max(0.0, across) : across;
      hessian_.block(j) = {stiffness * c, stiffness * (1 - c), d / length};
    }
    hessian_.clear_contacts();
    for (const TouchingVertex& at : touching_)
      hessian_.add_contact(at.vertex, augmented(at, x[at.vertex]).hessian);
  }

  double energy(const std::vector<Vec3>& x, double h) const {
    double sum = bending_energy(bending_, x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (hessian_.column(i) >= 0)
        sum += hessian_.mass(i) / (2 * h * h) * (x[i] - y_[i]).squaredNorm();
    for (const auto& [a, b, rest, stiffness] : springs_) {
      const double c = (x[b] - x[a]).norm() - rest;
      sum += stiffness / 2 * c * c;
    }
    for (const TouchingVertex& at : touching_) sum += augmented(at, x[at.vertex]).energy;
    return sum;
  }

  /// y - x of the vertices that move [m].
  Vector way_to_y(const std::vector<Vec3>& x) const {
    Vector way(hessian_.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0) way.segment<3>(c) = y_[i] - x[i];
    return way;
  }

  Vector gradient(const std::vector<Vec3>& x, double h) const {
    Vector g = elastic(x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0)
        g.segment<3>(c) += hessian_.mass(i) / (h * h) * (x[i] - y_[i]);
    return g;
  }

  /// The part of links, bending and contact.
  Vector elastic(const std::vector<Vec3>& x) const {
    Vector g = Vector::Zero(hessian_.size());
    for (const auto& [a, b, rest, stiffness] : springs_) {
      const Vec3 d = x[b] - x[a];
      const double length = d.norm();
      if (length == 0) continue;  // no direction to push in
      const Vec3 pull = stiffness * (length - rest) / length * d;
      if (hessian_.column(a) >= 0) g.segment<3>(hessian_.column(a)) -= pull;
      if (hessian_.column(b) >= 0) g.segment<3>(hessian_.column(b)) += pull;
    }
    for (const BendingElement& e : bending_) {
      const Vec3 pull = e.stiffness * e.value([&](std::size_t v) { return x[v]; });
      for (std::size_t i = 0; i < e.size; ++i)
        if (const int c = hessian_.column(to_index(e.vertex[i])); c >= 0)
          g.segment<3>(c) += e.weight[i] * pull;
    }
    for (const TouchingVertex& at : touching_)
      g.segment<3>(hessian_.column(at.vertex)) -= augmented(at, x[at.vertex]).force;
    return g;
  }

  std::vector<Vec3> moved(std::vector<Vec3> x, const Vector& direction, double step) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (const int c = hessian_.column(i); c >= 0) x[i] += step * direction.segment<3>(c);
    return x;
  }

  std::vector<Spring> springs_;
  std::vector<BendingElement> bending_;
  bool line_search_;
  int iterations_;
  enum class Integrator { euler, bdf2, midpoint } integrator_;
  Vec3 gravity_;                         ///< m/s^2
  std::vector<Vec3> before_, v_before_;  ///< m, m/s, a step ago, of bdf2; empty: there was none
  std::vector<Vec3> start_, v_start_;    ///< m, m/s, of this step; unless implicit Euler's
  std::vector<Vec3> pins_at_end_;        ///< [n] m, of midpoint
  std::vector<double> tension_;          ///< N, of springs, kept; empty: off
  double at_first_ = 0;                  ///< N/sqrt(kg), of |g| at the prediction
  bool keep_paused_ = false;
  Hessian hessian_;
  std::vector<double> stiffness_;          ///< N/m, of all links and bending at each vertex
  std::unique_ptr<Contacts> contacts_;     ///< null: none
  std::vector<TouchingVertex> touching_;   ///< of this iteration
  std::vector<ContactForce> acting_;       ///< [touching]
  double left_ = 0;                        ///< N, the gradient after the last Newton step
  std::vector<double> contact_stiffness_;  ///< [n] N/m, k; empty: no contact
  bool clamped_ = true, first_ = true;
  double enough_ = 0, enough_at_first_ = 0;  ///< N, of |g| in this substep
  Points<double> y_;                         ///< m, where they would go without links
  std::vector<Vec3> ended_at_;  ///< m, where nothing was left to do in this substep; empty: nowhere
};

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = unsupported_of_springs(scene, params);
  if (params.is("integrator", "euler")) return reasons;
  const std::string own = "integrator=" + std::string(params.choice("integrator"));
  if (!scene.colliders.empty() || (scene.self_collision && !params.is("self", "off")))
    reasons.push_back(own + " knows no contact: it would act at another time than the links");
  if (scene.wind) reasons.push_back(own + " knows no wind");
  if (scene.damping > 0) reasons.push_back(own + " knows no damping but its own");
  return reasons;
}

DeclaredStep declared_step(const Scene& scene, const Params& params) {
  DeclaredStep step = implicit_euler(scene, params);
  if (!params.is("integrator", "euler"))
    step.none = "it is a step of " +
                std::string(params.is("integrator", "bdf2") ? "BDF2" : "the midpoint rule");
  return step;
}

loop::Links<double> links(const loop::Setup& s) {
  return {.layout = Layout::packed(s.w.size()),
          .pass = std::make_unique<NewtonPass>(s),
          .bends = true,
          .contacts = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make<double>(scene, params, links);
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const std::size_t moving = to_index(scene.mesh.size()) - scene.pins.size();
  const ResolvedSettings own{
      {"links", describe_springs(scene, params)},
      {"links solved", std::string(params.is("integrator", "bdf2")       ? "BDF2"
                                   : params.is("integrator", "midpoint") ? "the midpoint rule"
                                                                         : "implicit Euler") +
                           " by Newton's method, " +
                           (params.is("multipliers", "keep") ? "tensions kept, " : "") +
                           (factors(params, moving) ? "sparse LDLT, analysed once as set-up"
                                                    : "conjugate gradients")},
      {"work unit", "Newton iterations, not projections"}};
  return loop::resolved_settings(scene, params, own, "constant terms of the Hessian",
                                 loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{"multipliers", "keep"}};

}  // namespace
}  // namespace taut::solver::implicit

TAUT_SOLVER(implicit) = {
    .name = "implicit",
    .title = "implicit Euler (Newton)",
    .summary = "Implicit Euler of springs, each step solved by Newton's method",
    .source = "Baraff, Witkin 1998; Choi, Ko 2002",
    .params = taut::solver::implicit::kParams,
    .make = taut::solver::implicit::make,
    .unsupported = taut::solver::implicit::unsupported,
    .resolved_settings = taut::solver::implicit::resolved_settings,
    .declared_step = taut::solver::implicit::declared_step,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .all_at_once = true,
                 .stiffness = taut::kStiffnesses,
                 .alternatives = taut::solver::implicit::kAlternatives,
                 .labelled = "substeps|iterations|structural|multipliers"}};
