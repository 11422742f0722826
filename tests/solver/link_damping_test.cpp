// Damping of links in every solver that has it: one energy, the same step, the same bits.
#include "core/model/link_damping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/model/larger.hpp"
#include "core/reference/implicit_step.hpp"
#include "core/reference/linear_stability.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/springs.hpp"
#include "core/reference/step_error.hpp"
#include "core/solver/layout/colour_batches.hpp"
#include "core/solver/simd/kernels.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::link_damping_test {
namespace {

constexpr std::array<double, 3> kSoft{300, 120, 15};  // N/m

/// An irregular net in motion, stretched and compressed.
Scene moving_net() {
  Scene s = irregular_net(7);
  s.stiffness = kSoft;
  s.link_damping = 0.02;
  return s;
}

/// Gradient of implicit Euler's energy [N] at x with the forces b K (n - n_t)/h u of the links.
double left(const Scene& s, const std::vector<Vec3>& x) {
  Eigen::VectorXd g = ElasticStep(s, s.stiffness).gradient(x);
  for (const Link& l : s.links) {
    const std::size_t a = to_index(l.a), b = to_index(l.b);
    const Vec3 way = x[b] - x[a];
    const double k = s.stiffness[static_cast<std::size_t>(l.family)],
                 before = (s.start.x[b] - s.start.x[a]).norm();
    const Vec3 pull = s.link_damping * k * (way.norm() - before) / s.dt * way.normalized();
    if (!is_pinned(s, l.a)) g.segment<3>(3 * l.a) -= pull;
    if (!is_pinned(s, l.b)) g.segment<3>(3 * l.b) += pull;
  }
  return g.norm();
}

TEST(LinkDamping, EverySolverOfTheStepReachesTheMinimumOfOneEnergy) {
  const Scene s = moving_net();
  const double at_first = left(s, s.start.x);
  EXPECT_GT(at_first, 1);
  for (const auto& [solver, within] :
       {std::pair<const char*, double>{"implicit:iterations=200", 1e-9},
        {"implicit:iterations=200,linear=cg", 1e-9},
        {"implicit:iterations=200,multipliers=keep", 1e-9},
        {"vbd:iterations=3000", 1e-9},
        {"vbd:iterations=3000,order=mesh,start=inertia", 1e-9},
        {"pd:iterations=3000", 1e-9},
        {"pd:iterations=300,method=lbfgs", 1e-6},
        {"pd:iterations=300,anderson=5", 1e-6},
        {"admm:iterations=3000", 1e-9},
        {"xpbd:iterations=300,method=global,primal=on,precision=double", 1e-6}})
    EXPECT_LT(left(s, after_one_step(s, solver).x) / at_first, within) << solver;
  Scene undamped = s;
  undamped.link_damping = 0;
  EXPECT_GT(left(s, after_one_step(undamped, "implicit:iterations=200").x) / at_first, 0.01);
}

TEST(LinkDamping, TheExactStepIsThatOfImplicitAndStepErrorMeasuresFromIt) {
  const Scene s = moving_net();
  const State exact = after_one_step(s, "implicit:iterations=200");
  const auto minimum = reference::ImplicitStep(s, s.start, 0, s.stiffness).minimum(s.start.x);
  EXPECT_EQ(minimum.problem, "");
  EXPECT_LT(largest_distance(minimum.x, exact.x), 1e-9);
  reference::StepError error(s, s.stiffness);
  EXPECT_LT(error.of(s.start, 0, s.dt, exact.x).distance, 1e-9);
  Scene undamped = s;
  undamped.link_damping = 0;
  EXPECT_GT(error.of(s.start, 0, s.dt, after_one_step(undamped, "implicit").x).distance, 1e-4);
}

bool same_bits(const State& a, const State& b) {
  const auto same = [](const std::vector<Vec3>& p, const std::vector<Vec3>& q) {
    return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size() * sizeof p[0]) == 0;
  };
  return same(a.x, b.x) && same(a.v, b.v);
}

Scene crumpled_sheet(int nu, int nv) {
  Scene s = crumpled(hanging_sheet(nu, nv), 0.05 / nu);
  s.stiffness = kSoft;
  s.link_damping = 3e-4;
  return s;
}

