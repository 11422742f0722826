#include "experiments/steps/error_probes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "core/reference/implicit_step.hpp"
#include "core/reference/step_error.hpp"
#include "experiments/steps/convergence.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

constexpr double kWithin = 0.25;      ///< relative to the true distance
constexpr double kMicrometre = 1e-6;  ///< m
constexpr int kIterations[] = {1, 5, 15};
constexpr double kStiffnesses[] = {1e3, 1e4, 1e5, 1e6};  ///< N/m
constexpr double kTimes[] = {0.25, 0.5, 0.75, 1};  ///< s, times of the states with rigid links

struct ProbedScene {
  std::string name;
  SceneSettings settings;
  double at = 0.5;  ///< s, time of the state

  std::string title() const {
    return settings.empty() ? name : name + ", " + join(settings, ", ", &SceneSetting::text);
  }
};

std::vector<ProbedScene> scenes_of(ProbePart part) {
  const SceneSettings small{"cloth.grid=[17,17]"};
  switch (part) {
    case ProbePart::free:
      return {{"cantilever", {}}, {"chain", {}}, {"drape", {}}, {"drape", {"cloth.span=0.7"}},
              {"drape-disc", {}}, {"fall", {}},  {"flag", {}},  {"hang", {}},
              {"strip", {}},      {"swing", {}}};
    case ProbePart::contact:
      return {{"ball", small, 0.75}, {"box", small, 0.75},       {"plane", small, 0.75},
              {"incline", {}, 0.5},  {"arm", small, 0.75},       {"disc", {}, 0.75},
              {"tunnel", {}, 0.5},   {"moving-ball", small, 0.5}};
    case ProbePart::rigid:
      return {{"chain", {}},
              {"drape", {}},
              {"drape", {"cloth.span=0.7"}},
              {"swing", {}},
              {"strip", {}}};
  }
  return {};
}

std::vector<std::string> solvers_of(ProbePart part) {
  if (part == ProbePart::rigid) return {"jakobsen", "xpbd", "admm", "avbd"};
  return {"pd",   "pd:anderson=5", "pd:chebyshev=0.9", "vbd",
          "admm", "xpbd",          "implicit",         "implicit:line-search=off"};
}

/// Setting that gives this stiffness to every family of the scene.
std::string stiffness_setting(const Scene& scene, double k) {
  std::vector<std::string> parts;
  for (const Family family : kFamilies)
    if (std::ranges::any_of(scene.links, [&](const Link& l) { return l.family == family; }))
      parts.push_back(std::string(to_string(family)) + " = " + shortest(k));
  return "links.stiffness={ " + join(parts, ", ") + " }";
}

