// Reductions of a case and their steps, drafts written as files, and differences that do not
// matter.
#include <gtest/gtest.h>

#include <cmath>

#include "core/io/fabrics.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/require/draft.hpp"
#include "experiments/require/effects.hpp"
#include "experiments/require/perturbation.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::reductions_test {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

Case hang(const SceneSettings& settings,
          const std::string& solver = "jakobsen:substeps=1,iterations=1") {
  return make_case({"hang", settings, solver});
}

/// Steps of one effect; empty if the case does not have it.
Strings steps_of(const Case& one, const std::string& name) {
  Strings all;
  for (const Effect& effect : effects_of(one))
    if (effect.name == name)
      for (const Reduction& step : effect.reductions) all.push_back(step.change);
  return all;
}

TEST(Reductions, OfAGridHalveItTwice) {
  const auto steps = [](const std::string& grid) {
    return steps_of(hang({"cloth.grid=" + grid}), "resolution");
  };
  EXPECT_EQ(steps("[33, 5]"), (Strings{"33x5 -> 17x3", "33x5 -> 9x2"})) << "along its longer side";
  EXPECT_EQ(steps("[5, 32]"), (Strings{"5x32 -> 3x16", "5x32 -> 2x8"}));
  EXPECT_EQ(steps("[65, 65]"), (Strings{"65x65 -> 33x33", "65x65 -> 17x17"}));
  EXPECT_EQ(steps("[7, 7]"), Strings{"7x7 -> 4x4"});
  EXPECT_EQ(steps("[6, 6]"), Strings{});
  EXPECT_EQ(steps("[8, 3]"), Strings{"8x3 -> 4x2"});
  EXPECT_EQ(steps("[20, 2]"), Strings{}) << "a sheet stays one";
  EXPECT_EQ(steps_of(make_case({"chain", {}, "jakobsen"}), "resolution"),
            (Strings{"1x33 -> 1x17", "1x33 -> 1x9"}));
}

TEST(Reductions, OfADurationAreHalvesDownToAStep) {
  const auto steps = [](const std::string& seconds) {
    return steps_of(hang({"time.duration=" + seconds}), "duration");
  };
  EXPECT_EQ(steps("2"), (Strings{"2 s -> 1 s", "2 s -> 0.5 s", "2 s -> 0.25 s"}));
  EXPECT_EQ(steps("0.0625"), (Strings{"0.0625 s -> 0.03125 s", "0.0625 s -> 0.015625 s"}))
      << "four steps";
  EXPECT_EQ(steps("0.015625"), Strings{}) << "one";
}

TEST(Reductions, OfParametersAreCheaperChoicesAndHalves) {
  const Case one =
      hang({}, "jakobsen:substeps=5,iterations=8,precision=double,tethers=on,levels=3");
  EXPECT_EQ(steps_of(one, "substeps"), (Strings{"5 -> 3", "5 -> 2", "5 -> 1"}));
  EXPECT_EQ(steps_of(one, "sweeps"), (Strings{"8 -> 4", "8 -> 2", "8 -> 1"}));
  EXPECT_EQ(steps_of(one, "precision"), Strings{"double -> float"});
  EXPECT_EQ(steps_of(one, "tethers"), Strings{"on -> off"});
  EXPECT_EQ(steps_of(one, "levels"), (Strings{"3 -> 2", "3 -> 1"}));
  EXPECT_EQ(steps_of(one, "contact of faces"), Strings{}) << "nothing is touched";
  for (const std::string solver : {"jakobsen", "xpbd", "implicit", "pd", "admm", "vbd", "avbd"}) {
    const auto faces = [&](const std::string& value) {
      return steps_of(make_case({"ball", {}, solver + ":faces=" + value}), "contact of faces");
    };
    EXPECT_EQ(faces("on"), (Strings{"on -> edges", "on -> off"})) << solver;
    EXPECT_EQ(faces("edges"), Strings{"edges -> off"}) << solver;
    EXPECT_EQ(faces("off"), Strings{}) << solver;
  }
  EXPECT_EQ(steps_of(hang({}, "jakobsen:precision=float"), "precision"), Strings{});
  EXPECT_EQ(steps_of(hang({}, "mass-spring:substeps=4"), "sweeps"), Strings{}) << "it has none";
}

