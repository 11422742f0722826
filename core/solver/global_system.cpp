#include "core/solver/global_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/solver/contact/augmented_contacts.hpp"
#include "core/solver/contact/coupled_contacts.hpp"

namespace taut {

namespace {

using Rows = CoupledContacts::Rows;

constexpr double kSame = 1e-9;  ///< tolerance for equal normals, and for equal offsets [m]

/// Orders TouchingVertex by vertex.
struct Before {
  static int vertex(const TouchingVertex& at) { return static_cast<int>(at.vertex); }
  bool operator()(const TouchingVertex& at, int v) const { return vertex(at) < v; }
  bool operator()(int v, const TouchingVertex& at) const { return v < vertex(at); }
};

/// The unknown of each vertex: the vertices that move are numbered; -1: a pin.
std::vector<int> unknown_of_vertices(std::span<const double> w) {
  std::vector<int> unknown(w.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) unknown[i] = next++;
  return unknown;
}

PanelFactor make_factor(std::span<const double> w, const std::vector<Spring>& springs,
                        const std::vector<BendingElement>& bending, const MembraneModel& membrane,
                        Simd simd) {
  const std::vector<int> unknown = unknown_of_vertices(w);
  std::vector<PanelFactor::Pair> pairs;
  const auto add = [&](std::size_t a, std::size_t b) {
    if (unknown[a] >= 0 && unknown[b] >= 0) pairs.push_back({unknown[a], unknown[b]});
  };
  for (const Spring& s : springs) add(s.a, s.b);
  for (const BendingElement& e : bending)
    for (std::size_t i = 0; i < e.size; ++i)
      for (std::size_t j = 0; j < i; ++j) add(to_index(e.vertex[i]), to_index(e.vertex[j]));
  for (const MembraneElement& e : membrane.elements)
    for (std::size_t i = 0; i < 3; ++i) add(to_index(e.vertex[i]), to_index(e.vertex[(i + 1) % 3]));
  const auto moving =
      static_cast<std::size_t>(std::ranges::count_if(w, [](double m) { return m > 0; }));
  return PanelFactor(moving, pairs, 1, simd);
}

/// Vertices in the order of elimination.
std::vector<int> vertices_in_order(const PanelFactor& factor, std::span<const double> w) {
  std::vector<int> moving, order;
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) moving.push_back(static_cast<int>(i));
  for (const int unknown : factor.order()) order.push_back(moving[to_index(unknown)]);
  return order;
}

}  // namespace

template <class Real>
struct GlobalSystem<Real>::Contact {
  std::unique_ptr<Contacts> contacts;
  /// Contacts of this iteration: those of vertices, then of pieces.
  std::vector<TouchingVertex> touching;
  std::size_t vertices = 0;  ///< number of contacts of vertices in `touching`
  TouchingPieces pieces{.solved = true};
  /// Pieces that the contacts of their corners do not hold off.
  std::vector<TouchingPiece*> solved;
  using Corners = std::vector<std::pair<Eigen::Index, double>>;
  std::vector<Corners> places;  ///< [touching] where its corners are in `rows`, and their weights
  std::vector<Vec3> pinned;     ///< [touching] m, what pinned corners add to its position
  std::vector<Eigen::Index> place_of_row;
  Rows held;  ///< N, contact forces in the last solution
  CoupledContacts coupled;
  /// [rows] columns of the inverse [m/N]; empty: not needed yet.
  std::vector<Eigen::VectorXd> inverse;
  /// Displacement of each of `rows` per force at each of them [m/N].
  Eigen::MatrixXd compliance;
  std::vector<int> rows;

  void forget(std::size_t n) {
    inverse.assign(n, {});
    rows.clear();
  }

  template <class P>
  void find(const P& p) {
    contacts->find(p, touching);
    vertices = touching.size();
    solved.clear();
    for (TouchingPiece& piece : pieces.all) {
      if (is_kept_out_by_corners(piece)) {
        piece.force = {};
        continue;
      }
      solved.push_back(&piece);
      touching.push_back(piece.at);
    }
  }
  /// Whether all corners touch the same flat part of the collider as the piece, and so hold it off.
  bool is_kept_out_by_corners(const TouchingPiece& piece) const {
    const auto at_plane = [&](int corner) {
      const auto [first, last] = std::equal_range(
          touching.begin(), touching.begin() + static_cast<std::ptrdiff_t>(vertices), corner,
          Before{});
      return std::any_of(first, last, [&](const TouchingVertex& at) {
        return (at.normal - piece.at.normal).squaredNorm() < kSame * kSame &&
               std::abs(at.offset - piece.at.offset) < kSame;
      });
    };
    for (std::size_t k = 0; k < 3; ++k)
      if (piece.weights[static_cast<Eigen::Index>(k)] != 0 && !at_plane(piece.corners[k]))
        return false;
    return true;
  }
  ContactForce& force(std::size_t c) {
    if (c >= vertices) return solved[c - vertices]->force;
    return contacts->force(touching[c].vertex, touching[c].collider);
  }
  /// Calls f(vertex, weight) for the corners of contact c, whose position is their weighted sum.
  template <class F>
  void each_corner(std::size_t c, const F& f) const {
    if (c < vertices) return f(touching[c].vertex, 1.0);
    const TouchingPiece& piece = *solved[c - vertices];
    for (std::size_t k = 0; k < 3; ++k)
      if (const double weight = piece.weights[static_cast<Eigen::Index>(k)]; weight != 0)
        f(to_index(piece.corners[k]), weight);
  }

