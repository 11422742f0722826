#include "experiments/report/report.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <set>
#include <stdexcept>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/report/questions/costs.hpp"
#include "experiments/report/questions/links.hpp"
#include "experiments/report/questions/questions.hpp"
#include "experiments/report/questions/winners.hpp"
#include "experiments/study/main_job.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

namespace {

/// The bench of the main job as words of `taut bench`: "trade --preset quick".
std::string bench_of_main_job() {
  const MainJob job = main_job();
  return job.bench + " --preset " + job.preset;
}

Json json_of(const Colour& colour) { return {{"light", colour.light}, {"dark", colour.dark}}; }

/// Title of the report: the input's own, or made from all cases, such as "Jakobsen and Bullet" or
/// "8 cloth solvers on 20 scenes".
std::string report_title(const ReportInput& input) {
  if (!input.title.empty()) return input.title;
  constexpr std::size_t kMostNames = 3;
  std::vector<std::string> names, scenes;
  const auto count = [&](const Record& r) {
    push_unique(names, solver_title(r.solver));
    push_unique(scenes, r.scene);
  };
  for (const StudyResult& study : input.studies) std::ranges::for_each(study.records, count);
  if (input.bench)
    for (const SceneBench& scene : input.bench->scenes)
      for (const BenchedCase& c : scene.cases) count(c.record);
  if (names.size() > kMostNames)
    return std::to_string(names.size()) + " cloth solvers on " + std::to_string(scenes.size()) +
           (scenes.size() == 1 ? " scene" : " scenes");
  return joined(names);
}

/// Builds the model, part by part.
class Builder {
 public:
  explicit Builder(const ReportInput& input)
      : input_(input), compared_(compared_solvers_of(input)), refs_(input) {}

  Json build() {
    const Answer answer = answer_of(input_, compared_, refs_);
    Json winners = json_of_winners(input_, answer, refs_, tables_);
    std::vector<Chart> charts;
    for (const QuotedScene& quoted : compared_.scenes)
      std::ranges::move(scene_charts(input_, quoted.task.scene), std::back_inserter(charts));
    for (const Figure& figure : figures_of(charts)) add_figure(drawn_, "scenes", figure, refs_);
    Json scenes = Json::array();
    for (const QuotedScene& quoted : compared_.scenes) scenes.push_back(scene(quoted));
    for (const SceneMedia& media : input_.media)
      if (!compared_.quoted(media.scene)) scenes.push_back(filmed_scene(media));
    Json cost, differences;
    if (input_.bench) cost = json_of_cost(input_, refs_, drawn_, tables_);
    if (input_.differences) differences = json_of(*input_.differences, refs_, tables_);
    Json steps = json_of_steps(input_, refs_, drawn_, tables_);
    Json limits = json_of_limits(input_, refs_, tables_);
    Json history = json_of_history(input_, refs_);
    Json method = this->method();
    Json cases = this->cases();
    for (const char* name : {kSweeps, kSubsteps, "dt", "t", "projections"}) refs_.use(name);
    Json model{{"schema", "taut-report/8"}, {"meta", meta(cases.size())}, {"solvers", solvers()},
               {"statuses", statuses()},    {"shades", shades()},         {"metrics", metrics()}};
    add_if(model, "winners", std::move(winners));
    model["answer"] = parse_json(to_json(answer));
    for (const auto& [term, meaning] : terms_of(quoted_and_timed(), input_.vectors))
      model["terms"].push_back({{"term", term}, {"meaning", meaning}});
    add_if(model, "scenes", std::move(scenes));
    add_if(model, "charts", std::move(drawn_.charts));
    add_if(model, "figures", std::move(drawn_.figures));
    add_if(model, "maps", std::move(maps_));
    add_if(model, "films", std::move(films_));
    add_if(model, "steps", std::move(steps));
    add_if(model, "limits", std::move(limits));
    add_if(model, "tables", json_of_tables(tables_));
    add_if(model, "cost", std::move(cost));
    if (input_.truths) add_if(model, "truths", input_.truths->shown);
    add_if(model, "history", std::move(history));
    if (input_.regressions) add_if(model, "regressions", *input_.regressions);
    add_if(model, "differences", std::move(differences));
    model["method"] = std::move(method);
    add_if(model, "missing", missing());
    add_if(model, "left_out", left_out());
    add_if(model, "cases", std::move(cases));
    return model;
  }

