// A solver's own motion and a motion given by positions alone get the same judgement, from memory
// and from a file.
#include "experiments/case/computed_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "core/io/positions/positions.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/data.hpp"

namespace taut::computed_motion_test {
namespace {

const SceneSettings kSmall{"cloth.grid=[8, 8]", "time.duration=0.5"};

Scene small(const SceneSettings& more = {}) {
  SceneSettings all = kSmall;
  all.insert(all.end(), more.begin(), more.end());  // the last setting of a key counts
  return load_scene(find_scene("hang"), all);
}

/// Run in double, and all of its positions in sequence.
struct Computed {
  CaseRun run;
  std::vector<double> x;
};

Computed computed(const Scene& scene, int stride = 1) {
  Computed all;
  all.run = run_case(scene, parse_solver("jakobsen:precision=double"),
                     {.every = 5, .timed = true, .watch = [&](const Snapshot& m) {
                        if (m.step % stride != 0) return;
                        for (const Vec3& x : m.state.x)
                          all.x.insert(all.x.end(), x.begin(), x.end());
                      }});
  return all;
}

ComputedFrames in_memory(const std::vector<double>& x, const Scene& scene) {
  ComputedFrames frames{.name = "positions"};
  frames.positions = positions_in(std::span(x), scene.mesh.rest.size(), "positions");
  return frames;
}

TEST(ComputedMotions, AreScoredAsTheSolverThatMadeThem) {
  const Scene scene = small();
  const Computed made = computed(scene);
  const CaseRun scored = score(scene, in_memory(made.x, scene), {.every = 5, .timed = true});
  EXPECT_EQ(scored.record.status.kind, Status::Kind::ok);
  ASSERT_EQ(scored.last.x.size(), made.run.last.x.size());
  for (std::size_t i = 0; i < scored.last.x.size(); ++i)
    EXPECT_EQ(scored.last.x[i], made.run.last.x[i]);
  for (const char* of_positions : {"stretch.rms", "stretch.max", "area.rms", "structural.p95"})
    EXPECT_EQ(scored.record.value(of_positions), made.run.record.value(of_positions));
  EXPECT_EQ(scored.series.columns, made.run.series.columns);
  EXPECT_EQ(scored.record.solver, "positions");
  EXPECT_TRUE(std::isnan(scored.cpu_seconds));
}

// The cloth at rest says which vertex is which; the motion itself begins where its first frame is.
TEST(ComputedMotions, ThatBeginLaterThanTheSceneBeginAsTheyDo) {
  const Scene whole = small({"time.duration=1"}), scene = small({"time.duration=0.5"});
  const Computed made = computed(whole);
  const auto all = std::span(made.x).subspan(32 * 64 * 3);
  std::vector<double> rest;
  for (const Vec3& x : scene.mesh.rest) rest.insert(rest.end(), x.begin(), x.end());
  const auto later = [&](std::vector<double> x) {
    ComputedFrames frames = in_memory(x, scene);
    frames.rest = positions_in(std::span<const double>(rest), 64, "rest");
    std::vector<Vec3> first;
    const CaseRun run = score(scene, frames, {.watch = [&](const Snapshot& m) {
                                if (m.step == 0) first = m.state.x;
                              }});
    EXPECT_EQ(first[63], Vec3(all[63 * 3], all[63 * 3 + 1], all[63 * 3 + 2]));
    return run;
  };
  const CaseRun run = later({all.begin(), all.end()});
  EXPECT_EQ(run.record.status.kind, Status::Kind::ok) << run.record.status.reason.text();
  EXPECT_EQ(run.last.x, made.run.last.x);
  std::vector<double> gaining(all.begin(), all.end());
  for (std::size_t k = 2; k < 33; ++k) gaining[(k * 64 + 63) * 3] += 0.02 * std::pow(2, k);
  const Status gained = later(gaining).record.status;
  EXPECT_EQ(gained.kind, Status::Kind::exploded);
  EXPECT_EQ(gained.vertex, 63);
}

TEST(ComputedMotions, ThatDoNotFitAreRefusedByName) {
  const Scene scene = small();
  Computed made = computed(scene);
  made.x[0] += 0.1;
  try {
    score(scene, in_memory(made.x, scene));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("positions does not begin as hang does"),
              std::string::npos);
  }
  EXPECT_THROW(positions_in(std::span<const double>(made.x).first(64 * 3 + 1), 64, "some"),
               InputError);
  EXPECT_THROW(positions_in(std::span<const double>(made.x), 0, "some"), InputError);
  EXPECT_THROW(positions_in(std::span<const double>(), 64, "some"), InputError);
}

TEST(ComputedMotions, InMemoryAreWhatTheyAreInAFile) {
  const std::vector<double> doubles{1, 2, 3, 0.1, 0.2, 0.3};
  const std::vector<float> floats{1, 2, 3, 0.1F, 0.2F, 0.3F};
  const auto wide = positions_in(std::span(doubles), 1, "wide");
  const auto narrow = positions_in(std::span(floats), 1, "narrow");
  EXPECT_EQ(wide->header().frames, 2);
  EXPECT_EQ(wide->header().vertices, 1);
  EXPECT_EQ(wide->header().rounding, Rounding::binary64);
  EXPECT_EQ(narrow->header().rounding, Rounding::binary32);
  EXPECT_EQ(wide->read(1), std::vector{Vec3(0.1, 0.2, 0.3)});
  EXPECT_EQ(wide->read(0), std::vector{Vec3(1, 2, 3)});
  EXPECT_EQ(narrow->read(1)[0].x(), static_cast<double>(0.1F));
}

TEST(ComputedMotions, GiveTheSceneTheirTimeStepAndTheirDuration) {
  const auto load = [](const SceneSettings& with) { return small(with); };
  const Scene scene = small();
  const auto with = [&](int stride, std::size_t frames, double fps) {
    Computed made = computed(scene, stride);
    made.x.resize(frames * 64 * 3);
    ComputedFrames all = in_memory(made.x, scene);
    all.fps = fps;
    const Scene timed = load(fitted(load, {}, all));
    score(timed, all);
    return std::pair(timed.dt, timed.steps);
  };
  EXPECT_EQ(with(1, 33, 0), std::pair(1.0 / 64, 32));
  EXPECT_EQ(with(1, 33, 64), std::pair(1.0 / 64, 32));
  EXPECT_EQ(with(2, 17, 32), std::pair(1.0 / 32, 16));
  EXPECT_EQ(with(1, 20, 0), std::pair(1.0 / 64, 19)) << "shorter";
  EXPECT_THROW(with(1, 1, 0), InputError);
  EXPECT_EQ(fitted(load, {"time.dt=0.01"}, in_memory(computed(scene).x, scene)).front(),
            "time.dt=0.01")
      << "what was said stays";
}

TEST(RunCase, GivesARowEachSoManySteps) {
  const Scene scene = small();
  const auto steps = [&](const RunOptions& options) {
    std::vector<double> all;
    for (const auto& row : run_case(scene, parse_solver("jakobsen"), options).series.rows)
      all.push_back(row.front());
    return all;
  };
  EXPECT_EQ(steps({.every = 10}), (std::vector<double>{0, 10, 20, 30, 32}));
  EXPECT_EQ(steps({.series_rows = 2, .every = 16}), (std::vector<double>{0, 16, 32}));
  EXPECT_EQ(steps({.every = 99}), (std::vector<double>{0, 32}));
  EXPECT_TRUE(steps({}).empty());
}

TEST(RunCase, NotesTheCostOfTheStepsIfAsked) {
  const auto cost = [](const char* duration, bool timed) {
    const Scene scene = small({std::string("time.duration=") + duration});
    const SolverChoice choice = parse_solver("jakobsen:iterations=200,substeps=1");
    return run_case(scene, choice, {.timed = timed, .measure = false}).cpu_seconds;
  };
  EXPECT_TRUE(std::isnan(cost("0.5", false)));
  const double few = cost("0.5", true), many = cost("10", true);
  EXPECT_GT(few, 0);
  EXPECT_GT(many, 5 * few) << "of twenty times as many steps";
}

TEST(Cases, OfASceneInMemoryHaveTheKeyOfTheOneThatWasRead) {
  const Case read = make_case({"hang", kSmall, "jakobsen:iterations=4"});
  const Case given = case_of({"hang", kSmall, ""}, std::make_shared<const Scene>(small()),
                             parse_solver("jakobsen:iterations=4"));
  EXPECT_EQ(given.key, read.key);
  EXPECT_EQ(given.id, read.id);
  EXPECT_EQ(given.spec.solver, read.spec.solver);
}

}  // namespace
}  // namespace taut::computed_motion_test
