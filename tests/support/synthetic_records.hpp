#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"

// Records of a study from closed forms, for tests of figures and reports.
namespace taut::synthetic {

inline Record record(const std::string& scene, const std::string& solver, int sweeps, double dt) {
  Record r;
  r.scene = scene;
  r.solver = solver;
  r.params = {{"iterations", std::to_string(sweeps)}, {"precision", "double"}};
  r.sweeps = sweeps;
  r.work_parameters = {"iterations"};
  r.spec = {scene, {}, solver + ":iterations=" + std::to_string(sweeps) + ",precision=double"};
  r.id = scene + " dt=" + std::to_string(dt) + " " + r.spec.solver;
  r.key = "k" + std::to_string(std::hash<std::string>{}(r.id));
  r.dt = dt;
  r.steps = static_cast<int>(4 / dt);
  r.vertices = 400;
  r.links = 1482;
  r.projections = static_cast<std::size_t>(r.links * sweeps);
  r.step_cost = {{"verlet", 400, 1, 28800, false},
                 {"structural", 760, static_cast<std::size_t>(sweeps), 12160, true},
                 {"shear", 722, static_cast<std::size_t>(sweeps), 11552, true}};
  r.resolved_settings = {{"time step", "1/64 s, as binary32"},
                         {"projection", solver == "bullet" ? "sqrt-free" : "exact"}};
  return r;
}

inline void fail(Record& r, Status::Kind kind, const StatusReason& reason, int step = 12) {
  r.status = {kind, reason, step, 7};
  r.values.clear();
}

/// Stretch falls as 1/k; Bullet's is three times as large. The last but one of Bullet's cases
/// explodes.
inline std::vector<Record> iterations(const std::string& scene) {
  std::vector<Record> all;
  for (const std::string solver : {"jakobsen", "bullet"})
    for (int k = 1; k <= 256; k *= 2) {
      Record r = record(scene, solver, k, 1.0 / 64);
      r.values["stretch.rms"] = (solver == "bullet" ? 0.3 : 0.1) / std::pow(k, 0.9);
      r.values["stretch.max"] = 4 * r.values["stretch.rms"];
      r.values["penetration.max"] = k >= 64 ? 0.0 : 0.004 / k;
      if (solver == "bullet" && k == 128) fail(r, Status::Kind::exploded, Reason::nonfinite);
      all.push_back(r);
    }
  return all;
}

/// Cases with long steps and few sweeps fail; Bullet's fail sooner.
inline std::vector<Record> time_steps(const std::string& scene) {
  std::vector<Record> all;
  for (const std::string solver : {"jakobsen", "bullet"})
    for (const double dt : {0.001, 0.002, 0.004, 1.0 / 120, 1.0 / 64, 1.0 / 30, 0.05, 0.1})
      for (int k = 1; k <= 64; k *= 2) {
        Record r = record(scene, solver, k, dt);
        r.values["stretch.rms"] = 400 * dt * dt / k;
        r.values["penetration.max"] = 9.81 * dt * dt;
        const double load = dt * (solver == "bullet" ? 2 : 1) / std::sqrt(k);
        if (load > 0.04) r.status = {Status::Kind::unsettled, "speed", -1, -1};
        if (load > 0.07) fail(r, Status::Kind::exploded, Reason::energy);
        if (solver == "bullet" && k == 64 && dt < 0.0015) fail(r, Status::Kind::timeout, "60 s");
        if (solver == "bullet" && k == 1 && dt < 0.0015) fail(r, Status::Kind::crash, "SIGSEGV");
        all.push_back(r);
      }
  return all;
}

}  // namespace taut::synthetic