double rms_apart(const Scene& scene, const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  int n = 0;
  for (int i = 0; i < scene.mesh.size(); ++i)
    if (!is_pinned(scene, i)) {
      sum += (a[to_index(i)] - b[to_index(i)]).squaredNorm();
      ++n;
    }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

State step_of(const Scene& scene, const std::string& solver, const State& from, double at) {
  const SolverChoice choice = parse_solver(solver);
  const std::unique_ptr<Solver> made = choice.entry->make(scene, choice.params);
  made->load(from);
  made->step(at, scene.dt);
  State state;
  made->store(state);
  return state;
}

/// A state, its exact step, and the StepError that estimates the distance from it.
struct Probed {
  const Scene& scene;
  double at;
  State from;
  std::vector<Vec3> exact;  ///< empty if there is no exact step
  reference::StepError error;

  Probed(const Scene& s, double time, const std::string& solver)
      : scene(s),
        at(std::round(time / s.dt) * s.dt),
        from(state_at(s, parse_solver(solver), at)),
        error(s, s.stiffness) {
    if (!s.bending) {
      const auto minimum = reference::ImplicitStep(s, from, at, s.stiffness).minimum(from.x);
      if (minimum.problem.empty()) exact = minimum.x;
    }
    if (!exact.empty() || s.stiffness == kRigid) return;
    // The scene has bending, or the 100 iterations of the reference were too few.
    exact = step_of(s, "implicit:iterations=2000", from, at).x;
  }
};

/// Counts for a scene and a solver.
struct Tally {
  int probes = 0, within = 0, refused = 0, without_exact = 0;
  /// Estimated over true distance, for estimates that are believed.
  std::vector<double> ratios = {};

  void add(Probed& probed, const std::string& solver) {
    ++probes;
    if (probed.exact.empty()) {
      ++without_exact;
      return;
    }
    const std::vector<Vec3> x = step_of(probed.scene, solver, probed.from, probed.at).x;
    const double truth = rms_apart(probed.scene, x, probed.exact);
    const auto told = probed.error.of(probed.from, probed.at, probed.scene.dt, x);
    if (!told.believed) {
      ++refused;
      return;
    }
    if (truth <= kMicrometre) {
      within += told.distance <= 2 * kMicrometre;
      return;
    }
    ratios.push_back(told.distance / truth);
    within += std::abs(ratios.back() - 1) <= kWithin;
  }
  void add(const Tally& other) {
    probes += other.probes;
    within += other.within;
    refused += other.refused;
    without_exact += other.without_exact;
    ratios.insert(ratios.end(), other.ratios.begin(), other.ratios.end());
  }
  std::vector<Cell> row(const std::string& scene, const std::string& solver) const {
    std::vector<Cell> row{scene, solver, probes, within, refused, without_exact};
    const auto [low, high] = std::ranges::minmax_element(ratios);
    row.push_back(ratios.empty() ? Cell() : Cell(*low));
    row.push_back(ratios.empty() ? Cell() : Cell(*high));
    return row;
  }
};

Table table_of(ProbePart part, const std::vector<std::string>& asked, Answer& answer) {
  const std::string name = probe_parts()[static_cast<std::size_t>(part)];
  Table table{name,
              "",
              {{"scene"},
               {"solver"},
               {"probes"},
               {"within", "within " + percent(kWithin)},
               {"refused"},
               {"without_exact", "no exact step"},
               {"least", "least of told/true"},
               {"most", "most of told/true"}}};
  const std::vector<std::string> solvers = solvers_of(part);
  Tally all;
  for (const ProbedScene& one : scenes_of(part)) {
    if (!asked.empty() && std::ranges::find(asked, one.name) == asked.end()) continue;
    std::vector<Tally> of(solvers.size());
    const Scene plain = load_scene(find_scene(one.name), one.settings);
    for (std::size_t k = 0; k < std::size(kStiffnesses); ++k) {
      SceneSettings settings = one.settings;
      if (part != ProbePart::rigid) settings.push_back(stiffness_setting(plain, kStiffnesses[k]));
      const Scene scene = load_scene(find_scene(one.name), settings);
      const double at = part == ProbePart::rigid ? kTimes[k] : one.at;
      Probed probed(scene, at,
                    part == ProbePart::rigid ? "implicit:structural=1e5,shear=1e5,bend=1e5"
                                             : "implicit:iterations=100");
      for (std::size_t s = 0; s < solvers.size(); ++s)
        for (const int iterations : kIterations)
          of[s].add(probed,
                    with(solvers[s], "iterations=" + std::to_string(iterations) + ",substeps=1"));
    }
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      table.rows.push_back(of[s].row(one.title(), solvers[s]));
      all.add(of[s]);
    }
  }
  table.rows.push_back(all.row("all", ""));
  answer.add(
      {name + "_share", name + ": within " + percent(kWithin) + " of the true distance", kShare},
      all.probes > 0 ? all.within / static_cast<double>(all.probes) : 0);
  return table;
}

}  // namespace

std::vector<std::string> probe_parts() { return {"free", "contact", "rigid"}; }

Answer error_probes(const std::vector<ProbePart>& parts, const std::vector<std::string>& scenes) {
  Answer answer{"verify steps", "the distance from the exact step, told without it"};
  std::vector<Table> tables;
  for (const ProbePart part : parts) tables.push_back(table_of(part, scenes, answer));
  for (Table& table : tables) answer.add(std::move(table));
  return answer;
}

}  // namespace taut
