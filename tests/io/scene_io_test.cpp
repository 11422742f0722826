// Scene files: shipped files load, documented facts hold, and errors are reported with their place.
#include "core/io/scene_io.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "core/io/fabrics.hpp"
#include "core/model/input_error.hpp"
#include "tests/support/numbers.hpp"

namespace taut::scene_io_test {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes";

std::vector<std::filesystem::path> shipped_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  return files;
}

Scene shipped(const std::string& name, const SceneSettings& settings = {}) {
  return load_scene(kScenes / (name + ".toml"), settings);
}

/// Errors in the text of a scene file called x; "" if there is no error.
std::string errors_of(const std::string& text, const SceneSettings& settings = {}) {
  try {
    parse_scene("x", text, settings);
  } catch (const InputError& error) {
    return std::string(error.what()) + "\n";
  }
  return "";
}

double total_mass(const Scene& scene) {
  return std::accumulate(scene.mesh.mass.begin(), scene.mesh.mass.end(), 0.0);
}

/// Largest |d / rest - 1| of a family at the start.
double start_strain(const Scene& scene, Family family) {
  double worst = 0;
  for (const Link& l : scene.links)
    if (l.family == family) {
      const auto a = static_cast<std::size_t>(l.a), b = static_cast<std::size_t>(l.b);
      worst = std::max(worst, std::abs((scene.start.x[b] - scene.start.x[a]).norm() / l.rest - 1));
    }
  return worst;
}

TEST(SceneFiles, StretchMovesTheStartAndWeightsTheMasses) {
  const Scene plain = shipped("hang"), scene = shipped("hang", {"cloth.stretch=100"});
  EXPECT_NEAR(start_strain(scene, Family::structural), 99, 1e-6);
  EXPECT_EQ(scene.links[0].rest, plain.links[0].rest);
  const Scene heavy = shipped("hang", {"cloth.weights=[{ vertices = [0, 5], factor = 1e6 }]"});
  for (const std::size_t i : {0u, 5u}) EXPECT_EQ(heavy.mesh.mass[i], 1e6 * plain.mesh.mass[i]);
  EXPECT_EQ(heavy.mesh.mass[1], plain.mesh.mass[1]);
  EXPECT_THROW(shipped("hang", {"cloth.weights=[{ vertices = [0] }]"}), InputError);
  EXPECT_THROW(shipped("hang", {"cloth.stretch=0"}), InputError);
}

TEST(SceneFiles, EveryShippedSceneLoadsAndStartsUnstretched) {
  EXPECT_GE(shipped_files().size(), 11u);
  for (const auto& file : shipped_files()) {
    const Scene scene = load_scene(file);
    EXPECT_EQ(scene.name, file.stem());
    EXPECT_FALSE(scene.summary.empty()) << file;
    EXPECT_GT(scene.steps, 0) << file;
    EXPECT_EQ(scene.start.x.size(), scene.mesh.rest.size()) << file;
    EXPECT_EQ(scene.start.v.size(), scene.mesh.rest.size()) << file;
    for (const Family family : kFamilies) EXPECT_LT(start_strain(scene, family), 1e-13) << file;
  }
}

TEST(SceneFiles, TheHangingSheetIsAsDocumented) {
  const Scene hang = shipped("hang");
  EXPECT_EQ(hang.mesh.size(), 32 * 32);
  EXPECT_EQ(hang.pins, (std::vector{0, 31}));
  EXPECT_EQ(hang.links.size(), 2u * 32 * 31 + 2u * 31 * 31);
  EXPECT_EQ(hang.dt, 1.0 / 64);
  EXPECT_EQ(hang.steps, 640);
  EXPECT_NEAR(total_mass(hang), 0.2, 1e-14);
}

TEST(SceneFiles, CornerPinsFollowAnOverriddenGrid) {
  EXPECT_EQ(shipped("hang", {"cloth.grid=[33, 17]"}).pins, (std::vector{0, 32}));
}

