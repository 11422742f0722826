#include "experiments/study/extremes/extremes.hpp"

#include <algorithm>
#include <utility>

#include "core/model/text.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/study/extremes/symptom.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

/// To its end.
bool ran(const Record& record) {
  const Status::Kind kind = record.status.kind;
  return kind == Status::Kind::ok || kind == Status::Kind::unsettled ||
         kind == Status::Kind::extreme;
}

JudgedRun look(const Case& one, const Record& record, const Store& store) {
  JudgedRun seen{one, record, {}};
  if (!ran(record) || !store.has_frames(one.key)) return seen;
  TrajectoryReader motion(store.folder(one.key) / kFramesFile);
  if (motion.frames() > 0) seen.end = motion.read(motion.frames() - 1).state.x;
  return seen;
}

/// The search along one parameter.
class ParameterSearch {
 public:
  ParameterSearch(ExtremeSetting setting, std::string solver, const Store& store)
      : setting_(std::move(setting)), store_(store) {
    found_.solver = std::move(solver), found_.parameter = setting_.name,
    found_.unit = setting_.unit;
    found_.lacks = setting_.lacks;
  }

  /// False: interrupted.
  bool run(const Session& session, const CampaignOptions& options) {
    if (!found_.lacks.empty()) return true;
    const FrontierQuestion& question = setting_.question;
    found_.downwards = question.direction != Direction::up;
    found_.from = question.setting(question.range.from);
    found_.to = question.setting(question.range.to);
    const Case first = make_case(question.at(question.range.from));
    if (run_cases({first}, store_, session, options).interrupted) return false;
    const std::optional<Record> record = store_.find(first);
    if (!record) return false;
    if (!ran(*record)) {
      found_.lacks = record->status.reason.empty() ? std::string(to_string(record->status.kind))
                                                   : record->status.reason;
      return true;
    }
    start_ = look(first, *record, store_);
    known_ = symptoms(*start_, nullptr);
    found_.at_start = join(known_, ", ");
    tell_theory();
    const CaseFrontier result =
        find_frontier(question, store_, session, options,
                      [&](const Case& one, const Record& r) { return judge(one, r); });
    found_.cases = result.frontier.probes.size(), found_.ran = result.ran;
    tell(result.frontier);
    return !result.interrupted;
  }

  ParameterFrontier take() { return std::move(found_); }

 private:
  std::string judge(const Case& one, const Record& record) const {
    std::vector<std::string> wrong = symptoms(look(one, record, store_), &*start_);
    std::erase_if(wrong, [&](const std::string& name) { return std::ranges::count(known_, name); });
    return join(wrong, ", ");
  }

  void tell_theory() {
    if (!setting_.theory) return;
    found_.law = setting_.theory->law;
    const double end = setting_.theory->value;
    if (setting_.theory->kind == Frontier::Kind::bracketed && end < setting_.question.range.to)
      found_.theory = setting_.question.setting(end);
  }

  void tell(const Frontier& frontier) {
    using Kind = Frontier::Kind;
    const FrontierQuestion& question = setting_.question;
    if (frontier.kind == Kind::not_answered) {
      found_.lacks = "not answered: no time or memory, or interrupted";
      return;
    }
    if (frontier.kind != Kind::none_stable) found_.good = question.setting(frontier.stable);
    if (frontier.kind == Kind::all_stable) return;
    found_.bad = question.setting(frontier.unstable);
    found_.symptom = frontier.at(frontier.unstable)->symptom;
    found_.beyond = question.at(frontier.unstable);
  }

  ExtremeSetting setting_;
  const Store& store_;
  std::optional<JudgedRun> start_;
  std::vector<std::string> known_;  ///< symptoms at the start of the range
  ParameterFrontier found_;
};

constexpr const char* kSchema = "taut-frontiers-2";

ParameterFrontier frontier_of(const JsonReader& json) {
  ParameterFrontier one;
  one.solver = json.at("solver").text();
  one.parameter = json.at("parameter").text(), one.unit = json.at("unit").text();
  one.lacks = json.at("lacks").text();
  one.downwards = json.at("downwards").flag();
  one.from = json.at("from").number(), one.to = json.at("to").number();
  one.good = json.at("good").number_or_null(), one.bad = json.at("bad").number_or_null();
  one.symptom = json.at("symptom").text(), one.at_start = json.at("at_start").text();
  one.theory = json.at("theory").number_or_null(), one.law = json.at("law").text();
  const JsonReader beyond = json.at("beyond");
  one.beyond = {beyond.at("scene").text(), beyond.at("overrides").texts(),
                beyond.at("solver").text()};
  one.cases = json.at("cases").count();
  return one;
}

Json json_of(const ParameterFrontier& k) {
  return {
      {"solver", k.solver},
      {"parameter", k.parameter},
      {"unit", k.unit},
      {"lacks", k.lacks},
      {"downwards", k.downwards},
      {"from", k.from},
      {"to", k.to},
      {"good", k.good},
      {"bad", k.bad},
      {"symptom", k.symptom},
      {"at_start", k.at_start},
      {"theory", k.theory},
      {"law", k.law},
      {"beyond",
       {{"scene", k.beyond.scene}, {"overrides", k.beyond.overrides}, {"solver", k.beyond.solver}}},
      {"cases", k.cases}};
}

}  // namespace

Extremes find_extremes(const std::string& solver, const Store& store, const Session& session,
                       const CampaignOptions& options,
                       const std::function<void(std::size_t done, std::size_t all)>& progress) {
  Extremes all;
  const std::vector<ExtremeSetting> settings = extreme_settings(solver);
  const std::string name = parse_solver(solver).brief();
  for (const ExtremeSetting& setting : settings) {
    ParameterSearch search(setting, name, store);
    all.interrupted = !search.run(session, options);
    if (all.interrupted) return all;
    all.frontiers.push_back(search.take());
    progress(all.frontiers.size(), settings.size());
  }
  return all;
}

std::string to_json(const std::vector<ParameterFrontier>& frontiers, std::string_view program) {
  Json all{{"schema", kSchema}, {"program", program}, {"parameters", Json::array()}};
  for (const ParameterFrontier& one : frontiers) all["parameters"].push_back(json_of(one));
  return to_text(all, 1) + "\n";
}

std::optional<std::vector<ParameterFrontier>> read_frontiers(const std::filesystem::path& file,
                                                             std::string_view program) {
  return read_json(read_text(file), file.string(), [&](const JsonReader& root) {
    root.require_schema(kSchema);
    std::optional<std::vector<ParameterFrontier>> found;
    if (root.at("program").text() != program) return found;
    found.emplace();
    for (const JsonReader& one : root.at("parameters").items()) found->push_back(frontier_of(one));
    return found;
  });
}

}  // namespace taut
