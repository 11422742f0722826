#include "core/reference/step_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/model/bending.hpp"
#include "core/model/collider.hpp"
#include "core/model/index.hpp"
#include "core/model/link_damping.hpp"
#include "core/model/membrane.hpp"
#include "core/model/wind.hpp"
#include "core/solver/panel_factor.hpp"

namespace taut::reference {

namespace {

using Points = std::vector<Vec3>;
using Eigen::Matrix3d;

/// K of rigid links, as a multiple of the largest m/h^2.
constexpr double kRigidHardness = 1e6;
/// Rounds in which the system is solved and the multipliers of rigid links are updated.
constexpr int kMultiplierRounds = 3;
/// Stiffness of contact at a vertex, as a multiple of all other stiffness there.
constexpr double kContactHardness = 1e4;
/// Largest gap at which a vertex counts as touching until it is pulled, as a share of the scene's
/// extent.
constexpr double kNearly = 1e-6;
/// Most steps of Newton's method: two, and more while the last one is not small.
constexpr int kMostSteps = 4;
/// Largest last step of an estimate that is believed, as a share of the sum.
constexpr double kBelieved = 0.3;
/// kSmall: a last step below this share of the sum ends the steps. kMostRatio: largest ratio of
/// successive steps that is extrapolated.
constexpr double kSmall = 0.1, kMostRatio = 0.8;
/// Largest steps of Newton's method that count as rounding, as a share of the scene's extent (RMS).
/// In contact they stay larger, because kNearly decides what touches and slips.
constexpr double kRounded = 1e-9, kRoundedInContact = 1e-5;
/// Number of times that a linear system is solved, to update the tensions and contact forces in it.
constexpr int kRounds = 2, kSecondRounds = 1, kRoundsInContact = 6, kSecondRoundsInContact = 4;

}  // namespace

class StepError::Work {
 public:
  Work(const Scene& scene, const Stiffness& stiffness)
      : scene_(scene),
        extent_(extent(scene)),
        bending_(make_bending(scene)),
        membrane_(make_membrane(scene, scene.dt)),
        column_(scene.mesh.mass.size(), kPin) {
    std::vector<bool> pinned(column_.size());
    for (const int pin : scene.pins) pinned[to_index(pin)] = true;
    for (std::size_t i = 0; i < column_.size(); ++i)
      if (!pinned[i]) {
        column_[i] = static_cast<int>(moving_.size());
        moving_.push_back(i);
      }
    for (const Link& l : scene.links)
      if (const double k = stiffness[static_cast<std::size_t>(l.family)];
          k > 0 && (column_[to_index(l.a)] >= 0 || column_[to_index(l.b)] >= 0))
        links_.push_back({.a = to_index(l.a),
                          .b = to_index(l.b),
                          .undamped = {l.rest, k},
                          .rest = l.rest,
                          .stiffness = k});
    analyse();
  }

