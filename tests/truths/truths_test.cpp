// The list of truths as a whole, verdicts on findings, and committed references.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/reference/fit.hpp"
#include "core/reference/textbook.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/reference_store.hpp"
#include "experiments/truths/truth.hpp"

namespace taut::truths_test {
namespace {

const std::filesystem::path kSource = TAUT_SOURCE_DIR;

TEST(Truths, EverySectionHasItsRowsAndEveryTruthASource) {
  std::set<std::pair<int, int>> places;
  for (const TruthEntry* truth : truths()) {
    EXPECT_TRUE(places.emplace(truth->section, truth->row).second) << truth->name;
    EXPECT_FALSE(truth->statement.empty()) << truth->name;
    EXPECT_FALSE(truth->source.empty()) << truth->name;
  }
  for (int section = 1; section <= 11; ++section)
    EXPECT_TRUE(places.count({section, 1})) << section;
  for (const auto& [section, row] : places)
    EXPECT_TRUE(row == 1 || places.count({section, row - 1})) << section << '.' << row;
}

TEST(Truths, TheProgramHasEverySolverThatTheyBind) {
  for (const char* name : {"jakobsen", "bullet", "xpbd", "mass-spring"})
    EXPECT_NO_THROW(find_solver(name));
}

TEST(Findings, OneVertexThatIsNanIsTheWorstWhereverItStands) {
  const double nan = std::nan("");
  const std::vector<Vec3> rest{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  for (std::size_t i = 0; i < rest.size(); ++i) {
    std::vector<Vec3> x = rest;
    x[i] = {nan, 0, 0};
    EXPECT_TRUE(std::isnan(max_distance(x, rest))) << i;
    Scene scene;
    scene.links = {{0, 1, 1}, {1, 2, 1}};
    EXPECT_TRUE(std::isnan(max_strain(scene, {x, {}}))) << i;
  }
}

TEST(Findings, JudgesByTheToleranceAndNeverPassesNan) {
  Findings findings;
  findings.equal("a", "q", "m", 1.0, 1.1, 0.2);
  findings.equal("a", "q", "m", 1.0, 1.3, 0.2);
  findings.below("a", "q", "m", std::nan(""), 1);
  findings.deviates("a", "q", "m", 2.0, 1.0, 2.1, 0.2, "known");
  findings.deviates("a", "q", "m", 2.0, 1.0, 3.0, 0.2, "known");
  findings.deviates("a", "q", "m", 2.0, 1.9, 2.1, 0.2, "known");
  std::vector<TruthVerdict> verdicts;
  for (const Finding& f : findings.all()) verdicts.push_back(f.verdict);
  EXPECT_EQ(verdicts,
            (std::vector{TruthVerdict::passed, TruthVerdict::broken, TruthVerdict::broken,
                         TruthVerdict::deviates, TruthVerdict::broken, TruthVerdict::passed}));
}

TEST(Findings, KeepsOnlyTheSolversAskedFor) {
  Findings findings({"bullet"});
  EXPECT_TRUE(findings.wants("bullet:iterations=3"));
  EXPECT_FALSE(findings.wants("jakobsen:iterations=3"));
  findings.equal("jakobsen", "q", "m", 0, 1, 0);
  EXPECT_TRUE(findings.all().empty());
}

TEST(Fit, SlopesAndRecurrencesOfExactData) {
  std::vector<double> x, y, wave;
  for (const double v : {1.0, 2.0, 4.0, 8.0}) {
    x.push_back(v);
    y.push_back(3 * std::pow(v, -1.5));
  }
  const PowerLaw law = fit_power_law(x, y);
  EXPECT_NEAR(law.factor, 3, 1e-12);
  EXPECT_NEAR(law.exponent, -1.5, 1e-12);
  EXPECT_LT(law.error, 1e-12);
  for (int n = 0; n < 20; ++n) wave.push_back(std::pow(0.9, n) * std::cos(0.3 * n + 1));
  const auto [p, q] = two_term_recurrence(wave);
  EXPECT_NEAR(p, 2 * 0.9 * std::cos(0.3), 1e-10);
  EXPECT_NEAR(q, -0.81, 1e-10);
}

TEST(Fit, APowerLawIsFoundWithItsUncertainty) {
  std::vector<double> x, exact, bent;
  for (double v = 1; v <= 256; v *= 2) {
    x.push_back(v);
    exact.push_back(3 / v);
    bent.push_back(3 / v * (1 + 0.1 * std::sin(v)));
  }
  const PowerLaw law = fit_power_law(x, exact), rough = fit_power_law(x, bent);
  EXPECT_NEAR(law.exponent, -1, 1e-12);
  EXPECT_NEAR(law.factor, 3, 1e-12);
  EXPECT_LT(law.error, 1e-12);
  EXPECT_GT(rough.error, 1e-3);
  EXPECT_LT(std::abs(rough.exponent + 1), 4 * rough.error);
}

TEST(Textbook, TheSolverTakesTheStepsOfThePublishedListing) {
  Scene s = bare::sheet(6, 6, {.shear = true});
  s.pins = {0, 5};
  s.gravity = {0, -kG, 0};
  Textbook<double> textbook(s, 3);
  Simulation sim(s, jakobsen(3));
  for (int n = 0; n < 64; ++n) {
    textbook.step();
    sim.step();
    ASSERT_LT(max_distance(textbook.x(), sim.state().x), 1e-10) << n;
  }
}

TEST(References, AreReadAsTheyWereWritten) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "references";
  const Scene s = bare::sheet(2, 2);
  Reference reference{"sheet", reference_digest(s, "static"), "by hand", 1e-16, s.mesh.rest};
  reference.x[1] = Vec3(0.1, 1.0 / 3, -2e-17);
  write_reference(reference, folder / "sheet");
  Scene named = s;
  named.name = "sheet";
  const auto found = find_references(named, folder).rest;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->x[1], reference.x[1]);
  EXPECT_EQ(found->floor, reference.floor);
  named.dt /= 2;
  named.steps *= 2;
  named.damping = 3;  // does not change the equilibrium
  EXPECT_TRUE(find_references(named, folder).rest);
  named.mesh.mass[0] *= 2;
  EXPECT_FALSE(find_references(named, folder).rest);
}

/// Scenes that have references beside those of the shipped ones: by the settings that studies use.
std::map<std::string, std::vector<SceneSettings>> referred() {
  std::map<std::string, std::vector<SceneSettings>> all{
      {"drape", {{"cloth.span=0.7"}}},
      {"swing",
       {{"links.shear=false"},
        {"cloth.grid=[12, 12]", "links.stiffness={ structural = 300, shear = 300 }"}}}};
  for (const char* stiffness : {"1e3", "1e4", "1e5", "1e6"}) {  // the study `methods`
    const std::string grid = "cloth.grid=[16, 16]",
                      links = std::string("links.stiffness={ structural = ") + stiffness + " }";
    all["drape"].push_back({"cloth.span=0.7", "cloth.tilt=45", grid, links});
    all["swing"].push_back({"links.shear=false", grid, links});
  }
  return all;
}

TEST(References, TheCommittedOnesBelongToTheShippedScenes) {
  int rests = 0, motions = 0;
  const auto known_settings = referred();
  for (const auto& entry : std::filesystem::directory_iterator(kSource / "results/references")) {
    const std::string name = entry.path().filename().string();
    const auto path = kSource / "experiments/scenes" / (name + ".toml");
    std::vector<SceneSettings> settings{{}};
    if (const auto more = known_settings.find(name); more != known_settings.end())
      settings.insert(settings.end(), more->second.begin(), more->second.end());
    std::set<std::filesystem::path> known;
    for (const SceneSettings& set : settings) {
      const Scene scene = load_scene(path, set);
      const References own = find_references(scene, kSource / "results/references");
      for (const char* kind : {"static", "motion", "ensemble"})
        known.insert(reference_file(kind, reference_digest(scene, kind), entry.path()));
      if (own.rest) {
        EXPECT_LT(own.rest->floor, (elastic_links(scene).empty() ? 1e-6 : 1e-4) * extent(scene));
        ++rests;
      }
      if (own.motion) {
        EXPECT_LT(own.motion->floor, 0.02) << name;
        EXPECT_GE(own.motion->horizon, 0.5) << name;
        ++motions;
      }
    }
    for (const auto& file : std::filesystem::directory_iterator(entry.path()))
      EXPECT_TRUE(known.contains(std::filesystem::path(file.path()).replace_extension(".json")))
          << file << " belongs to no scene: run `taut reference " << name << '`';
  }
  EXPECT_GE(rests, 3);
  EXPECT_GE(motions, 14);
}

}  // namespace
}  // namespace taut::truths_test
