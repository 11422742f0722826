#include "experiments/require/require.hpp"

#include <chrono>
#include <cmath>

#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::verb::requiring {

namespace {

namespace fs = std::filesystem;

constexpr double kPictureSeconds = 8;  ///< for which there has to be time

struct Options {
  std::string scene, solver = "jakobsen", output, out;
  std::vector<std::string> keep, settings;
  double patience = 120;
  int jobs = 1;
  Format format;
};

/// The part of the full model's time that an effect costs; nothing: not timed.
Cell time_of(const Requirement& found, const std::optional<Interval>& ratio) {
  if (!ratio) return {};
  const bool none = ratio->contains(1) || std::abs(1 - ratio->mid) <= spread(found.control);
  return none ? Cell("none seen") : Cell(1 - ratio->mid);
}

std::size_t full_bytes(const Requirement& found, const Store& store) {
  const auto record = store.find(found.full);
  return record ? bytes_of(record->step_cost) : 0;
}

std::string verdict(const EffectTrial& effect) {
  if (!effect.done()) return "not done";
  if (effect.chosen) return "drop";
  if (effect.may_go()) return "keep: may go, but not with the others";
  return effect.representative().why.empty() ? "keep" : "keep: " + effect.representative().why;
}

Column column_of(const KeptAnswer& answer) { return {answer.name, "", unit_of(answer)}; }

/// The answers that are kept: what they are, and by how much they may move.
Table answers_of(const Requirement& found) {
  Table table{"answers",
              "answers that are kept",
              {{"name", "answer"},
               {"shown", "shown in"},
               {"value", "full model"},
               {"tolerance", "may move by"},
               {"noise", "moves by rounding"},
               {"order", "by order of links"},
               Column("unit").in_detail()}};
  for (std::size_t i = 0; i < found.answers.size(); ++i) {
    const KeptAnswer& answer = found.answers[i];
    const Unit unit = unit_of(answer);
    const auto said = [&](double value, const std::string& remark = "") {
      std::string note = unit.shown.empty() ? "" : text(answer, value);
      if (!note.empty() && !remark.empty()) note += ", ";
      return Cell(value).with(note + remark);
    };
    const bool vacuous = !answer.is_shape() && answer.tolerance > std::abs(found.values[i]);
    const bool noisy = i < found.noise.size() && found.noise[i] > answer.tolerance;
    table.rows.push_back(
        {answer.name, unit.shown.empty() ? "1" : unit.shown,
         answer.is_shape() ? Cell() : said(found.values[i]),
         said(answer.tolerance, vacuous ? "LARGER THAN THE VALUE: SAYS NOTHING" : ""),
         i < found.noise.size() ? said(found.noise[i], noisy ? "MORE THAN THE TOLERANCE" : "")
                                : Cell(),
         i < found.by_order.size() ? said(found.by_order[i]) : Cell(), unit.si});
  }
  return table;
}

/// What every effect does to the answers, and what it costs.
Table effects_of(const Requirement& found, std::size_t bytes) {
  Table table{"effects", "by how much the answers move without", {{"name", "effect"}, {"change"}}};
  for (const KeptAnswer& answer : found.answers) table.columns.push_back(column_of(answer));
  table.columns.insert(table.columns.end(), {{"time", "its time", kShare, 2},
                                             {"bytes", "its memory", kKilobytes},
                                             {"verdict"},
                                             Column("may_go").in_detail()});
  const auto add = [&](const std::string& name, const ModelTrial& trial,
                       const std::optional<Interval>& time, const std::string& verdict,
                       bool may_go) {
    auto& row = table.rows.emplace_back();
    row = {name, trial.change};
    for (std::size_t i = 0; i < found.answers.size(); ++i)
      row.push_back(i < trial.moved.size() ? Cell(trial.moved[i]) : Cell());
    const double less = static_cast<double>(bytes) - static_cast<double>(bytes_of(trial.cost));
    row.insert(row.end(),
               {time_of(found, time), trial.cost.empty() ? Cell() : Cell(less), verdict, may_go});
  };
  for (const EffectTrial& effect : found.effects)
    add(effect.name, effect.representative(), effect.time, verdict(effect), effect.may_go());
  if (found.smallest)
    add("(smallest model)", *found.smallest, found.time_ratio,
        found.verified ? "verified: the same bits from its file" : "NOT VERIFIED", true);
  return table;
}

/// All that was tried.
Table trials_of(const Requirement& found) {
  Table table{"trials",
              "all that was tried",
              {{"effect"},
               {"change"},
               {"done"},
               {"within"},
               {"why"},
               {"bytes", "bytes of a step", kBytes},
               {"work_per_step"},
               {"steps"},
               {"scene"},
               {"solver"}}};
  for (const KeptAnswer& answer : found.answers) table.columns.push_back(column_of(answer));
  for (const EffectTrial& effect : found.effects)
    for (const ModelTrial& trial : effect.trials) {
      auto& row = table.rows.emplace_back();
      row = {effect.name,      trial.change,         trial.done,          trial.within,
             trial.why,        bytes_of(trial.cost), work_of(trial.cost), trial.steps,
             trial.spec.scene, trial.spec.solver};
      for (std::size_t i = 0; i < found.answers.size(); ++i)
        row.push_back(i < trial.moved.size() ? Cell(trial.moved[i]) : Cell());
    }
  table.detail = true;
  return table;
}

std::string command_of(const CaseSpec& spec) {
  return "taut case " + shell_word(spec.scene) + " " +
         shell_word(parse_solver(spec.solver).brief());
}

/// What goes and what stays, in words.
struct Summary {
  std::string kept, can_go = "nothing", required = "-";
};

Summary summary_of(const Requirement& found) {
  std::string drop, keep;
  for (const EffectTrial& effect : found.effects) {
    std::string& list = effect.chosen ? drop : keep;
    list += (list.empty() ? "" : ", ") + effect.name;
    const ModelTrial& told =
        effect.chosen ? effect.trials[*effect.chosen] : effect.representative();
    if (effect.chosen && told.change != "gone") list += " " + told.change;
  }
  for (const std::string& what : found.not_done)
    drop += (drop.empty() ? "not done: " : "; not done: ") + what;
  return {join(found.answers, ", ", &KeptAnswer::name), drop.empty() ? "nothing" : drop,
          keep.empty() ? (found.effects.empty() ? "-" : "nothing") : keep};
}

std::string chaos_text(const Requirement& found) {
  return found.chaotic ? "after " + number_text(found.horizon, kTime, 2) : "no";
}

Table list(const char* name, const char* title, const std::vector<std::string>& lines) {
  Table table{name, title, {{"what"}}};
  for (const std::string& line : lines) table.rows.push_back({line});
  return table;
}

/// `seconds` of the patience were used.
Answer answer_of(const Requirement& found, const Store& store, const std::string& picture,
                 double seconds, double patience) {
  Answer answer{"require", found.full.id};
  const Summary summary = summary_of(found);
  const std::size_t bytes = full_bytes(found, store);
  answer.add(Column("key").in_detail(), found.full.key);
  answer.add(Column("scene").in_detail(), found.full.scene->name);
  answer.add(Column("solver").in_detail(), found.full.choice.brief());
  answer.add({"can_go", "can go"}, summary.can_go);
  answer.add({"required"}, summary.required);
  answer.add(Column("kept").in_detail(), summary.kept);
  answer.add({"chaotic"},
             Cell(chaos_text(found))
                 .with(found.chaotic ? "a rounding error at the start moves the shape beyond its "
                                       "tolerance; only statistics are kept"
                                     : ""));
  answer.add(Column("horizon", "", kTime).in_detail(),
             found.chaotic ? Cell(found.horizon) : Cell());
  answer.add({"bytes", "memory of a step", kKilobytes}, bytes);
  if (found.smallest) {
    answer.add({"smallest", "smallest model"}, command_of(found.smallest->spec));
    answer.add({"file", "its scene"}, found.file.string());
    answer.add({"verified", "run again from its file, the same bits"}, found.verified);
    answer.add({"time_left", "its CPU time", kShare}, found.time_ratio);
    answer.add({"control", "the full model against itself"}, found.control);
  }
  if (!picture.empty()) answer.add({"picture"}, picture);
  answer.add({"cases", "cases looked at"}, found.cases);
  answer.add({"ran", "of which were run now"}, found.ran);
  answer.add({"seconds", "time", kTime}, seconds);
  answer.add({"patience", "of", kTime}, patience);
  answer.add({"complete"}, found.not_done.empty() && !found.interrupted);
  answer.add(answers_of(found));
  answer.add(effects_of(found, bytes));
  answer.add(list("not_kept", "not kept", found.given_up));
  answer.add(list("not_done", "NOT DONE: stopped by --patience; the same command goes on",
                  found.not_done));
  answer.add(trials_of(found));
  return answer;
}

/// One model's cloth at its end, under its own camera.
Image panel(const CaseSpec& spec, const std::string& title, const Store& store) {
  const Case one = make_case(spec);
  RecordedRun run = recorded_run(*one.scene, store.motion(one.key));
  run.title = title;
  run.settings = report::brief_settings(one.choice.canonical());
  run.colour = kInk;
  const auto layout = PageLayout::page(800, 720, 1);
  SceneRendererOptions look;
  look.width = layout.panel_width, look.height = layout.panel_height;
  look.quality = RenderQuality::video();
  look.from = look.to = one.scene->duration();
  const std::vector<RecordedRun> runs{std::move(run)};
  return compose(SceneRenderer(*one.scene, runs, look), layout, {one.scene->duration()});
}

/// The full and the smallest model side by side; "": no time, or no renderer.
std::string draw(const Requirement& found, const Store& store, const fs::path& file) {
  try {
    const Image full = panel(found.full.spec, "full model", store),
                smallest = panel(found.smallest->spec, "smallest model", store);
    Image both(full.width() + smallest.width(), full.height());
    both.paste(full, 0, 0);
    both.paste(smallest, full.width(), 0);
    write_png(file, both);
    return file.string();
  } catch (const InputError& error) {
    std::cerr << "no picture: " << error.what() << '\n';
    return "";
  }
}

int exit_code(const Requirement& found) {
  if (found.interrupted) return kInterrupted;
  if (found.smallest && !found.verified && found.not_done.empty()) return kConflict;
  return found.not_done.empty() ? kPass : kIncomplete;
}

/// Adds a row to `scenes`; prints the whole answer of a scene asked for alone.
int run_one(const Options& options, const std::string& scene, Table& scenes, bool alone) {
  const auto start = SteadyClock::now();
  const auto seconds = [&] { return seconds_since(start); };
  const CaseSpec spec{scene, options.settings, parse_solver(options.solver).canonical()};
  const Case full = make_case(spec);
  for (const std::string& reason :
       full.choice.entry->unsupported(*full.scene, full.choice.params)) {
    if (alone) throw InputError(full.id + ": " + reason);
    scenes.rows.push_back({full.scene->name, {}, {}, {}, reason, {}});
    return kPass;
  }
  const Store store(options.out);
  store.prepare();
  store.begin_session("taut require " + full.id);
  const fs::path folder =
      fs::path(options.out) / "require" / (full.scene->name + "-" + full.key.substr(0, 8));
  Progress shown;
  const Requirement found = find_requirement({.full = spec,
                                              .keep = options.keep,
                                              .patience = options.patience,
                                              .jobs = options.jobs,
                                              .progress =
                                                  [&](const CampaignProgress& c, const Record* r) {
                                                    if (r) shown.show(c, r);
                                                  }},
                                             store, folder);
  std::string picture;
  if (found.smallest && seconds() + kPictureSeconds < options.patience)
    picture =
        draw(found, store,
             options.output.empty() || !alone ? folder / "models.png" : fs::path(options.output));
  const Summary summary = summary_of(found);
  scenes.rows.push_back({full.scene->name, chaos_text(found), summary.kept, summary.can_go,
                         summary.required, found.time_ratio});
  const Answer answer = answer_of(found, store, picture, seconds(), options.patience);
  if (!found.answers.empty()) store.keep(answer);
  if (alone)
    print(answer, options.format);
  else
    progress() << full.scene->name << ": without " << summary.can_go << '\n';
  return exit_code(found);
}

int run(const Options& options) {
  Table scenes{"scenes",
               "",
               {{"scene"},
                {"chaotic"},
                {"kept"},
                {"can_go", "can go"},
                {"required"},
                {"time_left", "CPU time left", kShare, 2}}};
  if (options.scene != "all") {
    find_scene(options.scene);
    return run_one(options, options.scene, scenes, true);
  }
  int worst = kPass;
  for (const std::string& scene : shipped("scenes")) {
    const int code = run_one(options, scene, scenes, false);
    if (code == kInterrupted) return code;
    worst = std::max(worst, code);
  }
  Answer answer{"require", "all, " + options.solver};
  answer.add(std::move(scenes));
  print(answer, options.format);
  return worst;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.scene, "Name or path of a scene; all: every shipped one, as a table")
      ->required();
  app.add_option("SOLVER", o.solver, "NAME or NAME:key=value,... (default: jakobsen)");
  app.add_option("--keep", o.keep,
                 "An answer to keep: shape or a metric value, and :TOLERANCE in SI units, in the "
                 "unit shown (:2mm) or in % of the cloth, of the duration or of the value; repeat "
                 "it (default: shape, stretch, depth, crossings, settling time)")
      ->allow_extra_args(false);
  add_settings(app, o.settings);
  app.add_option("--patience", o.patience, "For all of a scene's work [s] (default: 120)")
      ->check(above_zero_seconds());
  add_output(app, o.output,
             "Where to draw both models (default: models.png beside the smallest scene)");
  add_jobs(app, o.jobs);
  add_results(app, o.out);
  add_format(app, o.format, "Print all that was tried, too");
}

}  // namespace
}  // namespace taut::verb::requiring

TAUT_VERB(require) = {
    .name = "require",
    .group = VerbGroup::extremes,
    .summary = "Finds the smallest model of a scene that keeps its answers",
    .example =
        "taut require flag\n  taut require ball jakobsen:faces=on --keep shape:2% --keep "
        "stretch.max:0.5%\n  taut require my/scene.toml bullet --json\n"
        "Exit: 0 found; 3 stopped by --patience; 6 the smallest model does not repeat bit for bit",
    .bind = taut::bind_verb<taut::verb::requiring::add_options, taut::verb::requiring::run>};
