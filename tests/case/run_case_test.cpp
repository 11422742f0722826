// One case in one process: explosions against legitimate extremes, and the contents of a record.
#include "experiments/case/run_case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/model/bending.hpp"
#include "core/model/index.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/divergence.hpp"
#include "experiments/case/record_io.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/cloths.hpp"

namespace taut::run_case_test {
namespace {

Scene at_rest(const SheetShape& shape) {
  Scene scene;
  scene.name = "test";
  scene.mesh = make_sheet(shape);
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {});
  scene.dt = 1.0 / 64;
  scene.steps = 640;
  return scene;
}

/// Chain that hangs from its first vertex.
Scene chain(int links, double dt) {
  Scene scene =
      at_rest({.nu = 1, .nv = links + 1, .height = 1, .mass = 0.1, .lumping = Lumping::equal});
  scene.pins = {0};
  scene.dt = dt;
  scene.steps = static_cast<int>(10 / dt);
  return scene;
}

Status verdict_on(const Scene& scene, const std::string& solver) {
  return run_case(scene, parse_solver(solver)).record.status;
}

TEST(RunCase, WhatSweepsLeaveAtRestIsPredictedBesideWhatIsMeasured) {
  Scene scene = at_rest({.nu = 9, .nv = 9, .width = 1, .height = 1, .mass = 0.2});
  scene.pins = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  scene.damping = 2;
  const auto stretch = [&](const char* solver) {
    const Record r = run_case(scene, parse_solver(solver)).record;
    return std::pair(r.value("stretch.predicted"), r.value("stretch.rms"));
  };
  constexpr const char* kSolver = "jakobsen:projection=exact,precision=double,iterations=8";
  const auto [predicted, measured] = stretch(kSolver);
  EXPECT_NEAR(predicted / measured, 1, 0.05);
  EXPECT_TRUE(std::isnan(stretch("pd").first)) << "no law is known";
  EXPECT_TRUE(std::isnan(stretch("jakobsen:levels=2").first)) << "nor here";
  scene.damping = 0;
  for (Vec3& x : scene.start.x) x = Vec3(x.x(), x.z(), x.y());
  EXPECT_TRUE(std::isnan(stretch(kSolver).first)) << "it still swings";
  scene.start.x = scene.mesh.rest;
  scene.damping = 2;
  scene.steps = 640;
  scene.colliders = {{.shape = Ball{.center = {0.5, -9, 0.5}, .radius = 0.1}}};
  const Record r = run_case(scene, parse_solver(kSolver)).record;
  EXPECT_FALSE(r.values.contains("stretch.predicted")) << "contact";
}

TEST(RunCase, AMetricThatIsTooDearSaysSoAndTheCaseGoesOn) {
  const Scene scene = chain(4, 1.0 / 64);
  const CaseRun all = run_case(scene, parse_solver("jakobsen"));
  std::vector<const MetricEntry*> at_work;
  double seconds = 0;
  const MeasuringTime none{.most = 0, .tell = [&](const MetricEntry* metric, double now) {
                             at_work.push_back(metric);
                             EXPECT_GE(now, seconds);
                             seconds = now;
                           }};
  const CaseRun run =
      run_case(scene, parse_solver("jakobsen"), {.series_rows = 9, .measuring = none});
  EXPECT_EQ(run.record.status.kind, all.record.status.kind);
  EXPECT_EQ(run.record.digest, all.record.digest);
  EXPECT_GT(seconds, 0);
  EXPECT_EQ(at_work.back(), nullptr);
  ASSERT_EQ(run.record.values.size(), all.record.values.size());
  for (const auto& [name, value] : run.record.values) EXPECT_TRUE(std::isnan(value)) << name;
  for (const std::vector<double>& row : run.series.rows)
    EXPECT_EQ(row.size(), run.series.columns.size());
  const auto dear = std::ranges::count_if(run.record.resolved_settings, [](const auto& one) {
    return one.text.starts_with("no value: too dear for this case, ");
  });
  EXPECT_EQ(dear, std::ranges::count_if(metrics(), [&](const MetricEntry* entry) {
              return entry->make(scene) != nullptr;
            }));
}

TEST(DivergenceDetector, TheSameMotionHasTheSameStatusInAnySteps) {
  Scene scene;
  scene.name = "two";
  scene.mesh.rest = {Vec3::Zero(), Vec3(1, 0, 0)};
  scene.mesh.mass = {0.7, 0.7};
  scene.start = {{Vec3::Zero(), Vec3(1.1, 0, 0)}, {Vec3::Zero(), Vec3::Zero()}};
  scene.links = {{0, 1, 1, Family::structural}};
  scene.gravity.setZero();
  scene.dt = 1.0 / 64;
  scene.steps = 16;
  Scene cut = scene;
  cut.dt /= 32;
  cut.steps *= 32;
  const std::string spring = "mass-spring:precision=double,structural=1e6,substeps=";
  EXPECT_EQ(verdict_on(cut, spring + "1").kind, Status::Kind::ok);
  EXPECT_EQ(verdict_on(scene, spring + "32").kind, Status::Kind::ok)
      << verdict_on(scene, spring + "32").reason.text();
  EXPECT_EQ(verdict_on(cut, "mass-spring:precision=double,structural=1e9,substeps=1").kind,
            Status::Kind::exploded);
  EXPECT_EQ(verdict_on(scene, "mass-spring:precision=double,structural=1e9,substeps=32").kind,
            Status::Kind::exploded);
}

/// Solver with a prescribed state after each step.
struct Scripted final : Solver {
  explicit Scripted(const Scene& scene) : state(scene.start) {}
  void load(const State& s) override { state = s; }
  void step(double, double) override { script(++steps, state); }
  void store(State& s) const override { s = state; }
  std::vector<PassCost> step_cost() const override { return {}; }
  static inline std::function<void(int, State&)> script;
  State state;
  int steps = 0;
};

SolverEntry scripted() {
  return {.name = "scripted",
          .make = [](const Scene& s, const Params&) -> std::unique_ptr<Solver> {
            return std::make_unique<Scripted>(s);
          },
          .unsupported = [](const Scene&, const Params&) { return std::vector<std::string>{}; },
          .resolved_settings = [](const Scene&, const Params&) { return ResolvedSettings{}; }};
}

CaseRun run_scripted(const Scene& scene, std::function<void(int, State&)> script,
                     const RunOptions& options = {}, const SolverEntry& entry = scripted()) {
  Scripted::script = std::move(script);
  return run_case(scene, {&entry, Params("scripted", {}, "")}, options);
}

TEST(DivergenceDetector, NotANumberIsAnExplosionAtItsStepAndVertex) {
  const Scene scene = at_rest({.nu = 3, .nv = 3, .width = 1, .height = 1, .mass = 0.2});
  const CaseRun run = run_scripted(scene, [](int step, State& s) {
    s.x[1].y() -= 0.001;
    if (step == 7) s.x[5].y() = std::numeric_limits<double>::quiet_NaN();
  });
  EXPECT_EQ(run.record.status.kind, Status::Kind::exploded);
  EXPECT_EQ(run.record.status.reason, Reason::nonfinite);
  EXPECT_EQ(run.record.status.step, 7);
  EXPECT_EQ(run.record.status.vertex, 5);
  EXPECT_NEAR(run.last.x[1].y(), -0.006, 1e-12) << "the last stable state is that after step 6";
  EXPECT_GT(run.record.values.size(), 10u);
  for (const auto& [name, value] : run.record.values) EXPECT_TRUE(std::isnan(value)) << name;
}

TEST(DivergenceDetector, EnergyOutOfNothingIsAnExplosion) {
  const Scene scene = chain(16, 1.0 / 64);
  const CaseRun run = run_scripted(scene, [](int, State& s) {
    s.v[9] = 1.1 * s.v[9] + Vec3(0.01, 0, 0);  // grows by 10 % a step
  });
  EXPECT_EQ(run.record.status.kind, Status::Kind::exploded);
  EXPECT_EQ(run.record.status.reason, Reason::energy);
  EXPECT_EQ(run.record.status.vertex, 9);
}

TEST(DivergenceDetector, LeavingTheWorldIsAnExplosion) {
  const Scene scene = chain(4, 1.0 / 64);
  const CaseRun run = run_scripted(scene, [](int step, State& s) {
    if (step == 3) s.x[2].z() = -2e6;
  });
  EXPECT_EQ(run.record.status.reason, Reason::box);
  EXPECT_EQ(run.record.status.step, 3);
}

TEST(DivergenceDetector, FreeFallIsNoExplosionHoweverLong) {
  Scene scene = at_rest({.nu = 3, .nv = 3, .width = 1, .height = 1, .mass = 0.2});
  scene.steps = 64 * 60;
  EXPECT_EQ(verdict_on(scene, listing("precision=double")).kind, Status::Kind::ok);
}

// One sweep at dt = 1/10 s stretches the top link to dozens of its rest length. This is soft, not
// unstable, and extreme where truth 5.5 has a peak above 30. In long chains at short steps, where
// theory has strains below 1, the square-root-free projection pumps (core/README.md, "Orders") to a
// strain above 10: this is extreme as well, and no explosion.
TEST(DivergenceDetector, LegitimateStrainIsNoExplosion) {
  for (const int links : {16, 64, 128})
    for (const double dt : {1.0 / 10, 1.0 / 30, 1.0 / 60, 1.0 / 480})
      for (const char* projection : {"exact", "sqrt-free"}) {
        const Status status = verdict_on(
            chain(links, dt), listing("iterations=1,projection=") + std::string(projection));
        const bool pumped = links >= 64 && dt < 0.01 && projection == std::string("sqrt-free");
        const bool extreme = pumped || 1.8 * (links - 1) * links * 9.81 * dt * dt > 30;
        EXPECT_EQ(completed(status), !extreme)
            << links << " links, dt " << dt << ", " << projection << ": " << status.reason.text()
            << " at step " << status.step;
        EXPECT_EQ(status.kind == Status::Kind::extreme, extreme);
      }
}

TEST(DivergenceDetector, DrivenScenesAreNoExplosion) {
  Scene flag = at_rest({.nu = 12, .nv = 8, .width = 1, .height = 0.7, .mass = 0.05});
  for (int j = 0; j < 8; ++j) flag.pins.push_back(flag.mesh.grid->index(0, j));
  flag.wind = Wind{.velocity = {12, 0, 3}, .strength = 1};
  EXPECT_EQ(verdict_on(flag, listing("iterations=8")).kind, Status::Kind::ok);

  Scene dragged = chain(20, 1.0 / 64);
  dragged.gravity.setZero();
  dragged.pin_motions = {{{0}, {.velocity = {5, 0, 0}}}};
  EXPECT_EQ(verdict_on(dragged, listing("iterations=8")).kind, Status::Kind::ok);

  Scene whirled = chain(20, 1.0 / 64);
  whirled.pin_motions = {{{0}, {.spin = {0, 0, 9}, .pivot = {0.5, 0, 0}}}};
  EXPECT_EQ(verdict_on(whirled, listing("iterations=8")).kind, Status::Kind::ok);
}

TEST(DivergenceDetector, AStartFarFromRestMaySnapBack) {
  Scene scene = chain(10, 1.0 / 64);
  scene.gravity.setZero();
  for (Vec3& x : scene.start.x) x *= 2.5;
  EXPECT_EQ(verdict_on(scene, listing("iterations=16,projection=exact")).kind, Status::Kind::ok);
}

/// A weightless strip of 0.4 m by 0.2 m that starts as a part of a tube of 0.2 m.
Scene bent_strip() {
  Scene scene = at_rest({.nu = 9, .nv = 5, .width = 0.4, .height = 0.2, .mass = 0.016});
  for (Vec3& x : scene.start.x)
    x = {0.2 * std::sin(x.x() / 0.2), x.y(), 0.2 - 0.2 * std::cos(x.x() / 0.2)};
  for (Link& link : scene.links)  // bending is all that it holds
    link.rest = (scene.start.x[to_index(link.b)] - scene.start.x[to_index(link.a)]).norm();
  scene.bending = Bending{.warp = 1e-4, .weft = 1e-4};
  scene.gravity.setZero();
  scene.steps = 32;
  return scene;
}

TEST(DivergenceDetector, ABentStartMaySpringBackAndNoMore) {
  const Scene scene = bent_strip();
  const double energy = bending_energy(make_bending(scene), scene.start.x);
  EXPECT_NEAR(energy, 1e-4 / 2 * 0.08 / (0.2 * 0.2), 0.2e-4) << "less at its edges";
  for (const char* solver : {"jakobsen", "xpbd", "implicit", "pd", "vbd", "avbd", "mass-spring"}) {
    double fastest = 0;
    const CaseRun run =
        run_case(scene, parse_solver(solver), {.measure = false, .watch = [&](const Snapshot& m) {
                                                 double sum = 0;
                                                 for (const Vec3& v : m.state.v)
                                                   sum += v.squaredNorm() / 45;
                                                 fastest = std::max(fastest, std::sqrt(sum));
                                               }});
    EXPECT_EQ(run.record.status.kind, Status::Kind::ok) << solver;
    EXPECT_GT(fastest, 1e-4) << solver;
    EXPECT_LT(fastest, 1.2 * std::sqrt(2 * energy / 0.016)) << solver;
  }
  const auto gains = [&](double times) {
    const double speed = std::sqrt(2 * times * energy / 0.016);
    return run_scripted(scene, [&](int, State& s) { s.v.assign(45, Vec3(speed, 0, 0)); })
        .record.status;
  };
  EXPECT_EQ(gains(9).kind, Status::Kind::ok);
  EXPECT_EQ(gains(11).reason, Reason::energy);
}

// No vertex starts in the bodies, which the middle of a face and of an edge do.
TEST(DivergenceDetector, FacesAndEdgesMayLeaveTheBodyThatTheyStartIn) {
  Scene scene = at_rest({.nu = 2, .nv = 2, .width = 0.2, .height = 0.2, .mass = 0.016});
  for (Vec3& x : scene.start.x) x = {x.x() - 0.1, 0, x.y() + 0.1};
  scene.gravity.setZero();
  scene.steps = 8;
  const Box box{.center = {0.02, -0.05, 0.03}, .half_extents = {0.02, 0.06, 0.02}};
  for (const Shape& shape :
       {Shape(box), Shape(Ball{{0.02, -0.03, 0.03}, 0.04}),
        Shape(Capsule{{-0.2, -0.03, 0.02}, {0.2, -0.03, 0.02}, 0.04}),
        Shape(MeshBody{.mesh = box_of_triangles(box.half_extents).mesh(), .center = box.center})}) {
    scene.colliders = {{.shape = shape}};
    for (const char* solver : {"jakobsen", "xpbd", "mass-spring"}) {
      EXPECT_EQ(verdict_on(scene, std::string(solver) + ":faces=on").kind, Status::Kind::ok)
          << solver << " at a " << type_name(shape);
    }
    const Status gained =
        run_scripted(scene, [](int, State& s) { s.v.assign(4, Vec3(0, 50, 0)); }).record.status;
    EXPECT_EQ(gained.reason, Reason::energy) << type_name(shape);
  }
}

TEST(RunCase, ComparesPinsWithTheScenesAfterEveryStep) {
  Scene scene = chain(4, 1.0 / 64);
  scene.pins = {0, 3};
  scene.steps = 16;
  scene.pin_motions = {{{3}, {.velocity = {0.5, 0, 0}, .spin = {0, 0, 1}, .pivot = {0, 1, 0}}}};
  scene.releases = {{8, {3}}};
  SolverEntry foreign = scripted();
  foreign.implementation = "another program";
  const auto ends = [&](const SolverEntry& entry, int vertex, int from, double off) {
    return run_scripted(
               scene,
               [&](int step, State& s) {
                 const double t = step * scene.dt;
                 if (step <= 8) s.x[3] = scene.pin_motions[0].motion.moved(scene.start.x[3], t);
                 if (step >= from) s.x[to_index(vertex)] += Vec3(0, 0, off);
               },
               {}, entry)
        .record;
  };
  EXPECT_EQ(ends(scripted(), 0, 99, 0).status.kind, Status::Kind::ok);
  EXPECT_EQ(ends(scripted(), 0, 16, 1e-10).status.kind, Status::Kind::ok);
  EXPECT_EQ(ends(foreign, 0, 16, 1e-6).status.kind, Status::Kind::ok);
  for (const int vertex : {0, 3}) {
    const Record ours = ends(scripted(), vertex, 8, 1e-8), theirs = ends(foreign, vertex, 8, 1e-4);
    EXPECT_EQ(ours.status.kind, Status::Kind::error);
    EXPECT_EQ(theirs.status.kind, Status::Kind::protocol);
    EXPECT_EQ(theirs.status.step, 8);
    EXPECT_EQ(theirs.status.vertex, vertex);
    EXPECT_TRUE(theirs.status.reason.text().starts_with("does not hold the scene's pins: vertex " +
                                                        std::to_string(vertex) +
                                                        " is 0.0001 m from (0"))
        << theirs.status.reason.text();
    EXPECT_TRUE(std::isnan(theirs.value("stretch.rms")));
  }
  EXPECT_EQ(ends(foreign, 3, 9, 1e-2).status.kind, Status::Kind::ok) << "it has been let go";
}

TEST(DivergenceDetector, SettlingTimeIsKnownForHangingClothOnly) {
  const std::vector<PassCost> step_cost{{.pass = "structural", .repeats = 4, .projections = true}};
  Scene scene = chain(16, 1.0 / 64);
  const double pi = std::acos(-1.0);
  ASSERT_TRUE(settling_time(scene, step_cost));
  EXPECT_GT(*settling_time(scene, step_cost), 8 * 256 / (pi * pi * 4 * 64));
  EXPECT_FALSE(settling_time(scene, {})) << "no sweeps";
  scene.wind = Wind{};
  EXPECT_FALSE(settling_time(scene, step_cost)) << "wind";
  scene = chain(16, 1.0 / 64);
  scene.pins.clear();
  EXPECT_FALSE(settling_time(scene, step_cost)) << "nothing holds it";
}

TEST(DivergenceDetector, WhatNeverRestsIsUnsettled) {
  Scene scene = chain(4, 1.0 / 16);
  scene.steps = 320;  // 20 s; the slowest swing decays in 2.3 s
  const auto restless = [](int step, State& s) { s.v[3].x() = step % 2 ? 0.5 : -0.5; };
  EXPECT_EQ(run_scripted(scene, restless).record.status.kind, Status::Kind::ok)
      << "without sweeps there is no theory to judge by";
  DivergenceDetector verdict(scene, {{.pass = "structural", .repeats = 16, .projections = true}});
  State state = scene.start;
  for (int n = 0; n <= scene.steps; ++n) {
    if (n > 0) restless(n, state);
    ASSERT_TRUE(verdict.observe(n, n * scene.dt, state));
  }
  verdict.finish();
  EXPECT_EQ(verdict.status().kind, Status::Kind::unsettled);
  EXPECT_EQ(verdict.status().vertex, 3);
  EXPECT_EQ(verdict_on(scene, listing("iterations=16")).kind, Status::Kind::ok)
      << "the same chain comes to rest under relaxation";
}

TEST(RunCase, UnsupportedScenesAreSaidSoAndNotRun) {
  Scene scene = chain(4, 1.0 / 64);
  static const SolverEntry entry{
      .name = "picky",
      .make = [](const Scene&, const Params&) -> std::unique_ptr<Solver> { std::abort(); },
      .unsupported =
          [](const Scene&, const Params&) {
            return std::vector<std::string>{"dislikes chains", "dislikes Mondays"};
          },
      .resolved_settings = [](const Scene&, const Params&) { return ResolvedSettings{}; }};
  const CaseRun run = run_case(scene, {&entry, Params("picky", {}, "")});
  EXPECT_EQ(run.record.status.kind, Status::Kind::unsupported);
  EXPECT_EQ(run.record.status.reason.text(), "dislikes chains; dislikes Mondays");
}

TEST(RunCase, TheRecordNamesWhatWasRun) {
  const Scene scene = chain(16, 1.0 / 64);
  const CaseRun run = run_case(scene, parse_solver(listing("iterations=8")), {.series_rows = 120});
  EXPECT_EQ(run.record.solver, "jakobsen");
  EXPECT_EQ(run.record.params.at("iterations"), "8");
  EXPECT_EQ(run.record.params.at("substeps"), "1");
  EXPECT_EQ(run.record.steps, 640);
  EXPECT_EQ(run.record.vertices, 17);
  EXPECT_EQ(run.record.links, 16);
  EXPECT_EQ(run.record.projections, 16u * 8u);
  EXPECT_EQ(run.record.digest, digest(run.last));
  EXPECT_TRUE(run.record.values.contains("drift.max"));
  ASSERT_GE(run.series.rows.size(), 120u);
  EXPECT_LE(run.series.rows.size(), 130u);
  EXPECT_EQ(run.series.rows.front()[0], 0);
  EXPECT_EQ(run.series.rows.back()[0], 640);
  for (const auto& row : run.series.rows) EXPECT_EQ(row.size(), run.series.columns.size());
}

TEST(RunCase, RunsRepeatToTheBit) {
  const Scene scene = chain(16, 1.0 / 64);
  const SolverChoice choice = parse_solver(listing("iterations=8"));
  EXPECT_EQ(run_case(scene, choice).record.digest, run_case(scene, choice).record.digest);
}

TEST(Digest, MatchesTheStandardsTestVector) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(RunCase, SeriesAreEvenlySpreadWithTheStartAndTheEnd) {
  Scene scene = chain(2, 1.0 / 64);
  const auto steps = [&](int all, int rows) {
    scene.steps = all;
    std::vector<double> seen;
    for (const auto& row :
         run_scripted(scene, [](int, State&) {}, {.series_rows = rows}).series.rows) {
      seen.push_back(row[0]);
      EXPECT_EQ(row[1], row[0] / 64);
    }
    return seen;
  };
  EXPECT_EQ(steps(10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(steps(11, 5), (std::vector<double>{0, 2, 4, 6, 8, 10, 11}));
  EXPECT_EQ(steps(3, 100), (std::vector<double>{0, 1, 2, 3}));
  EXPECT_EQ(steps(3, 1), (std::vector<double>{0, 3}));
  EXPECT_TRUE(steps(3, 0).empty());
  const CaseRun run = run_scripted(scene, [](int, State&) {}, {.series_rows = 1});
  EXPECT_EQ(run.series.columns[0], "step");
  EXPECT_EQ(run.series.columns[1], "t");
  for (const MetricEntry* entry : metrics())
    for (const ValueSpec& value : entry->values)
      EXPECT_LE(std::ranges::count(run.series.columns, value.name), value.in_series) << value.name;
  EXPECT_EQ(std::ranges::count(run.series.columns, "stretch.rms"), 1);
}

TEST(RunCase, WhoWatchesSeesEveryStableBoundary) {
  Scene scene = chain(2, 1.0 / 64);
  scene.steps = 6;
  std::vector<int> steps;
  std::vector<double> heights;
  const RunOptions options{.measure = false, .watch = [&](const Snapshot& m) {
                             EXPECT_EQ(m.t, m.step / 64.0);
                             steps.push_back(m.step);
                             heights.push_back(m.state.x[2].z());
                           }};
  const CaseRun run = run_scripted(
      scene, [](int step, State& s) { s.x[2].z() = step == 5 ? std::nan("") : 1e-3 * step; },
      options);
  EXPECT_EQ(steps, (std::vector{0, 1, 2, 3, 4}));
  EXPECT_EQ(heights, (std::vector<double>{0, 1e-3, 2e-3, 3e-3, 4e-3}));
  EXPECT_TRUE(run.record.values.empty());
  EXPECT_EQ(run.record.digest, digest(run.last));
  EXPECT_EQ(run.last.x[2].z(), 4e-3);
}

// A solver that ends for a reason of taut's ends as if taut had found it.
TEST(RunCase, AFailureKeepsItsReason) {
  const auto reason = [](const StatusReason& thrown) {
    return run_scripted(chain(2, 1.0 / 64),
                        [&](int step, State&) {
                          if (step == 1) throw SolverFailure(Status::Kind::exploded, thrown);
                        })
        .record.status.reason;
  };
  EXPECT_EQ(reason(Reason::box), Reason::box);
  EXPECT_EQ(reason(Reason::box).text(), "box");
  EXPECT_FALSE(reason("box") == Reason::box);
}

TEST(RunCase, AFailingSolverEndsAtItsLastWholeStep) {
  Scene scene = chain(2, 1.0 / 64);
  scene.steps = 6;
  const CaseRun run = run_scripted(scene, [](int step, State& s) {
    if (step == 4) throw SolverFailure(Status::Kind::oom, "2 GiB", "its last words");
    s.x[2].z() = step;
  });
  EXPECT_EQ(run.record.status.kind, Status::Kind::oom);
  EXPECT_EQ(run.record.status.reason.text(), "2 GiB");
  EXPECT_EQ(run.record.status.step, 3);
  EXPECT_EQ(run.record.status.vertex, -1);
  EXPECT_EQ(run.record.log, "its last words");
  EXPECT_TRUE(run.record.values.empty());
}

TEST(RunCase, CountsTheStepsThatDoNotConverge) {
  Scene scene = at_rest({.nu = 4, .nv = 4, .width = 1, .height = 1, .mass = 0.1});
  scene.pins = {0, 3};
  scene.steps = 8;
  scene.releases = {{.step = 4, .vertices = {3}}};
  const auto unconverged = [&](const std::string& solver) {
    return run_case(scene, parse_solver(solver)).record.values.at("steps.unconverged");
  };
  const std::string primal = "xpbd:method=global,primal=on,precision=double,structural=1e-3,";
  EXPECT_EQ(unconverged("implicit:structural=1000,iterations=50"), 0);
  EXPECT_EQ(unconverged("implicit:structural=1000,iterations=1"), 8);
  EXPECT_EQ(unconverged(primal + "iterations=50"), 0);
  EXPECT_EQ(unconverged(primal + "iterations=1"), 8);
  for (const char* fixed : {"vbd", "jakobsen", "pd", "xpbd"})
    EXPECT_TRUE(std::isnan(unconverged(fixed))) << fixed;
}

}  // namespace
}  // namespace taut::run_case_test
