// Answers of programs that speak taut-solver/1, and commands that start such programs: what is
// accepted and what is refused.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/model/body_frames.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/triangle_mesh.hpp"
#include "experiments/external/connection.hpp"
#include "experiments/external/external.hpp"
#include "experiments/external/probe.hpp"
#include "experiments/external/protocol.hpp"
#include "experiments/external/sdk/taut_solver.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "tests/support/cloths.hpp"

namespace taut::external::answers_test {
namespace {

/// Message with which the reader refuses the answer; "" if it accepts it.
template <class Read>
std::string refusal(const Read& read) {
  try {
    read();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

Json hello_with(const std::string& name, const Json& spec) {
  return {
      {"protocol", "taut-solver/1"}, {"name", "p"}, {"version", "2"}, {"params", {{name, spec}}}};
}

Json integer(double least, double given, double most) {
  return {{"type", "integer"}, {"min", least}, {"default", given}, {"max", most}};
}

std::string refused_param(const Json& spec, const std::string& name = "n") {
  return refusal([&] { read_hello(hello_with(name, spec)); });
}

TEST(Hello, HasParametersOfEveryType) {
  Json answer = hello_with("n", integer(-3, 2, 7));
  answer["params"]["n"]["unit"] = "m";
  answer["params"]["n"]["doc"] = "help";
  answer["params"]["r"] = {{"type", "real"}, {"min", 0}, {"max", 1}, {"default", 0.25}};
  answer["params"]["c"] = {{"type", "choice"}, {"choices", {"a", "b"}}, {"default", "b"}};
  answer["params"]["t"] = {{"type", "text"}, {"default", "x y"}};
  const auto hello = read_hello(answer);
  EXPECT_EQ(hello->name + hello->version, "p2");
  EXPECT_EQ(hello->summary, "p");
  EXPECT_EQ(hello->source, "p 2");
  EXPECT_EQ(hello->unmeasurable, "");
  std::map<std::string, ParamSpec> specs;
  for (const ParamSpec& spec : hello->params) specs[std::string(spec.name)] = spec;
  ASSERT_EQ(specs.size(), 4u);
  EXPECT_EQ(specs["n"].min, -3);
  EXPECT_EQ(specs["n"].max, 7);
  EXPECT_EQ(specs["n"].default_value, "2");
  EXPECT_EQ(specs["n"].unit, "m");
  EXPECT_EQ(specs["n"].help, "help");
  EXPECT_EQ(specs["n"].kind, ParamSpec::Kind::integer);
  EXPECT_EQ(specs["r"].default_value, "0.25");
  EXPECT_EQ(specs["r"].kind, ParamSpec::Kind::real);
  EXPECT_EQ(specs["c"].choices, "a|b");
  EXPECT_EQ(specs["c"].default_value, "b");
  EXPECT_EQ(specs["t"].default_value, "x y");
  EXPECT_EQ(own_params(*hello, Params("x", hello->params, "")),
            (Json{{"n", 2}, {"r", 0.25}, {"c", "b"}, {"t", "x y"}}));
  answer["summary"] = "s";
  answer["source"] = "o";
  answer["unmeasurable"] = "u";
  const auto told = read_hello(answer);
  EXPECT_EQ(told->summary + told->source + told->unmeasurable, "sou");
}

TEST(Hello, RefusesWhatNoParameterCanBe) {
  const double most = 2147483647;
  EXPECT_EQ(refused_param(integer(-most, most, most)), "");
  EXPECT_EQ(refused_param(integer(1, 1, 1)), "");
  EXPECT_NE(refused_param(integer(-most - 1, 0, 1)), "");
  EXPECT_NE(refused_param(integer(0, 0, most + 1)), "");
  EXPECT_NE(refused_param(integer(0, 0.5, 1)), "");
  EXPECT_NE(refused_param(integer(1, 0, 2)), "");
  EXPECT_NE(refused_param(integer(1, 3, 2)), "");
  EXPECT_NE(refused_param({{"type", "number"}}), "");
  for (const char* choice : {"", "a|b", "a,b", "a'b", "a\"b", "a b"})
    EXPECT_NE(refused_param({{"type", "choice"}, {"choices", {"x", choice}}, {"default", "x"}}), "")
        << choice;
  EXPECT_NE(refused_param({{"type", "choice"}, {"choices", {"x"}}, {"default", "y"}}), "");
  for (const char* name : {"cmd", "timeout", "folder", "build", "a b", "1a", ""})
    EXPECT_NE(refused_param(integer(0, 0, 1), name), "") << name;
  Json other = hello_with("n", integer(0, 0, 1));
  other["protocol"] = "taut-solver/7";
  EXPECT_NE(refusal([&] { read_hello(other); }), "");
}

struct FromBefore {};
struct Knowing {
  static constexpr const char* kProtocol = "taut-solver/2";
};
struct KnowingBodies {
  static constexpr const char* kProtocol = "taut-solver/3";
};
struct KnowingFrames {
  static constexpr const char* kProtocol = "taut-solver/4";
};

TEST(Hello, SaysWhichProtocolTheProgramSpeaks) {
  for (const auto& [protocol, spoken] : {std::pair{taut_solver::protocol_of<FromBefore>(), 1},
                                         {taut_solver::protocol_of<Knowing>(), 2},
                                         {taut_solver::protocol_of<KnowingBodies>(), 3},
                                         {taut_solver::protocol_of<KnowingFrames>(), 4}})
    EXPECT_EQ(read_hello({{"protocol", protocol}, {"name", "p"}, {"version", "2"}})->version_spoken,
              spoken);
}

TEST(SceneAnswer, HasPassesAndSettingsUnlessTheSceneIsRefused) {
  const Json answer{
      {"vertices", 9},
      {"plan",
       {{{"pass", "a"}, {"items", 4}},
        {{"pass", "b"}, {"items", 5}, {"repeats", 6}, {"bytes", 7}, {"projections", true}}}},
      {"settings", {{"order", "mesh"}}}};
  const SceneAnswer told = read_scene_answer(answer, 9);
  ASSERT_EQ(told.plan.size(), 2u);
  EXPECT_EQ(told.plan[0].items, 4u);
  EXPECT_EQ(told.plan[0].repeats, 1u);
  EXPECT_EQ(told.plan[0].bytes, 0u);
  EXPECT_FALSE(told.plan[0].projections);
  EXPECT_EQ(told.plan[1].items, 5u);
  EXPECT_EQ(told.plan[1].repeats, 6u);
  EXPECT_EQ(told.plan[1].bytes, 7u);
  EXPECT_TRUE(told.plan[1].projections);
  EXPECT_EQ(told.settings, (ResolvedSettings{{"order", "mesh"}}));
  EXPECT_THROW(read_scene_answer(answer, 8), InputError);
  const SceneAnswer refused = read_scene_answer({{"cannot", {"wind"}}, {"vertices", 1}}, 9);
  EXPECT_EQ(refused.cannot, std::vector<std::string>{"wind"});
  EXPECT_EQ(read_scene_answer({{"cannot", Json::array()}, {"vertices", 9}}, 9).cannot.size(), 0u);
}

TEST(StepAnswer, HasNanosecondsIfAny) {
  EXPECT_DOUBLE_EQ(read_step({{"cpu_ns", 2500}}), 2.5e-6);
  EXPECT_TRUE(std::isnan(read_step(Json::object())));
}

TEST(StoreAnswer, HasTheBytesOfPositionsAndVelocities) {
  EXPECT_EQ(read_store({{"bytes", 480}}, 10), 480u);
  EXPECT_THROW(read_store({{"bytes", 479}}, 10), InputError);
  EXPECT_THROW(read_store({{"bytes", 481}}, 10), InputError);
}

TEST(ItsOwnWord, AgreesWithinATenthAndTwoEmptyExchanges) {
  EXPECT_TRUE(agrees(1.09, 1, 0));
  EXPECT_FALSE(agrees(1.11, 1, 0));
  EXPECT_TRUE(agrees(0.91, 1, 0));
  EXPECT_FALSE(agrees(0.89, 1, 0));
  EXPECT_TRUE(agrees(1.28, 1, 0.1));
  EXPECT_FALSE(agrees(1.32, 1, 0.1));
  EXPECT_TRUE(agrees(0, 1, 0.5));
}

TEST(Commands, AreSplitAsAShellWouldButRunByNone) {
  const Scratch scratch;
  write_file(scratch.path() / "prog", "");
  const Command command = split_command("./prog 'a b' \"c d\" e", scratch.path());
  EXPECT_EQ(command.words, (std::vector<std::string>{"./prog", "a b", "c d", "e"}));
  EXPECT_EQ(command.folder, scratch.path());
  EXPECT_EQ(command.text(), "./prog 'a b' 'c d' e");
  EXPECT_EQ(split_command("sh -c x", scratch.path()).words.size(), 3u);
  const auto said = [&](const std::string& text) {
    return refusal([&] { split_command(text, scratch.path()); });
  };
  for (const char* text :
       {"./prog | cat", "./prog; true", "./prog & x", "./prog $(id)", "./prog `id`"})
    EXPECT_NE(said(text).find("no shell runs it"), std::string::npos) << text;
  setenv("TAUT_TEST_WORD", "/*/* b", 1);
  EXPECT_EQ(
      split_command(
          R"(./prog "" /* ~ ~x a\ b "c\"d" '$TAUT_TEST_WORD' $TAUT_TEST_WORD x"${TAUT_TEST_WORD}"y $TAUT_TEST_NONE ?[a])",
          scratch.path())
          .words,
      (std::vector<std::string>{"./prog", "", "/*", std::getenv("HOME") ? std::getenv("HOME") : "",
                                "~x", "a b", "c\"d", "$TAUT_TEST_WORD", "/*/* b", "x/*/* by",
                                "?[a]"}))
      << "no pattern is expanded";
  EXPECT_NE(said("./prog \"$(id)\"").find("no shell runs it"), std::string::npos);
  EXPECT_NE(said("./prog 'a").find("a quote is not closed"), std::string::npos);
  EXPECT_NE(said("  ").find("names no program"), std::string::npos);
  EXPECT_NE(said("./no x").find("no program './no'"), std::string::npos);
  EXPECT_NE(said("no-such-program-at-all x").find("no program"), std::string::npos);
}

TEST(SceneFile, HasEveryPartOfTheSceneUnderItsName) {
  Scene scene;
  scene.name = "made up";
  scene.mesh = make_sheet({.nu = 3, .nv = 2, .width = 1, .height = 0.5, .mass = 0.6});
  scene.mesh.mass[4] = 0.25;
  scene.start = {scene.mesh.rest, std::vector<Vec3>(6, Vec3(1, 2, 3))};
  scene.start.x[5] = Vec3(7, 8, 9);
  scene.pins = {1, 3};
  scene.links = {{0, 2, 1.5, Family::bend}, {4, 3, 0.25, Family::shear}};
  scene.dt = 0.125;
  scene.steps = 12;
  scene.gravity = Vec3(1, -2, 3);
  scene.damping = 0.75;
  scene.thickness = 0.01;
  const Motion moving{.velocity = Vec3(1, 2, 3),
                      .spin = Vec3(4, 5, 6),
                      .pivot = Vec3(7, 8, 9),
                      .path = {{0.5, Vec3(1, 0, 2)}}};
  scene.pin_motions = {{{3}, moving}};
  Box box;
  box.center = Vec3(1, 2, 3);
  box.half_extents = Vec3(4, 5, 6);
  box.rotation = Eigen::Quaterniond(2.0 / 9, 4.0 / 9, -5.0 / 9, 6.0 / 9);
  scene.colliders = {{Plane{Vec3(0, 0.6, 0.8), -2}, {}, 0.5},
                     {Ball{Vec3(1, 2, 3), 4}, moving, 0.25},
                     {box, {}, 0}};
  EXPECT_TRUE(beyond(1, scene).empty());
  scene.wind = Wind{Vec3(3, 2, 1), 0.5, Wind::Law::literal};
  scene.self_collision.emplace();
  scene.self_collision->radius = 0.125;
  const Json motion{{"velocity", {1, 2, 3}},
                    {"spin", {4, 5, 6}},
                    {"pivot", {7, 8, 9}},
                    {"path", {{{"t", 0.5}, {"displacement", {1, 0, 2}}}}}};
  scene.stiffness[1] = 500;
  Json file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/2");
  EXPECT_EQ(file["stiffness"],
            (Json{{"structural", nullptr}, {"shear", 500.0}, {"bend", nullptr}}));
  EXPECT_EQ(beyond(1, scene), std::vector<std::string>{"links of 500 N/m"});
  EXPECT_FALSE(file.contains("link_damping"));
  const auto at_rest = file["damping"];
  scene.link_damping = 0.25;
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/6");
  EXPECT_EQ(file["link_damping"], 0.25);
  EXPECT_EQ(file["damping"], at_rest) << "another key of that name";
  EXPECT_EQ(beyond(5, scene), std::vector<std::string>{"damping of links"});
  EXPECT_TRUE(beyond(6, scene).empty());
  scene.link_damping = 0;
  scene.stiffness = kRigid;
  scene.membrane = Membrane{.warp = 8, .weft = 4, .shear = 2};
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/5");
  EXPECT_FALSE(file["membrane"].contains("damping"));
  scene.membrane->damping = 0.25;
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/6");
  EXPECT_EQ(file["membrane"]["damping"], 0.25);
  EXPECT_EQ(beyond(5, scene), std::vector<std::string>{"damping of the membrane"});
  scene.membrane.reset();
  scene.bending = Bending{2, 0.5, Vec3(0, 0.6, 0.8)};
  EXPECT_EQ(beyond(1, scene), std::vector<std::string>{"bending stiffness"});
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/2");
  EXPECT_EQ(file["bending"], (Json{{"warp", 2.0}, {"weft", 0.5}, {"direction", {0, 0.6, 0.8}}}));
  scene.bending.reset();
  scene.colliders.push_back({Capsule{Vec3(1, 2, 3), Vec3(4, 5, 6), 7}, moving, 0.75});
  EXPECT_EQ(beyond(1, scene), std::vector<std::string>{"a capsule"});
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/2");
  EXPECT_FALSE(file.contains("stiffness"));
  EXPECT_EQ(file["colliders"][3], (Json{{"type", "capsule"},
                                        {"from", {1, 2, 3}},
                                        {"to", {4, 5, 6}},
                                        {"radius", 7},
                                        {"friction", 0.75},
                                        {"motion", motion}}));
  EXPECT_TRUE(beyond(2, scene).empty());
  scene.colliders.pop_back();
  const auto triangle = std::make_shared<const TriangleMesh>(
      std::vector<Vec3>{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 2, 0)},
      std::vector<Triangle>{{0, 1, 2}});
  scene.colliders.push_back(
      {MeshBody{triangle, Vec3(1, 2, 3), box.rotation, MeshBody::Sides::both}, moving, 0.75});
  EXPECT_EQ(beyond(1, scene), std::vector<std::string>{"a body of triangles"});
  EXPECT_EQ(beyond(2, scene), std::vector<std::string>{"a body of triangles"});
  EXPECT_TRUE(beyond(3, scene).empty());
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/3");
  EXPECT_EQ(file["colliders"][3], (Json{{"type", "mesh"},
                                        {"center", {1, 2, 3}},
                                        {"sides", "both"},
                                        {"rotation", {2.0 / 9, 4.0 / 9, -5.0 / 9, 6.0 / 9}},
                                        {"vertices", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}},
                                        {"triangles", {{0, 1, 2}}},
                                        {"friction", 0.75},
                                        {"motion", motion}}));
  scene.colliders.back().frames = std::make_shared<const BodyFrames>(BodyFrames{
      .places = {triangle->vertices(), {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 3, 0)}}, .fps = 24});
  EXPECT_EQ(beyond(1, scene),
            (std::vector<std::string>{"a body of triangles", "a body that deforms"}));
  EXPECT_EQ(beyond(3, scene), std::vector<std::string>{"a body that deforms"});
  EXPECT_TRUE(beyond(4, scene).empty());
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["format"], "taut-scene/4");
  EXPECT_EQ(file["colliders"][3]["fps"], 24);
  EXPECT_EQ(file["colliders"][3]["frames"],
            (Json{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}, {{0, 0, 1}, {1, 0, 0}, {0, 3, 0}}}));
  scene.colliders.pop_back();
  file = parse_json(scene_file(scene));
  const auto expect = [&](const char* key, const Json& value) {
    EXPECT_EQ(file[key], value) << key;
    file.erase(key);
  };
  expect("format", "taut-scene/1");
  expect("name", "made up");
  expect("vertices", 6);
  expect("grid", {3, 2});
  expect("dt", 0.125);
  expect("steps", 12);
  expect("gravity", {1, -2, 3});
  expect("damping", 0.75);
  expect("thickness", 0.01);
  Json x = Json::array(), v = Json::array(), mass = Json::array(), inverse = Json::array();
  for (const Vec3& p : scene.mesh.rest) {
    x.push_back({p.x(), p.y(), p.z()});
    v.push_back({1, 2, 3});
  }
  expect("rest", x);
  x[5] = {7, 8, 9};
  expect("x", x);
  expect("v", v);
  for (std::size_t i = 0; i < 6; ++i) {
    mass.push_back(scene.mesh.mass[i]);
    inverse.push_back(i == 1 || i == 3 ? 0 : 1 / scene.mesh.mass[i]);
  }
  expect("mass", mass);
  expect("inverse_mass", inverse);
  expect("pins", {1, 3});
  expect("pin_motions", Json::array({{{"vertices", {3}}, {"motion", motion}}}));
  expect("links", {{0, 2, 1.5, "bend"}, {4, 3, 0.25, "shear"}});
  expect("triangles", scene.mesh.triangles);
  expect("colliders", {{{"type", "plane"},
                        {"normal", {0, 0.6, 0.8}},
                        {"offset", -2},
                        {"friction", 0.5},
                        {"motion", nullptr}},
                       {{"type", "ball"},
                        {"center", {1, 2, 3}},
                        {"radius", 4},
                        {"friction", 0.25},
                        {"motion", motion}},
                       {{"type", "box"},
                        {"center", {1, 2, 3}},
                        {"half_extents", {4, 5, 6}},
                        {"rotation", {2.0 / 9, 4.0 / 9, -5.0 / 9, 6.0 / 9}},
                        {"friction", 0},
                        {"motion", nullptr}}});
  expect("wind", {{"velocity", {3, 2, 1}}, {"strength", 0.5}, {"law", "literal"}});
  expect("self_collision", {{"radius", 0.125}});
  EXPECT_EQ(file, Json::object()) << "and nothing else";
  scene.wind->law = Wind::Law::relative;
  scene.self_collision.reset();
  scene.mesh.grid.reset();
  file = parse_json(scene_file(scene));
  EXPECT_EQ(file["wind"]["law"], "relative");
  EXPECT_TRUE(file["self_collision"].is_null() && file["grid"].is_null());
}