  Estimate of(const State& from, double t, double h, const Points& answer) {
    begin(from, t, h);
    Points x = answer;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column_[i] < 0) x[i] = y_[i];
    const bool contact = !scene_.colliders.empty();
    const int first = contact ? kRoundsInContact : kRounds,
              next = contact ? kSecondRoundsInContact : kSecondRounds;
    Points all(moving_.size(), Vec3::Zero()), last;
    Estimate out;
    for (int k = 0; k < kMostSteps; ++k) {
      last = way_;
      if (!newton(x, k == 0 ? first : next)) return kNoEstimate;
      for (std::size_t i = 0; i < moving_.size(); ++i) {
        all[i] += way_[i];
        x[moving_[i]] += way_[i];
      }
      out = {rms(all), rms(way_), false};
      if (k > 0 && out.last <= kSmall * out.distance) break;
    }
    // Where steps shrink by a factor, as with slack links, sum the geometric series. Steps that
    // grow have no sum.
    double along = 0, square = 0;
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      along += way_[i].dot(last[i]);
      square += last[i].squaredNorm();
    }
    const double factor = square > 0 ? along / square : 0;
    const double ratio = factor < 1 ? std::clamp(factor, 0.0, kMostRatio) : 0;
    for (std::size_t i = 0; i < moving_.size(); ++i) all[i] += ratio / (1 - ratio) * way_[i];
    out.distance = rms(all);
    out.believed = out.last <= std::max(kBelieved * out.distance,
                                        extent_ * (contact ? kRoundedInContact : kRounded));
    return out;
  }

 private:
  static constexpr int kPin = -1;
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static constexpr Estimate kNoEstimate{kNone, kNone, false};

  struct Member {
    std::size_t a = 0, b = 0;
    struct {
      double rest = 0, stiffness = 0;
    } undamped;
    double rest = 0, stiffness = 0;  ///< m, N/m, in this step; infinite: rigid
    double tension = 0;              ///< N, from the last linear system
    double excess = 0, length = 0;   ///< m, at x
    Vec3 u = Vec3::Zero();           ///< unit vector at x
  };
  /// A vertex and a collider.
  struct Touch {
    enum class Kind { open, sticks, slips } kind = Kind::open;
    Vec3 normal = Vec3::Zero();
    double gap = 0;            ///< m, at x
    Vec3 slip = Vec3::Zero();  ///< m, at x: displacement since t tangential to the collider
    Vec3 rub = Vec3::Zero();   ///< N, friction on a vertex that slips
  };
  /// A block of 3 x 3 numbers in the matrix; null: one end is pinned.
  struct Block {
    double* first = nullptr;
    std::size_t stride = 0;
    double& operator()(int r, int c) const { return first[to_index(r) * stride + to_index(c)]; }
  };

  static double rms(const Points& ways) {
    double sum = 0;
    for (const Vec3& way : ways) sum += way.squaredNorm();
    return ways.empty() ? 0 : std::sqrt(sum / static_cast<double>(ways.size()));
  }

  void analyse() {
    std::vector<PanelFactor::Pair> pairs;
    const auto join = [&](std::size_t a, std::size_t b) {
      if (a != b && column_[a] >= 0 && column_[b] >= 0) pairs.push_back({column_[a], column_[b]});
    };
    for (const Member& l : links_) join(l.a, l.b);
    for (const BendingElement& e : bending_)
      for (std::size_t i = 0; i < e.size; ++i)
        for (std::size_t j = 0; j < i; ++j) join(to_index(e.vertex[i]), to_index(e.vertex[j]));
    for (const MembraneElement& e : membrane_.elements)
      for (std::size_t i = 0; i < 3; ++i)
        join(to_index(e.vertex[i]), to_index(e.vertex[(i + 1) % 3]));
    factor_ = PanelFactor(moving_.size(), pairs, 3, widest());
    rank_.resize(moving_.size());
    for (std::size_t k = 0; k < rank_.size(); ++k) rank_[to_index(factor_.order()[k])] = k;
    for (std::size_t i = 0; i < moving_.size(); ++i) diagonal_.push_back(block(i, i));
    for (const Member& l : links_)
      beside_.push_back(column_[l.a] >= 0 && column_[l.b] >= 0
                            ? block(to_index(column_[l.a]), to_index(column_[l.b]))
                            : Block{});
    for (const BendingElement& e : bending_)
      for (std::size_t i = 0; i < e.size; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
          const int a = column_[to_index(e.vertex[i])], b = column_[to_index(e.vertex[j])];
          if (a >= 0 && b >= 0)
            bent_.emplace_back(block(to_index(a), to_index(b)),
                               e.stiffness * e.weight[i] * e.weight[j]);
        }
  }
  Block block(std::size_t a, std::size_t b) {
    const auto [low, high] = std::minmax({rank_[a], rank_[b]});
    double* const first = factor_.at(high, low);
    return {first, static_cast<std::size_t>(factor_.at(high, low, 1) - first)};
  }

  /// Computes the step's prediction, pins and colliders.
  void begin(const State& from, double t, double h) {
    h_ = h;
    const double keep = std::exp(-scene_.damping * h);
    y_ = from.x;
    Points acceleration(y_.size(), scene_.gravity);
    if (scene_.wind)
      for (const auto& [a, b, c] : scene_.mesh.triangles) {
        const Vec3 mean = (from.v[to_index(a)] + from.v[to_index(b)] + from.v[to_index(c)]) / 3;
        const Vec3 corner = wind_on_corner(*scene_.wind, from.x[to_index(a)], from.x[to_index(b)],
                                           from.x[to_index(c)], mean);
        for (const int i : {a, b, c}) acceleration[to_index(i)] += corner / mass(to_index(i));
      }
    for (std::size_t i = 0; i < y_.size(); ++i)
      y_[i] = column_[i] < 0 ? pin_position(scene_, static_cast<int>(i), t + h)
                             : Vec3(from.x[i] + h * keep * from.v[i] + h * h * acceleration[i]);
    double heaviest = 0;
    for (const std::size_t i : moving_) heaviest = std::max(heaviest, mass(i));
    rigid_ = kRigidHardness * heaviest / (h * h);
    hardness_.assign(moving_.size(), 0);
    for (std::size_t k = 0; k < moving_.size(); ++k) hardness_[k] = mass(moving_[k]) / (h * h);
    const LinkDamping damping(scene_, h);
    for (Member& l : links_) {
      l.tension = 0;
      if (damping.on() && !is_rigid(l)) {
        l.rest = damping.rest(l.undamped.rest, (from.x[l.b] - from.x[l.a]).norm());
        l.stiffness = damping.stiffer() * l.undamped.stiffness;
      }
      for (const std::size_t v : {l.a, l.b})
        if (column_[v] >= 0) hardness_[to_index(column_[v])] += stiffness(l);
    }
    if (!membrane_.rests.empty()) {
      membrane_ = make_membrane(scene_, h);
      membrane_.begin([&](std::size_t v) { return from.x[v]; });
    }
    if (!membrane_.empty()) {
      std::vector<double> all(column_.size(), 0.0);
      membrane_.add_stiffness(all);
      for (std::size_t k = 0; k < moving_.size(); ++k) hardness_[k] += all[moving_[k]];
    }
    for (double& k : hardness_) k *= kContactHardness;
    shapes_.clear();
    carried_.clear();
    Points start;
    for (const std::size_t i : moving_) start.push_back(from.x[i]);
    for (const Collider& c : scene_.colliders) {
      shapes_.push_back(shape_at(c, t + h));
      const Points with_it = carried(c, t, h, start);
      carried_.insert(carried_.end(), with_it.begin(), with_it.end());
    }
    touches_.assign(carried_.size(), {});
    new_touches_ = true;
  }

  double mass(std::size_t vertex) const { return scene_.mesh.mass[vertex]; }
  bool is_rigid(const Member& l) const { return std::isinf(l.stiffness); }
  double stiffness(const Member& l) const { return is_rigid(l) ? rigid_ : l.stiffness; }

  /// Sets way_ to the displacement from x to the minimum of the model there. Returns false if there
  /// is no minimum.
  bool newton(const Points& x, int rounds) {
    for (Member& l : links_) {
      const Vec3 d = x[l.b] - x[l.a];
      l.length = d.norm();
      l.excess = l.length - l.rest;
      l.u = l.length > 0 ? Vec3(d / l.length) : Vec3(Vec3::Zero());
    }
    lay_planes(x);
    way_.assign(moving_.size(), Vec3::Zero());
    stretch_at(x, false);
    for (int round = 0; round < rounds; ++round) {
      fill();
      if (!factor_.factor()) {
        if (membrane_.empty()) return false;
        stretch_at(x, true);
        fill();
        if (!factor_.factor()) return false;
      }
      for (int k = 0; k < (any_rigid() ? kMultiplierRounds : 1); ++k) {
        solve(x);
        for (Member& l : links_) {
          const double stretch = l.excess + l.u.dot(way(l.b) - way(l.a));
          l.tension = (is_rigid(l) ? l.tension : 0) + stiffness(l) * stretch;
        }
      }
      for (const Vec3& p : way_)
        if (!p.allFinite()) return false;
      settle_contacts();
    }
    return true;
  }

  /// Sets the membrane's blocks to those at x.
  void stretch_at(const Points& x, bool positive) {
    stretched_.clear();
    for (const MembraneElement& e : membrane_.elements)
      membrane_.add_second(
          e, [&](std::size_t v) { return x[v]; }, positive,
          [&](std::size_t a, std::size_t b, const Matrix3d& part) {
            if (column_[a] < 0 || column_[b] < 0) return;
            const std::size_t i = to_index(column_[a]), j = to_index(column_[b]);
            stretched_.emplace_back(block(i, j),
                                    rank_[i] >= rank_[j] ? part : Matrix3d(part.transpose()));
          });
  }

  bool any_rigid() const {
    return std::ranges::any_of(links_, [this](const Member& l) { return is_rigid(l); });
  }
  Vec3 way(std::size_t vertex) const {
    return column_[vertex] < 0 ? Vec3(Vec3::Zero()) : way_[to_index(column_[vertex])];
  }

  /// Sets the surfaces' tangent planes to those at x.
  void lay_planes(const Points& x) {
    for (std::size_t c = 0; c < shapes_.size(); ++c)
      for (std::size_t k = 0; k < moving_.size(); ++k) {
        Touch& touch = touches_[c * moving_.size() + k];
        const Vec3& at = x[moving_[k]];
        const Surface s = surface(shapes_[c], at);
        touch.normal = s.normal;
        touch.gap = s.distance - scene_.thickness;
        const Vec3 way = at - carried_[c * moving_.size() + k];
        touch.slip = way - s.normal.dot(way) * s.normal;
        const double nearly = kNearly * extent_;
        if (new_touches_ && touch.gap <= nearly)
          touch.kind = touch.slip.norm() > nearly ? Touch::Kind::slips : engaged(c);
      }
    new_touches_ = false;
  }

  Touch::Kind engaged(std::size_t collider) const {
    return scene_.colliders[collider].friction > 0 ? Touch::Kind::sticks : Touch::Kind::slips;
  }
  /// Decides from the solution whether each vertex touches, and sticks or slips, and its friction.
  void settle_contacts() {
    for (std::size_t j = 0; j < touches_.size(); ++j) {
      const std::size_t k = j % moving_.size(), c = j / moving_.size();
      Touch& touch = touches_[j];
      const double gap = touch.gap + touch.normal.dot(way_[k]), push = -hardness_[k] * gap;
      if (!(push > 0)) {
        touch.kind = Touch::Kind::open;
        touch.rub.setZero();
        continue;
      }
      const double most = scene_.colliders[c].friction * push;
      const Vec3 slip = touch.slip + across(touch, way_[k]);
      if (touch.kind == Touch::Kind::open) {
        touch.kind = engaged(c);
      } else if (touch.kind == Touch::Kind::sticks) {
        if (const double length = hardness_[k] * slip.norm(); length > most) {
          touch.kind = Touch::Kind::slips;
          touch.rub = -most / length * hardness_[k] * slip;
        }
      } else if (most > 0) {
        if (touch.rub.dot(slip) > 0)
          touch.kind = Touch::Kind::sticks;
        else
          touch.rub = -most * slip.normalized();
      }
    }
  }
  static Vec3 across(const Touch& touch, const Vec3& p) {
    return p - touch.normal.dot(p) * touch.normal;
  }

  void add_diagonal(std::size_t k, const Matrix3d& part) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c <= r; ++c) diagonal_[k](r, c) += part(r, c);
  }
  void fill() {
    factor_.clear();
    for (std::size_t k = 0; k < moving_.size(); ++k)
      add_diagonal(k, mass(moving_[k]) / (h_ * h_) * Matrix3d::Identity());
    for (const auto& [at, k] : bent_)
      for (int c = 0; c < 3; ++c) at(c, c) += k;
    for (const auto& [at, part] : stretched_)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) at(r, c) += part(r, c);
    for (std::size_t j = 0; j < links_.size(); ++j) {
      const Member& l = links_[j];
      const Matrix3d along = l.u * l.u.transpose();
      const double across = l.length > 0 ? std::max(0.0, l.tension) / l.length : stiffness(l);
      const Matrix3d part = stiffness(l) * along + across * (Matrix3d::Identity() - along);
      for (const std::size_t v : {l.a, l.b})
        if (column_[v] >= 0) add_diagonal(to_index(column_[v]), part);
      if (const Block& at = beside_[j]; at.first)
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) at(r, c) -= part(r, c);
    }
    for (std::size_t j = 0; j < touches_.size(); ++j) {
      const std::size_t k = j % moving_.size();
      const Touch& touch = touches_[j];
      if (touch.kind == Touch::Kind::sticks)
        add_diagonal(k, hardness_[k] * Matrix3d::Identity());
      else if (touch.kind == Touch::Kind::slips)
        add_diagonal(k, hardness_[k] * touch.normal * touch.normal.transpose());
    }
  }

  /// Solves for way_, with tensions of rigid links updated by the stretch that the last solution
  /// left.
  void solve(const Points& x) {
    Points right(moving_.size());
    for (std::size_t k = 0; k < moving_.size(); ++k)
      right[k] = mass(moving_[k]) / (h_ * h_) * (y_[moving_[k]] - x[moving_[k]]);
    const auto push = [&](std::size_t vertex, const Vec3& force) {
      if (column_[vertex] >= 0) right[to_index(column_[vertex])] += force;
    };
    for (const Member& l : links_) {
      const double pull = (is_rigid(l) ? l.tension : 0) + stiffness(l) * l.excess;
      push(l.a, pull * l.u);
      push(l.b, -pull * l.u);
    }
    for (const BendingElement& e : bending_) {
      const Vec3 pull = e.stiffness * e.value([&](std::size_t v) { return x[v]; });
      for (std::size_t i = 0; i < e.size; ++i) push(to_index(e.vertex[i]), -e.weight[i] * pull);
    }
    for (const MembraneElement& e : membrane_.elements)
      membrane_.add_forces(
          e, [&](std::size_t v) { return x[v]; }, push);
    for (std::size_t j = 0; j < touches_.size(); ++j) {
      const std::size_t k = j % moving_.size();
      const Touch& touch = touches_[j];
      if (touch.kind == Touch::Kind::open) continue;
      right[k] -= hardness_[k] * touch.gap * touch.normal;
      if (touch.kind == Touch::Kind::sticks)
        right[k] -= hardness_[k] * touch.slip;
      else
        right[k] += touch.rub;
    }
    in_order_.resize(3 * moving_.size());
    for (std::size_t k = 0; k < moving_.size(); ++k)
      for (int c = 0; c < 3; ++c) in_order_[3 * rank_[k] + to_index(c)] = right[k][c];
    factor_.solve_one(in_order_.data());
    for (std::size_t k = 0; k < moving_.size(); ++k)
      for (int c = 0; c < 3; ++c) way_[k][c] = in_order_[3 * rank_[k] + to_index(c)];
  }

  const Scene& scene_;
  double extent_;  ///< m
  std::vector<BendingElement> bending_;
  MembraneModel membrane_;
  std::vector<int> column_;          ///< [n] index among the vertices that move
  std::vector<std::size_t> moving_;  ///< vertices that move
  std::vector<Member> links_;
  PanelFactor factor_;
  std::vector<std::size_t> rank_;               ///< [moving] rank in the order of elimination
  std::vector<Block> diagonal_, beside_;        ///< [moving], [links]
  std::vector<std::pair<Block, double>> bent_;  ///< bending [N/m] in each block, times the identity
  std::vector<std::pair<Block, Matrix3d>> stretched_;  ///< membrane [N/m] in each block
  std::vector<double> in_order_;
  double h_ = 0, rigid_ = 0;      ///< s, N/m
  std::vector<double> hardness_;  ///< [moving] N/m, stiffness of contact
  Points y_, way_;                ///< [n], [moving] m
  std::vector<taut::Shape> shapes_;
  /// [colliders][moving] m, positions if they moved with the collider.
  Points carried_;
  std::vector<Touch> touches_;  ///< [colliders][moving]
  bool new_touches_ = true;
};

StepError::StepError(const Scene& scene, const Stiffness& stiffness)
    : work_(std::make_unique<Work>(scene, stiffness)) {}
StepError::~StepError() = default;

StepError::Estimate StepError::of(const State& from, double t, double h,
                                  const std::vector<Vec3>& x) {
  return work_->of(from, t, h, x);
}

}  // namespace taut::reference
