#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/study/study.hpp"
#include "experiments/system/data.hpp"
#include "experiments/truths/vasilovici/assertions.hpp"

namespace taut::verb::list {

namespace {

struct Options {
  std::string what;
  bool json = false;
};

std::string allowed(const ParamSpec& spec) {
  if (spec.kind == ParamSpec::Kind::choice) return std::string(spec.choices);
  if (spec.kind == ParamSpec::Kind::text) return "any text";
  if (spec.kind == ParamSpec::Kind::integer)
    return std::to_string(static_cast<long>(spec.min)) + " to " +
           std::to_string(static_cast<long>(spec.max));
  return shortest(spec.min) + " to " + shortest(spec.max);
}

Json list_scenes() {
  return json_array(shipped("scenes"), [](const std::string& name) -> Json {
    const Scene scene = load_scene(find_scene(name));
    return {{"name", name},
            {"summary", scene.summary},
            {"vertices", scene.mesh.size()},
            {"links", scene.links.size()},
            {"dt", scene.dt},
            {"duration", scene.duration()}};
  });
}

Json list_solvers() {
  const auto param = [](const ParamSpec& spec) -> Json {
    return {{"name", spec.name},
            {"default", spec.default_value},
            {"unit", spec.unit},
            {"allowed", allowed(spec)},
            {"help", spec.help}};
  };
  return json_array(all_solvers(), [&](const SolverEntry* entry) -> Json {
    return {{"name", entry->name},
            {"summary", entry->summary},
            {"source", entry->source},
            {"params", json_array(entry->params, param)}};
  });
}

Json list_metrics() {
  const auto value = [](const ValueSpec& spec) -> Json {
    return {{"name", spec.name},
            {"unit", spec.unit.si},
            {"help", spec.help},
            {"in_series", spec.in_series}};
  };
  return json_array(metrics(), [&](const MetricEntry* entry) -> Json {
    return {{"name", entry->name},
            {"summary", entry->summary},
            {"source", entry->source},
            {"values", json_array(entry->values, value)}};
  });
}

Json list_studies() {
  return json_array(shipped("studies"), [](const std::string& name) -> Json {
    const Study study = load_study(name);
    return {{"name", name},
            {"question", study.question},
            {"presets", study.presets},
            {"scenes", study.scenes},
            {"solvers", study.solvers}};
  });
}

/// What Vasilovici's report asserts.
Json list_assertions() {
  return json_array(vasilovici_assertions(), [](const VasiloviciAssertion& assertion) -> Json {
    return {{"name", assertion.section},
            {"summary", assertion.assertion},
            {"verdict", to_string(assertion.verdict)},
            {"because", assertion.because},
            {"truth", assertion.truth.empty() ? Json() : Json(assertion.truth)}};
  });
}

constexpr std::pair<const char*, Json (*)()> kKinds[] = {{"scenes", list_scenes},
                                                         {"solvers", list_solvers},
                                                         {"metrics", list_metrics},
                                                         {"studies", list_studies},
                                                         {"assertions", list_assertions}};

std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : ""; }

void print_text(std::string_view kind, const Json& all) {
  std::cout << kind << '\n';
  for (const Json& one : all) {
    std::cout << "  " << text(one["name"]) << ": "
              << text(one.contains("summary") ? one["summary"] : one["question"]) << '\n';
    if (one.contains("verdict")) {
      const std::string truth = text(one["truth"]);
      std::cout << "      " << text(one["verdict"]) << ": " << text(one["because"])
                << (truth.empty() ? "" : " (truth " + truth + ")") << '\n';
    }
    if (one.contains("source")) std::cout << "      source: " << text(one["source"]) << '\n';
    for (const Json& param : one.value("params", Json::array())) {
      std::cout << "      " << text(param["name"]) << '=' << text(param["default"]);
      if (const std::string unit = text(param["unit"]); !unit.empty())
        std::cout << " [" << unit << ']';
      std::cout << "  (" << text(param["allowed"]) << ")  " << text(param["help"]) << '\n';
    }
    for (const Json& value : one.value("values", Json::array()))
      std::cout << "      " << text(value["name"]) << " [" << text(value["unit"]) << "]  "
                << text(value["help"]) << '\n';
  }
}

int run(const Options& options) {
  const std::string& what = options.what;
  Json all;
  for (const auto& [kind, list] : kKinds)
    if (what.empty() || what == kind) all[kind] = list();
  if (options.json) {
    print_json(what.empty() ? all : all[what], 2);
    return kPass;
  }
  for (const auto& [kind, items] : all.items()) {
    if (kind != all.begin().key()) std::cout << '\n';
    print_text(kind, items);
  }
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("WHAT", o.what, "scenes | solvers | metrics | studies | assertions (default: all)")
      ->check(CLI::IsMember({"scenes", "solvers", "metrics", "studies", "assertions"}));
  add_json(app, o.json, "The same");
}

}  // namespace
}  // namespace taut::verb::list

TAUT_VERB(list) = {
    .name = "list",
    .group = VerbGroup::one_case,
    .summary = "Names scenes, solvers with their parameters, metrics, studies and assertions",
    .example = "taut list solvers",
    .bind = taut::bind_verb<taut::verb::list::add_options, taut::verb::list::run>};