/// Program that computes exact free fall with pins by symplectic Euler; parameters introduce
/// errors.
constexpr const char* kSlightlyWrong = R"(
import math, sys
sys.path.insert(0, sys.argv[1])
import taut_solver
def turned(spin, t, p):
    rate = math.hypot(*spin)
    if rate == 0:
        return p
    a, c, s = [k / rate for k in spin], math.cos(rate * t), math.sin(rate * t)
    dot = sum(u * v for u, v in zip(a, p))
    return [p[k] * c + (a[(k + 1) % 3] * p[(k + 2) % 3] - a[(k + 2) % 3] * p[(k + 1) % 3]) * s
            + a[k] * dot * (1 - c) for k in range(3)]
def way(path, t):
    for a, b in zip(path, path[1:]):
        if a["t"] <= t <= b["t"]:
            share = (t - a["t"]) / (b["t"] - a["t"])
            return [u + share * (v - u) for u, v in zip(a["displacement"], b["displacement"])]
    return [0] * 3 if not path else path[0 if t < path[0]["t"] else -1]["displacement"]
class Slightly:
    name, version, scenes = "slightly", "1", 0
    def __init__(self, scene, params):
        Slightly.scenes += 1
        self.w, self.g = scene["inverse_mass"], scene["gravity"]
        self.off = lambda what: params.get(what, 0)
        self.held = min(self.w) == 0
        self.moving, self.start = scene["pin_motions"], scene["x"]
    def load(self, x, v):
        self.x, self.v, self.fresh = list(x), list(v), True
    def step(self, t, dt):
        self.fresh = False
        for k in range(len(self.x)):
            if self.w[k // 3] > 0:
                self.v[k] += dt * self.g[k % 3] * (1 + self.off("gravity"))
                self.x[k] += dt * self.v[k]
        for group in self.moving:
            m, end = group["motion"], (t + dt) * (1 + self.off("clock"))
            for i in group["vertices"]:
                p = turned(m["spin"], end, [a - b for a, b in zip(self.start[i], m["pivot"])])
                d = way(m["path"], end)
                self.x[3 * i:3 * i + 3] = [p[k] + m["pivot"][k] + m["velocity"][k] * end + d[k] for k in range(3)]
    def store(self):
        x, v = list(self.x), list(self.v)
        if self.held:
            x[31] += self.off("scenes before") * Slightly.scenes
        if not self.fresh:
            x[11] += self.off("pin" if self.held else "shape")
            if not self.held:
                v = [c + self.off("velocity") * (k % 3 == 0) for k, c in enumerate(v)]
        elif self.held:
            x[25] += self.off("place after load")
            v[25] += self.off("velocity after load")
        return x, v
taut_solver.serve(Slightly)
)";

