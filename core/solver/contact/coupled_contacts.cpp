#include "core/solver/contact/coupled_contacts.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace taut {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Rounds at most; sweeps after them, and where they led nowhere.
constexpr int kRounds = 4, kSweeps = 2, kSweepsAlone = 30;
constexpr double kEnough = 1e-12;  ///< of coordinates, of gaps and slips
/// Beyond so many contacts a round, whose cost grows with their cube, is dearer than many
/// iterations of the links: then sweeps alone, a few an iteration, go on from the forces of the
/// last.
constexpr std::size_t kRoundsPay = 160;
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
  const int rounds = at.size() <= kRoundsPay ? kRounds : 0;
  for (int round = 0; round <= rounds; ++round) {
    double away = 0;
    bool same = round > 0;
    for (std::size_t c = 0; c < at.size(); ++c) {
      const Trial now = trial(c, x);
      same = same && now.state == trials[c].state;
      away = std::max(away, now.away);
      trials[c] = now;
    }
    if (away < best.away) {
      best = {away, round, {}, x, change};
      for (std::size_t c = 0; c < at.size(); ++c) best.forces.push_back(force(c));
    }
    if (away <= enough) return change;
    if (same || round == rounds) break;
    solve(trials, x, change);
  }
  for (std::size_t c = 0; c < at.size(); ++c) force(c) = best.forces[c];
  x = best.x;
  change = best.change;
  const int sweeps = rounds == 0 ? kSweepsOfMany : best.round > 0 ? kSweeps : kSweepsAlone;
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
  const double length = rub.norm(), most = at.friction * push;
  Trial out{State::sticking, Vec3::Zero(), 0};
  if (length > most) {
    out.state = State::sliding;
    out.direction = at.normal + at.friction / length * rub;
    rub *= most / length;
  }
  out.away = own * (at.total({push, rub}) - at.total(force)).norm();
  return out;
}

/// With G of the sticking S and the sliding L, whose forces are d f, and u what is without them:
///
///     G_SS F_S + G_SL d f = target_S - u_S,        n . (G_LS F_S + G_LL d f) = offset_L - n . u_L
void CoupledContacts::solve(const std::vector<Trial>& trials, Rows& x, Rows& change) {
  const MatrixXd& g = *compliance_;
  std::vector<std::size_t> sticking, sliding;
  std::vector<Index> s, l;
  Rows total = Rows::Zero(x.rows(), 3);
  for (std::size_t c = 0; c < at_.size(); ++c) {
    ContactForce& force = (*force_)(c);
    total.row(place_[c]) -= at_[c].total(force).transpose();
    if (trials[c].state == State::open) force = {};
    if (trials[c].state == State::sticking) {
      sticking.push_back(c);
      s.push_back(place_[c]);
    }
    if (trials[c].state == State::sliding) {
      sliding.push_back(c);
      l.push_back(place_[c]);
    }
  }
  const Rows free = x + g * total;
  // A vertex that two colliders hold has two forces, which its place does not tell apart.
  constexpr double kApart = 1e-9;
  Rows wanted(s.size(), 3);
  for (Index k = 0; k < wanted.rows(); ++k) {
    const TouchingVertex& at = at_[sticking[static_cast<std::size_t>(k)]];
    const Vec3 target = at.from - at.gap(at.from) * at.normal;
    wanted.row(k) = target.transpose() - free.row(s[static_cast<std::size_t>(k)]);
  }
  MatrixXd g_ss = part(g, s, s), g_ll = part(g, l, l);
  const MatrixXd g_sl = part(g, s, l);
  g_ss.diagonal() *= 1 + kApart;
  const Eigen::LLT<MatrixXd> stuck(g_ss);
  const MatrixXd across = stuck.solve(g_sl);  // G_SS^-1 G_SL
  g_ll -= g_sl.transpose() * across;
  const Rows pulled = across.transpose() * wanted;
  Eigen::VectorXd right(l.size());
  for (Index k = 0; k < right.size(); ++k) {
    const TouchingVertex& at = at_[sliding[static_cast<std::size_t>(k)]];
    right[k] = -at.gap((free.row(l[static_cast<std::size_t>(k)]) + pulled.row(k)).transpose());
    for (Index m = 0; m < right.size(); ++m)
      g_ll(k, m) *= at.normal.dot(trials[sliding[static_cast<std::size_t>(m)]].direction);
    g_ll(k, k) *= 1 + kApart;
  }
  const Eigen::VectorXd push = g_ll.partialPivLu().solve(right);
  Rows slides(l.size(), 3);
  for (Index k = 0; k < push.size(); ++k) {
    const std::size_t c = sliding[static_cast<std::size_t>(k)];
    ContactForce& force = (*force_)(c);
    force.push = std::max(0.0, push[k]);
    force.rub = force.push * (trials[c].direction - at_[c].normal);
    slides.row(k) = at_[c].total(force).transpose();
  }
  const Rows holds = stuck.solve(wanted) - across * slides;
  for (Index k = 0; k < holds.rows(); ++k) {
    const std::size_t c = sticking[static_cast<std::size_t>(k)];
    const Vec3 f = holds.row(k).transpose();
    ContactForce& force = (*force_)(c);
    force = {std::max(0.0, at_[c].normal.dot(f)), at_[c].across(f)};
    const double length = force.rub.norm(), most = at_[c].friction * force.push;
    if (length > most) force.rub *= most / length;
  }
  for (std::size_t c = 0; c < at_.size(); ++c)
    total.row(place_[c]) += at_[c].total((*force_)(c)).transpose();
  change += total;
  x += g * total;
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
