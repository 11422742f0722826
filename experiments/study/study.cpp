#include "experiments/study/study.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/io/document.hpp"
#include "core/model/text.hpp"
#include "experiments/results/builds.hpp"
#include "experiments/study/study_reading.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

constexpr const char* kAll = "all";  ///< stands for all shipped scenes

/// Whether any of the solvers has the parameter; if `whole`, as an integer.
bool has_param(const std::vector<SolverChoice>& solvers, const StudyAxis& axis, bool whole) {
  for (const SolverChoice& choice : solvers)
    for (const ParamSpec& spec : choice.entry->params)
      if (axis.is_of(choice.entry->name) && spec.name == axis.parameter() &&
          (!whole || spec.kind == ParamSpec::Kind::integer))
        return true;
  return false;
}

/// Reports control characters. Texts of a study become parts of commands, scripts and file names.
void refuse_control_characters(Diagnostics& diagnostics, const Value& value) {
  const auto check = [&](const SourceLocation& place, const std::string& text) {
    if (std::ranges::any_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
      diagnostics.report(place,
                         "a text of a study holds no line breaks, tabs or other control "
                         "characters");
  };
  check(value.place, value.string);
  for (const Key& key : value.keys) check(key.place, key.text);
  for (const Value& item : value.items) refuse_control_characters(diagnostics, item);
}

/// Reads a document into a Study and reports errors to the diagnostics.
class StudyReader {
 public:
  StudyReader(Diagnostics& diagnostics, Study& study, std::string preset,
              std::vector<std::string> instead)
      : diagnostics_(diagnostics),
        study_(study),
        wanted_(std::move(preset)),
        instead_(std::move(instead)) {}

  void read(const Value& root) {
    Section section(diagnostics_, root, "the study");
    section.need({"question", "scenes", "solvers"});
    read_keys(section, false);
    refuse_clashes();
    section.finish();
  }

  void read_question(Section& section) {
    study_.question = section.string("question").value_or("");
    if (study_.question.empty()) section.missing("question");
  }
  void read_scenes(Section& section) {
    strings(section, "scenes", study_.scenes, [this](const std::string& text) {
      const StudyScene scene = parse_study_scene(text);
      if (scene.name != kAll)
        find_scene(scene_seen_from(study_.file, scene.name));
      else if (!scene.settings.empty())
        throw InputError("'all' has no settings of its own: `set` holds for every scene");
    });
    for (std::string& scene : study_.scenes) scene = seen_from_here(scene);
    for (const Value& item : section.find("scenes")->items)
      study_.scene_places[seen_from_here(item.string)] = item.place;
    if (std::erase(study_.scenes, kAll) > 0)
      for (const std::string& name : shipped("scenes"))
        if (std::ranges::count(study_.scenes, name) == 0) study_.scenes.push_back(name);
  }
  void read_solvers(Section& section) {
    const auto read = [](const std::string& text) {
      admit_solver(text);
      parse_solver(text);
    };
    if (!instead_.empty()) {
      section.find("solvers");
      std::ranges::for_each(study_.solvers = instead_, read);
      remember_solvers();
    } else if (strings(section, "solvers", study_.solvers, read)) {
      remember_solvers();
    }
  }
  void read_searched(Section& section) {
    const std::optional<std::string> file = section.string("searched");
    if (!file) return;
    study_.searched = study_.file.parent_path() / *file;
    study_.chosen.clear();
    std::error_code none;
    if (!std::filesystem::exists(study_.searched, none)) return;  // the search has not run yet
    for (const SearchedSetting& row : taut::read_searched(study_.searched))
      if (row.chosen()) study_.chosen[row.scene].push_back(row.solver);
    for (auto& [scene, solvers] : study_.chosen) {
      std::set<std::string> canonical;
      for (const std::string& text : solvers) canonical.insert(parse_solver(text).canonical());
      for (const std::string& text : study_.solvers)  // as it is, beside its best
        if (canonical.insert(parse_solver(text).canonical()).second) solvers.push_back(text);
    }
  }
  void read_set(Section& section) {
    std::vector<std::string> texts;
    if (!strings(section, "set", texts, [](const std::string&) {})) return;
    study_.settings = scene_settings(texts);
    for (const Value& item : section.find("set")->items) study_.places[item.string] = item.place;
  }
  void read_axes(Section& section) {
    if (const Value* axes = section.table("axes")) read_axes(*axes);
  }
  void read_exclude(Section& section) { read_exclusions(section, *section.find("exclude")); }
  void read_plots(Section& section) {
    for (const Value* plot : section.tables("plot")) read_plot(*plot);
  }
  void read_presets(Section&);

 private:
  /// Reads the keys. A list in a preset replaces the one before.
  void read_keys(Section&, bool of_preset);

  /// A scene as the study writes it, "scene.toml:links.shear=false", seen from the current folder.
  std::string seen_from_here(const std::string& text) const {
    const std::string name = text.substr(0, text.find(':'));
    return scene_seen_from(study_.file, name) + text.substr(name.size());
  }

  /// Reports a scene that is listed twice with settings, and an axis that varies a setting of a
  /// scene: tables and curves distinguish the cases of a scene only by solver and axes.
  void refuse_clashes() {
    std::map<std::string, std::string> text_of;
    for (const std::string& text : study_.scenes) try {
        const StudyScene scene = parse_study_scene(text);
        const auto report = [&](const std::string& what) {
          diagnostics_.report(study_.scene_places.at(text), what);
        };
        if (const auto [at, fresh] = text_of.try_emplace(scene.name, text);
            !fresh && at->second != text)
          report("scene '" + scene.name + "' is listed twice: vary a setting by an axis");
        for (const StudyAxis& axis : study_.axes)
          if (find_setting(scene.settings, axis.name))
            report("'" + axis.name + "' of scene '" + scene.name + "' is an axis of the study");
      } catch (const InputError&) {  // already reported where it was read
      }
  }

  bool strings(Section& section, const std::string& key, std::vector<std::string>& into,
               const std::function<void(const std::string&)>& check) {
    const Value* list = section.find(key);
    if (!list) return false;
    if (!list->is_array() || list->items.empty()) {
      section.report(key, "must be a list of texts, not " + describe(*list));
      return false;
    }
    into.clear();
    for (const Value& item : list->items) {
      if (!item.is_string()) {
        diagnostics_.report(item.place, "'" + key + "' holds texts, not " + describe(item));
        continue;
      }
      guarded(item, [&] { check(item.string); });
      into.push_back(item.string);
    }
    return true;
  }

  /// Runs `action` and reports its InputErrors at the value. A column within a text counts from its
  /// quote.
  bool guarded(const Value& value, const std::function<void()>& action) try {
    action();
    return true;
  } catch (const InputError& error) {
    for (const Diagnostic& d : error.diagnostics()) {
      const bool of_argument = d.line == 0 && d.column > 0;
      SourceLocation place = value.place;
      if (of_argument && value.is_string()) place.column += d.column;
      diagnostics_.report(place, of_argument ? d.message : d.text());
    }
    return false;
  }

  /// Text of a value. Reports a value that the key may not have and returns "".
  std::string text(const Value& value, const std::string& key, bool toml) {
    if (has_text(value, toml)) return text_of(value, toml);
    diagnostics_.report(
        value.place,
        "'" + key + "' holds " + (toml ? "no dates" : "texts and numbers, no tables or dates"));
    return {};
  }

  void remember_solvers() {
    choices_.clear();
    for (const std::string& text : study_.solvers) try {
        choices_.push_back(parse_solver(text));
      } catch (const InputError&) {  // already reported where it was read
      }
  }

  void read_axes(const Value& table) {
    for (std::size_t i = 0; i < table.items.size(); ++i) {
      StudyAxis axis{table.keys[i].text, {}};
      const Value& value = table.items[i];
      if (!axis.of_scene() && value.is_table() && !value.find("from")) {
        for (std::size_t k = 0; k < value.items.size(); ++k)  // time.dt without quotes is a table
          read_axis({axis.name + "." + value.keys[k].text, {}}, value.keys[k], value.items[k]);
        continue;
      }
      read_axis(std::move(axis), table.keys[i], value);
    }
  }

  /// Units of the parameter if solvers that have it under the same name measure it differently:
  /// "N/m in bullet-deformable, 1 in bullet"; "" if all units agree.
  std::string mixed_units(const StudyAxis& axis) const {
    std::map<std::string, std::string> solver_of;
    for (const SolverChoice& choice : choices_)
      for (const ParamSpec& spec : choice.entry->params)
        if (axis.is_of(choice.entry->name) && spec.name == axis.parameter())
          solver_of.emplace(spec.unit.empty() ? "1" : spec.unit, choice.entry->name);
    return solver_of.size() < 2 ? "" : join(solver_of, " and ", [](const auto& one) {
      return one.first + " in " + one.second;
    });
  }

  void read_axis(StudyAxis axis, const Key& key, const Value& value) {
    if (const std::string mixed = mixed_units(axis); !mixed.empty()) {
      diagnostics_.report(key.place, "'" + axis.name + "' is " + mixed +
                                         ": an axis for each, as \"" + axis_of_first(axis) + "\"");
      return;
    }
    if (!axis.of_scene() && !choices_.empty() && !has_param(choices_, axis, false)) {
      diagnostics_.report(key.place, "no solver of this study has a parameter '" + axis.name + "'" +
                                         suggestion(axis.parameter(), param_names()) +
                                         " (a scene key has a dot, as \"time.dt\"; a parameter of "
                                         "one solver a colon, as \"xpbd:substeps\")");
      return;
    }
    if (value.is_table())
      axis.values = range(value, has_param(choices_, axis, true));
    else if (value.is_array())
      for (const Value& item : value.items) {
        axis.values.push_back(text(item, axis.name, axis.of_scene()));
        if (axis.values.back().empty() && !item.is_string()) return;  // already reported
      }
    if (axis.values.empty()) {
      if (!value.is_table())
        diagnostics_.report(value.place, "'" + axis.name +
                                             "' must be a list of values or a range " +
                                             "{ from, to, steps, scale }");
      return;
    }
    if (!axis.of_scene())
      check_values(axis, value);
    else
      for (std::size_t i = 0; i < axis.values.size(); ++i)
        study_.places[SceneSetting(axis.name, axis.values[i]).text()] =
            value.is_array() ? value.items[i].place : value.place;
    const auto same = [&](const StudyAxis& s) { return s.name == axis.name; };
    std::erase_if(study_.axes, same);
    study_.axes.push_back(std::move(axis));
  }

  std::vector<std::string> range(const Value& table, bool whole) {
    Section section(diagnostics_, table, "the range");
    const std::optional<double> from = section.number("from", {}), to = section.number("to", {});
    const std::optional<double> steps = section.number("steps", {2, 1000});
    const bool log = section.choice("scale", {"linear", "log"}, "linear") == "log";
    section.need({"from", "to", "steps"});
    section.finish();
    if (!from || !to || !steps) return {};
    if (log && !(*from > 0 && *to > 0)) {
      diagnostics_.report(table.place, "a logarithmic range needs ends greater than 0");
      return {};
    }
    std::vector<std::string> values;
    const int count = static_cast<int>(*steps);
    for (int i = 0; i < count; ++i) {
      const double s = static_cast<double>(i) / (count - 1);
      double value = log ? *from * std::pow(*to / *from, s) : *from + s * (*to - *from);
      if (i == count - 1) value = *to;
      std::string text = whole ? std::to_string(std::lround(value)) : shortest(value);
      if (values.empty() || values.back() != text) values.push_back(std::move(text));
    }
    return values;
  }

  void check_values(const StudyAxis& axis, const Value& value) {
    for (const SolverChoice& choice : choices_)
      if (has_param({choice}, axis, false))
        for (std::size_t i = 0; i < axis.values.size(); ++i)
          if (!guarded(value.is_array() ? value.items[i] : value, [&] {
                Params(choice.entry->name, choice.entry->params,
                       axis.parameter() + "=" + axis.values[i]);
              }))
            return;
  }

  /// The axis restricted to the first solver that has it: "bullet:stiffness" for stiffness.
  std::string axis_of_first(const StudyAxis& axis) const {
    for (const SolverChoice& choice : choices_)
      if (has_param({choice}, axis, false))
        return std::string(choice.entry->name) + ":" + axis.name;
    return axis.name;
  }

  std::vector<std::string> param_names() const {
    std::vector<std::string> names;
    for (const SolverChoice& choice : choices_)
      for (const ParamSpec& spec : choice.entry->params) names.emplace_back(spec.name);
    return names;
  }

  void read_exclusions(Section& section, const Value& list) {
    study_.exclusions.clear();
    if (!list.is_array()) section.report("exclude", "must be a list of tables");
    for (const Value& item : list.items) {
      Exclusion exclusion;
      for (std::size_t i = 0; i < item.items.size() && item.is_table(); ++i) {
        const std::string& key = item.keys[i].text;
        const bool toml = StudyAxis{key, {}}.of_scene();
        if (std::ranges::count(settings(), key) == 0)
          diagnostics_.report(item.keys[i].place, "nothing that this study varies is called '" +
                                                      key + "'" + suggestion(key, settings()) +
                                                      " (scene, solver, or an axis's name)");
        std::vector<std::string>& values = exclusion.when[key];
        const auto add = [&](const Value& value) {
          values.push_back(text(value, key, toml));
          guarded(value, [&] {  // also for scenes and solvers of a preset
            if (key == "scene")
              find_scene(parse_study_scene(values.back() = seen_from_here(values.back())).name);
            if (key == "solver") find_solver(values.back());
          });
        };
        if (item.items[i].is_array() && !toml)
          for (const Value& v : item.items[i].items) add(v);
        else
          add(item.items[i]);
      }
      if (exclusion.when.empty())
        diagnostics_.report(item.place, "an exclusion is a table such as { scene = \"ball\" }");
      else
        study_.exclusions.push_back(std::move(exclusion));
    }
  }

  /// Names that an exclusion may use.
  std::vector<std::string> settings() const {
    std::vector<std::string> names{"scene", "solver"};
    for (const StudyAxis& axis : study_.axes) names.push_back(axis.name);
    return names;
  }

  void read_plot(const Value& table) {
    Plot plot;
    std::vector<std::string> known;
    for (const StudyKey& key : study_keys())
      if (key.name.starts_with("plot.")) known.emplace_back(key.name.substr(5));
    for (std::size_t i = 0; i < table.items.size(); ++i)
      if (std::ranges::count(known, table.keys[i].text) == 0)
        diagnostics_.report(table.keys[i].place, "unknown key '" + table.keys[i].text +
                                                     "' in [[plot]]" +
                                                     suggestion(table.keys[i].text, known));
    for (std::size_t i = 0; i < table.items.size(); ++i) {
      const std::string& key = table.keys[i].text;
      (key == "kind" ? plot.kind : plot.options[key]) = text(table.items[i], key, false);
      plot.places[key] = table.items[i].place;
    }
    if (plot.kind.empty())
      diagnostics_.report(table.place, "missing key 'kind' in [[plot]]");
    else
      study_.plots.push_back(std::move(plot));
  }

  Diagnostics& diagnostics_;
  Study& study_;
  std::string wanted_;                ///< preset to apply
  std::vector<std::string> instead_;  ///< solvers that replace the study's own
  std::vector<SolverChoice> choices_;
};

/// A key and the function that reads it. The keys of a figure are read together.
struct StudyRow {
  StudyKey key;
  void (StudyReader::*read)(Section&) = nullptr;
};

constexpr StudyRow kKeys[] = {
    {{"question", false, "one sentence; it heads the report"}, &StudyReader::read_question},
    {{"scenes", true,
      "names of shipped scenes, or paths (with a `/`, or ending in `.toml`); `\"all\"`: every "
      "shipped scene. Scene keys of one scene alone follow its name: "
      "`\"drape:cloth.span=0.7,time.duration=4\"`, a value with commas in quotes, as parameters of "
      "a solver"},
     &StudyReader::read_scenes},
    {{"solvers", true,
      "`\"name\"` or `\"name:key=value,...\"` (`taut list solvers`). Defaults differ: where sweeps "
      "are to be equal work, name the substeps too (`jakobsen:substeps=1,order=mesh` beside "
      "`bullet`)"},
     &StudyReader::read_solvers},
    {{"searched", true,
      "a file beside the study: settings of the solvers, chosen scene by scene, that stand in "
      "their "
      "place; `taut advise --study` searches them and writes it"},
     &StudyReader::read_searched},
    {{"set", true,
      "scene keys for every case, as on the command line: `[\"cloth.grid=[16, 16]\", "
      "\"time.duration=4\"]`"},
     &StudyReader::read_set},
    {{"axes", true, "`[axes]`: what varies; every combination is a case"}, &StudyReader::read_axes},
    {{"exclude", true,
      "cases to leave out: `[{ scene = \"fall\", iterations = [64, 128] }]` leaves out those that "
      "match all of the named settings. `scene` is written as in `scenes`, `solver` is a plain "
      "name"},
     &StudyReader::read_exclude},
    {{"preset", false,
      "`[preset.NAME]`: a smaller or larger version, chosen with `--preset NAME`; each of "
      "`scenes`, `solvers`, `set`, `axes`, `exclude` replaces what it names (axes one by one)"},
     &StudyReader::read_presets},
    {{"plot", false, "`[[plot]]`: a figure"}, &StudyReader::read_plots},
    {{"plot.kind", false, "what it shows (below)"}},
    {{"plot.x", false, "a value or an axis, horizontally"}},
    {{"plot.y", false, "a value, vertically"}},
    {{"plot.along", false, "an axis whose values are joined to curves"}},
    {{"plot.title", false, "above the figure"}},
    {{"plot.file", false, "its name"}},
    {{"plot.slope", false, "the exponent of a theory, drawn as a line"}}};

void StudyReader::read_keys(Section& section, bool of_preset) {
  for (const auto& [key, read] : kKeys)
    if (read && (key.in_preset || !of_preset) && section.find(std::string(key.name)))
      (this->*read)(section);
}

void StudyReader::read_presets(Section& section) {
  const Value* presets = section.table("preset");
  if (!presets) return;
  for (std::size_t i = 0; i < presets->items.size(); ++i) {
    const std::string& name = presets->keys[i].text;
    study_.presets.push_back(name);
    Study other = study_;  // presets that are not applied are checked as well
    StudyReader reader(diagnostics_, name == wanted_ ? study_ : other, "", instead_);
    reader.choices_ = choices_;
    Section preset(diagnostics_, presets->items[i], "[preset." + name + "]");
    reader.read_keys(preset, true);
    if (name != wanted_) reader.refuse_clashes();
    preset.finish();
    if (name == wanted_) study_.preset = name;
  }
}

}  // namespace

std::vector<StudyKey> study_keys() {
  std::vector<StudyKey> keys;
  for (const StudyRow& row : kKeys) keys.push_back(row.key);
  return keys;
}

std::string study_name(const std::string& name_or_path) {
  return printable(find_study(name_or_path).stem().string());
}

Study load_study(const std::string& name_or_path, const std::string& preset,
                 const std::vector<std::string>& solvers) {
  Study study;
  study.file = find_study(name_or_path);
  study.name = study_name(name_or_path);
  const Document document = read_document(study.file, {});
  Diagnostics diagnostics(document);
  refuse_control_characters(diagnostics, document.root);
  diagnostics.throw_if_any();
  StudyReader(diagnostics, study, preset, solvers).read(document.root);
  if (!diagnostics.clean()) judge_scenes(study, diagnostics);
  diagnostics.throw_if_any();
  if (!preset.empty() && study.preset.empty())
    throw InputError({{study.file, 0, 0,
                       "study '" + study.name + "' has no preset '" + preset + "'" +
                           suggestion(preset, study.presets)}});
  return of_build(std::move(study), given_build().id);
}

}  // namespace taut
