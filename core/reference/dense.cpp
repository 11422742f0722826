#include "core/reference/dense.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace taut::reference {

namespace {

template <class Decomposition>
const Decomposition& converged(const Decomposition& decomposition) {
  if (decomposition.info() != Eigen::Success)
    throw NotComputable("the QR algorithm for eigenvalues does not converge");
  return decomposition;
}

}  // namespace

Modes modes(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  return {converged(solver).eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix, false);
  return converged(solver).eigenvalues();
}

double spectral_radius(const Eigen::MatrixXd& matrix) {
  return eigenvalues(matrix).cwiseAbs().maxCoeff();
}

Eigen::VectorXd tridiagonal_eigenvalues(const Eigen::VectorXd& diagonal,
                                        const Eigen::VectorXd& beside) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
  if (solver.info() == Eigen::Success) return solver.eigenvalues();
  // Eigen 3.4 treats an off-diagonal value as zero if its square is small beside the diagonal,
  // which depends on the unit. With large numbers it may never end, where the same matrix scaled
  // below 1 does.
  const double largest = diagonal.cwiseAbs().maxCoeff();
  solver.computeFromTridiagonal(diagonal / largest, beside / largest, Eigen::EigenvaluesOnly);
  return largest * converged(solver).eigenvalues();
}

Eigen::VectorXd solve(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(matrix);
  if ((factors.matrixLU().diagonal().array() == 0).any())
    throw NotComputable("the matrix of a linear system is singular");
  return factors.solve(right);
}

}  // namespace taut::reference
