#include "experiments/case/record_columns.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "experiments/case/record_io.hpp"

namespace taut {

namespace {

constexpr bool kResult = true, kMayLack = true;
constexpr Unit kMilliseconds{Unit::Kind::time, "s", "ms", 1e3};

const RecordColumn kColumns[] = {
    {"key", "key", &Record::key, "SHA-256 of everything that decides the result"},
    {"id", "id", &Record::id, "the case for people"},
    {"setting", "setting", &Record::setting,
     "settings of the scene and the solver's text: `id` without the scene", !kResult, kMayLack},
    {"spec.scene", "scene_file", &CaseSpec::scene, "the scene as it was asked for"},
    {"spec.settings", "settings", &CaseSpec::settings, "settings of the scene, in their order"},
    {"spec.solver", "solver_text", &CaseSpec::solver, "the solver with all its parameters"},
    {"scene", "scene", &Record::scene, "name of the scene"},
    {"solver", "solver", &Record::solver, "name of the solver"},
    {"params", "parameters", &Record::params, "all parameters of the solver, as text"},
    {"substeps", "substeps", &Record::substeps,
     "substeps of a step; -1: the solver names no parameter for them", !kResult, kMayLack,
     "substeps per step"},
    {"sweeps", "sweeps", &Record::sweeps,
     "sweeps of a substep; -1: the solver names no parameter for them", !kResult, kMayLack,
     "sweeps per substep"},
    {"work_parameters", "work_parameters", &Record::work_parameters,
     "the parameters that set these two"},
    {"dt", "dt", &Record::dt, "time step [s]", !kResult, !kMayLack, "time step", kMilliseconds},
    {"steps", "steps", &Record::steps, "of the whole case", !kResult, !kMayLack, "steps"},
    {"vertices", "vertices", &Record::vertices, "of the cloth", !kResult, !kMayLack, "vertices"},
    {"links", "links", &Record::links, "of the cloth", !kResult, !kMayLack, "links"},
    {"status.kind", "status", &Status::kind, stored_statuses(), kResult},
    {"status.reason", "reason", &Status::reason, "why the status is not ok", kResult},
    {"status.step", "step", &Status::step, "where it happened; -1: not known", kResult, kMayLack},
    {"status.vertex", "vertex", &Status::vertex, "the first vertex concerned; -1: not known",
     kResult, kMayLack},
    {"values", "", &Record::values,
     "metric values by name; `taut list metrics` says what each is and its unit", kResult},
    {"projections", "projections", &Record::projections, "constraint projections per step", kResult,
     !kMayLack, "constraint projections per step"},
    {"step_cost", "passes", &Record::step_cost,
     "passes of a step: `pass`, `items`, `repeats`, `bytes` that exist because of it, whether it "
     "`projections` constraints",
     kResult},
    {"resolved_settings", "resolved_settings", &Record::resolved_settings,
     "what the solver made of the scene: `name`, `text`; `token`, by which it is compared, and "
     "`number` in SI where it has them",
     kResult},
    {"digest", "state_digest", &Record::digest, "SHA-256 of the final state", kResult},
    {"log", "log", &Record::log,
     "the end of what a solver's own program wrote to standard error; absent if nothing", !kResult,
     kMayLack},
};

template <class Struct, class Value>
std::string_view type_of(Value Struct::*) {
  if (std::is_same_v<Value, std::string> || std::is_same_v<Value, Status::Kind> ||
      std::is_same_v<Value, StatusReason>)
    return "text";
  if (std::is_same_v<Value, double>) return "number";
  if (std::is_integral_v<Value>) return "whole number";
  return "JSON";
}

}  // namespace

std::string_view RecordColumn::type() const {
  return std::visit([](auto any) { return type_of(any); }, member);
}

std::span<const RecordColumn> record_columns() { return kColumns; }

const RecordColumn* find_axis(std::string_view json) {
  const auto found = std::ranges::find(kColumns, json, &RecordColumn::json);
  return found == std::end(kColumns) || found->title.empty() ? nullptr : found;
}

std::optional<ImpossibleField> impossible_field(const Record& record) {
  if (!is_key(record.key)) return ImpossibleField{"key", "expected 64 hexadecimal digits"};
  if (!(record.dt > 0)) return ImpossibleField{"dt", "expected a time step greater than 0"};
  return {};
}

double number_in(const Record& record, const RecordColumn& column) {
  const double number = with_member(record, column, [](const auto& value) {
    if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>)
      return static_cast<double>(value);
    else
      return std::numeric_limits<double>::quiet_NaN();
  });
  return column.may_lack && number < 0 ? std::numeric_limits<double>::quiet_NaN() : number;
}

}  // namespace taut