TEST(Reductions, OfSeveralKindsStandInOrderAndAreWhatTheySay) {
  const Scratch scratch;
  const Case full = hang({"cloth.grid=[33, 5]", "time.duration=1"},
                         "jakobsen:substeps=5,iterations=8,precision=double");
  Strings names;
  for (const Effect& effect : effects_of(full)) {
    names.push_back(effect.name);
    int k = 0;
    for (const Reduction& step : effect.reductions) {
      Draft draft(full.spec);
      step.apply(draft);
      const Case less = make_case(draft.write(scratch.path(), effect.name + std::to_string(++k)));
      const std::string to = step.change.substr(step.change.rfind(' ') + 1);
      const Grid& grid = *less.scene->mesh.grid;
      if (effect.name == "resolution") {
        EXPECT_EQ(std::to_string(grid.nu) + "x" + std::to_string(grid.nv), to);
      } else if (effect.name == "duration") {
        EXPECT_EQ(less.scene->steps, full.scene->steps >> k);
      } else if (effect.name == "substeps") {
        EXPECT_EQ(less.choice.params.value("substeps"), to);
      } else if (effect.name == "sweeps") {
        EXPECT_EQ(less.choice.params.value("iterations"), to);
      } else if (effect.name == "precision") {
        EXPECT_EQ(less.choice.params.value("precision"), "float");
      }
    }
  }
  EXPECT_EQ(names,
            (Strings{"shear links", "substeps", "sweeps", "precision", "resolution", "duration"}));
}

TEST(Reductions, OfAWindAreItsLawAndItself) {
  const Scratch scratch;
  const Case full = hang({"wind={ velocity = [1, 0, 0] }"});
  const auto less = [&](const std::string& name) {
    Draft draft(full.spec);
    for (const Effect& effect : effects_of(full))
      if (effect.name == name) effect.reductions.front().apply(draft);
    return make_case(draft.write(scratch.path(), "wind"));
  };
  EXPECT_EQ(steps_of(full, "law of the wind"), Strings{"relative -> literal"});
  EXPECT_EQ(less("law of the wind").scene->wind->law, Wind::Law::literal);
  EXPECT_FALSE(less("wind").scene->wind);
  EXPECT_EQ(steps_of(hang({"wind={ velocity = [1, 0, 0], law = \"literal\" }"}), "law of the wind"),
            Strings{});
  Draft both(full.spec);  // without wind there is no law of wind
  for (const Effect& effect : effects_of(full))
    if (effect.name.ends_with("wind")) effect.reductions.front().apply(both);
  EXPECT_FALSE(make_case(both.write(scratch.path(), "both")).scene->wind);
}

TEST(Drafts, OfAFabricHaveWhatItSets) {
  const Scratch scratch;
  for (const Fabric& fabric : fabrics()) {
    const Case full = hang({"fabric='" + std::string(fabric.name) + "'"}, "pd");
    Draft draft(full.spec);
    draft.set("forces", "damping", "0.5");
    const Case one = make_case(draft.write(scratch.path(), slug(fabric.name)));
    EXPECT_EQ(one.scene->damping, 0.5);
    EXPECT_EQ(one.scene->mesh.mass, full.scene->mesh.mass) << fabric.name;
    EXPECT_EQ(one.scene->bending->warp, fabric.warp) << fabric.name;
    EXPECT_EQ(one.scene->bending->weft, fabric.weft) << fabric.name;
  }
}

TEST(Drafts, AreTheCaseAsItWasGivenUntilTheSceneChanges) {
  const Scratch scratch;
  const CaseSpec spec{"hang", {"cloth.grid=[4, 4]"}, "jakobsen:iterations=7"};
  Draft draft(spec);
  const CaseSpec same = draft.write(scratch.path(), "same");
  EXPECT_EQ(same.scene, "hang");
  EXPECT_EQ(same.settings, spec.settings);
  EXPECT_EQ(same.solver, parse_solver(spec.solver).canonical());
  EXPECT_TRUE(fs::is_empty(scratch.path()));
  draft.set_parameter("iterations", "3");
  const CaseSpec other = draft.write(scratch.path() / "a/b", "other", "# why\n");
  EXPECT_EQ(parse_solver(other.solver).params.integer("iterations"), 3);
  EXPECT_EQ(other.scene, (scratch.path() / "a/b/other.toml").string());
  EXPECT_TRUE(other.settings.empty());
  EXPECT_TRUE(read_text(other.scene).starts_with("# why\n"));
  EXPECT_EQ(make_case(other).scene->mesh.size(), 16);
  draft.set("time", "duration", "3");
  draft.set("forces", "damping", "0.5");
  draft.remove("cloth", "pins");
  draft.remove("cloth", "nothing");
  draft.remove("nothing");
  EXPECT_TRUE(draft.has("forces"));
  EXPECT_EQ(draft.find("time", "duration")->number, 3);
  EXPECT_EQ(draft.find("cloth", "pins"), nullptr);
  EXPECT_EQ(draft.tables("collider"), nullptr);
  const Case changed = make_case(draft.write(scratch.path(), "changed"));
  EXPECT_EQ(changed.scene->duration(), 3);
  EXPECT_EQ(changed.scene->damping, 0.5);
  EXPECT_TRUE(changed.scene->pins.empty());
  draft.remove("forces");
  EXPECT_EQ(make_case(draft.write(scratch.path(), "again")).scene->damping, 0);
  EXPECT_THROW(toml_value("[1, "), InputError);
}

