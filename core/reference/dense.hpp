#pragma once

#include <Eigen/Core>

// The one place that instantiates Eigen's dense decompositions, which take long to compile.

namespace taut::reference {

/// Eigenvalues of a general real matrix and, as columns in the same order, its eigenvectors, each
/// of norm one.
struct Modes {
  Eigen::VectorXcd eigenvalues;
  Eigen::MatrixXcd eigenvectors;
};

/// Precondition: square and finite. Accuracy: that of the QR algorithm. Throws std::runtime_error
/// if that does not converge.
Modes modes(const Eigen::MatrixXd&);
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd&);

/// The largest |eigenvalue|.
double spectral_radius(const Eigen::MatrixXd&);

/// Eigenvalues, ascending, of the symmetric matrix with this diagonal and these values beside it.
Eigen::VectorXd tridiagonal_eigenvalues(const Eigen::VectorXd& diagonal,
                                        const Eigen::VectorXd& beside);

/// x of `matrix` x = `right`, by partial pivoting. Throws std::runtime_error if the
/// matrix is exactly singular.
Eigen::VectorXd solve(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

}  // namespace taut::reference
