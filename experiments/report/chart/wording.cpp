#include "experiments/report/chart/wording.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_columns.hpp"
#include "experiments/case/run_case.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/text.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::report {

std::string typeset(std::string_view plain) {
  constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"^2", "²"},    {"^3", "³"},    {">=", "≥"}, {"<=", "≤"}, {"+-", "±"},
      {" x ", " × "}, {" - ", " − "}, {"mu", "μ"}, {"pi", "π"}};
  const auto at = [&](std::size_t i) { return i < plain.size() ? plain[i] : ' '; };
  const auto letter = [&](std::size_t i) {
    return at(i) == '_' || std::isalnum(static_cast<unsigned char>(at(i)));
  };
  const auto digit = [&](std::size_t i) { return std::isdigit(static_cast<unsigned char>(at(i))); };
  std::string out;
  for (std::size_t i = 0; i < plain.size();) {
    const auto found = std::ranges::find_if(kSigns, [&](const auto& sign) {
      const bool word = std::isalpha(static_cast<unsigned char>(sign.first[0]));
      return plain.substr(i).starts_with(sign.first) &&
             (!word || (!letter(i - 1) && !letter(i + sign.first.size())));
    });
    const bool minus = at(i) == '-' && digit(i + 1) && (at(i - 1) == ' ' || at(i - 1) == '(');
    std::size_t end = i + 1;  // of an exponent behind a digit: e-12
    if (at(end) == '-' || at(end) == '+') ++end;
    const std::size_t digits = end;
    while (digit(end)) ++end;
    if (found != std::end(kSigns)) {
      out += found->second;
      i += found->first.size();
    } else if (at(i) == 'e' && digit(i - 1) && end > digits && !letter(end)) {
      out += "×" + power_of_ten(plain.substr(i + 1, end - i - 1));
      i = end;
    } else {
      out += minus ? "−" : std::string(1, plain[i]);
      ++i;
    }
  }
  return out;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

