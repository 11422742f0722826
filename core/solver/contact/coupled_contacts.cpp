#include "core/solver/contact/coupled_contacts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace taut {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Most rounds; sweeps after rounds that helped, and sweeps if no round did.
constexpr int kRounds = 4, kSweeps = 2, kSweepsAlone = 30;
constexpr double kEnough = 1e-12;  ///< tolerance of gaps and slips, as a share of coordinates
/// Beyond kMany contacts the factor of a matrix, which costs their cube, takes longer than many
/// iterations of the links. Then at most kFactors are made in a substep, and rounds that need
/// another are left out. Beyond kTooMany there are only sweeps, starting from the forces of the
/// last iteration. A cloth that lies on so many contacts does not come to rest completely
/// (results/benchmarks/contact-rests.md).
constexpr std::size_t kMany = 160, kTooMany = 700;
constexpr int kFactors = 16;
constexpr int kSweepsOfMany = 2;

MatrixXd part(const MatrixXd& matrix, const std::vector<Index>& rows,
              const std::vector<Index>& columns) {
  MatrixXd out(rows.size(), columns.size());
  for (Index c = 0; c < out.cols(); ++c)
    for (Index r = 0; r < out.rows(); ++r)
      out(r, c) = matrix(rows[static_cast<std::size_t>(r)], columns[static_cast<std::size_t>(c)]);
  return out;
}

}  // namespace

CoupledContacts::Rows CoupledContacts::resolve(
    const MatrixXd& compliance, std::span<const TouchingVertex> at, std::span<const Index> place,
    const std::function<ContactForce&(std::size_t)>& force, Rows& x) {
  compliance_ = &compliance;
  at_ = at;
  place_ = place;
  force_ = &force;
  Rows change = Rows::Zero(x.rows(), 3);
  std::vector<Trial> trials(at.size());
  const double enough = kEnough * x.cwiseAbs().maxCoeff();
  struct {
    double away = std::numeric_limits<double>::infinity();
    int round = 0;
    std::vector<ContactForce> forces;
    Rows x, change;
  } best;
  const bool many = at.size() > kMany;
  const int rounds = at.size() <= kTooMany ? kRounds : 0;
  for (int round = 0; round <= rounds; ++round) {
    double away = 0;
    bool same = round > 0;
    for (std::size_t c = 0; c < at.size(); ++c) {
      const Trial now = trial(c, x);
      same = same && now.state == trials[c].state;
      away = std::max(away, now.away);
      trials[c] = now;
    }
    if (round == 0 || away < best.away) {
      best = {away, round, {}, x, change};
      for (std::size_t c = 0; c < at.size(); ++c) best.forces.push_back(force(c));
    }
    if (away <= enough) return change;
    if (same || round == rounds) break;
    if (const Sets sets = sets_of(trials); !factored_ || sets != factored_->sets) {
      if (many && factored_in_substep_++ >= kFactors) break;
      factor(sets);
    }
    solve(trials, x, change);
  }
  for (std::size_t c = 0; c < at.size(); ++c) force(c) = best.forces[c];
  x = best.x;
  change = best.change;
  const int sweeps = many ? kSweepsOfMany : best.round > 0 ? kSweeps : kSweepsAlone;
  for (int n = 0; n < sweeps; ++n) sweep(x, change);
  return change;
}

CoupledContacts::Trial CoupledContacts::trial(std::size_t c, const Rows& x) const {
  const TouchingVertex& at = at_[c];
  const ContactForce& force = (*force_)(c);
  const Vec3 here = x.row(place_[c]).transpose();
  const double own = (*compliance_)(place_[c], place_[c]);
  const double push = force.push - at.gap(here) / own;
  if (push <= 0) return {State::open, Vec3::Zero(), own * at.total(force).norm()};
  if (at.friction == 0) return {State::sliding, at.normal, own * std::abs(push - force.push)};
  Vec3 rub = force.rub - at.slip(here) / own;
  const FrictionCone cone = at.cone(rub, push);
  Trial out{State::sticking, Vec3::Zero(), 0};
  if (!cone.sticks()) {
    out.state = State::sliding;
    out.direction = at.normal + at.friction / cone.length * rub;
    rub *= cone.share();
  }
  out.away = own * (at.total({push, rub}) - at.total(force)).norm();
  return out;
}

CoupledContacts::Sets CoupledContacts::sets_of(const std::vector<Trial>& trials) const {
  Sets sets;
  for (std::size_t c = 0; c < trials.size(); ++c) {
    if (trials[c].state == State::sticking) sets.sticking.push_back(place_[c]);
    if (trials[c].state != State::sliding) continue;
    sets.sliding.push_back(place_[c]);
    sets.normals.push_back(at_[c].normal);
    sets.directions.push_back(trials[c].direction);
  }
  return sets;
}