TEST(SceneFiles, VerticesAreNamedByNumberIndexEdgeCornerOrBox) {
  const auto pins = [](const std::string& what) {
    return shipped("hang", {"cloth.grid=[3, 2]", "cloth.pins=" + what}).pins;
  };
  EXPECT_EQ(pins("[4, 0]"), (std::vector{0, 4}));
  EXPECT_EQ(pins("[[2, 1], [0, 0]]"), (std::vector{0, 5}));
  EXPECT_EQ(pins("\"top\""), (std::vector{0, 1, 2}));
  EXPECT_EQ(pins("[\"bottom\", \"left\"]"), (std::vector{0, 3, 4, 5}));
  EXPECT_EQ(pins("[\"right\"]"), (std::vector{2, 5}));
  EXPECT_EQ(pins("[\"bottom-right\", 5, [2, 1]]"), (std::vector{5}));
  EXPECT_EQ(pins("[{ min = [0.5, -1, 0], max = [1, 0, 0] }]"), (std::vector{1, 2, 4, 5}));
  EXPECT_EQ(pins("{ min = [0, 0, 0], max = [0.1, 0, 0] }"), (std::vector{0}));
}

TEST(SceneFiles, ASpanHangsTheRowsWithoutStretchingThem) {
  for (const char* span : {"0.05", "0.8", "0.9999"}) {
    const Scene drape = shipped("drape", {std::string("cloth.span=") + span});
    EXPECT_LT(start_strain(drape, Family::structural), 1e-12) << span;
    const Vec3 right = drape.start.x[31];
    EXPECT_EQ(right, Vec3(number_at(span), 0, 0));
    EXPECT_LT(drape.start.x[16].y(), 0);  // it sags
  }
  const Scene skewed = shipped("drape", {"cloth.span=0.8", "cloth.v=[0.6, -0.8, 0.3]"});
  EXPECT_LT(start_strain(skewed, Family::structural), 1e-12) << "in a parallelogram too";
  EXPECT_LT(skewed.start.x[16].y(), 0);
}

TEST(SceneFiles, ATiltTurnsTheSheetAboutItsTopEdge) {
  const Scene swing = shipped("swing", {"cloth.tilt=90"});
  EXPECT_EQ(swing.start.x[31], Vec3(1, 0, 0));
  EXPECT_LT((swing.start.x.back() - Vec3(1, 0, -1)).norm(), 1e-15);
}

TEST(SceneFiles, TheTimeStepIsRoundedToBinary32) {
  const Scene a = shipped("hang", {"time.dt=\"1/60\"", "time.duration=10"});
  EXPECT_EQ(a.dt, static_cast<double>(1.0f / 60));
  EXPECT_EQ(a.steps, 600);
  // the number of steps is rounded down
  const Scene b = shipped("hang", {"time.dt=0.01", "time.duration=10"});
  EXPECT_EQ(b.steps, 1000);
  EXPECT_EQ(shipped("hang", {"time.dt=0.3", "time.duration=1"}).steps, 4);
}

TEST(SceneFiles, SettingsReplaceAddAndPickElements) {
  const Scene scene =
      shipped("ball", {"collider.0.radius=\"2/5\"", "wind.velocity=[1, 0, 0]", "cloth.mass=3"});
  EXPECT_EQ(std::get<Ball>(scene.colliders[0].shape).radius, 0.4);
  EXPECT_EQ(scene.wind->velocity, Vec3(1, 0, 0));
  EXPECT_NEAR(total_mass(scene), 3, 1e-13);
  EXPECT_TRUE(content(shipped("ball", {"summary=\"other\""})) == content(shipped("ball")));
}

TEST(SceneFiles, ABoxTurnsByAxisAndAngleOrByAQuaternion) {
  const auto rotation = [](const std::string& text) {
    return std::get<Box>(shipped("box", {"collider.0.rotation=" + text}).colliders[0].shape)
        .rotation;
  };
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(std::acos(-1.0) / 2, Vec3::UnitZ()));
  EXPECT_TRUE(rotation("{ axis = [0, 0, 7], angle = 90 }").isApprox(quarter, 1e-15));
  EXPECT_TRUE(rotation("[3, 0, 0, 3]").isApprox(quarter, 1e-15));
  EXPECT_THROW(rotation("[0, 0, 0, 0]"), InputError);
  EXPECT_THROW(rotation("45"), InputError);
}

TEST(SceneFiles, PinsMoveAndStartWithTheVelocityOfTheirMotion) {
  const std::string text(
      R"(cloth = { grid = [2, 2], size = [1, 1], pins = ["top"], velocity = [0, 0, 5] }
[[pin_motion]]
vertices = [1]
velocity = [2, 0, 0]
spin = [0, 0, 3]
pivot = [0, 1, 0]
path = [{ t = 0, displacement = [0, 0, 0] }, { t = 2, displacement = [0, 0, 1] }]
)");
  const Scene scene = parse_scene("x", text);
  EXPECT_EQ(scene.start.v[0], Vec3::Zero());
  EXPECT_EQ(scene.start.v[1], Vec3(5, 3, 0.5));
  EXPECT_EQ(scene.start.v[3], Vec3(0, 0, 5));
  const double h = 1e-7;
  EXPECT_LT(((pin_position(scene, 1, h) - pin_position(scene, 1, 0)) / h - scene.start.v[1]).norm(),
            1e-5);
}

