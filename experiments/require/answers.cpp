#include "experiments/require/answers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

namespace {

/// Value of 100 %.
double whole(const KeptQuantity& answer, const Observation& full) {
  const double of_scene = hundred_percent(unit_of(answer), *full.one.scene);
  return std::isnan(of_scene) ? std::abs(value_of(answer, full)) : of_scene;
}

double default_tolerance(const KeptQuantity& answer, const Observation& full) {
  if (answer.is_shape()) return 0.01 * whole(answer, full);
  switch (unit_of(answer).kind) {
    case Unit::Kind::count:
      return 0;
    case Unit::Kind::share:
      return 0.01 * whole(answer, full);
    case Unit::Kind::length:
      return 0.001 * whole(answer, full);
    case Unit::Kind::time:
    case Unit::Kind::other:
      break;
  }
  return 0.1 * whole(answer, full);
}

/// Position at (u, v) in [0, 1]^2 of a sheet, interpolated bilinearly between the vertices of a
/// grid.
Vec3 between(const Grid& grid, const std::vector<Vec3>& x, double u, double v) {
  const auto part = [](double share, int count) {
    const double at = share * (count - 1);
    const int below = std::clamp(static_cast<int>(at), 0, std::max(0, count - 2));
    return std::pair(below, at - below);
  };
  const auto [i, a] = part(u, grid.nu);
  const auto [j, b] = part(v, grid.nv);
  const auto at = [&, i = i, j = j](int di, int dj) -> const Vec3& {
    return x[to_index(grid.index(std::min(i + di, grid.nu - 1), std::min(j + dj, grid.nv - 1)))];
  };
  return (1 - a) * (1 - b) * at(0, 0) + a * (1 - b) * at(1, 0) + (1 - a) * b * at(0, 1) +
         a * b * at(1, 1);
}

double apart(const Scene& scene, const std::vector<Vec3>& x, const Scene& other,
             const std::vector<Vec3>& y) {
  double most = 0;
  if (x.size() == y.size()) {
    for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, (x[i] - y[i]).norm());
    return most;
  }
  if (!scene.mesh.grid || !other.mesh.grid) return kNoAnswer;
  const bool first = x.size() < y.size();
  const Grid &few = first ? *scene.mesh.grid : *other.mesh.grid,
             &many = first ? *other.mesh.grid : *scene.mesh.grid;
  const auto share = [](int i, int count) {
    return count > 1 ? static_cast<double>(i) / (count - 1) : 0.0;
  };
  for (int j = 0; j < few.nv; ++j)
    for (int i = 0; i < few.nu; ++i) {
      const Vec3& here = (first ? x : y)[to_index(few.index(i, j))];
      const Vec3 there = between(many, first ? y : x, share(i, few.nu), share(j, few.nv));
      most = std::max(most, (here - there).norm());
    }
  return most;
}

/// A metric's value on a motion, measured as on the full model's scene.
double measured(const KeptQuantity& answer, const Scene& scene, const std::vector<Frame>& frames) {
  const auto [entry, value] = find_value(answer.name);
  const auto metric = entry->make(scene);
  if (!metric) return std::nan("");
  for (const Frame& frame : frames) {
    if (frame.state.x.size() != scene.start.x.size()) return std::nan("");
    const State state{frame.state.x, scene.start.v};
    const auto before_end = std::lround((frames.back().t - frame.t) / scene.dt);
    metric->observe({scene.steps - static_cast<int>(before_end), frame.t, state});
  }
  const std::vector<double> values = metric->finish();
  return values[static_cast<std::size_t>(value - entry->values.data())];
}

}  // namespace

Unit unit_of(const KeptQuantity& answer) {
  const ValueSpec* value = find_value(answer.name).second;
  return value ? value->unit : kLength;
}

std::string text(const KeptQuantity& answer, double value) {
  if (!std::isfinite(value)) return "-";
  return number_text(value, unit_of(answer));
}

std::string name_of_answer(const std::string& asked) {
  std::vector<std::string> names = value_names();
  names.emplace_back(kShapeAnswer);
  return name_of_kept(asked, names);
}

KeptQuantity parse_answer(const std::string& asked, const Observation& full) {
  const auto colon = asked.find(':');
  KeptQuantity answer{name_of_answer(asked), 0};
  if (!answer.is_shape() && std::isnan(value_of(answer, full)))
    throw InputError("--keep " + asked + ": has no value on this scene");
  if (colon == std::string::npos) {
    answer.tolerance = default_tolerance(answer, full);
    return answer;
  }
  answer.tolerance = number_of_kept(asked, unit_of(answer), whole(answer, full));
  return answer;
}

std::vector<std::string> default_answers(const Observation& full) {
  std::vector<std::string> names{kShapeAnswer};
  const auto& params = full.record.params;
  const auto touching = params.find(
      std::string(parameter_with(ParamSpec::Role::face_contact, full.one.choice.entry->params)));
  const bool faces = touching != params.end() && touching->second == "on";
  for (const MetricEntry* metric : metrics()) {
    const bool of_faces = std::ranges::count(metric->values, Role::face_depth, &ValueSpec::role);
    for (const ValueSpec& value : metric->values)
      if (value.kept && (faces || !of_faces) &&
          !std::isnan(value_of({std::string(value.name)}, full)))
        names.emplace_back(value.name);
  }
  return names;
}

double value_of(const KeptQuantity& answer, const Observation& one) {
  const auto found = one.record.values.find(answer.name);
  return found == one.record.values.end() ? std::nan("") : found->second;
}

double distance(const KeptQuantity& answer, const Observation& full, const Observation& other) {
  if (!completed(other.record.status) || other.frames.empty() || full.frames.empty())
    return kNoAnswer;
  if (answer.is_shape())
    return apart(*full.one.scene, full.frames.back().state.x, *other.one.scene,
                 other.frames.back().state.x);
  const double value = value_of(answer, other);
  if (!std::isnan(value)) return std::abs(value - value_of(answer, full));
  const double moved = std::abs(measured(answer, *full.one.scene, other.frames) -
                                measured(answer, *full.one.scene, full.frames));
  return std::isnan(moved) ? kNoAnswer : moved;
}

std::optional<double> apart_after(const Observation& a, const Observation& b, double tolerance) {
  for (std::size_t k = 0; k < std::min(a.frames.size(), b.frames.size()); ++k)
    if (apart(*a.one.scene, a.frames[k].state.x, *b.one.scene, b.frames[k].state.x) > tolerance)
      return a.frames[k].t;
  return std::nullopt;
}

}  // namespace taut
