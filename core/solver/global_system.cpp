#include "core/solver/global_system.hpp"

#include <Eigen/SparseCholesky>
#include <limits>

namespace taut {

struct GlobalSystem::Factor {
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> llt;
  Eigen::Matrix<double, Eigen::Dynamic, 3> bends;  ///< N, of bending at y; empty: none
};

GlobalSystem::GlobalSystem(std::vector<Spring> springs, std::vector<BendingElement> bending,
                           std::span<const double> w, double h)
    : springs_(std::move(springs)),
      bending_(std::move(bending)),
      row_(w.size(), -1),
      factor_(std::make_unique<Factor>()) {
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) row_[i] = static_cast<int>(mass_.size()), mass_.push_back(1 / w[i]);
  factor(h);
}
GlobalSystem::~GlobalSystem() = default;

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
}

void GlobalSystem::begin(const Particles<double>& p, double h) {
  if (h != factored_for_) factor(h);
  y_ = positions(p);
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
  Eigen::Matrix<double, Eigen::Dynamic, 3> right = factor_->bends;
  if (bending_.empty()) right.setZero(static_cast<Eigen::Index>(mass_.size()), 3);
  for (std::size_t j = 0; j < springs_.size(); ++j) {
    const auto& [a, b, rest, k] = springs_[j];
    const Vec3 pull = k * (q[j] - (y_[b] - y_[a]));
    if (row_[a] >= 0) right.row(row_[a]) -= pull;
    if (row_[b] >= 0) right.row(row_[b]) += pull;
  }
  if (factor_->llt.info() == Eigen::Success)
    right = factor_->llt.solve(right).eval();
  else
    right.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < row_.size(); ++i)
    if (row_[i] >= 0) p.x.set(i, y_[i] + right.row(row_[i]).transpose());
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