TEST(SceneFiles, EverythingWrongIsListedAtOnceWithItsPlace) {
  const std::string text(R"(sumary = "x"
[cloth]
gird = [3, 3]
size = [1, -1]
mass = 0
[links]
shear = 1
[[collider]]
type = "bal"
[time]
dt = "soon"
duration = inf
)");
  EXPECT_EQ(errors_of(text),
            "x:1:1: unknown key 'sumary' in the scene; did you mean 'summary'?\n"
            "x:2:1: missing key 'grid' in [cloth]\n"
            "x:3:1: unknown key 'gird' in [cloth]; did you mean 'grid'?\n"
            "x:4:12: 'size' in [cloth] must be at least 0 and at most 1e6, not -1\n"
            "x:5:8: 'mass' in [cloth] must be at least 1e-9 and at most 1e9, not 0\n"
            "x:7:9: 'shear' in [links] must be true or false, not a whole number\n"
            "x:9:8: 'type' in [[collider]] must be \"plane\" or \"ball\" or \"box\" or "
            "\"capsule\" or \"mesh\", not \"bal\"; did you mean 'ball'?\n"
            "x:11:6: 'dt' in [time] must be a number in s or a fraction such as \"1/64\", not the "
            "string \"soon\"\n"
            "x:12:12: 'duration' in [time] must be finite\n");
}