TEST(LinkDamping, HasTheSameBitsForEveryInstructionSetAndNumberOfThreads) {
  for (const auto& [nu, nv] : {std::pair{31, 33}, {3, 5}, {60, 50}})
    for (const char* solver :
         {"xpbd:iterations=3,substeps=2", "xpbd:iterations=1,substeps=3",
          "xpbd:iterations=2,order=mesh", "vbd:iterations=3", "pd:iterations=3,chebyshev=0.5",
          "pd:iterations=3,anderson=2", "admm:iterations=3,substeps=2", "mass-spring:substeps=160",
          "implicit:iterations=3"})
      for (const char* precision : {",precision=float", ",precision=double"}) {
        const bool no_choice = std::string_view(solver).starts_with("implicit");
        if (no_choice && std::string_view(precision).ends_with("float")) continue;
        const Scene s = crumpled_sheet(nu, nv);
        const std::string text = solver + std::string(no_choice ? "" : precision);
        const State want = simulate(s, text + ",simd=scalar", 3);
        Scene undamped = s;
        undamped.link_damping = 0;
        EXPECT_GT(largest_distance(want.x, simulate(undamped, text, 3).x), 1e-6) << text;
        std::vector<std::string> more{",threads=2", ",threads=3"};
        for (const Simd simd : {Simd::sse2, Simd::avx2, Simd::avx512})
          if (available(simd)) more.push_back(",simd=" + std::string(to_string(simd)));
        for (const std::string& one : more)
          EXPECT_TRUE(same_bits(simulate(s, text + one, 3), want)) << text << one;
      }
}

// Colour batches keep the rest lengths that damping changes in their lanes, near and far.
TEST(LinkDamping, BatchesAreTheGenericPathInTheirOrder) {
  for (const bool grid : {true, false}) {
    Scene s = crumpled_sheet(31, 33);
    if (!grid) {
      s.mesh.grid.reset();
      std::erase_if(s.links, [](const Link& l) { return (l.a * 7 + l.b) % 5 == 0; });
    }
    const std::vector<double> w = inverse_masses(s);
    const Layout layout = Layout::packed(s.start.x.size(), tile_ranks(s.mesh));
    const ColourBatches<double> batches(colour(s.links, s.mesh), w, 1, layout);
    Scene in_order = s;
    in_order.links.clear();
    for (const DistanceConstraint<double>& c : batches.order(layout)) {
      const auto same = [&](const Link& l) { return l.a == c.a && l.b == c.b; };
      in_order.links.push_back(*std::ranges::find_if(s.links, same));
    }
    for (const char* iterations : {"1", "4"}) {
      const std::string text = std::string("xpbd:precision=double,iterations=") + iterations;
      EXPECT_TRUE(same_bits(simulate(in_order, text + ",order=mesh", 8),
                            simulate(s, text + ",order=coloured", 8)))
          << text;
    }
  }
}

// Without damping the regular sheet stays interleaved, and other layouts keep no second length.
TEST(LinkDamping, CostsNothingWhereASceneHasNone) {
  const auto bytes = [](const Scene& s, const char* solver) {
    const SolverChoice choice = parse_solver(solver);
    std::size_t sum = 0;
    for (const PassCost& cost : choice.entry->make(s, choice.params)->step_cost())
      sum += cost.bytes;
    return sum;
  };
  for (const char* solver : {"xpbd", "xpbd:layout=batches", "xpbd:order=mesh", "vbd", "pd", "admm",
                             "mass-spring", "implicit"}) {
    Scene s = crumpled_sheet(20, 20);
    const std::size_t with = bytes(s, solver);
    s.link_damping = 0;
    EXPECT_GE(with, bytes(s, solver) + 4 * s.links.size()) << solver;
  }
}

