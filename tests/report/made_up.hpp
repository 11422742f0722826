#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "experiments/case/record_io.hpp"
#include "experiments/report/input.hpp"

// Invented results: failures that left values behind, ties, noise, a single solver, missing
// metrics, colliders that are gone before the last second, unequal substeps.
namespace taut::report::made_up {

class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {}

  ReportInput input() {
    const std::vector<std::string> names = some({"jakobsen", "bullet", "xpbd"});
    const std::vector<std::string> scenes = some({"hang", "ball", "box", "tunnel", "fall"});
    const bool unequal = chance(0.15), no_sweeps = chance(0.1);
    StudyResult sweeps{"iterations", "?", {}, 0, {}}, steps{"time-steps", "?", {}, 0, {}};
    for (const std::string& scene : scenes) {
      const bool stepped = chance(0.5);
      for (const std::string& solver : names) {
        const int substeps = unequal && solver == "jakobsen" ? 5 : 1;
        for (int k : {1, 4, 16, 64}) {
          if (no_sweeps && solver == "xpbd" && k > 1) continue;
          if (no_sweeps && solver == "xpbd") k = -1;
          if (!chance(0.1)) add(sweeps, scene, solver, 1.0 / 64, substeps, k);
          for (const double dt : {1e-3, 1.0 / 240, 1.0 / 60, 1.0 / 30, 0.1})
            if (stepped && !chance(0.03)) add(steps, scene, solver, dt, substeps, k);
        }
      }
    }
    ReportInput input;
    input.studies = {sweeps, steps};
    // the intervals of a bench take the most time
    if (chance(0.1)) input.bench = bench(names, scenes);
    if (chance(0.2)) input.differences = differences(input);
    return input;
  }

  /// Sets the status and the values. Failed runs keep values that would flatter them.
  void fill(Record& r) {
    end(r);
    const bool failure = !completed(r.status);
    double stretch = between(1e-5, 0.3);
    if (chance(0.3)) stretch = chance(0.5) ? 0.02 : 0.0205;
    if (r.scene == "fall") stretch = between(1e-17, 1e-12);
    if (failure) stretch = 1e-6;
    if (!chance(0.05)) r.values["stretch.rms"] = chance(0.02) ? std::nan("") : stretch;
    if (r.scene != "fall" && r.scene != "plane" && !chance(0.1)) {
      r.values["motion.error"] = between(0.005, chance(0.2) ? 1.5 : 0.2);
      r.values["motion.floor"] = r.scene == "box" ? 0.01 : 0;
      r.values["motion.strain"] = r.scene == "swing" ? 0.02 : 0;
    }
    if (r.scene == "hang" || r.scene == "fall" || r.scene == "swing") return;
    const double peak = failure || chance(0.2) ? 0 : between(1e-6, 0.2);
    r.values["penetration.peak"] = peak;
    // 0: the cloth has left the collider
    r.values["penetration.max"] = chance(0.4) ? 0 : peak * uniform();
    if (!chance(0.1)) r.values["face.peak"] = failure ? 0 : peak + between(1e-5, 0.1);
    r.values["face.max"] = 0;
    r.values["tunnelling.events"] = failure ? 0 : static_cast<double>(random_() % 3 * 28);
    r.values["tunnelling.count"] = 0;
    if (!chance(0.1)) r.values["step.error"] = between(1e-5, 0.05);
  }
  bool chance(double p) { return uniform() < p; }
  double uniform() { return static_cast<double>(random_() >> 11U) * 0x1p-53; }
  double between(double low, double high) { return low * std::pow(high / low, uniform()); }

 private:
  /// Random nonempty selection in random order.
  std::vector<std::string> some(std::vector<std::string> all) {
    std::shuffle(all.begin(), all.end(), random_);
    all.resize(1 + random_() % all.size());
    return all;
  }

  Record record(const std::string& scene, const std::string& solver, double dt, int substeps,
                int sweeps, const std::string& more = "") {
    Record r;
    r.scene = scene;
    r.solver = solver;
    r.dt = dt;
    r.params = {{"substeps", std::to_string(substeps)}};
    if (sweeps > 0) r.params["iterations"] = std::to_string(sweeps);
    r.steps = 256;
    r.vertices = 100;
    r.links = 300;
    r.projections = 300;
    r.spec = {scene,
              {"time.dt=" + std::to_string(dt)},
              solver + ":substeps=" + std::to_string(substeps) +
                  ",iterations=" + std::to_string(sweeps) + more};
    r.id = scene + " " + std::to_string(dt) + " " + r.spec.solver;
    r.key = std::to_string(std::hash<std::string>{}(r.id)) + std::string(20, 'x');
    return r;
  }