TEST(SceneFiles, EachKindOfBadInputIsNamed) {
  const std::map<std::string, std::string> wrong{
      {"cloth.grid=[1, 1]", "a cloth of one vertex"},
      {"cloth.grid=[0, 4]", "must be at least 1"},
      {"cloth.grid=[2.5, 4]", "whole numbers"},
      {"cloth.grid=[100000, 100000]", "at most 16777216"},
      {"cloth.grid=4", "an array of 2 numbers"},
      {"cloth.size=[0, 1]", "must be greater than 0"},
      {"cloth.size=[1e-300, 1]", "on top of each other"},
      {"cloth.size=[1, -1]", "must be at least 0"},
      {"cloth.mass=-0.2", "'mass' in [cloth] must be"},
      {"cloth.mass=nan", "must be finite"},
      {"cloth.area_density=1", "excludes 'mass'"},
      {"cloth.v=[2, 0, 0]", "parallel"},
      {"cloth.u=[0, 0, 0]", "must not be zero"},
      {"cloth.pins=[[32, 0]]", "[32, 0] outside the grid"},
      {"cloth.pins=[1024]", "vertex 1024"},
      {"cloth.pins=[-1]", "vertex -1"},
      {"cloth.pins=[\"topp\"]", "did you mean 'top'?"},
      {"cloth.pins=[{ min = [5, 5, 5], max = [6, 6, 6] }]", "holds no vertex"},
      {"cloth.pins=[{ min = [5, 5, 5] }]", "missing key 'max'"},
      {"cloth.pins=true", "must name vertices"},
      {"cloth.placed=[{ vertex = [0, 0] }]", "missing key 'at'"},
      {"cloth.placed=[{ vertex = \"top\", at = [0, 0, 0] }]", "must name one vertex"},
      {"cloth.span=1.5", "at most the width"},
      {"cloth.span=0", "greater than 0"},
      {"cloth.scale=2", "belongs to a mesh, not to a grid"},
      {"cloth.weld=1", "belongs to a mesh, not to a grid"},
      {"cloth.lumping=\"aera\"", "did you mean 'area'?"},
      {"cloth.velocity=[inf, 0, 0]", "must be finite"},
      {"links.damping=-1", "'damping' in [links] must be at least 0"},
      {"links.damping=inf", "'damping' in [links] must be finite"},
      {"links.damping=1e-3", "'damping' in [links] is in proportion to the stiffness of links"},
      {"links={ damping = 1e-3, bend = false, stiffness = { bend = 10 } }", "these are rigid"},
      {"forces.damping=-1", "'damping' in [forces] must be at least 0"},
      {"forces.gravity=[0, 1]", "an array of 3 numbers"},
      {"wind.strength=-1", "'strength' in [wind]"},
      {"wind=3", "must be a table"},
      {"wind.speed=3", "unknown key 'speed' in [wind]"},
      {"self_collision={}", "missing key 'radius'"},
      {"self_collision.radius=0", "greater than 0"},
      {"time.dt=0", "'dt' in [time]"},
      {"time.dt=-0.1", "'dt' in [time]"},
      {"time.dt=\"1/0\"", "'dt' in [time]"},
      {"time.dt=1e-300", "'dt' in [time]"},
      {"time.duration=0", "'duration' in [time]"},
      {"time.duration=1979-05-27", "not a date"},
      {"time={ dt = 1e-7, duration = 1e6 }", "steps; at most 1e9"},
      {"collider=[{ type = \"ball\", center = [0, 0, 0] }]", "missing key 'radius'"},
      {"collider=[{ type = \"ball\", center = [0, 0, 0], radius = -1 }]",
       "'radius' in [[collider]] must be greater than 0"},
      {"self_collision.radius=-0.01", "greater than 0"},
      {"collider=[{ type = \"ball\", center = [0, 0, 0], radius = 1, normal = [0, 1, 0] }]",
       "unknown key 'normal'"},
      {"collider=[{ type = \"box\", center = [0, 0, 0], half_extents = [1, 0, 1] }]",
       "'half_extents' in [[collider]] must be greater than 0"},
      {"collider=[{ type = \"capsule\", from = [0, 0, 0], radius = 1 }]", "missing key 'to'"},
      {"collider=[{ type = \"capsule\", from = [0, 0, 0], to = [0, 1, 0], radius = 0 }]",
       "'radius' in [[collider]] must be greater than 0"},
      {"collider=[{ type = \"capsule\", from = [0, 0, 0], to = [0, 1, 0], radius = 1, center = "
       "[0, 0, 0] }]",
       "unknown key 'center'"},
      {"collider=[{ type = \"plane\", normal = [0, 0, 0] }]", "must not be zero"},
      {"collider=[{ type = \"plane\", path = [{ t = 1, displacement = [0, 0, 0] }, "
       "{ t = 1, displacement = [0, 0, 0] }] }]",
       "must grow"},
      {"collider=[{ radius = 1 }]", "missing key 'type'"},
      {"collider.0.radius=1", "[[collider]]"},
      {"pin_motion=[{ vertices = [5], velocity = [1, 0, 0] }]", "vertex 5, which is no pin"},
      {"pin_motion=[{ vertices = [0] }, { vertices = [0] }]", "which another pin_motion moves"},
      {"time.dt=1/60", "Error while parsing"},
  };
  for (const auto& [assignment, expected] : wrong) {
    try {
      shipped("hang", {assignment});
      ADD_FAILURE() << assignment << " was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos)
          << assignment << "\n  says " << error.what() << "\n  not " << expected;
      EXPECT_NE(std::string(error.what()).find(assignment), std::string::npos)
          << error.what() << " does not name the setting";
    }
  }
}

