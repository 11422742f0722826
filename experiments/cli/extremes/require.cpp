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
  bool json = false;
};

std::string percent(double share) { return number_text(100 * share, 2) + " %"; }

std::string kilobytes(double bytes) { return number_text(bytes / 1000) + " kB"; }

/// The part of the full model's time that an effect costs; "-": not timed.
std::string time_text(const Requirement& found, const std::optional<Interval>& ratio) {
  if (!ratio) return "-";
  const bool none = ratio->contains(1) || std::abs(1 - ratio->mid) <= spread(found.control);
  return none ? "none seen" : percent(1 - ratio->mid);
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

/// What is printed, as a table: head, the full model, its tolerances and noise, effects, the
/// smallest model.
std::vector<Row> table(const Requirement& found, std::size_t bytes) {
  Row head{"without", "change"}, full{"(full model)", ""}, may{"(may move by)", ""},
      noise{"(noise)", ""};
  for (std::size_t i = 0; i < found.answers.size(); ++i) {
    const KeptAnswer& answer = found.answers[i];
    head.push_back(answer.name);
    full.push_back(answer.is_shape() ? "" : text(answer, found.values[i]));
    may.push_back(text(answer, answer.tolerance));
    noise.push_back(text(answer, found.noise[i]));
  }
  for (const char* name : {"time", "bytes", "verdict"}) head.emplace_back(name);
  full.insert(full.end(), {"100 %", kilobytes(static_cast<double>(bytes)), ""});
  std::vector<Row> rows{head, full, may, noise};
  const auto add = [&](const std::string& name, const ModelTrial& trial,
                       const std::optional<Interval>& time, const std::string& last) {
    Row row{name, trial.change};
    for (std::size_t i = 0; i < found.answers.size(); ++i)
      row.push_back(i < trial.moved.size() ? text(found.answers[i], trial.moved[i]) : "-");
    const double less = static_cast<double>(bytes) - static_cast<double>(bytes_of(trial.cost));
    row.insert(row.end(),
               {time_text(found, time), trial.cost.empty() ? "-" : kilobytes(less), last});
    rows.push_back(row);
  };
  for (const EffectTrial& effect : found.effects)
    add(effect.name, effect.representative(), effect.time, verdict(effect));
  if (found.smallest)
    add("(smallest model)", *found.smallest, found.time_ratio,
        found.verified ? "verified: the same bits from its file" : "NOT VERIFIED");
  for (Row& row : rows) row.resize(head.size());
  return rows;
}

std::string command_of(const CaseSpec& spec) {
  return "taut case " + shell_word(spec.scene) + " " +
         shell_word(parse_solver(spec.solver).brief());
}

std::string horizon_text(const Requirement& found) {
  return "chaotic: a rounding error at the start moves the shape beyond its tolerance after " +
         number_text(found.horizon, 2) + " s; only statistics are kept";
}

void print_text(const Requirement& found, const Store& store, const std::string& picture,
                double seconds, double patience) {
  std::cout << found.full.id << '\n';
  if (found.chaotic) std::cout << "  " << horizon_text(found) << '\n';
  for (const std::string& answer : found.given_up) std::cout << "  not kept: " << answer << '\n';
  if (!found.effects.empty()) print_columns(table(found, full_bytes(found, store)), 2);
  if (found.smallest) {
    std::cout << "  smallest model  " << command_of(found.smallest->spec) << '\n';
    if (found.time_ratio)
      std::cout << "  its CPU time    " << interval_text(*found.time_ratio)
                << " of the full model's; that against itself: " << interval_text(found.control)
                << '\n';
  } else if (found.not_done.empty() && !found.interrupted) {
    std::cout << "  nothing can go: every effect is required\n";
  }
  if (!picture.empty()) std::cout << "  picture         " << picture << '\n';
  for (const std::string& what : found.not_done)
    std::cout << "  NOT DONE        " << what << ": stopped by --patience " << number_text(patience)
              << "; the same command goes on\n";
  std::cout << "  looked at       " << found.cases << " cases, of which " << found.ran
            << " were run now; " << number_text(seconds) << " s of " << number_text(patience)
            << " s\n";
}

Json json_of(const std::optional<Interval>& i) { return i ? Json(*i) : Json(); }

Json json_of(const ModelTrial& trial) {
  return {{"change", trial.change},
          {"scene", trial.spec.scene},
          {"solver", trial.spec.solver},
          {"done", trial.done},
          {"within", trial.within},
          {"why", trial.why.empty() ? Json() : Json(trial.why)},
          {"moved", trial.moved},
          {"bytes", bytes_of(trial.cost)},
          {"work_per_step", work_of(trial.cost)},
          {"steps", trial.steps}};
}

Json json_of(const Requirement& found, const Store& store, const std::string& picture,
             double seconds, double patience) {
  Json all{{"id", found.full.id},
           {"key", found.full.key},
           {"chaotic", found.chaotic},
           {"horizon_seconds", found.chaotic ? Json(found.horizon) : Json()},
           {"answers", Json::array()},
           {"not_kept", found.given_up},
           {"bytes", full_bytes(found, store)},
           {"effects", Json::array()},
           {"smallest", nullptr},
           {"control", found.control},
           {"cases", found.cases},
           {"ran", found.ran},
           {"seconds", seconds},
           {"patience_seconds", patience},
           {"complete", found.not_done.empty() && !found.interrupted},
           {"not_done", found.not_done}};
  for (std::size_t i = 0; i < found.answers.size(); ++i)
    all["answers"].push_back({{"name", found.answers[i].name},
                              {"unit", unit_of(found.answers[i]).si},
                              {"value", found.values[i]},
                              {"tolerance", found.answers[i].tolerance},
                              {"noise", i < found.noise.size() ? Json(found.noise[i]) : Json()}});
  for (const EffectTrial& effect : found.effects) {
    Json one{{"name", effect.name},
             {"verdict", !effect.done()  ? "not done"
                         : effect.chosen ? "drop"
                                         : "keep"},
             {"may_go", effect.may_go()},
             {"time_ratio", json_of(effect.time)},
             {"chosen", effect.chosen ? Json(*effect.chosen) : Json()},
             {"trials", Json::array()}};
    for (const ModelTrial& trial : effect.trials) one["trials"].push_back(json_of(trial));
    all["effects"].push_back(std::move(one));
  }
  if (found.smallest) {
    all["smallest"] = json_of(*found.smallest);
    all["smallest"]["file"] = found.file.string();
    all["smallest"]["verified"] = found.verified;
    all["smallest"]["time_ratio"] = json_of(found.time_ratio);
    all["smallest"]["command"] = command_of(found.smallest->spec);
  }
  if (!picture.empty()) all["picture"] = picture;
  return all;
}

/// One model's cloth at its end, under its own camera.
Image panel(const CaseSpec& spec, const std::string& title, const Store& store) {
  const Case one = make_case(spec);
  RecordedRun run = recorded_run(*one.scene, store.motion(one.key));
  run.title = title;
  run.settings = report::brief_settings(one.choice.canonical());
  run.colour = kInk;
  const PageLayout layout(800, 720, 1);
  SceneRendererOptions look;
  look.width = layout.panel_width, look.height = layout.panel_height;
  look.quality = RenderQuality::video();
  look.from = look.to = one.scene->duration();
  const std::vector<RecordedRun> runs{std::move(run)};
  return compose(SceneRenderer(*one.scene, runs, look), layout, one.scene->duration());
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

/// One line of the table over all scenes.
Row summary(const Requirement& found) {
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
  return {found.full.scene->name,
          found.chaotic ? number_text(found.horizon, 2) + " s" : "no",
          join(found.answers, ", ", &KeptAnswer::name),
          drop.empty() ? "nothing" : drop,
          keep.empty() ? (found.effects.empty() ? "-" : "nothing") : keep,
          found.time_ratio ? percent(found.time_ratio->mid) : "-"};
}

/// For the report.
void leave(const Requirement& found, const Row& row, const fs::path& folder) {
  make_folder(folder);
  write_file(folder / "found.json",
             to_text(Json{{"schema", "taut-require-1"},
                          {"program", program_digest()},
                          {"summary",
                           {{"scene", row[0]},
                            {"solver", found.full.choice.brief()},
                            {"chaotic", found.chaotic ? "after " + row[1] : ""},
                            {"answers", row[2]},
                            {"drop", row[3]},
                            {"keep", row[4]},
                            {"time", row[5]},
                            {"command", found.smallest ? command_of(found.smallest->spec) : ""}}}},
                     1) +
                 "\n");
}

int run_one(const Options& options, const std::string& scene, Json& all, std::vector<Row>& rows,
            bool alone) {
  const auto start = SteadyClock::now();
  const auto seconds = [&] { return seconds_since(start); };
  const CaseSpec spec{scene, options.settings, parse_solver(options.solver).canonical()};
  const Case full = make_case(spec);
  for (const std::string& reason :
       full.choice.entry->unsupported(*full.scene, full.choice.params)) {
    if (alone) throw InputError(full.id + ": " + reason);
    rows.push_back({full.scene->name, "-", "-", "-", reason, "-"});
    return kPass;
  }
  const Store store(options.out);
  store.prepare();
  begin_session(store, "taut require " + full.id);
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
  rows.push_back(summary(found));
  if (!found.answers.empty()) leave(found, rows.back(), folder);
  if (options.json)
    all.push_back(json_of(found, store, picture, seconds(), options.patience));
  else if (alone)
    print_text(found, store, picture, seconds(), options.patience);
  else
    progress() << rows.back()[0] << ": without " << rows.back()[3] << '\n';
  return exit_code(found);
}

int run(const Options& options) {
  Json all = Json::array();
  std::vector<Row> rows{{"scene", "chaotic after", "kept", "can go", "required", "time left"}};
  if (options.scene != "all") {
    find_scene(options.scene);
    const int code = run_one(options, options.scene, all, rows, true);
    if (options.json) print_json(all.at(0));
    return code;
  }
  int worst = kPass;
  for (const std::string& scene : shipped("scenes")) {
    const int code = run_one(options, scene, all, rows, false);
    if (code == kInterrupted) return code;
    worst = std::max(worst, code);
  }
  if (options.json)
    print_json(all);
  else
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (const std::string& cell : rows[i]) std::cout << "| " << cell << ' ';
      std::cout << "|\n" << (i == 0 ? "|---|---|---|---|---|---|\n" : "");
    }
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
  add_json(app, o.json, "The table, the smallest model and all that was tried");
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
