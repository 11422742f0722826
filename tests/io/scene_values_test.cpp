// A scene has the numbers that its file states, and limits are tested just below and above.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"

namespace taut::scene_values_test {
namespace {

std::string problems(const std::string& text, const SceneSettings& settings = {}) {
  try {
    parse_scene("x", text, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

void expect_near(const Vec3& a, const Vec3& b) {
  EXPECT_LT((a - b).norm(), 1e-12) << a.transpose() << " is not " << b.transpose();
}

constexpr const char* kEverything = R"(summary = "all of it"
[cloth]
grid = [3, 4]
size = [2, 6]
origin = [1, 2, 3]
u = [0, 5, 0]
v = [0, 0, -0.5]
area_density = 0.5
thickness = 0.125
velocity = [1, 2, 4]
pins = ["top-right", "bottom-left", [1, 2]]
stretch = 2
weights = [{ vertices = [0, 4], factor = 3 }, { vertices = "bottom", factor = 0.5 }]
placed = [{ vertex = [2, 1], at = [1.5, 6, -1] }, { vertex = 1, at = [1, 4, 4] }]
[links]
structural = false
bend = true
[forces]
gravity = [0.5, -1, 2]
damping = 0.25
[wind]
velocity = [3, 4, 5]
strength = 0.75
law = "literal"
[self_collision]
radius = 0.01
[[collider]]
type = "plane"
normal = [0, 3, 4]
offset = -50
friction = 0.5
velocity = [1, 0, 0]
spin = [0, 1, 0]
pivot = [7, 8, 9]
path = [{ t = -1, displacement = [0, 0, 1] }, { t = 2, displacement = [0, 4, 1] }]
[[collider]]
type = "ball"
center = [10, 20, 30]
radius = 2
[[collider]]
type = "box"
center = [-10, -20, -30]
half_extents = [1, 2, 3]
rotation = { axis = [0, 2, 0], angle = 60 }
friction = 1.5
[[collider]]
type = "capsule"
from = [-10, -20, -30]
to = [-10, -22, -30]
radius = 0.5
[[pin_motion]]
vertices = [2]
velocity = [0, 1, 0]
spin = [2, 0, 0]
pivot = [1, 4, 2]
path = [{ t = -1, displacement = [0, 0, 0] }, { t = 0, displacement = [3, 0, 0] }, { t = 0.5, displacement = [3, 0, 2] }]
[time]
dt = 0.25
duration = 1.1
)";

TEST(SceneValues, OfTheClothAreThoseOfItsFile) {
  const Scene s = parse_scene("folder/all.toml", kEverything);
  EXPECT_EQ(s.name, "all");
  EXPECT_EQ(s.summary, "all of it");
  ASSERT_EQ(s.mesh.size(), 12);
  EXPECT_EQ(s.mesh.grid->nu, 3);
  EXPECT_EQ(s.mesh.grid->nv, 4);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 3; ++i) {
      const auto v = static_cast<std::size_t>(3 * j + i);
      expect_near(s.mesh.rest[v], Vec3(1, 2 + i, 3 - 2 * j));
      if (v != 1 && v != 5) expect_near(s.start.x[v], Vec3(1, 2 + 2 * i, 3 - 4 * j));
      const bool pin = v == 2 || v == 7 || v == 9;
      expect_near(s.start.v[v], v == 2 ? Vec3(0, -1, 8) : pin ? Vec3::Zero() : Vec3(1, 2, 4));
      // kg; 1 for an inner vertex
      const double lumped = (i == 1 ? 1 : 0.5) * (j % 3 == 0 ? 0.5 : 1),
                   factor = (v == 0 || v == 4 ? 3 : 1) * (j == 3 ? 0.5 : 1);
      EXPECT_NEAR(s.mesh.mass[v], lumped * factor, 1e-14) << v;
    }
  expect_near(s.start.x[5], Vec3(1.5, 6, -1));
  expect_near(s.start.x[1], Vec3(1, 4, 4));
  EXPECT_EQ(s.pins, (std::vector{2, 7, 9}));
  std::size_t shear = 0, bend = 0;
  for (const Link& l : s.links) {
    EXPECT_NE(l.family, Family::structural);
    (l.family == Family::shear ? shear : bend) += 1;
    EXPECT_NEAR(l.rest, l.family == Family::shear ? std::sqrt(5.0) : l.b == l.a + 2 ? 2 : 4, 1e-14);
  }
  EXPECT_EQ(shear, 12u);
  EXPECT_EQ(bend, 4u + 6u);
  EXPECT_EQ(s.thickness, 0.125);
  EXPECT_EQ(s.gravity, Vec3(0.5, -1, 2));
  EXPECT_EQ(s.damping, 0.25);
  EXPECT_EQ(s.self_collision->radius, 0.01);
  EXPECT_EQ(s.dt, 0.25);
  EXPECT_EQ(s.steps, 5);
}

TEST(SceneValues, OfWindCollidersAndMotionsAreThoseOfTheFile) {
  const Scene s = parse_scene("x", kEverything);
  EXPECT_EQ(s.wind->velocity, Vec3(3, 4, 5));
  EXPECT_EQ(s.wind->strength, 0.75);
  EXPECT_EQ(s.wind->law, Wind::Law::literal);
  ASSERT_EQ(s.colliders.size(), 4u);
  const auto& plane = std::get<Plane>(s.colliders[0].shape);
  expect_near(plane.normal, Vec3(0, 0.6, 0.8));
  EXPECT_EQ(plane.offset, -50);
  EXPECT_EQ(s.colliders[0].friction, 0.5);
  const Motion& m = s.colliders[0].motion;
  EXPECT_EQ(m.velocity, Vec3(1, 0, 0));
  EXPECT_EQ(m.spin, Vec3(0, 1, 0));
  EXPECT_EQ(m.pivot, Vec3(7, 8, 9));
  ASSERT_EQ(m.path.size(), 2u);
  EXPECT_EQ(m.path[0].t, -1);
  EXPECT_EQ(m.path[1].t, 2);
  EXPECT_EQ(m.path[1].displacement, Vec3(0, 4, 1));
  const auto& ball = std::get<Ball>(s.colliders[1].shape);
  EXPECT_EQ(ball.center, Vec3(10, 20, 30));
  EXPECT_EQ(ball.radius, 2);
  EXPECT_EQ(s.colliders[1].motion.pivot, ball.center) << "it turns about its middle";
  EXPECT_EQ(s.colliders[1].friction, 0);
  const auto& box = std::get<Box>(s.colliders[2].shape);
  EXPECT_EQ(box.half_extents, Vec3(1, 2, 3));
  EXPECT_EQ(s.colliders[2].motion.pivot, box.center);
  EXPECT_EQ(s.colliders[2].friction, 1.5);
  expect_near(box.rotation * Vec3::UnitX(), Vec3(0.5, 0, -std::sqrt(0.75)));
  const auto& capsule = std::get<Capsule>(s.colliders[3].shape);
  EXPECT_EQ(capsule.from, Vec3(-10, -20, -30));
  EXPECT_EQ(capsule.to, Vec3(-10, -22, -30));
  EXPECT_EQ(capsule.radius, 0.5);
  EXPECT_EQ(s.colliders[3].motion.pivot, Vec3(-10, -21, -30));
  ASSERT_EQ(s.pin_motions.size(), 1u);
  EXPECT_EQ(s.pin_motions[0].vertices, std::vector{2});
  EXPECT_EQ(s.pin_motions[0].motion.path.size(), 3u);
}

/// Text of a level sheet of 3 x 3 vertices half a metre apart, thickness 0, with additions to
/// [cloth] and further sections.
std::string level(const std::string& cloth = "", const std::string& more = "") {
  return "[cloth]\ngrid = [3, 3]\nsize = [1, 1]\nv = [0, 0, 1]\n" + cloth + "\n" + more;
}

TEST(SceneValues, EveryEdgeAndCornerOfAGridHasItsName) {
  const auto pins = [](const std::string& what) {
    return parse_scene("x", "cloth = { grid = [3, 4], size = [1, 1], pins = " + what + " }").pins;
  };
  EXPECT_EQ(pins("'top-left'"), std::vector{0});
  EXPECT_EQ(pins("'top-right'"), std::vector{2});
  EXPECT_EQ(pins("'bottom-left'"), std::vector{9});
  EXPECT_EQ(pins("'bottom-right'"), std::vector{11});
  EXPECT_EQ(pins("'top'"), (std::vector{0, 1, 2}));
  EXPECT_EQ(pins("'bottom'"), (std::vector{9, 10, 11}));
  EXPECT_EQ(pins("'left'"), (std::vector{0, 3, 6, 9}));
  EXPECT_EQ(pins("'right'"), (std::vector{2, 5, 8, 11}));
  EXPECT_EQ(pins("{ edge = 'left', at = 0.34 }"), (std::vector{3}));
  EXPECT_EQ(pins("{ edge = 'left', at = 1 }"), (std::vector{9}));
  EXPECT_EQ(pins("{ edge = 'bottom', at = 0.5 }"), (std::vector{10}));
  EXPECT_EQ(pins("{ edge = 'right', at = 0.5 }"), (std::vector{5})) << "the first of two";
  EXPECT_EQ(pins("[[0, 3], [2, 0], 11, 0]"), (std::vector{0, 2, 9, 11}));
  EXPECT_EQ(pins("{ min = [0.5, -0.5, 0], max = [1, 0, 0] }"), (std::vector{1, 2, 4, 5}));
}

TEST(SceneValues, WhatNamesNoVertexIsRefusedAtTheBorder) {
  const auto refused = [](const std::string& pins) {
    const std::string said =
        problems("[cloth]\ngrid = [3, 4]\nsize = [1, 1]\npins = [" + pins + "]\n");
    return said == "none" ? said : said.substr(said.find("] ") + 2);
  };
  EXPECT_EQ(refused("[2, 3]"), "none");
  for (const char* pair : {"[3, 0]", "[0, 4]", "[-1, 0]", "[0, -1]"})
    EXPECT_EQ(refused(pair),
              "names " + std::string(pair) + " outside the grid, which has [0, 0] to [2, 3]");
  EXPECT_EQ(refused("12"), "names vertex 12, but the cloth has 0 to 11");
  EXPECT_EQ(refused("1.5"), "names vertex 1.5, but the cloth has 0 to 11");
  for (const char* pair : {"[1]", "[1, 2, 3]", "[1, 2.0]", "[1.0, 2]", "['a', 2]"})
    EXPECT_EQ(refused(pair), "must be a pair of whole numbers [i, j]") << pair;
  EXPECT_EQ(refused("'tap'"), "names no edge or corner: \"tap\"; did you mean 'top'?");
  EXPECT_EQ(
      refused("true"),
      "must name vertices: a number, [i, j], an edge such as \"top\", a place { edge, at }, a box "
      "{ min, max } or a ball { center, radius }; not true");
  EXPECT_EQ(refused("{ edge = 'tap', at = 0.5 }"),
            "names no edge or corner: \"tap\"; did you mean 'top'?");
  EXPECT_NE(refused("{ edge = 'top', at = 1.5 }").find("at"), std::string::npos);
}

TEST(SceneValues, TheMassIsGivenOrFollowsFromTheArea) {
  const auto mass = [](const std::string& cloth) {
    double sum = 0;
    for (const double m : parse_scene("x", "[cloth]\ngrid = [2, 2]\n" + cloth).mesh.mass) sum += m;
    return sum;
  };
  EXPECT_NEAR(mass("size = [3, 2]"), 0.2 * 6, 1e-14);
  EXPECT_NEAR(mass("size = [3, 2]\nv = [1, -1, 0]"), 0.2 * 6 * std::sqrt(0.5), 1e-14) << "oblique";
  EXPECT_NEAR(mass("size = [3, 2]\narea_density = 7"), 42, 1e-12);
  EXPECT_NEAR(mass("size = [3, 2]\nmass = 7"), 7, 1e-14);
  EXPECT_EQ(
      problems("[cloth]\ngrid = [1, 2]\nsize = [0, 1]\narea_density = 1\n"),
      "x:4:16: 'area_density' in [cloth] means nothing for a cloth without area: give 'mass'");
  EXPECT_EQ(problems("[cloth]\ngrid = [1, 2]\nsize = [0, 1]\n"),
            "x:3:8: 'size' in [cloth] means nothing for a cloth without area: give 'mass'");
}

TEST(SceneValues, StepsReachTheDurationAndAreOneAtLeast) {
  const auto steps = [](const std::string& time) {
    return parse_scene("x", level(), {"time=" + time}).steps;
  };
  EXPECT_EQ(steps("{ dt = 0.25, duration = 2 }"), 8);
  EXPECT_EQ(steps("{ dt = 0.25, duration = 2.001 }"), 9);
  EXPECT_EQ(steps("{ dt = 0.25, duration = 1e-5 }"), 1);
  EXPECT_EQ(steps("{ dt = 0.1, duration = 1000 }"), 10000) << "float(0.1) is a little more";
  EXPECT_EQ(steps("{}"), 640);
  EXPECT_NEAR(steps("{ dt = 1e-3, duration = 1e6 }"), 1e9, 200);
  const std::string most =  // a rounding of 1e-7 of its 1.024e9 steps is tolerated
      "time={ dt = 0.0009765625, duration = 1e6 }";
  EXPECT_EQ(
      problems(level(), {most}),
      most + ": column 38: 'duration' in [time] makes 1023999898 steps; at most 1e9 are allowed");
}

// Three links form an arc whose ends are as far apart as a link is long: each link turns by a
// quarter of a circle.
TEST(SceneValues, ASpanBendsTheRowsAndATiltTurnsThem) {
  const Scene s = parse_scene(
      "x", "[cloth]\ngrid = [4, 2]\nsize = [3, 1]\nspan = 1\norigin = [5, 6, 7]\ntilt = 90\n");
  const Vec3 expected[] = {{5, 6, 7}, {5, 6, 6}, {6, 6, 6}, {6, 6, 7}};
  for (std::size_t i = 0; i < 4; ++i) {
    expect_near(s.start.x[i], expected[i]);
    expect_near(s.start.x[i + 4], expected[i] - Vec3::UnitZ());
  }
  EXPECT_EQ(problems("[cloth]\ngrid = [2, 2]\nsize = [3, 1]\nspan = 1\n"),
            "x:4:8: 'span' in [cloth] needs three vertices along u at least");
  EXPECT_EQ(problems("[cloth]\ngrid = [3, 2]\nsize = [3, 1]\nspan = 3.5\n"),
            "x:4:8: 'span' in [cloth] must be at most the width 3, not 3.5");
  expect_near(parse_scene("x", "[cloth]\ngrid = [3, 2]\nsize = [3, 1]\nspan = 3\n").start.x[2],
              Vec3(3, 0, 0));
}

TEST(SceneValues, AStartInsideAColliderIsMeasured) {
  const std::string plane = "[[collider]]\ntype = \"plane\"\nnormal = [-1, 0, 0]\noffset = -0.25\n",
                    advice =
                        " m deep; move one of them, or set start_inside = \"resolve\" in [cloth]";
  EXPECT_EQ(problems(level("", plane)),
            "x:6:1: the cloth starts inside this plane: 6 vertices, vertex 2 0.75" + advice);
  EXPECT_EQ(problems(level("pins = [2, 5]", plane)),
            "x:6:1: the cloth starts inside this plane: 4 vertices, vertex 8 0.75" + advice)
      << "a pin may be";
  EXPECT_EQ(problems(level("", plane), {"collider.0.offset=-0.95"}),
            "x:6:1: the cloth starts inside this plane: 3 vertices, vertex 2 0.05" + advice)
      << "not 0.050000000000000044";
  EXPECT_EQ(problems(level("pins = 'right'", plane)),
            "x:6:1: the cloth starts inside this plane: 3 vertices, vertex 1 0.25" + advice);
  EXPECT_EQ(problems(level("", plane), {"collider.0.offset=-1"}), "none") << "touches";
  // between two planes that leave no room
  EXPECT_EQ(
      problems(level("start_inside = 'resolve'",
                     plane + "[[collider]]\ntype = \"plane\"\nnormal = [1, 0, 0]\noffset = 0.5\n"))
              .find("start_inside = \"resolve\" found no way out") == std::string::npos,
      false);
  const Scene moved =
      parse_scene("x", level("pins = [2]\nthickness = 0.125\nstart_inside = 'resolve'", plane));
  expect_near(moved.start.x[2], Vec3(1, 0, 0));
  expect_near(moved.start.x[5], Vec3(0.125, 0, 0.5));
  expect_near(moved.start.x[3], Vec3(0, 0, 0.5));
  expect_near(moved.mesh.rest[5], Vec3(1, 0, 0.5));
}

TEST(SceneValues, APathJumpsIfAStepIsLongerThanTheCloth) {
  const auto moved = [](const std::string& motion) {
    return problems(
        "[cloth]\ngrid = [3, 3]\nsize = [3, 4]\n[time]\ndt = 0.25\n[[collider]]\n"
        "type = \"ball\"\ncenter = [0, 90, 0]\nradius = 1\n" +
        motion + "\n");
  };
  const auto path = [&](const std::string& t, const std::string& end) {
    return moved(
        "path = [{ t = 0, displacement = [0, 0, 0] }, { t = 1, displacement = [0, 1, 0] }, { t = " +
        t + ", displacement = [0, 1, " + end + "] }]");
  };
  EXPECT_EQ(path("1.125", "5"), "none") << "the diagonal";
  EXPECT_EQ(
      path("1.125", "-6"),
      "x:6:1: the path jumps: from key 2 to key 3 it makes 6 m within one time step, more than the "
      "size of the cloth");
  for (const char* same : {"velocity = [0, 0, 24]",
                           "path = [{ t = 0, displacement = [0, 0, 0] }, { t = 9, displacement = "
                           "[0, 0, 216] }]"})
    EXPECT_EQ(moved(same), "none") << same;
  EXPECT_EQ(problems(level("",
                           "[[collider]]\ntype = \"plane\"\noffset = -9\npath = [{ t = 1, "
                           "displacement = [0, 0, 0] }, { t = 0.5, displacement = [0, 0, 0] }]\n")),
            "x:9:52: 't' in 'path' in [[collider]] must grow from key to key: 0.5 follows 1");
}

TEST(SceneValues, ThicknessAndParticlesFitBetweenTheVertices) {
  const std::string ball = "[[collider]]\ntype = \"ball\"\ncenter = [0, 9, 0]\nradius = 1\n";
  for (const char* size : {"size=[1, 3]", "size=[3, 1]"}) {
    const std::string cloth = std::string("cloth.") + size;
    EXPECT_EQ(problems(level("thickness = 0.5", ball), {cloth}), "none");
    EXPECT_EQ(
        problems(level("thickness = 0.625", ball), {cloth}),
        "x:1:1: 'cloth' in the scene thickness 0.625 m is larger than the spacing 0.5 m of the "
        "vertices");
    EXPECT_EQ(problems(level("thickness = 0.625"), {cloth}), "none") << "nothing to keep away from";
    EXPECT_EQ(problems(level("", "[self_collision]\nradius = 0.25\n"), {cloth}), "none");
    EXPECT_EQ(problems(level("", "[self_collision]\nradius = 0.375\n"), {cloth}),
              "x:6:1: 'self_collision' in the scene particles of radius 0.375 m overlap at rest, "
              "where they are 0.5 m apart: at most half of that, or set overlap = true");
    EXPECT_EQ(problems(level("", "[self_collision]\nradius = 0.375\noverlap = true\n"), {cloth}),
              "none");
  }
}

TEST(SceneValues, PinsMoveOnceAndFacesAreWhatWindNeeds) {
  const std::string motion = "[[pin_motion]]\nvertices = [1]\nvelocity = [0, 1, 0]\n";
  EXPECT_EQ(problems(level("pins = [1]", motion)), "none");
  EXPECT_EQ(problems(level("pins = [0]", motion)),
            "x:7:12: 'vertices' in [[pin_motion]] names vertex 1, which is no pin");
  EXPECT_EQ(problems(level("pins = [1]", motion + motion)),
            "x:10:12: 'vertices' in [[pin_motion]] names vertex 1, which another pin_motion moves");
  EXPECT_EQ(problems("[wind]\n[cloth]\ngrid = [1, 3]\nsize = [0, 1]\nmass = 1\n"),
            "x:1:1: [wind] acts on faces, and this cloth has none");
  const Scene rests = parse_scene("x", level("pins = [1]", "[[pin_motion]]\nvertices = [1]\n"));
  EXPECT_TRUE(rests.pin_motions.empty()) << "that does not move";
}

TEST(SceneValues, TheFileComesFirstAndSettingsInTheirOrder) {
  EXPECT_EQ(problems("wind = 1\n" + level("mass = 0"), {"forces.damping=-2", "cloth.lumping='x'"}),
            "x:1:8: 'wind' in the scene must be a table, not a whole number\n"
            "x:6:8: 'mass' in [cloth] must be at least 1e-9 and at most 1e9, not 0\n"
            "cloth.lumping='x': column 15: 'lumping' in [cloth] must be \"area\" or \"equal\", not "
            "\"x\"\n"
            "forces.damping=-2: column 16: 'damping' in [forces] must be at least 0 and at most "
            "1e6, not -2");
}

}  // namespace
}  // namespace taut::scene_values_test