// |g| is 9.75 m/s^2 and t is 0.5 s. The tolerance of a velocity is (1.05 / 2n + 0.001) g t, or
// 0.0848 m/s in 32 steps and 0.0449 m/s in 64. The tolerance of a distance is (1.05 / n + 0.001) g
// t^2 / 2, of which the integrator uses 1 / n.
TEST(Probe, DrawsEveryLineWhereItSaysItDoes) {
  const Scratch scratch;
  write_file(scratch.path() / "slightly.py", kSlightlyWrong);
  const std::string sdk = std::string(TAUT_SOURCE_DIR) + "/experiments/external/sdk";
  const Command command = split_command(
      "python3 '" + (scratch.path() / "slightly.py").string() + "' '" + sdk + "'", scratch.path());
  const auto failed = [&](const Json& off) {
    std::string all;
    for (const Check& check : quick_probe(command, off)) {
      EXPECT_NE(check.verdict, Check::Verdict::skipped) << check.said;
      if (check.verdict == Check::Verdict::failed) all += check.name + ", ";
    }
    return all;
  };
  EXPECT_EQ(failed({{"pin", 9e-7},
                    {"shape", 9e-4},
                    {"velocity", 0.0447},
                    {"place after load", 9e-6},
                    {"velocity after load", 9e-4}}),
            "");
  EXPECT_EQ(failed({{"pin", 1.1e-6}, {"shape", 1.1e-3}}),
            "free fall, time step, pins, moving pins, ");
  EXPECT_EQ(failed({{"clock", 1e-7}}), "") << "at most 0.5 s x 1.1 m/s x 1e-7";
  EXPECT_EQ(failed({{"clock", 1e-5}}), "moving pins, ");
  EXPECT_EQ(failed({{"velocity", 0.0451}, {"place after load", 1.1e-5}}), "time step, restart, ");
  EXPECT_EQ(failed({{"velocity", 0.0850}, {"velocity after load", 1.1e-3}}),
            "free fall, time step, restart, ");
  EXPECT_EQ(failed({{"scenes before", 1e-12}}), "same bits, ") << "of the same scene, given again";
  EXPECT_EQ(failed({{"gravity", 1.7e-3}}), "");
  EXPECT_EQ(failed({{"gravity", 1.9e-3}}), "time step, ");
  EXPECT_EQ(failed({{"gravity", 3.6e-3}}), "free fall, time step, ");
}