TEST(Drafts, FindTheirMeshFromWhereverTheyAreWritten) {
  const Scratch scratch;
  make_folder(scratch.path() / "scenes/meshes");
  write_file(scratch.path() / "scenes/meshes/m.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
  write_file(scratch.path() / "scenes/s.toml",
             "[cloth]\nmesh = \"meshes/m.obj\"\nmass = 1\n[time]\ndt = 0.1\nduration = 1\n");
  Draft draft({(scratch.path() / "scenes/s.toml").string(), {}, "jakobsen"});
  draft.set("time", "duration", "2");
  const CaseSpec written = draft.write(scratch.path() / "else/where", "t");
  EXPECT_NE(read_text(written.scene).find("'../../scenes/meshes/m.obj'"), std::string::npos)
      << read_text(written.scene);
  EXPECT_EQ(make_case(written).scene->mesh.size(), 3);
}

// A scene that was written without one of its files is another scene, or none.
TEST(Drafts, AreTheirSceneWhereverTheyAreWritten) {
  const Scratch scratch;
  for (const std::string& scene : shipped("scenes")) {
    const CaseSpec full{scene, {}, "jakobsen"};
    const CaseSpec written = Draft(full).write(scratch.path() / "else/where", scene, "# \n");
    EXPECT_EQ(digest(load_scene(written.scene)), digest(*make_case(full).scene)) << scene;
  }
}

TEST(Perturbed, StartsDifferByOneOfFourFreeVertices) {
  const Scratch scratch;
  const Case full = hang({"cloth.grid=[4, 3]"});
  const Scene& scene = *full.scene;
  std::vector<std::size_t> free;
  for (int i = 0; i < scene.mesh.size(); ++i)
    if (!std::ranges::count(scene.pins, i)) free.push_back(to_index(i));
  ASSERT_EQ(free.size(), 10u);
  const Perturbations found = perturbations(full, scratch.path() / "made");
  ASSERT_EQ(found.rounding.size(), 4u);
  const std::size_t chosen[] = {free[1], free[3], free[6],
                                free[8]};  // at 1/8, 3/8, 5/8 and 7/8 of ten
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(found.rounding[k].scene,
              (scratch.path() / "made" / ("rounding-" + std::to_string(k + 1) + ".toml")).string());
    const Case other = make_case(found.rounding[k]);
    for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
      Vec3 expected = scene.start.x[i];
      if (i == chosen[k]) expected += std::ldexp(extent(scene), -23) * Vec3(0.8, 0.5, 0.3);
      EXPECT_EQ(other.scene->start.x[i], expected) << k << ": " << i;
    }
  }
}

TEST(Perturbed, StartsGoWhereTheColliderLetsThem) {
  const Scratch scratch;
  // The cloth lies in the corner of a floor and a wall and touches both: it can only move up and
  // away.
  const Case full =
      hang({"cloth.grid=[3, 3]", "cloth.origin=[0, 0, 0]", "cloth.v=[0, 0, 1]", "cloth.pins=[]",
            "cloth.thickness=0",
            "collider=[{ type = \"plane\" }, { type = \"plane\", normal = [1, 0, 0] }]"});
  const Scene& scene = *full.scene;
  for (const CaseSpec& spec : perturbations(full, scratch.path()).rounding) {
    const Case other = make_case(spec);
    for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
      EXPECT_GE(other.scene->start.x[i].y(), scene.start.x[i].y());
      EXPECT_GE(other.scene->start.x[i].x(), 0);
    }
  }
}

TEST(Perturbed, OrdersAreTwoOthersThanTheCases) {
  const Scratch scratch;
  const auto orders = [&](const std::string& solver) {
    Strings all;
    for (const CaseSpec& spec :
         perturbations(hang({"cloth.grid=[4, 4]"}, solver), scratch.path()).order) {
      const SolverChoice choice = parse_solver(spec.solver);
      EXPECT_EQ(spec.scene, "hang");
      all.push_back(std::string(choice.params.value("order")) + " " +
                    std::string(choice.params.value("seed")));
    }
    return all;
  };
  const std::string seed(parse_solver("jakobsen").params.value("seed"));
  EXPECT_EQ(orders("jakobsen:order=mesh"), (Strings{"random " + seed, "reversed " + seed}));
  EXPECT_EQ(orders("jakobsen:order=random"), (Strings{"random 2", "reversed " + seed}))
      << "another random one";
  EXPECT_EQ(orders("jakobsen:order=reversed"), (Strings{"random " + seed, "reversed 2"}));
  EXPECT_TRUE(orders("mass-spring").empty());
}

}  // namespace
}  // namespace taut::reductions_test
