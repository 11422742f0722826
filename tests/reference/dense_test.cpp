// Eigenvalues and linear systems of small matrices with known answers, reasons for refusing
// reference solutions, and the published listing.
#include "core/reference/dense.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/reference/closed_forms.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "core/reference/textbook.hpp"
#include "tests/support/cloths.hpp"

namespace taut::reference::dense_test {
namespace {

TEST(Dense, EigenvectorsAreTurnedIntoTheirMultiples) {
  Eigen::MatrixXd a(4, 4);  // a growing rotation, coupled with two real modes
  a << 1, -2, 0, 1, 3, 1, 0.5, 0, 0, 0, 5, 1, 0, 0, 0, -6;
  const Modes m = modes(a);
  double imaginary = 0;
  for (Eigen::Index k = 0; k < 4; ++k) {
    const Eigen::VectorXcd v = m.eigenvectors.col(k);
    EXPECT_NEAR(v.norm(), 1, 1e-12);
    EXPECT_LT((a * v - m.eigenvalues[k] * v).norm(), 1e-12) << k;
    imaginary = std::max(imaginary, m.eigenvalues[k].imag());
  }
  EXPECT_NEAR(imaginary, std::sqrt(6.0), 1e-12) << "1 +- i sqrt(2 3)";
  EXPECT_NEAR(spectral_radius(a), 6, 1e-12);
  EXPECT_NEAR(spectral_radius(a.topLeftCorner(2, 2)), std::sqrt(7.0), 1e-12);
  std::complex<double> sum = 0;
  for (const std::complex<double>& one : eigenvalues(a)) sum += one;
  EXPECT_LT(std::abs(sum - 1.0), 1e-12) << "the trace";
}

TEST(Dense, TridiagonalEigenvaluesAscend) {
  const int n = 6;
  const Eigen::VectorXd found = tridiagonal_eigenvalues(Eigen::VectorXd::Constant(n, 2),
                                                        Eigen::VectorXd::Constant(n - 1, -1));
  for (int j = 1; j <= n; ++j)
    EXPECT_NEAR(found[j - 1], 2 - 2 * std::cos(j * std::acos(-1.0) / (n + 1)), 1e-13);
  Eigen::MatrixXd a(3, 3);
  a << 0, 2, 1, 1, -1, 0, 3, 0, 4;
  const Eigen::VectorXd x = Eigen::Vector3d(1, -2, 5);
  EXPECT_LT((solve(a, a * x) - x).norm(), 1e-14);
  a.row(2) = a.row(0) + a.row(1);
  a.row(2).setZero();
  EXPECT_THROW(solve(a, x), std::runtime_error);
  try {
    solve(a, x);
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the matrix of a linear system is singular");
  }
}

Scene hung() {
  Scene scene = hanging_sheet(3, 3, {.structural = true});
  scene.pins = {0, 2};
  return scene;
}

using Change = std::function<void(Scene&)>;

TEST(ReferenceRefusals, OfTheStaticReferenceNameTheirReason) {
  const std::vector<std::pair<Change, std::string>> cases{
      {[](Scene& s) { s.colliders = {{.shape = Plane{}}}; },
       "contact: where the cloth comes to rest depends on its history"},
      {[](Scene& s) { s.self_collision = SelfCollision{0.1}; },
       "self-collision: it depends on its history"},
      {[](Scene& s) { s.wind = Wind{}; },
       "wind follows the faces: it has no potential to minimise"},
      {[](Scene& s) { s.links[0].family = Family::bend; },
       "bending links push: the sheet buckles, in more than one way"},
      {[](Scene& s) {
         s.bending = Bending{1, 1};
       },
       "bending: rods have none"},
      {[](Scene& s) {
         s.pin_motions = {{{0}, {.spin = {0, 0, 1}}}};
       },
       "the pins move"},
      {[](Scene& s) { s.gravity.setZero(); }, "without gravity nothing decides where it rests"},
      {[](Scene& s) { s.pins.clear(); }, "without pins it falls for ever"}};
  EXPECT_TRUE(refuse_static(hung()).empty());
  for (const auto& [change, reason] : cases) {
    Scene scene = hung();
    change(scene);
    EXPECT_EQ(refuse_static(scene), std::vector<std::string>{reason});
    const Equilibrium e = static_equilibrium(scene);
    EXPECT_FALSE(e.unique);
    EXPECT_EQ(e.reason, reason);
  }
  Scene still = hung();
  still.pin_motions = {{{0}, {}}};
  EXPECT_TRUE(refuse_static(still).empty());
}

TEST(ReferenceRefusals, OfTheDynamicReferenceNameTheirReason) {
  const std::vector<std::pair<Change, std::string>> cases{
      {[](Scene& s) { s.colliders = {{.shape = Plane{}}}; },
       "contact: impacts have no unique limit"},
      {[](Scene& s) { s.self_collision = SelfCollision{0.1}; },
       "self-collision: impacts have no unique limit"},
      {[](Scene& s) { s.links[0].family = Family::shear; },
       "rigid shear or bending links lock: J M^-1 J^T is singular in the plane"},
      {[](Scene& s) { s.links[0].family = Family::bend; },
       "rigid shear or bending links lock: J M^-1 J^T is singular in the plane"},
      {[](Scene& s) { s.start.x[8].y() -= 2e-6; },
       "a slack or stretched start is ill-posed: start on the constraints"},
      {[](Scene& s) { s.start.x[8].y() += 2e-6; },
       "a slack or stretched start is ill-posed: start on the constraints"}};
  EXPECT_TRUE(refuse_dynamic(hung()).empty());
  for (const auto& [change, reason] : cases) {
    Scene scene = hung();
    change(scene);
    EXPECT_EQ(refuse_dynamic(scene), std::vector<std::string>{reason});
    const Trajectory t = converged_motion(scene, {0.1}, 1.0 / 256);
    EXPECT_FALSE(t.unique);
    EXPECT_EQ(t.reason, reason);
    EXPECT_TRUE(t.states.empty());
  }
  Scene near = hung();
  near.start.x[8].y() -= 2e-7;
  EXPECT_TRUE(refuse_dynamic(near).empty()) << "within a millionth";
  Scene pinned = hung();
  pinned.pins = {0, 1, 2};
  pinned.links[0].rest *= 2;  // between pins: no placement can satisfy it
  EXPECT_TRUE(refuse_dynamic(pinned).empty());
  // The chain's lower end is far too heavy for the time step, so that the projection cannot
  // converge.
  EXPECT_EQ(converged_motion(hung(), {4}, 4).reason,
            "the projection does not converge: the constraints are redundant or dt is too long");
}

TEST(DenseSteps, EachConstraintIsProjectedByItsMasses) {
  Scene scene;
  scene.mesh.rest = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}};
  scene.mesh.mass = {1, 3, 1};
  scene.start = {{{0, 0, 0}, {2.5, 0, 0}, {2.5, 3, 0}}, std::vector<Vec3>(3, Vec3::Zero())};
  scene.pins = {2};
  scene.links = {{0, 1, 2}, {1, 2, 3}};
  scene.gravity.setZero();
  scene.dt = 0.5;
  Textbook<double> exact(scene, 1);
  EXPECT_EQ(exact.constraints(), 2u);
  exact.step();
  EXPECT_LT((exact.x()[0] - Vec3(0.375, 0, 0)).norm(), 1e-15) << "three quarters of the error";
  const Vec3 before(2.375, 0, 0), to_pin = Vec3(2.5, 3, 0) - before;
  EXPECT_LT((exact.x()[1] - (before + (to_pin.norm() - 3) * to_pin.normalized())).norm(), 1e-15);
  EXPECT_EQ(exact.x()[2], scene.start.x[2]);
  EXPECT_NEAR(exact.lambda()[0], 0.5 / (1 + 1.0 / 3), 1e-15);
  EXPECT_NEAR(exact.lambda()[1], (to_pin.norm() - 3) * 3, 1e-15);
  Textbook<double> without_root(scene, 1, false);
  without_root.sweep();
  EXPECT_NEAR(without_root.x()[0].x(), 2.5 * (2.5 * 2.5 - 4) / (2.5 * 2.5 + 4) * 0.75, 1e-15);
  Scene falls = scene;
  falls.links.clear();
  falls.gravity = {1, -2, 4};
  falls.damping = 2;
  falls.start.v[0] = {8, 0, 0};
  Textbook<double> free(falls, 3);
  free.step();
  EXPECT_LT((free.x()[0] - (Vec3(4 * std::exp(-1.0), 0, 0) + 0.25 * falls.gravity)).norm(), 1e-15);
}