  /// Returns the rows of all moving vertices in contact, and sets `places` accordingly.
  template <class P>
  std::vector<int> find_places(const P& p, const std::vector<int>& row_of) {
    std::vector<int> found;
    place_of_row.assign(inverse.size(), -1);
    places.assign(touching.size(), {});
    pinned.assign(touching.size(), Vec3::Zero());
    for (std::size_t c = 0; c < touching.size(); ++c)
      each_corner(c, [&](std::size_t vertex, double weight) {
        const int row = row_of[vertex];
        if (row < 0) {
          pinned[c] += weight * p.x[vertex].template cast<double>();
          return;
        }
        Eigen::Index& place = place_of_row[to_index(row)];
        if (place < 0) {
          place = static_cast<Eigen::Index>(found.size());
          found.push_back(row);
        }
        places[c].emplace_back(place, weight);
      });
    return found;
  }

  /// CoupledContacts::resolve() for contacts of vertices only. x: positions of the rows.
  Rows resolve_vertices(Rows& x) {
    std::vector<Eigen::Index> place;
    for (const Corners& at : places) place.push_back(at.front().first);
    return coupled.resolve(
        compliance, touching, place, [this](std::size_t c) -> ContactForce& { return force(c); },
        x);
  }
  /// CoupledContacts::resolve() where pieces touch, too: a force at a piece acts on its corners by
  /// their weights.
  Rows resolve_all(const Rows& x) {
    const auto n = static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd between = Eigen::MatrixXd::Zero(n, n);
    Rows at = Rows::Zero(n, 3);
    std::vector<Eigen::Index> place;
    for (Eigen::Index c = 0; c < n; ++c) {
      place.push_back(c);
      at.row(c) = pinned[static_cast<std::size_t>(c)].transpose();
      for (const auto& [i, wi] : places[static_cast<std::size_t>(c)]) {
        at.row(c) += wi * x.row(i);
        for (Eigen::Index d = 0; d < n; ++d)
          for (const auto& [j, wj] : places[static_cast<std::size_t>(d)])
            between(d, c) += wi * wj * compliance(j, i);
      }
    }
    coupled.compliance_changed();
    const Rows by = coupled.resolve(
        between, touching, place, [this](std::size_t c) -> ContactForce& { return force(c); }, at);
    coupled.compliance_changed();
    Rows change = Rows::Zero(x.rows(), 3);
    for (Eigen::Index c = 0; c < n; ++c)
      for (const auto& [i, wi] : places[static_cast<std::size_t>(c)])
        change.row(i) += wi * by.row(c);
    return change;
  }

  /// Solves for the missing columns of the inverse, four at a time.
  void find_columns(const PanelFactor& factor, const std::vector<int>& wanted) {
    std::vector<int> missing;
    for (const int r : wanted)
      if (inverse[to_index(r)].size() == 0) missing.push_back(r);
    const std::size_t n = inverse.size();
    std::vector<double, CacheLineAllocator<double>> four;
    for (std::size_t first = 0; first < missing.size(); first += 4) {
      const std::size_t count = std::min<std::size_t>(4, missing.size() - first);
      four.assign(4 * n, 0.0);
      for (std::size_t k = 0; k < count; ++k) four[4 * to_index(missing[first + k]) + k] = 1;
      factor.solve_four(four.data());
      for (std::size_t k = 0; k < count; ++k) {
        Eigen::VectorXd& column = inverse[to_index(missing[first + k])];
        column.resize(static_cast<Eigen::Index>(n));
        for (std::size_t i = 0; i < n; ++i) column[static_cast<Eigen::Index>(i)] = four[4 * i + k];
      }
    }
  }