namespace {

const SolverEntry* find_entry(std::string_view solver) {
  const auto known = solvers();
  const auto found = std::ranges::find(known, solver, &SolverEntry::name);
  return found == known.end() ? nullptr : *found;
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Unit kCost{Unit::Kind::time, "s", "ms", 1e3, true, true};

/// Quantities that are neither a record's field nor a metric's value: settings and costs.
struct Titled {
  std::string_view name, title;
  Unit unit;
  std::string_view help = "";
};
constexpr std::array kTitles{
    Titled{kSweeps, "sweeps per substep", kNumber,
           "passes over all links; most solvers call the parameter iterations"},
    Titled{"t", "simulated time", kTime},
    Titled{kCpuPerSecond, "CPU time per simulated second", kCost,
           "median of samples that alternate between the solvers, of all threads of the process"},
    Titled{kCpuPerStep, "CPU time per step", kCost,
           "median of samples that alternate between the solvers, of all threads of the process"},
    Titled{kWallPerStep, "wall time per step", kCost, "median of the same samples"},
    Titled{kPeakMemory, "peak memory of the process", kMegabytes},
    Titled{"step.distance", "distance from the exact step", kErrorLength,
           "root mean square over the vertices, after this many iterations of one step"},
    Titled{"step.gap",
           "share of the gap that is left",
           {Unit::Kind::other, "1", "", 1, true, true},
           "(G - G*) / (G_0 - G*) of springs; of rigid links the square of the distance over that "
           "of the prediction, weighted by mass"},
    Titled{"step.stretch", "RMS of length - rest length", kErrorLength},
    Titled{"step.residual", "|gradient of G|", {Unit::Kind::other, "N", "N", 1, true, true}},
    Titled{"cloth.weights.0.factor", "mass ratio", kNumber},
};

/// The text as a number; NaN if it is not exactly one number.
double number(const std::string& text) {
  double value = kNaN;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  return parsed.ec == std::errc() && parsed.ptr == end ? value : kNaN;
}

/// The number that the case gives a scene key; NaN: none.
double set_number(const Record& record, const std::string& key) {
  const SceneSetting* setting = find_setting(record.spec.settings, key);
  return setting ? number(setting->value()) : kNaN;
}

/// "stretch.max" -> "largest stretch"
std::string title_from(std::string_view name) {
  std::string title(name);
  std::ranges::replace_if(
      title, [](char c) { return c == '.' || c == '_'; }, ' ');
  for (const auto& [from, to] : {std::pair<std::string, std::string>{" rms", "RMS "},
                                 {" max", "largest "},
                                 {" peak", "peak "},
                                 {" p95", "95th percentile "},
                                 {" mean", "mean "}})
    if (title.ends_with(from)) title = to + title.substr(0, title.size() - from.size());
  return title;
}

}  // namespace

std::string own_parameter(std::string_view solver, std::string_view name) {
  const auto colon = name.find(':');
  const bool of_it = colon != name.npos && name.substr(0, colon) == solver;
  return std::string(of_it ? name.substr(colon + 1) : name);
}

double value_of(const Record& record, std::string_view name) {
  if (const RecordColumn* field = find_axis(name == kSweeps ? "sweeps" : name))
    if (const double value = number_in(record, *field); std::isfinite(value)) return value;
  if (name == kStrainFloor) {
    const ResolvedSetting* floor = find_setting(record.resolved_settings, kStrainFloor);
    return floor ? floor->number : kNaN;
  }
  const std::string key(name);
  if (const auto value = record.values.find(key); value != record.values.end())
    return value->second;
  const auto param = record.params.find(own_parameter(record.solver, key));
  return param == record.params.end() ? set_number(record, key) : number(param->second);
}

std::string Quantity::label() const {
  return unit.shown.empty() ? title : title + " [" + std::string(unit.shown) + "]";
}

namespace {

/// A parameter by its row; `solver`: "" for all that have it. What their rows disagree on is left
/// out.
std::optional<Quantity> parameter_quantity(std::string_view name, std::string_view solver) {
  std::optional<Quantity> found;
  for (const SolverEntry* entry : solvers()) {
    if (!solver.empty() && entry->name != solver) continue;
    for (const ParamSpec& spec : entry->params) {
      if (spec.name != own_parameter(entry->name, name)) continue;
      const Unit unit = spec.unit.empty() ? kNumber : Unit{Unit::Kind::other, spec.unit, spec.unit};
      if (!found) found = {std::string(name), std::string(spec.name), unit, std::string(spec.help)};
      if (found->unit.si != unit.si) found->unit = kNumber;
      if (found->help != spec.help) found->help.clear();
    }
  }
  return found;
}

}  // namespace

Quantity quantity(std::string_view name, std::string_view solver) {
  std::string own(name);
  if (const auto known = std::ranges::find(kTitles, name, &Titled::name); known != kTitles.end())
    return {own, std::string(known->title), known->unit, std::string(known->help)};
  if (const RecordColumn* field = find_axis(name))
    return {own, std::string(field->title), field->unit};
  const ValueSpec* value = find_value(name).second;
  if (!value) return parameter_quantity(name, solver).value_or(Quantity{own, own});
  return {own, value->title.empty() ? title_from(name) : std::string(value->title), value->unit,
          std::string(value->help), value->window};
}

std::string range_text(const std::set<double>& values, const Quantity& q) {
  const std::string least = q.text(*values.begin(), 3), most = q.text(*values.rbegin(), 3);
  return values.size() > 1 ? least + " to " + most : least;
}

std::vector<std::string> quantity_names() {
  std::vector<std::string> names = value_names();
  for (const Titled& known : kTitles) names.emplace_back(known.name);
  for (const RecordColumn& column : record_columns())
    if (!column.title.empty()) names.emplace_back(column.json);
  for (const SolverEntry* entry : solvers())
    for (const ParamSpec& spec : entry->params)
      if (spec.kind == ParamSpec::Kind::integer || spec.kind == ParamSpec::Kind::real)
        push_unique(names, spec.name);
  return names;
}

std::string solver_title(std::string_view solver) {
  if (const SolverEntry* entry = find_entry(solver); entry && !entry->title.empty())
    return std::string(entry->title);
  std::string title(solver);
  std::ranges::replace(title, '_', ' ');
  std::ranges::replace(title, '-', ' ');
  return capitalised(title);
}

bool solves_all_at_once(const std::string& solver) {
  const SolverEntry* entry = find_entry(solver);
  return entry && entry->accuracy.all_at_once;
}

std::map<std::string, std::string> other_settings(const Record& r) {
  std::map<std::string, std::string> others = r.params;
  for (const std::string& name : r.work_parameters) others.erase(name);
  return others;
}

std::vector<std::string> labelled_parameters(const std::string& solver) {
  const SolverEntry* entry = find_entry(solver);
  if (!entry) return {};
  std::vector<std::string> all;
  for (const std::string_view name : entry->accuracy.labelled)
    if (name != entry->accuracy.substeps && name != entry->accuracy.sweeps) all.emplace_back(name);
  return all;
}

std::string parameter_meaning(const std::string& solver, const std::string& name) {
  const SolverEntry* entry = find_entry(solver);
  if (!entry) return "";
  const auto spec = std::ranges::find(entry->params, name, &ParamSpec::name);
  if (spec == entry->params.end()) return "";
  std::string meaning(spec->help);
  if (!spec->unit.empty()) meaning += " [" + std::string(spec->unit) + "]";
  if (!spec->choices.empty()) meaning += " (" + join(parts_of(spec->choices), ", ") + ")";
  return meaning;
}

std::string parameter_term(const std::string& solver, const std::string& name) {
  const std::string meaning = parameter_meaning(solver, name);
  const bool means_one_thing = std::ranges::all_of(solvers(), [&](const SolverEntry* entry) {
    const std::string other(entry->name);
    return std::ranges::count(labelled_parameters(other), name) == 0 ||
           parameter_meaning(other, name) == meaning;
  });
  return means_one_thing ? name : name + " of " + solver_title(solver);
}

std::string link_order_parameter(const std::string& solver) {
  const SolverEntry* entry = find_entry(solver);
  return entry ? std::string(entry->accuracy.link_order) : "";
}

std::string parameter_of(std::string_view solver, ParamSpec::Role role) {
  const SolverEntry* entry = find_entry(solver);
  return std::string(entry ? parameter_with(role, entry->params) : usual_name(role));
}

std::vector<std::string> stiffness_parameters(const std::string& solver) {
  const SolverEntry* entry = find_entry(solver);
  if (!entry) return {};
  const Words& names = entry->accuracy.stiffness.parameters;
  return {names.begin(), names.end()};
}

std::vector<std::string> searched_parameters(const std::string& solver) {
  std::vector<std::string> all = labelled_parameters(solver);
  const SolverEntry* entry = find_entry(solver);
  if (!entry) return all;
  for (const std::string& name : stiffness_parameters(solver)) push_unique(all, name);
  for (const auto& [names, values] : entry->accuracy.alternatives)
    for (const std::string_view name : names) push_unique(all, std::string(name));
  return all;
}

std::vector<std::string> extras(const Record& r, const std::map<std::string, std::string>& others) {
  std::vector<std::string> used;
  const SolverEntry* entry = find_entry(r.solver);
  if (!entry) return used;
  for (const std::string_view accelerator : entry->accuracy.accelerators) {
    const std::string name(accelerator);
    const auto spec = std::ranges::find(entry->params, name, &ParamSpec::name);
    const auto at = r.params.find(name);
    if (at != r.params.end() && at->second != spec->default_value && !others.contains(name))
      used.push_back(name);
  }
  return used;
}

std::string Work::text() const {
  if (sweeps < 0) return substeps < 0 ? "defaults" : std::to_string(substeps) + " substeps";
  if (substeps < 0) return std::to_string(sweeps) + " sweeps";
  return std::to_string(substeps) + " × " + std::to_string(sweeps);
}

Work work_of(const Record& r) {
  // whole steps are one substep
  return {r.sweeps >= 0 ? std::max(1, r.substeps) : r.substeps, r.sweeps};
}

namespace {

std::string with_work(const Work& work, const std::string& others) {
  if (others.empty()) return work.text();
  return work == Work{} ? others : work.text() + ", " + others;
}

}  // namespace

std::string brief_settings(const SolverChoice& choice) {
  Record described;
  describe_solver(described, choice);
  const std::string changed = choice.params.brief(join(described.work_parameters, "|"));
  const auto text = [](const ParamItem& one) { return one.key + "=" + one.value; };
  return with_work(work_of(described), join(param_items(changed), ", ", text));
}

std::string brief_settings(const Record& r) try {
  return brief_settings(parse_solver(r.spec.solver));
} catch (const InputError&) {
  const auto text = [](const auto& one) { return one.first + "=" + one.second; };
  return with_work(work_of(r), join(other_settings(r), ", ", text));
}

std::string titled(const std::string& solver, const std::string& settings) {
  return solver_title(solver) + (settings.empty() ? "" : " " + settings);
}

std::string unequal_work(const Records& records) {
  std::map<std::string, std::set<Work>> works;
  std::vector<std::string> solvers;
  for (const Record* r : records)
    if (const Work work = work_of(*r); work.sweeps > 0) {
      if (!works.contains(r->solver)) solvers.push_back(r->solver);
      works[r->solver].insert(work);
    }
  if (works.size() < 2) return "";
  std::set<Work> common = works.begin()->second;
  std::string text;
  for (const std::string& solver : solvers) {
    const std::set<Work>& own = works[solver];
    std::erase_if(common, [&](const Work& work) { return !own.contains(work); });
    const Work &first = *own.begin(), &last = *own.rbegin();
    text += (text.empty() ? "" : ", ") + solver_title(solver) + " " + first.text() +
            (own.size() > 1 ? " to " + last.text() : "");
  }
  return common.empty() ? text + " (substeps × sweeps)" : "";
}

namespace {

/// The value of one of the labelled parameters, kSubsteps or kSweeps, as text; nothing: none.
std::optional<std::string> setting_of(const Record& r, const std::string& name) {
  if (name == kSubsteps || name == kSweeps) {
    const int value = name == kSubsteps ? r.substeps : r.sweeps;
    if (value >= 0) return std::to_string(value);
  }
  const auto at = r.params.find(name);
  if (at == r.params.end()) return {};
  return at->second;
}

/// The default in canonical form; "" for a solver or a parameter that this program lacks.
std::string default_of(const std::string& solver, const std::string& name) {
  const SolverEntry* entry = find_entry(solver);
  if (!entry) return "";
  const Params defaults(entry->name, entry->params, "");
  return defaults.has(name) ? std::string(defaults.value(name)) : "";
}

std::vector<std::string> names_in_labels(const std::string& solver) {
  std::vector<std::string> all{kSubsteps, kSweeps};
  for (const std::string& name : labelled_parameters(solver)) push_unique(all, name);
  return all;
}

}  // namespace

std::string named_setting(const std::string& name, const std::string& value) {
  if (name == kSweeps) return value + " sweeps";
  if (name == kSubsteps) return value + " substeps";
  const bool word = value != "on" && value != "off" &&
                    value.find_first_not_of("0123456789.+-e/") != std::string::npos;
  return word ? value : name + "=" + value;
}

std::string Label::text() const { return join(*this, ", ", &LabelPart::text); }

std::vector<std::string> Label::terms() const {
  std::vector<std::string> all;
  for (const LabelPart& part : *this)
    if (!part.term.empty()) all.push_back(part.term);
  return all;
}

LabelPart label_part(const Work& work) {
  return {work.text(), work.substeps >= 0 && work.sweeps >= 0 ? kWorkTerm : ""};
}

SettingLabels::SettingLabels(const Records& all) {
  for (const Record* r : all)
    for (const std::string& name : names_in_labels(r->solver))
      if (const auto value = setting_of(*r, name)) seen_[{r->solver, name}].insert(*value);
}

std::string SettingLabels::of(const Record& record, const std::vector<std::string>& beside) const {
  return parts(record, beside).text();
}

Label SettingLabels::parts(const Record& record, const std::vector<std::string>& beside) const {
  Label all;
  bool any = false, work = false;
  for (const std::string& name : names_in_labels(record.solver)) {
    const auto value = setting_of(record, name);
    if (!value || std::ranges::count(beside, name) > 0) continue;
    const auto seen = seen_.find({record.solver, name});
    const bool varies = seen != seen_.end() && seen->second.size() > seen->second.count(*value);
    if (!varies) continue;
    any = true;
    if (name == kSubsteps || name == kSweeps)
      work = true;
    else if (*value != default_of(record.solver, name))
      all.push_back({named_setting(name, *value), parameter_term(record.solver, name)});
  }
  if (work || (any && all.empty())) all.insert(all.begin(), label_part(work_of(record)));
  return all;
}

}  // namespace taut::report