TEST(SceneFiles, WhatMakesContactMeaninglessIsRefused) {
  const auto refused = [](const char* scene, SceneSettings settings, const std::string& expected) {
    try {
      shipped(scene, settings);
      ADD_FAILURE() << scene << " was accepted; expected: " << expected;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  };
  refused("ball", {"cloth.origin=[-0.5, 0.1, 0.5]"},
          "ball.toml:10:1: the cloth starts inside this ball");
  refused("box", {"cloth.origin=[-0.5, 0, 0.5]"}, "the cloth starts inside this box");
  refused("plane", {"cloth.origin=[0, -1, 0]"}, "start_inside = \"resolve\"");
  refused("ball", {"cloth.thickness=0.05"},
          "thickness 0.05 m is larger than the spacing 0.03125 m");
  refused("crumple", {"self_collision.radius=0.02"}, "overlap at rest");
  refused("moving-ball", {"collider.0.path.1.t=0.001"}, "the path jumps");
  refused("hang",
          {"self_collision.radius=0.01",
           "cloth.placed=[{ vertex = [5, 5], at = [0.5, -0.8, 0.1] }, "
           "{ vertex = [6, 5], at = [0.5, -0.8, -0.1] }]"},
          "the cloth starts through itself");
}

TEST(SceneFiles, BendingIsOneStiffnessOrThatOfWarpAndWeft) {
  EXPECT_FALSE(shipped("hang").bending);
  const Scene one = shipped("hang", {"bending.stiffness=2e-5"}),
              two = shipped("hang", {"bending.stiffness={ warp = 2e-5, weft = 1e-6 }"}),
              turned = shipped("hang", {"bending.stiffness=1", "bending.warp=[2, 0, 0]"});
  EXPECT_EQ(one.bending->warp, 2e-5);
  EXPECT_EQ(one.bending->weft, 2e-5);
  EXPECT_EQ(two.bending->weft, 1e-6);
  EXPECT_EQ(two.bending->direction, -Vec3::UnitY()) << "along v";
  EXPECT_EQ(turned.bending->direction, Vec3::UnitX());
  const std::string cloth = "cloth = { grid = [2, 2], size = [1, 1] }\n";
  const auto error = [&](const std::string& bending, const std::string& start) {
    return errors_of(start + "[bending]\n" + bending);
  };
  EXPECT_NE(error("stiffness = 0", cloth).find(":3:"), std::string::npos);
  EXPECT_NE(error("stiffness = 0", cloth).find("stiffness"), std::string::npos);
  EXPECT_NE(error("", cloth).find("'stiffness'"), std::string::npos);
  EXPECT_NE(error("stiffness = { warp = 1 }", cloth).find("'weft'"), std::string::npos);
  EXPECT_NE(error("stiffness = { warp = 1, weft = 1, bias = 1 }", cloth).find("bias"),
            std::string::npos);
  EXPECT_NE(error("stiffness = 1\nstifness = 1", cloth).find("stifness"), std::string::npos);
  EXPECT_NE(error("stiffness = 1", "cloth = { grid = [1, 9], size = [0, 1], mass = 1 }\n")
                .find("[bending] acts on faces"),
            std::string::npos);
}

TEST(SceneFiles, AMembraneTakesThePlaceOfLinks) {
  EXPECT_FALSE(shipped("hang").membrane);
  const Scene one = shipped("hang", {"membrane.stiffness=1000"}),
              two = shipped("hang", {"membrane.stiffness={ warp = 1200, weft = 800 }",
                                     "membrane.poisson=0.3", "membrane.shear=350"}),
              arap = shipped("hang", {"membrane.stiffness=1000", "membrane.law=\"arap\""}),
              bent = shipped("hang", {"membrane.stiffness=1000", "links.bend=true"});
  EXPECT_TRUE(one.links.empty());
  EXPECT_EQ(one.membrane->law, Membrane::Law::stvk);
  EXPECT_EQ(one.membrane->warp, 1000);
  EXPECT_EQ(one.membrane->weft, 1000);
  EXPECT_EQ(one.membrane->poisson, 0);
  EXPECT_EQ(one.membrane->shear, 500) << "of a material that is the same in all directions";
  EXPECT_EQ(one.membrane->direction, -Vec3::UnitY()) << "along v";
  EXPECT_EQ(two.membrane->weft, 800);
  EXPECT_EQ(two.membrane->poisson, 0.3);
  EXPECT_EQ(two.membrane->shear, 350);
  EXPECT_EQ(two.membrane->damping, 0);
  EXPECT_EQ(shipped("hang", {"membrane={ stiffness = 1000, damping = 0.25 }"}).membrane->damping,
            0.25);
  EXPECT_EQ(arap.membrane->law, Membrane::Law::arap);
  EXPECT_FALSE(bent.links.empty()) << "what it does not double";
  std::set<std::string> contents{content(shipped("hang")), content(one), content(two),
                                 content(arap), content(bent)};
  EXPECT_EQ(contents.size(), 5u);
  const auto turned = [](const SceneSettings& more) {
    SceneSettings all{"membrane.stiffness=1000", "bending.stiffness=1e-6"};
    all.insert(all.end(), more.begin(), more.end());
    return shipped("hang", all);
  };
  for (const Scene& s : {turned({"bending.warp=[1, 0, 0]"}), turned({"membrane.warp=[3, 0, 0]"}),
                         turned({"membrane.warp=[1, 0, 0]", "bending.warp=[1, 0, 0]"})}) {
    EXPECT_EQ(s.membrane->direction, Vec3::UnitX());
    EXPECT_EQ(s.bending->direction, Vec3::UnitX()) << "one warp for both";
  }
}

TEST(SceneFiles, AMembraneThatIsNoneIsRefusedWithLineAndKey) {
  const std::string cloth = "cloth = { grid = [3, 3], size = [1, 1] }\n";
  const auto refused = [&](const std::string& membrane, const std::string& place,
                           const std::string& words, const std::string& start) {
    const std::string all = errors_of(start + "[membrane]\n" + membrane);
    EXPECT_NE(all.find(place), std::string::npos) << membrane << " got: " << all;
    EXPECT_NE(all.find(words), std::string::npos) << all;
  };
  refused("stiffness = 0", ":3:13", "'stiffness' in [membrane] must be", cloth);
  refused("stiffness = -5", ":3:13", "'stiffness' in [membrane] must be", cloth);
  refused("", ":2:1", "missing key 'stiffness'", cloth);
  refused("stiffness = 10\nstifness = 1", ":4:1", "stifness", cloth);
  refused("stiffness = 10\nlaw = \"neo\"", ":4:7", "'law' in [membrane] must be", cloth);
  refused("stiffness = 10\npoisson = 1", ":4:11", "'poisson' in [membrane] must be within 1",
          cloth);
  refused("stiffness = 10\npoisson = -1", ":4:11", "'poisson' in [membrane]", cloth);
  refused("stiffness = { warp = 1, weft = 4 }\nshear = 1\npoisson = 0.5", ":5:11",
          "must be within 0.5", cloth);
  refused("stiffness = { warp = 1, weft = 4 }", ":2:1", "missing key 'shear'", cloth);
  refused("stiffness = 10\nlaw = \"arap\"\npoisson = 0.2", ":5:11", "is not free", cloth);
  refused("stiffness = 10\nlaw = \"arap\"\nshear = 0.2", ":5:9", "is not free", cloth);
  refused("stiffness = { warp = 1, weft = 4 }\nlaw = \"arap\"", ":3:13", "one number", cloth);
  refused("stiffness = 10\nlaw = \"arap\"\ndamping = 1e-3", ":5:11", "Green's strain", cloth);
  refused("stiffness = 10\ndamping = -1", ":4:11", "'damping' in [membrane] must be", cloth);
  refused("stiffness = 10\nwarp = [1, 0, 0]", ":5:8", "a cloth has one warp",
          cloth + "bending = { stiffness = 1, warp = [0, 1, 0] }\n");
  refused("stiffness = 10", ":2:24", "'structural' in [links] doubles the membrane",
          cloth + "links = { structural = true }\n");
  refused("stiffness = 10", ":2:19", "'shear' in [links] doubles the membrane",
          cloth + "links = { shear = true }\n");
  refused("stiffness = 10", ":2:", "acts on faces",
          "cloth = { grid = [1, 9], size = [0, 1], mass = 1 }\n");
  refused("stiffness = 10", ":2:", "starts on a line",
          "cloth = { grid = [3, 3], size = [1, 1], placed = [{ vertex = 0, at = [0.5, -0.25, 0] "
          "}] }\n");
}

TEST(SceneFiles, AFabricIsMassAndBendingInPlaceOfTheScenes) {
  const Scene s = shipped("hang", {"fabric=\"petrak-m1\""});
  double mass = 0;
  for (const double m : s.mesh.mass) mass += m;
  EXPECT_NEAR(mass, 0.135, 1e-12) << "of 1 m^2";
  EXPECT_EQ(s.bending->warp, 1950e-9);
  EXPECT_EQ(s.bending->weft, 610e-9);
  EXPECT_EQ(s.bending->direction, -Vec3::UnitY());
  for (const Fabric& fabric : fabrics()) {
    EXPECT_EQ(shipped("drape-disc", {"fabric=\"" + std::string(fabric.name) + "\""}).bending->warp,
              fabric.warp);
    EXPECT_TRUE(fabric.drape > 0 && fabric.drape < 1) << fabric.name;
  }
  EXPECT_NE(errors_of("fabric = \"petrak-m\"\ncloth = { grid = [2, 2], size = [1, 1] }")
                .find("not 'petrak-m'; did you mean 'petrak-m1'"),
            std::string::npos);
}

TEST(SceneFiles, WhatIsSetBesideAFabricContradictsIt) {
  const auto beside = [](const std::string& cloth, const std::string& rest,
                         const SceneSettings& settings) {
    return errors_of("cloth = { grid = [2, 2], size = [1, 1]" + cloth + " }\n" + rest, settings);
  };
  const std::string fabric = "fabric = \"petrak-m1\"", stiff = "bending = { stiffness = 1 }";
  EXPECT_EQ(beside(", mass = 1", stiff, {fabric}), "") << "which replaces what the file says";
  for (const auto& [cloth, rest, settings, says] :
       std::vector<std::tuple<std::string, std::string, SceneSettings, std::string>>{
           {", mass = 1", fabric, {}, "'mass' in [cloth]"},
           {", area_density = 1", fabric, {}, "'area_density' in [cloth]"},
           {"", fabric + "\n" + stiff, {}, "'stiffness' in [bending]"},
           {"", fabric, {"cloth.mass=3"}, "cloth.mass=3: column 12: 'mass' in [cloth]"},
           {"", "", {fabric, "cloth.mass=3"}, "'mass' in [cloth]"},
           {"", "", {"cloth.mass=3", fabric}, "'mass' in [cloth]"},
           {", mass = 1", stiff, {fabric, "bending.stiffness=2"}, "'stiffness' in [bending]"},
           {"",
            "bending.stiffness = { warp = 1, weft = 1 }",
            {fabric, "bending.stiffness.weft=2"},
            "'stiffness' in [bending]"},
           {"",
            "bending.stiffness = { warp = 1, weft = 1 }",
            {fabric, "bending.stiffness.warp=2"},
            "'stiffness' in [bending]"}}) {
    const std::string errors = beside(cloth, rest, settings);
    EXPECT_NE(errors.find(says + " conflicts with fabric = \"petrak-m1\", which sets it"),
              std::string::npos)
        << cloth << rest << errors;
  }
}

TEST(SceneFiles, ABallNamesTheVerticesInsideIt) {
  EXPECT_EQ(
      shipped("hang", {"cloth.grid=[3, 3]", "cloth.pins=[{ center = [0, 0, 0], radius = 0.5 }]"})
          .pins,
      (std::vector{0, 1, 3}));
  EXPECT_NE(errors_of("[cloth]\ngrid = [2, 2]\nsize = [1, 1]\n"
                      "pins = [{ center = [9, 0, 0], radius = 1 }]")
                .find(":4:9: 'pins' in [cloth] has a ball that holds no vertex"),
            std::string::npos);
}

TEST(SceneFiles, StiffnessIsOfTheFamiliesThatAreNamed) {
  const Scene rigid = shipped("hang"),
              elastic = shipped("hang", {"links.stiffness.shear=50", "links.stiffness.bend=0.25"});
  EXPECT_EQ(rigid.stiffness, kRigid);
  EXPECT_EQ(elastic.stiffness, (std::array{kRigid[0], 50.0, 0.25}));
  EXPECT_EQ(elastic_links(rigid), std::vector<std::string>{});
  EXPECT_EQ(elastic_links(elastic), std::vector<std::string>{"links of 50 N/m"}) << "none is bend";
  EXPECT_EQ(content(elastic).substr(0, content(rigid).size()), content(rigid));
  const std::string start = "cloth = { grid = [2, 2], size = [1, 1] }\n[links]\n";
  EXPECT_NE(errors_of(start + "stiffness = { shear = 0, sheer = 1 }").find("sheer"),
            std::string::npos);
  EXPECT_NE(errors_of(start + "stiffness = { shear = 0 }").find("x:3"), std::string::npos);
  EXPECT_NE(errors_of(start + "stiffness = 500").find("stiffness"), std::string::npos);
}

TEST(SceneFiles, AClothThatStartsInsideIsMovedOutIfItIsWished) {
  const Scene scene =
      shipped("ball", {"cloth.origin=[-0.5, 0.1, 0.5]", "cloth.start_inside=\"resolve\""});
  double least = 1;
  for (const Vec3& x : scene.start.x)
    least = std::min(least, surface(scene.colliders[0].shape, x).distance);
  EXPECT_NEAR(least, scene.thickness, 1e-15);
  EXPECT_EQ(scene.mesh.rest[0], Vec3(-0.5, 0.1, 0.5));
}

TEST(SceneFiles, PinsMayBeInsideACollider) {
  EXPECT_NO_THROW(shipped("ball", {"cloth.origin=[-0.5, 0.29999, 0.5]", "cloth.pins=[[16, 16]]"}));
}

TEST(SceneFiles, WindNeedsFaces) {
  EXPECT_THROW(shipped("chain", {"wind.velocity=[1, 0, 0]"}), InputError);
}

TEST(SceneFiles, MalformedAndMissingFilesAreInputErrors) {
  EXPECT_EQ(errors_of("summary = 1\nsummary = 2\n").rfind("x:2:", 0), 0u);  // duplicate
  EXPECT_EQ(errors_of("[cloth\ngrid = [3, 3]").rfind("x:1:", 0), 0u);
  EXPECT_EQ(errors_of(""), "x:1:1: missing key 'cloth' in the scene\n");
  EXPECT_THROW(load_scene("no/such/scene.toml"), InputError);
  EXPECT_THROW(load_scene(kScenes), InputError);
}

/// Cells of every row of the README's key tables: key, ..., default, example.
std::vector<std::vector<std::string>> documented_keys() {
  std::ifstream in(kScenes / "README.md");
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '|');) {
      const auto begin = cell.find_first_not_of(' '), end = cell.find_last_not_of(' ');
      cells.push_back(begin == cell.npos ? "" : cell.substr(begin, end - begin + 1));
    }
    if (cells.size() >= 8 && cells[1].front() == '`') rows.push_back(cells);
  }
  return rows;
}