/// While it exists no file can be opened.
class NoMoreFiles {
 public:
  NoMoreFiles() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{3, before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoMoreFiles() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoMoreFiles(const NoMoreFiles&) = delete;
  NoMoreFiles& operator=(const NoMoreFiles&) = delete;

 private:
  rlimit before_{};
};

// The timeout is part of a program's identity: a program that was once too slow may be fast enough
// with more time.
TEST(Programs, OfOneCommandAreOthersWithAnotherTimeout) {
  const std::string cmd = R"(external:cmd='sh -c "read x; sleep 1; echo {}; read x"',timeout=)";
  enable();
  admit_solver(cmd + "60");
  EXPECT_NE(parse_solver(cmd + "0.1").entry->summary.find("within 0.1 s"), std::string::npos);
  EXPECT_EQ(parse_solver(cmd + "60").entry->summary.find("within"), std::string::npos);
  set_solver_source({});
}

TEST(Probe, IsMadeAgainIfItCouldNotBeMade) {
  const Scratch scratch;
  std::string program = kSlightlyWrong;
  program.replace(program.find("self.off(\"gravity\")"), 19, "1");
  write_file(scratch.path() / "wrong.py", program);
  enable();
  const std::string solver = "external:cmd='python3 \"" + (scratch.path() / "wrong.py").string() +
                             "\" \"" + TAUT_SOURCE_DIR + "/experiments/external/sdk\"'";
  admit_solver(solver);
  const SolverChoice choice = parse_solver(solver);
  const Scene scene = hanging_sheet(4, 4);
  {
    const NoMoreFiles limit;
    EXPECT_THROW(choice.entry->make(scene, choice.params), InputError);
  }
  EXPECT_THROW(choice.entry->make(scene, choice.params), SolverFailure);
  set_solver_source({});
}

/// Program that answers every line with the resources it has used so far, and starts a process on
/// request.
constexpr const char* kTells = R"(
import json, os, subprocess, sys, time
held = bytearray(40_000_000)
for line in sys.stdin:
    if "sleep" in line:
        sleeper = subprocess.Popen(["sleep", "1000"])
    while time.process_time() < 0.15:
        pass
    with open("/proc/self/status") as status:
        kilobytes = [int(l.split()[1]) for l in status if l.startswith("VmHWM")][0]
    print(json.dumps({"kilobytes": kilobytes, "cpu": time.process_time()}), flush=True)
)";