 private:
  Json meta(std::size_t listed) const {
    Json one{{"title", report_title(input_)}};
    add_if(one, "question", input_.question);
    one["build"] = Json::object();
    for (const auto& [what, value] : input_.provenance)
      if (what == "program" || what == "toolchain")
        one["build"][what] = value;
      else
        one[what] = value;
    if (input_.bench) one["machine"] = input_.bench->machine;
    add_if(one, "command", input_.command);
    std::size_t planned = 0;
    for (const StudyResult& study : input_.studies)
      planned += std::max(study.planned, study.records.size()) - study.records.size();
    one["cases"] = refs_.cases().size();
    one["planned"] = refs_.cases().size() + planned;
    if (listed < refs_.cases().size()) one["listed"] = listed;
    return one;
  }

  /// The cases whose settings the first screen shows.
  std::vector<const Record*> quoted_and_timed() const {
    std::vector<const Record*> all;
    for (const QuotedScene& scene : compared_.scenes)
      for (const Record* r : scene.cases)
        if (r) all.push_back(r);
    if (input_.bench)
      for (const SceneBench& scene : input_.bench->scenes)
        for (const BenchedCase& c : scene.cases) all.push_back(&c.record);
    return all;
  }

  /// All cases named by parts above, each with its cost and film.
  Json cases() {
    Json all;
    std::map<std::string, const BenchedCase*> timed;
    if (input_.bench)
      for (const SceneBench& scene : input_.bench->scenes)
        for (const BenchedCase& c : scene.cases) timed[c.record.key] = &c;
    for (const Record* r : refs_.listed()) {
      const auto its = timed.find(r->key);
      Json one = json_of_case(*r, its == timed.end() ? nullptr : its->second, refs_);
      if (const auto film = film_of_.find(refs_.key(*r)); film != film_of_.end())
        one["film"] = film->second;
      all.push_back(std::move(one));
    }
    return all;
  }

  Json left_out() const {
    Json all;
    if (maps_left_out_ > 0)
      all.push_back(
          {{"file", "maps"},
           {"why", std::to_string(maps_left_out_) + " stability maps; a page has at most " +
                       std::to_string(kMostCells) + " cells of maps: taut plot STUDY"}});
    for (const auto& [file, why] : input_.left_out) all.push_back({{"file", file}, {"why", why}});
    return all;
  }

  Json solvers() const {
    Json all;
    std::vector<std::string> names;
    for (const ComparedSolver& solver : compared_.all) push_unique(names, solver.name);
    for (const Record* r : refs_.cases()) push_unique(names, r->solver);
    for (const SceneMedia& media : input_.media)
      for (const auto& [solver, why] : media.refused) push_unique(names, solver);
    for (const std::string& solver : names) {
      const SolverStyle style = solver_style(solver);
      Json one{{"id", solver},
               {"title", solver_title(solver)},
               {"colour", json_of(style.colour)},
               {"marker", style.shape},
               {"dash", style.dash}};
      for (const SolverInfo& info : input_.solvers) {
        if (info.name != solver) continue;
        one["summary"] = info.summary;
        one["source"] = info.source;
        for (const auto& [reason, scenes] : info.unsupported)
          one["unsupported"].push_back({{"reason", reason}, {"scenes", scenes}});
      }
      std::string settings;
      for (const ComparedSolver& compared : compared_.all)
        if (compared.name == solver)
          for (const auto& [key, value] : other_settings(*compared.cases.front()))
            settings += (settings.empty() ? "" : ", ") + key + "=" + retyped(value);
      one["settings"] = settings;
      const Arithmetics own = arithmetics_of(solver);
      add_if(one, "arithmetic", own.text());
      add_if(one, "terms", own.terms());
      all.push_back(std::move(one));
    }
    return all;
  }

  /// Arithmetics of a solver's compared cases, and of its timed ones.
  struct Arithmetics {
    std::vector<std::string> compared, timed;

    /// "double; timed: float"; the timed ones only if they differ.
    std::string text() const {
      const std::string one = join(compared, " or "), other = join(timed, " or ");
      return one == other || other.empty() ? one : one.empty() ? other : one + "; timed: " + other;
    }
    std::vector<std::string> terms() const {
      std::vector<std::string> all = compared;
      for (const std::string& one : timed) push_unique(all, one);
      return all;
    }
  };
  Arithmetics arithmetics_of(const std::string& solver) const {
    Arithmetics all;
    for (const ComparedSolver& one : compared_.all)
      if (one.name == solver)
        for (const Record* r : one.cases)
          push_unique(all.compared, arithmetic_of(*r, input_.vectors).brief());
    if (input_.bench)
      for (const SceneBench& scene : input_.bench->scenes)
        for (const BenchedCase& c : scene.cases)
          if (c.record.solver == solver)
            push_unique(all.timed, arithmetic_of(c.record, input_.vectors).brief());
    return all;
  }
  /// A number of a setting as people type it: "1e9" for "1e+09".
  static std::string retyped(const std::string& value) {
    double number = 0;
    const char* const end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, number);
    return error == std::errc() && stop == end && value.find('e') != std::string::npos
               ? as_typed(number)
               : value;
  }

