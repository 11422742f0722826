#include "core/solver/global_system.hpp"

#include <Eigen/SparseCholesky>
#include <limits>

#include "core/solver/contact/coupled_contacts.hpp"

namespace taut {

namespace {

using Rows = CoupledContacts::Rows;
}  // namespace

struct GlobalSystem::Factor {
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> llt;
  Rows bends;  ///< N, of bending at y; empty: none
  Rows held;   ///< N, forces of contact in the last solution; empty: no contact

  /// Column r of the inverse [m/N].
  const Eigen::VectorXd& inverse_column(int r) {
    Eigen::VectorXd& column = inverse[to_index(r)];
    if (column.size() == 0)
      column = llt.solve(Eigen::VectorXd::Unit(static_cast<Eigen::Index>(inverse.size()), r));
    return column;
  }
  std::vector<Eigen::VectorXd> inverse;  ///< [rows] empty: not needed yet

  CoupledContacts coupled;
  /// What a force at each of these rows moves the others by [m/N].
  Eigen::MatrixXd compliance;
  std::vector<int> rows;
  void select_rows(const std::vector<int>& wanted) {
    if (wanted == rows) return;
    rows = wanted;
    coupled.compliance_changed();
    const auto n = static_cast<Eigen::Index>(rows.size());
    compliance.resize(n, n);
    for (Eigen::Index c = 0; c < n; ++c) {
      const Eigen::VectorXd& column = inverse_column(rows[static_cast<std::size_t>(c)]);
      for (Eigen::Index r = 0; r < n; ++r)
        compliance(r, c) = column[rows[static_cast<std::size_t>(r)]];
    }
  }
};

GlobalSystem::GlobalSystem(const loop::Setup& s, std::vector<Spring> springs)
    : springs_(std::move(springs)),
      bending_(make_bending(s.scene)),
      row_(s.w.size(), -1),
      contacts_(make_contacts(s.scene, s.params)),
      factor_(std::make_unique<Factor>()) {
  for (std::size_t i = 0; i < s.w.size(); ++i)
    if (s.w[i] > 0) {
      row_[i] = static_cast<int>(mass_.size());
      mass_.push_back(1 / s.w[i]);
    }
  factor(s.scene.dt / s.params.integer("substeps"));
}
GlobalSystem::~GlobalSystem() = default;

void GlobalSystem::restart() {
  if (contacts_) contacts_->restart();
}

void GlobalSystem::factor(double h) {
  factored_for_ = h;
  if (mass_.empty()) return;
  std::vector<Eigen::Triplet<double>> entries;
  for (int r = 0; r < static_cast<int>(mass_.size()); ++r)
    entries.emplace_back(r, r, mass_[to_index(r)] / (h * h));
  for (const auto& [a, b, rest, k] : springs_) {
    for (const int r : {row_[a], row_[b]})
      if (r >= 0) entries.emplace_back(r, r, k);
    if (row_[a] >= 0 && row_[b] >= 0)
      entries.emplace_back(std::max(row_[a], row_[b]), std::min(row_[a], row_[b]), -k);
  }
  for (const BendingElement& e : bending_)
    for (std::size_t i = 0; i < e.size; ++i)
      for (std::size_t j = 0; j < e.size; ++j) {
        const int row = row_[to_index(e.vertex[i])], column = row_[to_index(e.vertex[j])];
        if (row >= column && column >= 0)
          entries.emplace_back(row, column, e.stiffness * e.weight[i] * e.weight[j]);
      }
  const auto n = static_cast<Eigen::Index>(mass_.size());
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor_->llt.compute(matrix);
  factor_->inverse.assign(mass_.size(), {});
  factor_->rows.clear();
}

void GlobalSystem::begin(const Particles<double>& p, double t, double h) {
  if (h != factored_for_) factor(h);
  y_ = positions(p);
  if (contacts_) {
    contacts_->begin(t, h);
    contacts_->predict_new(p, h);
    factor_->coupled.begin();
  }
  if (bending_.empty()) return;
  auto& bends = factor_->bends;
  bends.setZero(static_cast<Eigen::Index>(mass_.size()), 3);
  for (const BendingElement& e : bending_) {
    const Vec3 pull = -e.stiffness * e.value([&](std::size_t v) { return y_[v]; });
    for (std::size_t i = 0; i < e.size; ++i)
      if (const int r = row_[to_index(e.vertex[i])]; r >= 0) bends.row(r) += e.weight[i] * pull;
  }
}

void GlobalSystem::solve(std::span<const Vec3> q, Particles<double>& p) {
  if (mass_.empty()) return;
  Rows right = factor_->bends;
  if (bending_.empty()) right.setZero(static_cast<Eigen::Index>(mass_.size()), 3);
  for (std::size_t j = 0; j < springs_.size(); ++j) {
    const auto& [a, b, rest, k] = springs_[j];
    const Vec3 pull = k * (q[j] - (y_[b] - y_[a]));
    if (row_[a] >= 0) right.row(row_[a]) -= pull;
    if (row_[b] >= 0) right.row(row_[b]) += pull;
  }
  if (contacts_) {
    contacts_->find(p, touching_);
    factor_->held.setZero(right.rows(), 3);
    for (const TouchingVertex& at : touching_)
      factor_->held.row(row_[at.vertex]) += at.total(contacts_->force(at.vertex, at.collider));
    right += factor_->held;
  }
  if (factor_->llt.info() == Eigen::Success)
    right = factor_->llt.solve(right).eval();
  else
    right.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < row_.size(); ++i)
    if (row_[i] >= 0) p.x.set(i, y_[i] + right.row(row_[i]).transpose());
  if (contacts_ && right.allFinite()) resolve_contacts(p);
}

