// Answers that a smaller model has to keep: their units and tolerances, and the distance of two
// runs in each.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "core/model/input_error.hpp"
#include "experiments/require/require.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::kept_answers_test {
namespace {

const double kNaN = std::nan("");

/// Case with frames at these times [s], in which the rest shape is moved by f(x, t).
Observation moving(const CaseSpec& spec, const std::vector<double>& times,
                   const std::function<Vec3(const Vec3&, double)>& f) {
  Observation seen{make_case(spec), {}, {}};
  for (const double t : times) {
    State state = seen.one.scene->start;
    for (Vec3& x : state.x) x = f(x, t);
    seen.frames.push_back({t, state});
  }
  return seen;
}
Observation still(
    const std::string& scene, const SceneSettings& settings,
    const std::function<Vec3(const Vec3&)>& f = [](const Vec3& x) { return x; }) {
  return moving({scene, settings, "jakobsen"}, {1}, [&](const Vec3& x, double) { return f(x); });
}

TEST(KeptQuantities, AreShownInTheirUnits) {
  EXPECT_EQ(text({"shape"}, 0.0012), "1.2 mm");
  EXPECT_EQ(text({"stretch.max"}, 0.0256), "2.56 %");
  EXPECT_EQ(text({"settle.time"}, 3.5), "3.5 s");
  EXPECT_EQ(text({"tunnelling.count"}, 3), "3");
  EXPECT_EQ(text({"energy.mean"}, -0.25), "-0.25");
  EXPECT_EQ(text({"shape"}, kNaN), "-");
  EXPECT_EQ(text({"shape"}, kNoAnswer), "-");
}

TEST(KeptQuantities, HaveToleranceByTheirKind) {
  Observation full = still("plane", {"time.duration=4"});
  full.record.values = {{"stretch.max", 0.02},    {"settle.time", 3},      {"energy.mean", -0.5},
                        {"penetration.max", 0.1}, {"tunnelling.count", 3}, {"jitter.rms", 0.2}};
  const double size = extent(*full.one.scene);
  const auto tolerance = [&](const std::string& asked) {
    return parse_answer(asked, full).tolerance;
  };
  EXPECT_DOUBLE_EQ(tolerance("penetration.max"), 0.001 * size);
  EXPECT_DOUBLE_EQ(tolerance("penetration.max:1%"), 0.01 * size)
      << "of the extent, not of the value";
  EXPECT_DOUBLE_EQ(tolerance("settle.time"), 0.4);
  EXPECT_DOUBLE_EQ(tolerance("settle.time:50%"), 2) << "of the duration";
  EXPECT_DOUBLE_EQ(tolerance("settle.time:2s"), 2);
  EXPECT_DOUBLE_EQ(tolerance("stretch.max:2%"), 0.02) << "points";
  EXPECT_DOUBLE_EQ(tolerance("stretch.max:0.3"), 0.3);
  EXPECT_DOUBLE_EQ(tolerance("energy.mean"), 0.05);
  EXPECT_DOUBLE_EQ(tolerance("jitter.rms"), 0.02);
  EXPECT_DOUBLE_EQ(tolerance("stretch.max"), 0.01) << "a point";
  EXPECT_DOUBLE_EQ(tolerance("shape"), 0.01 * size);
  EXPECT_EQ(tolerance("tunnelling.count"), 0);
  EXPECT_EQ(tolerance("tunnelling.count:2"), 2);
  EXPECT_EQ(tolerance("shape:0"), 0);
  const auto wrong = [&](const std::string& asked) -> std::string {
    try {
      parse_answer(asked, full);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(
      wrong("shape:1kg"),
      "--keep shape:1kg: expected a number of at least 0 after ':' and then 'mm', '%' or nothing");
  EXPECT_EQ(
      wrong("stretch.max:x"),
      "--keep stretch.max:x: expected a number of at least 0 after ':' and then '%' or nothing");
  EXPECT_EQ(wrong("area.max"), "--keep area.max: has no value on this scene");
  EXPECT_EQ(wrong("shpae"), "--keep shpae: unknown metric value 'shpae'; did you mean 'shape'?");
}

TEST(KeptQuantities, ByDefaultAreThoseThatTheCaseHas) {
  Observation full = still("ball", {});
  full.record.values = {{"stretch.max", 0.02},
                        {"penetration.max", 0},
                        {"face.max", 0.1},
                        {"settle.time", kNaN},
                        {"stretch.rms", 1}};
  full.record.params = {{"contact", "continuous"}, {"faces", "off"}};
  using Names = std::vector<std::string>;
  EXPECT_EQ(default_answers(full), (Names{"shape", "penetration.max", "stretch.max"}));
  full.record.params["faces"] = "on";
  EXPECT_EQ(default_answers(full), (Names{"shape", "face.max", "penetration.max", "stretch.max"}));
  full.one.choice = parse_solver("bullet");
  EXPECT_EQ(default_answers(full), (Names{"shape", "penetration.max", "stretch.max"}))
      << "another solver's faces are normals";
  full.record.values["settle.time"] = 2;
  EXPECT_EQ(default_answers(full),
            (Names{"shape", "penetration.max", "settle.time", "stretch.max"}));
}

TEST(KeptQuantities, ShapesAreComparedAtTheCoarserGrid) {
  const KeptQuantity shape{"shape"};
  const Observation fine = still("hang", {"cloth.grid=[9, 5]"});
  const auto one_moved = [&](std::size_t vertex) {
    Observation other = still("hang", {"cloth.grid=[9, 5]"});
    other.frames[0].state.x[vertex] += Vec3(0.3, 0, -0.4);
    return other;
  };
  for (const std::size_t vertex : {0u, 7u, 44u}) {
    EXPECT_NEAR(distance(shape, fine, one_moved(vertex)), 0.5, 1e-12);
    EXPECT_NEAR(distance(shape, one_moved(vertex), fine), 0.5, 1e-12);
  }
  // Bilinear cloth is the same on every grid. A displaced vertex of the coarser grid is noticed at
  // any place.
  const auto bilinear = [](const Vec3& x) {
    return Vec3(x.x() + 0.5 * x.x() * x.y(), 2 * x.y(), x.x() - 0.3 * x.y());
  };
  const Observation many = still("hang", {"cloth.grid=[9, 5]"}, bilinear);
  for (const char* grid : {"[4, 3]", "[3, 4]", "[2, 2]"}) {
    Observation few = still("hang", {"cloth.grid=" + std::string(grid)}, bilinear);
    EXPECT_LT(distance(shape, many, few), 1e-12) << grid;
    EXPECT_LT(distance(shape, few, many), 1e-12) << grid;
    for (std::size_t i = 0; i < few.frames[0].state.x.size(); ++i) {
      few.frames[0].state.x[i].z() += 0.25;
      EXPECT_NEAR(distance(shape, many, few), 0.25, 1e-12) << grid << ": " << i;
      EXPECT_NEAR(distance(shape, few, many), 0.25, 1e-12) << grid << ": " << i;
      few.frames[0].state.x[i].z() -= 0.25;
    }
  }
  const Observation chain = still("chain", {}),
                    half = still("chain", {"cloth.grid=[1, 17]"},
                                 [](const Vec3&x) { return Vec3(x + Vec3(0, 0, 0.1)); });
  EXPECT_NEAR(distance(shape, chain, half), 0.1, 1e-12);
  EXPECT_EQ(distance(shape, still("disc", {}), fine), kNoAnswer) << "no grid";
}

TEST(KeptQuantities, AreOfTheLastFrameAndNoneOfARunThatDidNotEnd) {
  const KeptQuantity shape{"shape"};
  const CaseSpec spec{"hang", {"cloth.grid=[4, 4]"}, "jakobsen"};
  const auto slides = [](double speed) {
    return [=](const Vec3& x, double t) { return Vec3(x + Vec3(speed * t, 0, 0)); };
  };
  const Observation full = moving(spec, {0, 1, 2}, slides(0));
  Observation other = moving(spec, {0, 1, 2}, slides(0.1));
  EXPECT_NEAR(distance(shape, full, other), 0.2, 1e-12);
  EXPECT_EQ(apart_after(full, other, 0.05), 1);
  EXPECT_EQ(apart_after(full, other, 0.15), 2);
  EXPECT_EQ(apart_after(full, moving(spec, {0, 1, 2}, slides(0.5)), 0.5), 2)
      << "as far as the tolerance is not beyond it";
  EXPECT_EQ(apart_after(full, other, 0.25), std::nullopt);
  EXPECT_EQ(apart_after(full, moving(spec, {0, 1}, slides(0.1)), 0.15), std::nullopt)
      << "as long as both go";
  other.record.status.kind = Status::Kind::unsettled;
  EXPECT_NEAR(distance(shape, full, other), 0.2, 1e-12);
  other.record.status.kind = Status::Kind::exploded;
  EXPECT_EQ(distance(shape, full, other), kNoAnswer);
  other.record.status.kind = Status::Kind::ok;
  other.frames.clear();
  EXPECT_EQ(distance(shape, full, other), kNoAnswer);
  EXPECT_EQ(distance(shape, other, full), kNoAnswer);
}

TEST(KeptQuantities, ValuesDifferByTheirDistanceOrAsTheirMotionsDo) {
  const CaseSpec plane{"plane", {"time.duration=3"}, "jakobsen"},
      bare{"plane", {"time.duration=3", "collider=[]"}, "jakobsen"};
  // Level cloth at these heights: the metric looks at the last second alone.
  const auto level = [](double before, double at_end) {
    return [=](const Vec3& x, double t) { return Vec3(x.x(), t < 2.5 ? before : at_end, x.z()); };
  };
  const KeptQuantity depth{"penetration.max"};
  const std::vector<double> times{0, 1, 1.5, 2.5, 3};
  Observation full = moving(plane, times, level(-0.5, -0.125)),
              without = moving(bare, times, level(-0.75, -0.375));
  full.record.values["penetration.max"] = 7;
  EXPECT_NEAR(distance(depth, full, without), 0.25, 1e-12) << "both are measured on their motions";
  without.record.values["penetration.max"] = 4.5;
  EXPECT_NEAR(distance(depth, full, without), 2.5, 1e-12) << "both have the value";
  EXPECT_NEAR(distance(depth, without, full), 2.5, 1e-12);
  EXPECT_EQ(value_of(depth, full), 7);
  EXPECT_TRUE(std::isnan(value_of({"stretch.max"}, full)));
  without.record.values.clear();
  EXPECT_EQ(distance({"self.crossings"}, full, without), kNoAnswer)
      << "the full model's scene has none of it";
  Observation other =
      moving({"plane", {"time.duration=3", "collider=[]", "cloth.grid=[3, 3]"}, "jakobsen"}, times,
             level(0, 0));
  EXPECT_EQ(distance(depth, full, other), kNoAnswer)
      << "a metric of the scene does not take another grid";
}

TEST(KeptQuantities, WorkAndMemoryAreSumsOverThePasses) {
  const std::vector<PassCost> passes{{"verlet", 10, 2, 300, false}, {"links", 7, 6, 50, true}};
  EXPECT_EQ(work_of(passes), 62u);
  EXPECT_EQ(bytes_of(passes), 350u);
  EXPECT_EQ(work_of({}) + bytes_of({}), 0u);
}

}  // namespace
}  // namespace taut::kept_answers_test
