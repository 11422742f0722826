#pragma once

#include <Eigen/Core>

// The one place for dense eigenvalues (Eigen's EigenSolver and SelfAdjointEigenSolver), which are
// slow to compile.

namespace taut::reference {

/// Eigenvalues of a general real matrix and, as columns in the same order, its eigenvectors.
struct Modes {
  Eigen::VectorXcd eigenvalues;
  Eigen::MatrixXcd eigenvectors;
};

/// Precondition: square and finite. Accuracy: that of the QR algorithm.
Modes modes(const Eigen::MatrixXd&);
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd&);

/// The largest |eigenvalue|.
double spectral_radius(const Eigen::MatrixXd&);

/// Eigenvalues, ascending, of the symmetric matrix with this diagonal and these values beside it.
Eigen::VectorXd tridiagonal_eigenvalues(const Eigen::VectorXd& diagonal,
                                        const Eigen::VectorXd& beside);

}  // namespace taut::reference