  void select_rows(const PanelFactor& factor, const std::vector<int>& wanted) {
    if (wanted == rows) return;
    find_columns(factor, wanted);
    coupled.compliance_changed();
    // Few rows are new: the others are copied, since each entry of a long column is a cache miss.
    std::vector<Eigen::Index> was_at(inverse.size(), -1), from;
    for (std::size_t r = 0; r < rows.size(); ++r)
      was_at[to_index(rows[r])] = static_cast<Eigen::Index>(r);
    for (const int row : wanted) from.push_back(was_at[to_index(row)]);
    const Eigen::MatrixXd before = std::move(compliance);
    const auto n = static_cast<Eigen::Index>(wanted.size());
    compliance.resize(n, n);
    for (Eigen::Index c = 0; c < n; ++c) {
      const auto at = static_cast<std::size_t>(c);
      const Eigen::VectorXd& column = inverse[to_index(wanted[at])];
      for (Eigen::Index r = 0; r < n; ++r) {
        const auto other = static_cast<std::size_t>(r);
        const bool known = from[at] >= 0 && from[other] >= 0;
        compliance(r, c) = known ? before(from[other], from[at]) : column[wanted[other]];
      }
    }
    rows = wanted;
  }
};

template <class Real>
GlobalSystem<Real>::GlobalSystem(const loop::Setup& s, std::vector<Spring> springs)
    : springs_(std::move(springs)),
      bending_(make_bending(s.scene)),
      membrane_(make_membrane(s.scene)),
      ends_(ends_of(springs_, s.w.size())),
      factor_(make_factor(s.w, springs_, bending_, membrane_, s.simd)),
      groups_(ends_, vertices_in_order(factor_, s.w), s.w),
      row_(s.w.size(), -1),
      pool_(s.pool) {
  const std::vector<int> order = vertices_in_order(factor_, s.w);
  for (const int v : order) {
    row_[to_index(v)] = static_cast<int>(mass_.size());
    mass_.push_back(1 / s.w[to_index(v)]);
  }
  const auto layout = std::make_shared<const Layout>(groups_.layout());
  y_ = Points<Real>(layout);
  rows_ = Points<double>(layout);
  if (auto contacts = make_contacts(s.scene, s.params)) {
    contact_ = std::make_unique<Contact>();
    contact_->contacts = std::move(contacts);
  }
  factor(s.scene.dt / s.params.integer("substeps"));
}
template <class Real>
GlobalSystem<Real>::~GlobalSystem() = default;

template <class Real>
TouchingPieces* GlobalSystem<Real>::touching_pieces() {
  return contact_ ? &contact_->pieces : nullptr;
}

template <class Real>
void GlobalSystem<Real>::restart() {
  if (contact_) contact_->contacts->restart();
}

template <class Real>
void GlobalSystem<Real>::take_over(const GlobalSystem& before) {
  if (contact_) contact_->contacts->take_over(*before.contact_->contacts);
}

template <class Real>
void GlobalSystem<Real>::factor(double h) {
  factored_for_ = h;
  inertia_.assign(groups_.size() * kLanes, Real(0));
  factor_.clear();
  for (std::size_t r = 0; r < mass_.size(); ++r) {
    inertia_[r] = static_cast<Real>(mass_[r] / (h * h));  // all groups but the last are full
    *factor_.at(r, r) = mass_[r] / (h * h);
  }
  const auto add = [&](int row, int column, double k) {
    if (row >= column && column >= 0) *factor_.at(to_index(row), to_index(column)) += k;
  };
  for (const auto& [a, b, rest, k] : springs_) {
    add(row_[a], row_[a], k);
    add(row_[b], row_[b], k);
    add(std::max(row_[a], row_[b]), std::min(row_[a], row_[b]), -k);
  }
  for (const BendingElement& e : bending_)
    for (std::size_t i = 0; i < e.size; ++i)
      for (std::size_t j = 0; j < e.size; ++j)
        add(row_[to_index(e.vertex[i])], row_[to_index(e.vertex[j])],
            e.stiffness * e.weight[i] * e.weight[j]);
  for (const MembraneElement& e : membrane_.elements)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        add(row_[to_index(e.vertex[i])], row_[to_index(e.vertex[j])],
            e.area * membrane_.law.stiffest() * e.gradient[i].dot(e.gradient[j]));
  positive_ = factor_.factor();
  if (contact_) contact_->forget(mass_.size());
}

template <class Real>
void GlobalSystem<Real>::begin(const Particles<Real>& p, double t, double h) {
  if (h != factored_for_) factor(h);
  y_ = p.x;
  if (!contact_) return;
  contact_->contacts->begin(t, h);
  contact_->contacts->predict_new(p, h);
  contact_->coupled.begin();
}