TEST(Formulas, OfShapesAndSmallAngles) {
  const std::vector<double> w = spring_chain_frequencies(2, 9, 4);  // golden ratio over 1.5
  const double golden = (1 + std::sqrt(5.0)) / 2;
  EXPECT_NEAR(w[0], 1.5 / golden, 1e-12);
  EXPECT_NEAR(w[1], 1.5 * golden, 1e-12);
  const std::vector<double> shape = hanging_chain_mode(2, 1);  // w^2 = 2 (g/L)(2 - sqrt 2)
  EXPECT_NEAR(shape[1], 1, 1e-12) << "the free end";
  EXPECT_NEAR(shape[0], std::sqrt(2.0) - 1, 1e-12);
  EXPECT_NEAR(hanging_chain_mode(2, 2)[0], -1, 1e-12);
  EXPECT_NEAR(hanging_chain_mode(2, 2)[1], std::sqrt(2.0) - 1, 1e-12) << "to the other side";
  EXPECT_NEAR(stick_next_angle(std::acos(-1.0) / 2), std::atan(0.5), 1e-15);
  EXPECT_NEAR(capstan_ratio(0.3, 1, 1), (1 + 0.3 * std::tan(0.5)) / (1 - 0.3 * std::tan(0.5)),
              1e-14);
  EXPECT_NEAR(pendulum_quarter(1, 9.81, 1e-4) * 4, 2 * std::acos(-1.0) / std::sqrt(9.81), 1e-8);
  // Two elastic links: the joint hangs where their tensions carry its load.
  const Catenary c = discrete_catenary(2, 1.2, 1, 3, 10);
  const double t = c.tension[0], l = 1 + t / 10;
  EXPECT_NEAR(c.tension[1], t, 1e-12);
  EXPECT_NEAR(2 * t * c.sag() / l, 3, 1e-12);
  EXPECT_NEAR(std::hypot(0.6, c.sag()), l, 1e-12);
  EXPECT_NEAR(c.horizontal, t * 0.6 / l, 1e-12);
  EXPECT_NEAR(std::abs(verlet_root(0.5)), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(verlet_root(-1).real(), -1 - std::sqrt(2.0), 1e-15) << "the larger of both";
}

}  // namespace
}  // namespace taut::reference::dense_test