TEST(LinkDamping, RigidLinksHaveNoneBesideElasticOnes) {
  Scene s = crumpled_sheet(9, 9);
  s.stiffness[0] = kRigid[0];
  s.link_damping = 0.05;
  const auto strain = [&](const State& state) {
    double most = 0;
    for (const Link& l : s.links)
      if (l.family == Family::structural)
        most = larger(
            most, std::abs((state.x[to_index(l.b)] - state.x[to_index(l.a)]).norm() / l.rest - 1));
    return most;
  };
  EXPECT_GT(strain(s.start), 0.03);
  for (const char* solver : {"xpbd:iterations=3000,order=mesh", "xpbd:iterations=3000",
                             "xpbd:method=global,iterations=20"})
    EXPECT_LT(strain(after_one_step(s, std::string(solver) + ",substeps=1,precision=double")), 1e-3)
        << solver;
}

// The largest stable step of explicit integration shrinks to (2/w)(sqrt(1 + zeta^2) - zeta) of the
// fastest mode, zeta = b w/2.
TEST(LinkDamping, TheLargestStableStepIsThatOfTheFastestDampedMode) {
  Scene s = hanging_sheet(7, 7);
  s.gravity.setZero();
  s.stiffness = kSoft;
  s.link_damping = 2e-3;
  for (std::size_t v = 0; v < s.start.v.size(); ++v)
    if (!is_pinned(s, static_cast<int>(v)))
      s.start.v[v] = 1e-7 * Vec3(std::sin(3.0 * static_cast<double>(v)),
                                 std::cos(2.0 * static_cast<double>(v)), 0);
  const auto margin_at = [&](double dt) {
    s.dt = dt;
    return linear_stability(s, parse_solver("mass-spring:substeps=1"))->margin;
  };
  double low = 1e-5, high = 1;
  while (high - low > 1e-9) {
    const double middle = (low + high) / 2;
    (margin_at(middle) < 1 ? low : high) = middle;
  }
  Scene undamped = s;
  undamped.link_damping = 0;
  undamped.dt = low;
  EXPECT_LT(linear_stability(undamped, parse_solver("mass-spring:substeps=1"))->margin, 0.6);
  const auto speed_after = [&](double dt) {
    s.dt = dt;
    double fastest = 0;
    for (const Vec3& v : simulate(s, "mass-spring:substeps=1", 3000).v)
      fastest = larger(fastest, v.norm());
    return fastest;
  };
  EXPECT_LT(speed_after(0.98 * low), 1e-4);
  EXPECT_FALSE(speed_after(1.02 * low) < 1);
}

TEST(LinkDamping, OthersRefuseItAndSayWhy) {
  const Scene s = crumpled_sheet(9, 9);
  const auto reasons = [](const Scene& scene, const char* solver) {
    const SolverChoice choice = parse_solver(solver);
    return choice.entry->unsupported(scene, choice.params);
  };
  for (const char* solver : {"jakobsen", "avbd", "bullet"})  // any link that is not rigid
    EXPECT_FALSE(reasons(s, solver).empty()) << solver;
  for (const char* solver : {"bullet-deformable:stiffness=300,material=own", "vbd:damping=1e-3",
                             "xpbd:layout=interleaved", "xpbd:material=own", "admm:material=own",
                             "implicit:integrator=bdf2", "implicit:integrator=midpoint"}) {
    const auto why = reasons(s, solver);
    ASSERT_EQ(why.size(), 1u) << solver;
    EXPECT_NE(why[0].find("damping"), std::string::npos) << why[0];
  }
  Scene mixed = s;
  mixed.stiffness[0] = kRigid[0];
  ASSERT_EQ(reasons(mixed, "admm").size(), 1u);
  EXPECT_TRUE(reasons(mixed, "xpbd").empty());
  for (const char* solver : {"implicit", "vbd", "xpbd", "xpbd:method=global", "mass-spring", "pd",
                             "admm", "implicit:multipliers=keep"})
    EXPECT_TRUE(reasons(s, solver).empty()) << solver;
  const auto is_said = [](const std::vector<std::string>& all) {
    return std::ranges::count(all, "damping of links") == 1;
  };
  EXPECT_TRUE(is_said(reference::refuse_dynamic(s)));
  EXPECT_TRUE(is_said(reference::refuse_springs(s)));
}

}  // namespace
}  // namespace taut::link_damping_test