/// Adds bending and membrane to rows_, which holds the forces of inertia and links.
template <class Real>
void GlobalSystem<Real>::add_surface(const Particles<Real>& p) {
  for (const BendingElement& e : bending_) {
    const Vec3 pull =
        -e.stiffness * e.value([&](std::size_t v) { return p.x[v]; }).template cast<double>();
    for (std::size_t i = 0; i < e.size; ++i) rows_.add(to_index(e.vertex[i]), e.weight[i] * pull);
  }
  for (const MembraneElement& e : membrane_.elements)
    membrane_.add_forces(
        e, [&](std::size_t v) { return p.x[v]; },
        [&](std::size_t v, const Vec3& force) { rows_.add(v, force); });
}

template <class Real>
void GlobalSystem<Real>::solve_forces(std::span<double> forces) {
  if (mass_.empty()) return;
  if (!positive_) {
    std::ranges::fill(forces, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  factor_.solve_four(forces.data());
}

/// Moves p.x to the solution. rows_ holds the forces of inertia and links; adds bending,
/// membrane and contact.
template <class Real>
void GlobalSystem<Real>::solve_rows(Particles<Real>& p) {
  if (mass_.empty()) return;
  add_surface(p);
  if (contact_) {
    contact_->find(p);
    contact_->held.setZero(static_cast<Eigen::Index>(mass_.size()), 3);
    for (std::size_t c = 0; c < contact_->touching.size(); ++c) {
      const Vec3 force = contact_->touching[c].total(contact_->force(c));
      contact_->each_corner(c, [&](std::size_t vertex, double weight) {
        if (row_[vertex] < 0) return;
        contact_->held.row(row_[vertex]) += weight * force;
        rows_.add(vertex, weight * force);
      });
    }
  }
  if (!positive_) {
    rows_.fill(std::numeric_limits<double>::quiet_NaN());
    move(p);
    return;
  }
  factor_.solve_four(rows_.data());
  move(p);
  const std::span<const double> all(rows_.data(), 4 * mass_.size());
  if (contact_ && std::ranges::all_of(all, [](double x) { return std::isfinite(x); }))
    resolve_contacts(p);
}

/// Moves the vertices by rows_ [m].
template <class Real>
void GlobalSystem<Real>::move(Particles<Real>& p) {
  Real* const x = p.x.data();
  const double* const by = rows_.data();
  for (std::size_t i = 0; i < 4 * mass_.size(); ++i) x[i] += static_cast<Real>(by[i]);
}

/// Corrects p.x, the solution with the last contact forces, by the change of these forces.
template <class Real>
void GlobalSystem<Real>::resolve_contacts(Particles<Real>& p) {
  Contact& contact = *contact_;
  contact.find(p);
  if (contact.touching.empty()) return;
  contact.select_rows(factor_, contact.find_places(p, row_));
  const std::vector<int>& rows = contact.rows;
  const Eigen::MatrixXd& compliance = contact.compliance;
  Rows x(compliance.rows(), 3), change(compliance.rows(), 3);
  for (Eigen::Index r = 0; r < x.rows(); ++r) {
    const int row = rows[static_cast<std::size_t>(r)];
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      x(r, axis) =
          static_cast<double>(p.x.data()[4 * to_index(row) + static_cast<std::size_t>(axis)]);
    change.row(r) = -contact.held.row(row);  // normals have turned since
  }
  for (std::size_t c = 0; c < contact.touching.size(); ++c)
    for (const auto& [place, weight] : contact.places[c])
      change.row(place) += weight * contact.touching[c].total(contact.force(c)).transpose();
  x += compliance * change;
  change += contact.solved.empty() ? contact.resolve_vertices(x) : contact.resolve_all(x);
  if (change.isZero(0)) return;
  rows_.fill(0);
  for (std::size_t c = 0; c < rows.size(); ++c)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      rows_.data()[4 * to_index(rows[c]) + static_cast<std::size_t>(axis)] =
          change(static_cast<Eigen::Index>(c), axis);
  factor_.solve_four(rows_.data());
  move(p);
}

template <class Real>
std::vector<PassCost> GlobalSystem<Real>::cost(std::string_view local, std::size_t bytes) const {
  std::vector<PassCost> costs{
      {.pass = std::string(local),
       .items = springs_.size(),
       .bytes = springs_.size() * sizeof(Spring) + bytes},
      {.pass = "global system, entries of its factor",
       .items = factor_.entries(),
       .bytes = factor_.bytes() + groups_.bytes() + y_.bytes() + rows_.bytes() +
                inertia_.size() * sizeof(Real) + mass_.size() * sizeof(double) +
                row_.size() * sizeof(int) + bending_.size() * sizeof(BendingElement)}};
  if (!membrane_.empty())
    costs.push_back({.pass = "rotations of the membrane",
                     .items = membrane_.elements.size(),
                     .bytes = membrane_.bytes()});
  return costs;
}

template class GlobalSystem<float>;
template class GlobalSystem<double>;

}  // namespace taut