// The system for the forces F_S of the sticking contacts S and d f of the sliding contacts L, where
// u is x without these forces:
//
//     G_SS F_S + G_SL d f = target_S - u_S,        n . (G_LS F_S + G_LL d f) = offset_L - n . u_L

void CoupledContacts::factor(const Sets& sets) {
  const MatrixXd& g = *compliance_;
  MatrixXd g_ss = part(g, sets.sticking, sets.sticking), g_ll = part(g, sets.sliding, sets.sliding);
  const MatrixXd g_sl = part(g, sets.sticking, sets.sliding);
  // A vertex held by two colliders has two forces, which its position does not tell apart.
  constexpr double kApart = 1e-9;
  g_ss.diagonal() *= 1 + kApart;
  Eigen::LLT<MatrixXd> stuck(g_ss);
  MatrixXd across = stuck.solve(g_sl);
  g_ll -= g_sl.transpose() * across;
  for (Index k = 0; k < g_ll.rows(); ++k) {
    for (Index m = 0; m < g_ll.cols(); ++m)
      g_ll(k, m) *= sets.normals[static_cast<std::size_t>(k)].dot(
          sets.directions[static_cast<std::size_t>(m)]);
    g_ll(k, k) *= 1 + kApart;
  }
  factored_ = {sets, std::move(stuck), std::move(across), Eigen::PartialPivLU<MatrixXd>(g_ll)};
}

/// Solves with the factors of these trials' sets.
void CoupledContacts::solve(const std::vector<Trial>& trials, Rows& x, Rows& change) {
  const auto& [sets, stuck, across, slide] = *factored_;
  std::vector<std::size_t> sticking, sliding;
  Rows total = Rows::Zero(x.rows(), 3);
  for (std::size_t c = 0; c < at_.size(); ++c) {
    ContactForce& force = (*force_)(c);
    total.row(place_[c]) -= at_[c].total(force).transpose();
    if (trials[c].state == State::open) force = {};
    if (trials[c].state == State::sticking) sticking.push_back(c);
    if (trials[c].state == State::sliding) sliding.push_back(c);
  }
  const Rows free = x + *compliance_ * total;
  Rows wanted(sticking.size(), 3);
  for (Index k = 0; k < wanted.rows(); ++k) {
    const TouchingVertex& at = at_[sticking[static_cast<std::size_t>(k)]];
    const Vec3 target = at.from - at.gap(at.from) * at.normal;
    wanted.row(k) = target.transpose() - free.row(sets.sticking[static_cast<std::size_t>(k)]);
  }
  const Rows pulled = across.transpose() * wanted;
  Eigen::VectorXd right(sliding.size());
  for (Index k = 0; k < right.size(); ++k) {
    const Index place = sets.sliding[static_cast<std::size_t>(k)];
    right[k] = -at_[sliding[static_cast<std::size_t>(k)]].gap(
        (free.row(place) + pulled.row(k)).transpose());
  }
  const Eigen::VectorXd push = slide.solve(right);
  Rows slides(sliding.size(), 3);
  for (Index k = 0; k < push.size(); ++k) {
    const std::size_t c = sliding[static_cast<std::size_t>(k)];
    ContactForce& force = (*force_)(c);
    force.push = push[k];
    force.rub = force.push * (trials[c].direction - at_[c].normal);
    slides.row(k) = at_[c].total(force).transpose();
  }
  const Rows holds = stuck.solve(wanted) - across * slides;
  for (Index k = 0; k < holds.rows(); ++k) {
    const std::size_t c = sticking[static_cast<std::size_t>(k)];
    const Vec3 f = holds.row(k).transpose();
    ContactForce& force = (*force_)(c);
    force = {at_[c].normal.dot(f), at_[c].across(f)};
  }
  for (std::size_t c = 0; c < at_.size(); ++c)
    total.row(place_[c]) += at_[c].total((*force_)(c)).transpose();
  change += total;
  x += *compliance_ * total;
}

void CoupledContacts::sweep(Rows& x, Rows& change) {
  const MatrixXd& g = *compliance_;
  for (std::size_t c = 0; c < at_.size(); ++c) {
    const Index place = place_[c];
    Vec3 here = x.row(place).transpose();
    const Vec3 by = settle(at_[c], IsotropicCompliance{g(place, place)}, (*force_)(c), here);
    if (by.isZero(0)) continue;
    change.row(place) += by.transpose();
    for (Index axis = 0; axis < 3; ++axis) x.col(axis) += by[axis] * g.col(place);
  }
}

}  // namespace taut