/// p.x is the solution with the forces as they were.
void GlobalSystem::resolve_contacts(Particles<double>& p) {
  contacts_->find(p, touching_);
  if (touching_.empty()) return;
  std::vector<int> rows;  // of vertices; several contacts of one lie beside each other
  for (const TouchingVertex& at : touching_)
    if (rows.empty() || rows.back() != row_[at.vertex]) rows.push_back(row_[at.vertex]);
  factor_->select_rows(rows);
  const Eigen::MatrixXd& compliance = factor_->compliance;
  Rows x(compliance.rows(), 3), change(compliance.rows(), 3);
  std::vector<Eigen::Index> places;  // of each contact
  Eigen::Index place = -1;
  for (const TouchingVertex& at : touching_) {
    const int row = row_[at.vertex];
    if (place < 0 || rows[static_cast<std::size_t>(place)] != row) {
      ++place;
      x.row(place) = p.x[at.vertex].transpose();
      change.row(place) = -factor_->held.row(row);  // normals have turned since
    }
    change.row(place) += at.total(contacts_->force(at.vertex, at.collider));
    places.push_back(place);
  }
  x += compliance * change;
  change += factor_->coupled.resolve(
      compliance, touching_, places,
      [&](std::size_t c) -> ContactForce& {
        return contacts_->force(touching_[c].vertex, touching_[c].collider);
      },
      x);
  if (change.isZero(0)) return;
  Rows right = Rows::Zero(static_cast<Eigen::Index>(mass_.size()), 3);
  for (std::size_t c = 0; c < rows.size(); ++c)
    right.row(rows[c]) = change.row(static_cast<Eigen::Index>(c));
  right = factor_->llt.solve(right).eval();
  for (std::size_t i = 0; i < row_.size(); ++i)
    if (row_[i] >= 0) p.x.add(i, right.row(row_[i]).transpose());
}

std::size_t GlobalSystem::factor_entries() const {
  if (mass_.empty()) return 0;
  return static_cast<std::size_t>(factor_->llt.matrixL().nestedExpression().nonZeros());
}

std::vector<PassCost> GlobalSystem::cost(std::string_view local, std::size_t bytes) const {
  return {
      {.pass = std::string(local),
       .items = springs_.size(),
       .bytes = springs_.size() * sizeof(Spring) + bytes},
      {.pass = "global system, entries of its factor",
       .items = factor_entries(),
       .bytes = factor_entries() * (sizeof(double) + sizeof(int)) +
                mass_.size() * ((bending_.empty() ? 7 : 10) * sizeof(double) + 3 * sizeof(int)) +
                bending_.size() * sizeof(BendingElement)}};
}

}  // namespace taut