std::string unquoted(const std::string& cell) { return cell.substr(1, cell.size() - 2); }

/// Scene with each kind of section and no optional keys. The exception is cloth.start_inside, which
/// lets the obstacles stay at their default places.
constexpr const char* kBare = R"(
cloth = { grid = [32, 32], size = [1, 1], pins = ["top"], start_inside = "resolve" }
wind = {}
self_collision = { radius = 0.015 }
bending = { stiffness = 1e-5 }
[[collider]]
type = "plane"
[[collider]]
type = "ball"
center = [0, -9, 0]
radius = 1
[[collider]]
type = "box"
center = [0, -9, 0]
half_extents = [1, 1, 1]
[[collider]]
type = "capsule"
from = [0, -9, 0]
to = [0, -9, 1]
radius = 1
[[pin_motion]]
vertices = ["top-right"]
path = [{ t = 1, displacement = [0, 0, 1] }]
[[seam]]
a = [64, 65, 66]
b = [72, 73, 74]
)";

/// Dotted key with which a setting reaches a documented key in kBare.
std::string path_to(const std::string& key, const std::string& meaning) {
  const auto dot = key.find('.');
  const auto about = [&](const char* type) { return meaning.rfind(type, 0) == 0; };
  if (key.rfind("collider.", 0) == 0)
    return std::string("collider.") +
           (about("ball")      ? "1"
            : about("box")     ? "2"
            : about("capsule") ? "3"
                               : "0") +
           key.substr(dot);
  for (const std::string section : {"pin_motion", "seam"})
    if (key.starts_with(section + ".")) return section + ".0" + key.substr(dot);
  return key;
}

