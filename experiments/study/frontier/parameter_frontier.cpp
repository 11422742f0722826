#include "experiments/study/frontier/parameter_frontier.hpp"

#include <algorithm>
#include <utility>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
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
  seen.end = store.motion(one.key).frames.back().state.x;
  return seen;
}

void tell_theory(const FrontierSetting& setting, ParameterFrontier& found) {
  if (!setting.theory) return;
  found.law = setting.theory->law;
  const double end = setting.theory->value;
  if (setting.theory->kind == Frontier::Kind::bracketed && end < setting.question.range.to)
    found.theory = setting.question.setting(end);
}

void tell(const Frontier& frontier, const FrontierQuestion& question, ParameterFrontier& found) {
  using Kind = Frontier::Kind;
  if (frontier.kind == Kind::not_answered) {
    found.lacks = "not answered: no time or memory, or interrupted";
    return;
  }
  if (frontier.kind != Kind::none_stable) found.good = question.setting(frontier.stable);
  if (frontier.kind == Kind::all_stable) return;
  found.bad = question.setting(frontier.unstable);
  found.symptom = frontier.at(frontier.unstable)->symptom;
  found.beyond = question.at(frontier.unstable);
}

/// The search along one parameter; nothing: interrupted.
std::optional<ParameterFrontier> search(const FrontierSetting& setting, const std::string& solver,
                                        const Store& store, const CampaignOptions& options) {
  ParameterFrontier found;
  found.solver = solver, found.parameter = setting.name, found.unit = setting.unit;
  found.lacks = setting.lacks;
  if (!found.lacks.empty()) return found;
  const FrontierQuestion& question = setting.question;
  found.downwards = question.direction != Direction::up;
  found.from = question.setting(question.range.from);
  found.to = question.setting(question.range.to);
  const Case first = make_case(question.at(question.range.from));
  if (run_cases({first}, store, options).interrupted) return {};
  const std::optional<Record> record = store.find(first);
  if (!record) return {};
  if (!ran(*record)) {
    found.lacks = record->status.reason.empty() ? std::string(to_string(record->status.kind))
                                                : record->status.reason;
    return found;
  }
  const JudgedRun start = look(first, *record, store);
  const std::vector<std::string> known = symptoms(start, nullptr);
  found.at_start = join(known, ", ");
  tell_theory(setting, found);
  const Judge judge = [&](const Case& one, const Record& r) {
    std::vector<std::string> wrong = symptoms(look(one, r, store), &start);
    std::erase_if(wrong, [&](const std::string& name) { return std::ranges::count(known, name); });
    return join(wrong, ", ");
  };
  const CaseFrontier result = find_frontier(question, store, options, judge);
  found.cases = result.frontier.probes.size(), found.ran = result.ran;
  tell(result.frontier, question, found);
  if (result.interrupted) return {};
  return found;
}

constexpr const char* kSchema = "taut-frontiers-2";

using F = ParameterFrontier;
constexpr std::tuple kFields{
    Field{"solver", &F::solver},   Field{"parameter", &F::parameter}, Field{"unit", &F::unit},
    Field{"lacks", &F::lacks},     Field{"downwards", &F::downwards}, Field{"from", &F::from},
    Field{"to", &F::to},           Field{"good", &F::good},           Field{"bad", &F::bad},
    Field{"symptom", &F::symptom}, Field{"at_start", &F::at_start},   Field{"theory", &F::theory},
    Field{"law", &F::law},         Field{"beyond", &F::beyond},       Field{"cases", &F::cases}};

}  // namespace

std::optional<std::vector<ParameterFrontier>> find_frontiers(
    const std::string& solver, const Store& store, const CampaignOptions& options,
    const std::function<void(std::size_t done, std::size_t all)>& progress) {
  std::vector<ParameterFrontier> frontiers;
  const std::vector<FrontierSetting> settings = frontier_settings(solver);
  const std::string name = parse_solver(solver).brief();
  for (const FrontierSetting& setting : settings) {
    const auto found = search(setting, name, store, options);
    if (!found) return {};
    frontiers.push_back(*found);
    progress(frontiers.size(), settings.size());
  }
  return frontiers;
}

std::string to_json(const std::vector<ParameterFrontier>& frontiers, std::string_view program) {
  Json all{{"schema", kSchema}, {"program", program}, {"parameters", Json::array()}};
  for (const F& one : frontiers) all["parameters"].push_back(json_of(one, kFields));
  return to_text(all, 1) + "\n";
}

std::optional<std::vector<ParameterFrontier>> read_frontiers(const std::filesystem::path& file,
                                                             std::string_view program) {
  return read_json(read_text(file), file.string(), [&](const JsonReader& root) {
    root.require_schema(kSchema);
    std::optional<std::vector<ParameterFrontier>> found;
    if (root.at("program").text() != program) return found;
    found.emplace();
    for (const JsonReader& one : root.at("parameters").items())
      found->push_back(read_as(one, kFields));
    return found;
  });
}

}  // namespace taut
