// Parts that a model can lose, the comparison of answers, and scenes written as files.
#include "experiments/require/require.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include "core/io/document.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/require/draft.hpp"
#include "experiments/require/effects.hpp"
#include "experiments/require/perturbation.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::require_test {
namespace {

std::vector<std::string> names(const std::vector<Effect>& effects) {
  std::vector<std::string> all;
  for (const Effect& effect : effects) all.push_back(effect.name);
  return all;
}

/// Case with a motion of one frame, in which the rest shape is moved by f(x).
Observation observation(const std::string& scene, const SceneSettings& settings,
                        const std::function<Vec3(const Vec3&)>& f) {
  Observation seen{make_case({scene, settings, "jakobsen"}), {}, {}};
  State state = seen.one.scene->start;
  for (Vec3& x : state.x) x = f(x);
  seen.frames.push_back({seen.one.scene->duration(), state});
  return seen;
}

Vec3 bent(const Vec3& x) { return x + Vec3(0, 0, x.x() * x.x()); }

TEST(Toml, EveryShippedSceneReadsBackTheSame) {
  for (const std::string& name : shipped("scenes")) {
    const std::filesystem::path file = find_scene(name);
    const std::string text = to_toml(read_document(file, {}).root);
    EXPECT_EQ(digest(load_scene(file)), digest(parse_scene(file, text))) << name << '\n' << text;
  }
}

TEST(Toml, TextsAndKeysAreQuotedWhereTheyMustBe) {
  const std::string text =
      "a = \"quote \\\" slash \\\\ line \\n\"\n\"a key\" = [1, -2.5e-8, true]\n[t]\n"
      "x = { y = [{ z = 1 }] }\n[[l]]\nn = 1\n[[l]]\nn = 2\n";
  const std::string once = to_toml(parse_document("t", text, {}).root);
  const Value again = parse_document("t", once, {}).root;
  EXPECT_EQ(to_toml(again), once);
  EXPECT_EQ(again.find("a")->string, "quote \" slash \\ line \n");
  EXPECT_EQ(again.find("a key")->items[1].number, -2.5e-8);
  EXPECT_EQ(again.find("t")->find("x")->find("y")->items[0].find("z")->number, 1);
  EXPECT_EQ(again.find("l")->items[1].find("n")->number, 2);
}

TEST(Effects, AreThoseThatTheCaseHas) {
  EXPECT_EQ(names(effects_of(make_case({"hang", {}, "jakobsen:substeps=1,iterations=1"}))),
            (std::vector<std::string>{"shear links", "resolution", "duration"}));
  EXPECT_EQ(names(effects_of(make_case({"crumple", {}, "jakobsen:faces=on,precision=double"}))),
            (std::vector<std::string>{"bend links", "shear links", "damping", "friction", "plane",
                                      "self-collision", "thickness", "contact of faces",
                                      "continuous detection", "substeps", "sweeps", "precision",
                                      "resolution", "duration"}));
  EXPECT_EQ(names(effects_of(make_case({"flag", {}, "xpbd:substeps=1"}))).front(), "shear links");
}

TEST(Effects, EachLeavesWhatItSaysAndNothingElse) {
  const Scratch scratch;
  const Case full = make_case({"crumple", {"wind={velocity=[1,0,0]}"}, "jakobsen"});
  for (const Effect& effect : effects_of(full)) {
    Draft draft(full.spec);
    effect.reductions.front().apply(draft);
    const Case less = make_case(draft.write(scratch.path(), "less" + effect.name));
    EXPECT_NE(less.key, full.key) << effect.name;
    const Scene &a = *full.scene, &b = *less.scene;
    EXPECT_EQ(!b.wind, effect.name == "wind") << effect.name;
    EXPECT_EQ(!b.self_collision, effect.name == "self-collision") << effect.name;
    EXPECT_EQ(b.colliders.empty(), effect.name == "plane") << effect.name;
    EXPECT_EQ(b.damping == 0, effect.name == "damping") << effect.name;
    EXPECT_EQ(b.thickness == 0, effect.name == "thickness") << effect.name;
    EXPECT_EQ(b.steps < a.steps, effect.name == "duration") << effect.name;
    EXPECT_EQ(b.mesh.size() < a.mesh.size(), effect.name == "resolution") << effect.name;
    if (!b.colliders.empty()) {
      EXPECT_EQ(b.colliders[0].friction == 0, effect.name == "friction") << effect.name;
    }
    if (effect.name.ends_with("links")) {
      EXPECT_LT(b.links.size(), a.links.size()) << effect.name;
    }
  }
}

// A reduction that removes an effect leaves nothing of it: the case without it no longer has that
// effect.
TEST(Effects, OnlyWhatLeavesNothingRemovesOne) {
  const Scratch scratch;
  const Case full =
      make_case({"crumple", {"wind={velocity=[1,0,0]}"}, "jakobsen:faces=on,precision=double"});
  std::vector<std::string> removed;
  for (const Effect& effect : effects_of(full)) {
    for (const Reduction& reduction : effect.reductions) {
      Draft draft(full.spec);
      reduction.apply(draft);
      const Case less = make_case(draft.write(scratch.path(), effect.name + reduction.change));
      const std::vector<std::string> left = names(effects_of(less));
      EXPECT_TRUE(!reduction.removes || std::ranges::count(left, effect.name) == 0) << effect.name;
    }
    if (effect.reductions.front().removes) removed.push_back(effect.name);
  }
  EXPECT_EQ(removed,
            (std::vector<std::string>{"bend links", "shear links", "wind", "damping", "friction",
                                      "plane", "self-collision", "thickness"}));
}

TEST(Effects, OneOfSeveralCollidersGoes) {
  const Scratch scratch;
  const std::string balls =
      "collider=[{type='ball',center=[0,-3,0],radius=0.1,friction=0.5},"
      "{type='plane',offset=-5,friction=0.5},{type='ball',center=[5,0,0],radius=0.2}]";
  const Case full = make_case({"hang", {balls}, "jakobsen"});
  Draft draft(full.spec);
  for (const Effect& effect : effects_of(full))
    if (effect.name == "plane 2" || effect.name == "ball 1" || effect.name == "friction")
      effect.reductions.front().apply(draft);
  const Case less = make_case(draft.write(scratch.path(), "less"));
  ASSERT_EQ(less.scene->colliders.size(), 1u);
  EXPECT_EQ(std::get<Ball>(less.scene->colliders[0].shape).radius, 0.2);
}

TEST(Answers, ShapesOfOtherGridsAreComparedAtTheSameCloth) {
  const Observation fine = observation("hang", {"cloth.grid=[33, 33]"}, bent);
  const KeptQuantity shape{"shape", 0.01};
  const auto from = [&](const std::string& grid, const Vec3& off) {
    return distance(shape, fine, observation("hang", {"cloth.grid=" + grid}, [&](const Vec3& x) {
                      return Vec3(bent(x) + off);
                    }));
  };
  EXPECT_LT(from("[17, 17]", Vec3::Zero()), 1e-15);
  EXPECT_NEAR(from("[17, 17]", Vec3(0, 0.02, 0)), 0.02, 1e-15);
  // Between the vertices of the finer grid a parabola deviates by at most h^2/4.
  EXPECT_LE(from("[16, 16]", Vec3::Zero()), 1 / (32. * 32) / 4 + 1e-15);
  EXPECT_GT(from("[16, 16]", Vec3::Zero()), 0.1 / (32. * 32) / 4);
}

TEST(Answers, ToleranceIsReadInTheUnitsThatAreShown) {
  Observation full = observation("hang", {}, [](const Vec3& x) { return x; });
  full.record.values = {{"stretch.max", 0.02}, {"settle.time", 3},      {"energy.mean", -0.5},
                        {"drift.max", 0.1},    {"tunnelling.count", 3}, {"area.max", std::nan("")}};
  const double size = extent(*full.one.scene), time = full.one.scene->duration();
  const auto tolerance = [&](const std::string& text) {
    return parse_answer(text, full).tolerance;
  };
  EXPECT_DOUBLE_EQ(tolerance("shape"), 0.01 * size);
  EXPECT_DOUBLE_EQ(tolerance("shape:2%"), 0.02 * size);
  EXPECT_DOUBLE_EQ(tolerance("shape:2mm"), 0.002);
  EXPECT_DOUBLE_EQ(tolerance("drift.max:0.5"), 0.5);
  EXPECT_DOUBLE_EQ(tolerance("stretch.max:0.5%"), 0.005);
  EXPECT_DOUBLE_EQ(tolerance("stretch.max"), 0.01);
  EXPECT_DOUBLE_EQ(tolerance("settle.time"), 0.1 * time);
  EXPECT_DOUBLE_EQ(tolerance("energy.mean:10%"), 0.05);
  EXPECT_EQ(tolerance("tunnelling.count"), 0);
  for (const char* wrong : {"strech.max", "stretch.max:-1", "stretch.max:1kg", "stretch.max:x",
                            "area.max", "shape:", "shape:inf"})
    EXPECT_THROW(parse_answer(wrong, full), InputError) << wrong;
}

TEST(Answers, ALostValueIsMeasuredOnTheMotion) {
  Observation full = observation("plane", {}, [](const Vec3& x) { return x; });
  full.record.values["penetration.max"] = 0;
  Observation without = observation("plane", {"collider=[]"},
                                    [](const Vec3& x) { return Vec3(x.x(), -0.25, x.z()); });
  const KeptQuantity depth{"penetration.max", 0.001};
  EXPECT_NEAR(distance(depth, full, without), 0.25, 1e-12);
  without.record.status = {Status::Kind::exploded, Reason::energy, 3, 0};
  EXPECT_EQ(distance(depth, full, without), std::numeric_limits<double>::infinity());
}

TEST(Perturbations, MoveOneVertexByARoundingErrorEach) {
  const Scratch scratch;
  const Case full = make_case({"incline", {}, "jakobsen"});
  const Perturbations found = perturbations(full, scratch.path());
  ASSERT_EQ(found.rounding.size(), 4u);
  EXPECT_EQ(found.order.size(), 2u);
  for (const CaseSpec& spec : found.rounding) {
    const Case one = make_case(spec);
    int moved = 0;
    for (std::size_t i = 0; i < one.scene->start.x.size(); ++i) {
      const double way = (one.scene->start.x[i] - full.scene->start.x[i]).norm();
      moved += way > 0;
      EXPECT_LT(way, 2e-7 * extent(*full.scene));
    }
    EXPECT_EQ(moved, 1);
  }
}

}  // namespace
}  // namespace taut::require_test