TEST(SceneSchema, EveryDocumentedExampleIsAccepted) {
  const auto rows = documented_keys();
  EXPECT_GE(rows.size(), 40u);
  for (const auto& row : rows) {
    const std::string key = unquoted(row[1]), fallback = row[5], example = unquoted(row[6]);
    const bool mesh = row[7].ends_with("; mesh") || key == "cloth.mesh";
    const bool body = row[7].starts_with("mesh: ");
    const auto load = [&](SceneSettings settings) {
      if (key == "collider.frames" || key == "collider.fps") return shipped("skirt", settings);
      if (body) return shipped("mesh-box", settings);
      if (mesh) settings.emplace_back("cloth.start_inside=\"resolve\"");
      if (key == "membrane.stiffness") settings.emplace(settings.begin(), "membrane.shear=350");
      if (key == "links.damping")
        settings.emplace(settings.begin(), "links.stiffness={ structural = 1000 }");
      if (key.starts_with("membrane."))
        settings.emplace(settings.begin(), "membrane.stiffness=1000");
      return mesh ? shipped("disc", settings) : parse_scene("bare", kBare, settings);
    };
    const std::string path = path_to(key, row[7]);
    const Scene plain = load({});
    Scene changed;
    ASSERT_NO_THROW(changed = load({path + "=" + example})) << key;
    const bool permits = key == "cloth.start_inside" || key == "self_collision.overlap";
    if (fallback.empty() || fallback.front() != '`' || permits) continue;
    EXPECT_TRUE(content(load({path + "=" + unquoted(fallback)})) == content(plain))
        << key << " = " << fallback;
    if (key != "summary") {
      EXPECT_FALSE(content(changed) == content(plain)) << key << " has no effect";
    }
  }
}

TEST(SceneSchema, TheDocumentedFileLoads) {
  std::ifstream in(kScenes / "README.md");
  const std::string all{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const auto begin = all.find("```toml\n") + 8;
  EXPECT_EQ(errors_of(all.substr(begin, all.find("```", begin) - begin)), "");
}

}  // namespace
}  // namespace taut::scene_io_test