  Json statuses() const {
    std::set<Status::Kind> kinds{Status::Kind::ok};
    for (const Record* r : refs_.cases()) kinds.insert(r->status.kind);
    Json all;
    for (const Status::Kind kind : kinds) {
      const StatusStyle style = status_style(kind);
      const std::string_view name = to_string(kind);
      all.push_back({{"id", name},
                     {"title", name},
                     {"glyph", style.glyph},
                     {"help", style.help},
                     {"failed", taut::failed({.kind = kind})},
                     {"colour", json_of(style.colour)},
                     {"ink", json_of(style.ink)}});
    }
    return all;
  }

  Json shades() const {
    Json all;
    for (const StretchShade& shade : stretch_shades())
      all.push_back(
          {{"end", json_number(shade.end)}, {"share", shade.share}, {"text", shade.text}});
    return all;
  }

  Json metrics() const {
    Json all = Json::object();
    for (const auto& [name, q] : refs_.quantities())
      all[name] = {{"title", q.title},
                   {"help", q.help},
                   {"unit", q.unit.shown},
                   {"scale", q.unit.scale},
                   {"axis", q.unit.logarithmic ? "log" : "linear"},
                   {"window", to_string(q.window)}};
    for (const ValueSpec* value : values_with_role())
      if (const auto at = all.find(value->name); at != all.end()) (*at)["role"] = true;
    return all;
  }

  Json scene(const QuotedScene& quoted) {
    const std::string& name = quoted.task.scene;
    Json one{{"id", name}, {"title", solver_title(name)}, {"summary", ""}, {"studied", true}};
    for (const SceneInfo& info : input_.scenes)
      if (info.name == name) one["summary"] = info.summary;
    for (const SceneMedia& media : input_.media)
      if (media.scene == name) add_media(one, media);
    for (const Json& chart : drawn_.charts)
      if (chart["scene"] == name) one["charts"].push_back(chart["id"]);
    if (!one.contains("film")) add_series(one, name);
    std::map<std::string, int> names;
    for (const StatusMap& map : scene_maps(input_, name)) {
      if (map.cells.size() > cells_) {
        ++maps_left_out_;
        continue;
      }
      cells_ -= map.cells.size();
      std::string id = name + "-" + map.study + "-" + map.solver;
      if (const int n = names[id]++; n > 0) id += "-" + std::to_string(n + 1);
      add_by_id(one, "maps", json_of(map, id, refs_), maps_);
    }
    std::set<std::pair<std::string, std::string>> refusals;
    for (const Record* r : refs_.cases()) {
      if (r->scene != name) continue;
      Json& count = one["statuses"][r->solver][std::string(to_string(r->status.kind))];
      count = count.is_null() ? 1 : count.get<int>() + 1;
      if (r->status.kind == Status::Kind::unsupported)
        refusals.insert({r->solver, r->status.reason.text()});
    }
    one["facts"] = facts_of(refs_, name);
    for (const auto& [solver, reason] : refusals)
      one["refusals"].push_back({{"solver", solver}, {"reason", reason}});
    add_table(one, resolved_settings_table(quoted, compared_, refs_), tables_);
    return one;
  }

  Json filmed_scene(const SceneMedia& media) {
    Json one{{"id", media.scene},
             {"title", solver_title(media.scene)},
             {"summary", media.summary},
             {"studied", false}};
    add_media(one, media);
    for (const auto& [solver, reason] : media.refused)
      one["refusals"].push_back({{"solver", solver}, {"reason", reason}});
    return one;
  }

  void add_media(Json& scene, const SceneMedia& media) {
    if (media.footage.bytes.empty()) return;
    Json film = json_of(media, input_, refs_, budget_);
    scene["film"] = film["id"];
    for (const Json& panel : film["panels"])
      if (const std::string key = panel.value("case", ""); !key.empty())
        film_of_.emplace(key, film["id"].get<std::string>());
    films_.push_back(std::move(film));
  }

  /// Adds charts of values over time to a scene without a film, which would otherwise show them.
  void add_series(Json& scene, const std::string& name) {
    std::map<std::string, Chart> charts;
    for (const TimeSeries& series : input_.series) {
      if (series.scene != name) continue;
      Chart chart{.id = name + "-over-time-" + slug(series.value),
                  .scene = name,
                  .kind = "series",
                  .title = capitalised(quantity(series.value).title) + " over time",
                  .x = quantity("t"),
                  .y = quantity(series.value),
                  .cost = {}};
      chart.y.unit.logarithmic = false;
      charts.try_emplace(series.value, std::move(chart)).first->second.series.push_back(series);
    }
    for (auto& [value, chart] : charts) {
      add_floor(chart);
      add_by_id(scene, "charts", json_of(chart, refs_), drawn_.charts);
    }
  }

