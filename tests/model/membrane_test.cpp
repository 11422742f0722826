// The element of a membrane: its energy against closed forms, its derivatives against differences
// of that energy.
#include "core/model/membrane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "tests/support/cloths.hpp"

namespace taut::membrane_test {
namespace {

const Membrane kStvk{.warp = 1200, .weft = 800, .poisson = 0.4, .shear = 350};
const Membrane kArap{.law = Membrane::Law::arap, .warp = 500, .weft = 500, .shear = 250};

Deformation columns(const Vec3& f1, const Vec3& f2) {
  Deformation f;
  f << f1, f2;
  return f;
}

/// Some deformations: stretched, squeezed, sheared, turned over.
std::vector<Deformation> some() {
  return {columns({1.2, 0.1, -0.3}, {0.2, 0.9, 0.4}), columns({0.5, 0.2, 0.1}, {-0.1, 0.7, 0.2}),
          columns({1, 0, 0.2}, {0.6, 1.4, 0}), columns({-0.8, 0.1, 0.3}, {0.1, 1.1, -0.2})};
}

template <class Visit>
void each_case(const Visit& visit) {
  for (const Membrane& membrane : {kStvk, kArap})
    for (const Deformation& f : some()) visit(MembraneLaw(membrane), f);
}

TEST(Membrane, StressIsTheDerivativeOfTheEnergy) {
  each_case([](const MembraneLaw& law, const Deformation& f) {
    for (int k = 0; k < 6; ++k) {
      const auto moved = [&](double by) {
        Deformation g = f;
        g(k % 3, k / 3) += by;
        return law.energy(g);
      };
      const double h = 1e-5, slope = (moved(h) - moved(-h)) / (2 * h);
      EXPECT_NEAR(law.stress(f)(k % 3, k / 3), slope, 1e-5) << k;
    }
  });
}

Eigen::Matrix<double, 6, 6> matrix_of(const MembraneLaw::Second& s) {
  Eigen::Matrix<double, 6, 6> all;
  all << s.of11, s.of12, s.of12.transpose(), s.of22;
  return all;
}

TEST(Membrane, SecondDerivativeIsThatOfTheStress) {
  each_case([](const MembraneLaw& law, const Deformation& f) {
    const Eigen::Matrix<double, 6, 6> all = matrix_of(law.second(f, false));
    for (int k = 0; k < 6; ++k) {
      const auto moved = [&](double by) {
        Deformation g = f;
        g(k % 3, k / 3) += by;
        return law.stress(g);
      };
      const Deformation slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(all(i, k), slope(i % 3, i / 3), 2e-4) << i << k;
    }
  });
}

TEST(Membrane, ItsPositivePartHasNoNegativeEigenvalueAndIsItselfWhereStretched) {
  const auto positive = [](Eigen::Matrix<double, 6, 6> m) {
    m.diagonal().array() += 1e-9;
    return m.llt().info() == Eigen::Success;
  };
  int indefinite = 0;
  each_case([&](const MembraneLaw& law, const Deformation& f) {
    EXPECT_TRUE(positive(matrix_of(law.second(f, true))));
    indefinite += !positive(matrix_of(law.second(f, false)));
  });
  EXPECT_GT(indefinite, 2);
  const Deformation stretched = columns({1.2, 0, 0}, {0, 1.3, 0}),
                    squeezed = columns({0.8, 0, 0}, {0, 0.7, 0});
  for (const Membrane& membrane : {kStvk, kArap}) {
    const MembraneLaw law(membrane);
    const auto difference = [&](const Deformation& f) {
      return (matrix_of(law.second(f, true)) - matrix_of(law.second(f, false))).norm();
    };
    EXPECT_LT(difference(stretched), 1e-9);
    EXPECT_GT(difference(squeezed), 1);
  }
}

TEST(Membrane, EnergyIsHalfOfStrainTimesStiffnessTimesStrain) {
  each_case([](const MembraneLaw& law, const Deformation& f) {
    const MembraneLaw::Strain s = law.strain(f);
    EXPECT_NEAR(s.value.dot(law.stiffness() * s.value) / 2, law.energy(f), 1e-10);
    for (int k = 0; k < 6; ++k) {
      const auto moved = [&](double by) {
        Deformation g = f;
        g(k % 3, k / 3) += by;
        return law.strain(g).value;
      };
      const Vec3 slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
      const Eigen::Matrix3d& rows = k < 3 ? s.by_f1 : s.by_f2;
      EXPECT_LT((rows.col(k % 3) - slope).norm(), 1e-8) << k;
    }
  });
}

TEST(Membrane, ATurnStrainsNothing) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const Membrane& membrane : {kStvk, kArap}) {
    const MembraneLaw law(membrane);
    EXPECT_LT(law.energy(turn.leftCols<2>()), 1e-25);
    EXPECT_LT(law.stress(turn.leftCols<2>()).norm(), 1e-12);
    for (const Deformation& f : some()) {
      EXPECT_NEAR(law.energy(turn * f), law.energy(f), 1e-10);
      EXPECT_LT((law.stress(turn * f) - turn * law.stress(f)).norm(), 1e-10);
    }
  }
}

// arap's traction is .985, .93, .87, .76 of stvk's (with no Poisson's effect)
TEST(Membrane, ArapIsAnotherMaterialThatIsTheSameForSmallStrains) {
  const MembraneLaw arap(kArap),
      stvk({.warp = 500, .weft = 500, .poisson = 0, .shear = 250, .direction = kStvk.direction});
  const double ratio[] = {0.985, 0.93, 0.866, 0.758}, stretch[] = {1.01, 1.05, 1.1, 1.2};
  for (std::size_t k = 0; k < 4; ++k) {
    const Deformation f = columns({stretch[k], 0, 0}, {0, 1, 0});
    EXPECT_NEAR(arap.stress(f)(0, 0) / stvk.stress(f)(0, 0), ratio[k], 2e-3) << stretch[k];
  }
  for (const Deformation& f : some()) {
    const Deformation small = columns({1, 0, 0}, {0, 1, 0}) + 1e-5 * f;
    EXPECT_NEAR(arap.energy(small) / stvk.energy(small), 1, 1e-4);
  }
}

TEST(Membrane, ATriangleHasTheDeformationOfItsCornersInAnyPlane) {
  Scene s = hanging_sheet(4, 5, {false, false, false});
  s.pins.clear();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (Vec3& x : s.mesh.rest) x = turn * x;
  s.membrane = kStvk;
  s.membrane->direction = turn * Vec3(0, -1, 0);
  const MembraneModel model = make_membrane(s);
  ASSERT_EQ(model.elements.size(), s.mesh.triangles.size());
  const Deformation f = some()[0];
  double area = 0;
  for (const MembraneElement& e : model.elements) {
    area += e.area;
    const auto at = [&](std::size_t v) {
      const Vec3 flat = turn.transpose() * s.mesh.rest[v];
      return Vec3(f * Eigen::Vector2d(-flat.y(), flat.x()));
    };
    EXPECT_LT((e.deformation(at) - f).norm(), 1e-13);
  }
  EXPECT_NEAR(area, 4.0 / 3, 1e-13);
}

TEST(Membrane, TrianglesBetweenPinsAloneCostNothing) {
  Scene s = hanging_sheet(4, 4, {false, false, false});
  s.membrane = kStvk;
  s.pins = {0, 1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(make_membrane(s).elements.size(), s.mesh.triangles.size() - 6);
}

}  // namespace
}  // namespace taut::membrane_test