  void end(Record& r) {
    const double die = uniform();
    if (die < 0.7) return;
    r.status.reason = "made up";
    r.status.vertex = static_cast<int>(1000 * die) % 3 - 1;  // none, the first or another vertex
    r.status.step = static_cast<int>(1e6 * die) % 3 - 1;
    r.status.kind = die < 0.78   ? Status::Kind::unsettled
                    : die < 0.82 ? Status::Kind::extreme
                    : die < 0.88 ? Status::Kind::exploded
                    : die < 0.92 ? Status::Kind::timeout
                    : die < 0.96 ? Status::Kind::crash
                                 : Status::Kind::unsupported;
  }

  void add(StudyResult& study, const std::string& scene, const std::string& solver, double dt,
           int substeps, int sweeps) {
    Record r = record(scene, solver, dt, substeps, sweeps);
    fill(r);
    study.records.push_back(r);
  }

  /// The same cases computed again: most with the same bits, others with other values or another
  /// end.
  Differences differences(const ReportInput& input) {
    Differences found{"before", "after", {}, {}, 3, 0, chance(0.5) ? 0.02 : 0.3};
    const bool changed = chance(0.7);
    for (const Record& r : input.studies[0].records) {
      Record b = r;
      b.key = "b" + r.key;  // of another build
      if (changed && chance(0.1)) b.status.kind = Status::Kind::exploded;
      for (auto& [name, value] : b.values)
        if (changed && chance(0.3)) value *= between(0.5, 2);
      found.pairs.emplace_back(r, b);
    }
    if (!input.bench) return found;
    const double factor = chance(0.3) ? 1 : between(0.5, 2);
    for (const SceneBench& scene : input.bench->scenes)
      for (const BenchedCase& c : scene.cases) {
        found.timed.emplace_back(c, c);
        BenchedCase& b = found.timed.back().second;
        b.record.key = "b" + c.record.key;
        for (double& t : b.timing.samples) t *= factor;
      }
    return found;
  }

  StudyBench bench(const std::vector<std::string>& names, const std::vector<std::string>& scenes) {
    StudyBench session{"trade", "a machine", {}};
    for (const std::string& scene : scenes) {
      const double noise = chance(0.3) ? 0.4 : 0.02;
      SceneBench one{scene, {1 / (1 + noise * uniform()), 1, 1 + noise * uniform()}, {}};
      one.limits.emplace();
      for (const std::string& solver : names) {
        if (chance(0.1)) continue;
        const double speed = between(0.5, 4);
        const bool stubborn = chance(0.3);  // no setting reaches the error of the price table
        const bool to_the_end = chance(0.3);
        const double dt = 1.0 / (chance(0.2) ? 128 : 64);
        for (const auto& [substeps, sweeps] :
             {std::pair{1, 4}, {1, 16}, {4, 1}, {8, 2}, {1024, 1}, {1, 128}})
          for (const char* tethers : {"off", "on"}) {
            const bool on = tethers == std::string("on");
            if (on && solver != "jakobsen") continue;
            if (!to_the_end && (substeps > 8 || (sweeps > 16 && chance(0.5)))) continue;
            BenchedCase c{record(scene, solver, dt, substeps, sweeps,
                                 on ? ",tethers=on,precision=double" : ",precision=double"),
                          {}};
            if (solver == "jakobsen") c.record.params["tethers"] = tethers;
            end(c.record);
            c.record.values["stretch.rms"] = between(0.001, 0.03);
            if (scene != "fall" && !chance(0.05)) {
              c.record.values["motion.error"] =
                  between(stubborn ? 0.06 : 0.005, chance(0.1) ? 2 : 0.3);
              c.record.values["motion.floor"] = scene == "box" ? 0.01 : 0;
              c.record.values["motion.strain"] = scene == "tunnel" ? 0.02 : 0;
            }
            const double cost = speed * substeps * sweeps * (on ? 0.3 : 1) / 64;
            for (int i = 0; i < 10; ++i)
              c.timing.samples.push_back(cost * (1 + noise * (uniform() - 0.5)));
            c.timing.wall = c.timing.samples;
            if (chance(0.03)) c.timing.failure = "made up";
            one.cases.push_back(std::move(c));
          }
      }
      if (!one.cases.empty()) session.scenes.push_back(std::move(one));
    }
    return session;
  }

  std::mt19937_64 random_;
};

}  // namespace taut::report::made_up