TEST(Connections, MeasureWhatTheProgramUsesAndWhetherItHasHelp) {
  const Scratch scratch;
  write_file(scratch.path() / "tells.py", kTells);
  Connection connection(
      split_command("python3 '" + (scratch.path() / "tells.py").string() + "'", scratch.path()));
  const Json told = connection.ask_line("hello");
  const double kilobytes = told["kilobytes"], cpu = told["cpu"];
  EXPECT_GT(kilobytes, 40'000);
  EXPECT_NEAR(static_cast<double>(connection.peak_bytes()), 1024 * kilobytes, 10 * kilobytes);
  EXPECT_NEAR(connection.cpu_seconds(), cpu, 0.05);
  EXPECT_GE(connection.cpu_seconds(), cpu);
  EXPECT_FALSE(connection.has_helpers());
  connection.ask_line("sleep");
  EXPECT_TRUE(connection.has_helpers());
  EXPECT_TRUE(connection.close(20)->good()) << "it ends with its input";
}

TEST(Connections, SayHowAProgramFailed) {
  struct Failure {
    const char *script, *status, *reason, *log;
  };
  for (const Failure& one :
       {Failure{"read x; kill -XCPU $$", "timeout", "CPU time", ""},
        Failure{"read x; kill -SEGV $$", "crash", "SIGSEGV during 'go'", ""},
        Failure{"read x; echo first >&2; echo last >&2; exit 3", "crash",
                "exit code 3 during 'go': last", "first\nlast\n"},
        Failure{"read x; echo std::bad_alloc >&2; exit 1", "oom",
                "out of memory during 'go': std::bad_alloc", "std::bad_alloc\n"},
        Failure{"read x; echo '[1]'; sleep 1000", "protocol",
                "answer to 'go': not a JSON object: '[1]'", ""},
        Failure{"exec >&-; sleep 1000", "protocol", "closed its standard output during 'go'", ""},
        Failure{"read x; printf abc; sleep 1000", "timeout",
                "no answer to 'go' within 0.5 s, only 3 bytes", ""}}) {
    const bool waits = one.reason == std::string("no answer to 'go' within 0.5 s, only 3 bytes");
    Connection connection(
        {.words = {"sh", "-c", one.script}, .folder = "", .seconds = waits ? 0.5 : 20});
    try {
      connection.ask_line("go");
      ADD_FAILURE() << one.script;
    } catch (const SolverFailure& failure) {
      EXPECT_EQ(to_string(failure.status), one.status) << one.script;
      EXPECT_STREQ(failure.what(), one.reason);
      EXPECT_EQ(failure.log, one.log);
    }
  }
}

TEST(Connections, AProgramThatIsEndedFromOutsideHasNoResult) {
  for (const char* signal : {"KILL", "TERM"}) {
    Connection connection({.words = {"sh", "-c", std::string("read x; kill -") + signal + " $$"},
                           .folder = "",
                           .seconds = 20});
    EXPECT_THROW(connection.ask_line("go"), EndedFromOutside) << signal;
  }
}

TEST(SolverNames, StartWithALetterAndAreShort) {
  EXPECT_TRUE(is_solver_name("a"));
  EXPECT_TRUE(is_solver_name("aB_c-9"));
  EXPECT_TRUE(is_solver_name(std::string(40, 'a')));
  for (const std::string& text : {std::string(41, 'a'), std::string(), std::string("9a"),
                                  std::string("_a"), std::string("a.b"), std::string("a b")})
    EXPECT_FALSE(is_solver_name(text)) << text;
  const std::string name = name_for("my prog.py", "told by");
  EXPECT_TRUE(name.starts_with("my-prog-py-")) << name;
  EXPECT_EQ(name.size(), 15u);
  EXPECT_NE(name_for("my prog.py", "another"), name);
  EXPECT_EQ(name_for(std::string(50, 'a'), "x").size(), 35u);
  EXPECT_TRUE(name_for("9", "x").starts_with("external9-"));
  EXPECT_TRUE(name_for("", "x").starts_with("external-"));
  for (std::size_t length = 1; length < 60; ++length)
    for (const char first : {'a', '9', ' '})
      EXPECT_TRUE(is_solver_name(name_for(std::string(length, first), "x"))) << first << length;
}

}  // namespace
}  // namespace taut::external::answers_test