  Json method() {
    Json one{{"studies", Json::array()}};
    for (const StudyResult& study : input_.studies) {
      Json at{{"name", study.name},
              {"question", study.question},
              {"cases", study.records.size()},
              {"planned", std::max(study.planned, study.records.size())}};
      if (const std::string unequal = unequal_work(study.records); !unequal.empty())
        at["unequal"] = "Unequal work: " + unequal + ".";
      one["studies"].push_back(std::move(at));
    }
    add_table(one, assertions_table(input_.truths), tables_);
    add_table(one, spent_table(refs_.cases(), input_.spent), tables_);
    for (const auto& [what, value] : input_.provenance)
      one["facts"].push_back({{"name", what}, {"value", value}});
    for (const std::string& host : input_.cost_hosts)
      one["facts"].push_back({{"name", "cost measured on"}, {"value", host}});
    one["limits"] = limits_of(input_, refs_);
    return one;
  }

  Json missing() const {
    Json all;
    // No single build could make what is missing of two folders.
    if (input_.differences) return all;
    const auto add = [&](const char* section, const char* text, const std::string& command) {
      all.push_back({{"section", section}, {"text", text}, {"command", command}});
    };
    if (!input_.bench)
      add("cost", "No cost was measured.",
          "taut bench " +
              (input_.studies.size() == 1 ? input_.studies.front().name : bench_of_main_job()));
    if (input_.media.empty())
      add("films", "No pictures were rendered.",
          "taut render " + compared_.scenes.front().task.scene + " --video");
    if (!input_.truths)
      add("truths", "Closed forms and published numbers were not evaluated by this build.",
          "taut verify --record");
    if (!input_.regressions)
      add("regressions", "Not compared with the committed baselines by this build.",
          "taut check --record");
    return all;
  }

  const ReportInput& input_;
  ComparedSolvers compared_;
  CaseList refs_;
  DrawnCharts drawn_;
  Json maps_, films_;
  Answer tables_{"report", ""};
  std::map<std::string, std::string> film_of_;  ///< by short key of the case
  std::size_t budget_ = 6'000'000;              ///< bytes that pictures may take in a page
  std::size_t cells_ = kMostCells, maps_left_out_ = 0;
};

/// JSON for a script element, in which no text can close the element or open a comment.
std::string for_script(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

std::string_view page_file(std::string_view name) {
  const auto at = std::ranges::find(page_files(), name, &PageFile::name);
  if (at == page_files().end()) throw std::logic_error("no page file " + std::string(name));
  return at->text;
}

}  // namespace

std::string make_model(const ReportInput& input, int indent) {
  if (std::ranges::all_of(input.studies, [](const auto& s) { return s.records.empty(); }))
    throw InputError("there is no result of this build to report; `taut run` makes some");
  return to_text(Builder(input).build(), indent);
}

std::string make_report(const ReportInput& input) {
  const std::string model = for_script(make_model(input));
  CaseList list(input);
  const ComparedSolvers compared = compared_solvers_of(input);
  const std::string answer = escape_html(join(in_few_lines(input), "\n") + "\n\n" +
                                         to_text(answer_of(input, compared, list)));
  const std::string title = escape_html(report_title(input));
  const std::string_view page = page_file("index.html");
  std::string html;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t open = page.find("{{", at), close = page.find("}}", open);
    html += page.substr(at, open - at);
    if (open == std::string_view::npos) break;
    const std::string_view name = page.substr(open + 2, close - open - 2);
    html += name == "model"    ? model
            : name == "title"  ? title
            : name == "answer" ? answer
                               : page_file(name);
    at = close + 2;
  }
  return html;
}

std::vector<std::string> in_few_lines(const ReportInput& input) {
  constexpr std::size_t kMostScenes = 6;
  CaseList list(input);
  const WinnerMap map = winners_of(input, list);
  std::vector<std::string> lines;
  for (const std::vector<Said>& sentence : sentences_of(map)) lines.push_back(text_of(sentence));
  const auto level = static_cast<std::size_t>(std::ranges::find(kErrorLevels, kPricedError) -
                                              std::begin(kErrorLevels));
  for (const WinnerRow& row : map.rows)
    if (lines.size() < kMostScenes + 2) lines.push_back(line_of(row, level));
  return lines;
}

}  // namespace taut::report
