#pragma once

#include <Eigen/Core>
#include <complex>

namespace taut::reference {

/// One relaxation sweep over the links of a chain of n equal free masses, the first link fixed to
/// a support, acting on the links' strains [m], from the top down (gauss_seidel) or all at once
/// (jacobi). Each correction is multiplied by omega. [n x n]
enum class Sweep { gauss_seidel, jacobi };
Eigen::MatrixXd chain_sweep(int n, Sweep, double omega = 1);

/// Strain [m] of every link of the chain at rest when each step lets the masses fall by
/// a = g dt^2 [m] and then applies k sweeps G: e = (I - G^k)^-1 G^k a delta_1.
Eigen::VectorXd steady_strain(const Eigen::MatrixXd& sweep, int k, double a);

/// The largest of these strains in the limit of many links, Gauss-Seidel:
/// (2a/n) sum over odd j of 1 / (exp(j^2 pi^2 k / (4 n^2)) - 1).
double collapsed_strain(int n, int k, double a);

/// Spectral radius of a Gauss-Seidel sweep, cos^2(pi/2n), and of a Jacobi sweep, cos(pi/2n): the
/// printed limits for a chain of n links.
double chain_radius(int n, Sweep);

/// What k Gauss-Seidel sweeps do to small sideways displacements of that chain hanging at rest, in
/// place of the implicit (1 + w^2 dt^2)^-1: each correction acts along its link as it lies at that
/// moment of the sweeps. [n x n]; a = g dt^2 [m], links of length l [m].
Eigen::MatrixXd transverse_sweeps(int n, int k, double a, double l);

/// Growth per step of a mode that k sweeps multiply by mu: the roots of z^2 - 2 mu z + mu = 0.
/// The one of larger modulus.
std::complex<double> verlet_root(double mu);

}  // namespace taut::reference
