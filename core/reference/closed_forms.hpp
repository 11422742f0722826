#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <limits>
#include <vector>

#include "core/model/vec3.hpp"

/// Truths as code: closed forms, discrete identities and converged references in which no solver of
/// the testbed takes part. SI units throughout.

namespace taut::reference {

/// Period [s] of a pendulum of `length` [m] under g [m/s^2] released at rest at `amplitude` [rad]
/// in (0, pi): 2 pi sqrt(L/g) / AGM(1, cos(amplitude/2)) (Gauss).
double pendulum_period(double length, double g, double amplitude);

/// Time [s] at which the pendulum of pendulum_period() first passes its lowest point: a quarter of
/// the period.
inline double pendulum_quarter(double length, double g, double amplitude) {
  return pendulum_period(length, g, amplitude) / 4;
}

/// Positions [m] of the two unit masses of a double pendulum after t [s], released at rest. Both
/// links are 1 m long, g = 9.81 m/s^2, and the first mass hangs from the origin; angles [rad] are
/// from the downward vertical. Classical Runge-Kutta on the Lagrangian equations with `steps` equal
/// steps: error ~ steps^-4.
std::array<Vec3, 2> double_pendulum(std::array<double, 2> angles, double t, int steps = 20000);

/// Next angle per step [rad] of a stick that turns freely about a pivot, if the last angle per step
/// was phi, under Verlet with converged projection: tan(phi') = sin(phi) / (2 - cos(phi)).
double stick_next_angle(double phi);

/// Angular frequencies [rad/s], ascending, of small swings of n equal masses that hang on links of
/// length/n: sqrt(g/l xi), where xi are the roots of the Laguerre polynomial L_n (D. Bernoulli
/// 1733).
std::vector<double> hanging_chain_frequencies(int n, double length, double g);

/// Shape of mode `mode` (1 = lowest) of that chain, listed from the top: L_i(xi) of the i-th mass
/// counted from the free end, scaled to a largest value of 1. [n]
std::vector<double> hanging_chain_mode(int n, int mode);

/// Angular frequency [rad/s] of mode 1, 2, ... in the continuum limit of
/// hanging_chain_frequencies(): (j_0m / 2) sqrt(g/L).
double hanging_rope_frequency(int mode, double length, double g);

/// Angular frequencies [rad/s], ascending, of n masses m [kg] on springs K [N/m], with one end
/// fixed and the other free: 2 sqrt(K/m) sin((2j-1) pi / (2(2n+1))).
std::vector<double> spring_chain_frequencies(int n, double stiffness, double mass);

/// Largest eigenvalue times m/k of a flat nu x nu grid of equal masses and springs of equal
/// stiffness, with free edges, for motion in its plane. Explicit integrators without damping are
/// stable while dt < 2 sqrt(m/k) / sqrt(this). Power iteration to about 1e-6.
double spring_grid_eigenvalue(int nu, bool shear, bool bend);

/// Ratio of the tensions at both ends of a rope of links on the verge of slipping, which turns by
/// `wrap` [rad] in equal steps of `link` [rad] over a rough cylinder. Each node balances (T2 - T1)
/// cos(link/2) = mu (T1 + T2) sin(link/2). Tends to exp(mu wrap) in second order.
double capstan_ratio(double mu, double wrap, double link);

/// Ratio of the tensions as in capstan_ratio(), but the links touch the cylinder at their middles
/// and the nodes do not touch it. Each end takes half of a link's contact force, so tension and
/// push grow by r per node, r - 1/r = 2 mu sin(link). Tends to exp(mu wrap) in second order, from
/// below.
double capstan_ratio_of_links(double mu, double wrap, double link);

/// A chain of equal links between two supports of equal height, with an equal load at every joint.
struct Catenary {
  std::vector<double> x, y;     ///< [links + 1] m, from (0, 0) to (span, 0)
  std::vector<double> tension;  ///< [links] N
  double horizontal = 0;        ///< N, the same in every link
  double sag() const;           ///< m, depth of the lowest joint
};

/// The catenary with tan(theta_i) = (P/H)(i - (N+1)/2) and sum of l_i cos(theta_i) = span. H is a
/// root of a monotone function, found by bisection to the last bit. Links lengthen by T/stiffness;
/// infinite stiffness [N/m] = rods. Preconditions: links >= 2, load [N] > 0, 0 < span, and
/// span < links * link for rods.
Catenary discrete_catenary(int links, double span, double link, double load,
                           double stiffness = std::numeric_limits<double>::infinity());

/// Sag [m] of an inextensible rope of `length` over `span`: 2a sinh(span/2a) = length.
double continuum_sag(double length, double span);

/// Matrix of one relaxation sweep over the links of a chain of n equal free masses, whose first
/// link is fixed to a support. It acts on the links' strains [m]. Sweeps go from the top down
/// (gauss_seidel) or correct all links at once (jacobi); each correction is multiplied by omega. [n
/// x n]
enum class Sweep { gauss_seidel, jacobi };
Eigen::MatrixXd chain_sweep(int n, Sweep, double omega = 1);

/// Strain [m] of every link of the chain at rest, if each step lets the masses fall by a = g dt^2
/// [m] and then applies k sweeps G: e = (I - G^k)^-1 G^k a delta_1.
Eigen::VectorXd steady_strain(const Eigen::MatrixXd& sweep, int k, double a);

/// Largest of these strains in the limit of many links, Gauss-Seidel: (2a/n) sum over odd j of
/// 1 / (exp(j^2 pi^2 k / (4 n^2)) - 1).
double collapsed_strain(int n, int k, double a);

/// Spectral radius of a sweep over a chain of n links: cos^2(pi/2n) for Gauss-Seidel, cos(pi/2n)
/// for Jacobi.
double chain_radius(int n, Sweep);

/// Effect of k Gauss-Seidel sweeps on small sideways displacements of that chain hanging at rest.
/// It takes the place of (1 + w^2 dt^2)^-1 of an implicit step. Each correction acts along the
/// current direction of its link. [n x n]; a = g dt^2 [m], links of length l [m].
Eigen::MatrixXd transverse_sweeps(int n, int k, double a, double l);

/// Growth per step of a mode that k sweeps multiply by mu: the root of z^2 - 2 mu z + mu = 0 with
/// the larger modulus.
std::complex<double> verlet_root(double mu);

}  // namespace taut::reference
