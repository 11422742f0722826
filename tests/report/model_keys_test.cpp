// What the model's document names is written, and nothing else is.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "experiments/report/input.hpp"
#include "experiments/report/report.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "experiments/truths/assertions/assertions.hpp"
#include "tests/report/made_up.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::model_keys_test {
namespace {

using Keys = std::map<std::string, std::set<std::string>>;  ///< by part of the model

/// The names in backquotes, by row of the table at its top and by section below it.
Keys documented() {
  std::istringstream lines(
      read_text(std::string(TAUT_SOURCE_DIR) + "/experiments/report/model/MODEL.md"));
  const std::regex name("`([a-z_]+)\\??`");
  Keys keys;
  std::string part, section;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) part = section = line.substr(3);
    if (section.empty()) continue;
    if (section != "Top") part[0] = static_cast<char>(std::tolower(part[0]));
    const std::size_t cell = section == "Top" ? line.find('|', 1) : 0;
    for (std::sregex_iterator at(line.begin(), line.end(), name), end; at != end; ++at)
      if (static_cast<std::size_t>(at->position()) < cell)
        part = (*at)[1];
      else
        keys[part].insert((*at)[1]);
  }
  return keys;
}

void collect(const Json& node, std::set<std::string>& keys) {
  static const std::set<std::string> kByName{"policy",     "statuses", "counts", "verdicts",
                                             "parameters", "values",   "cost"};
  if (node.is_array())
    for (const Json& one : node) collect(one, keys);
  if (!node.is_object() || (node.contains("mid") && node.contains("n"))) return;  // an interval
  for (const auto& [key, value] : node.items()) {
    keys.insert(key);
    if (!value.is_object() || !kByName.contains(key)) collect(value, keys);
  }
}

void collect(const Json& model, Keys& keys) {
  for (const auto& [part, value] : model.items())
    if (part == "metrics")
      for (const auto& [name, metric] : value.items()) collect(metric, keys[part]);
    else if (part != "schema")
      collect(value, keys[part]);
}

/// Made-up results with everything that a page may have.
ReportInput full() {
  ReportInput input;
  StudyResult sweeps{"iterations", "?", {}, 400, {{"hang", -1}}},
      steps{"time-steps", "?", {}, 0, {}};
  for (const std::string scene : {"hang", "ball"}) {
    for (const Record& r : synthetic::iterations(scene)) sweeps.records.push_back(r);
    for (const Record& r : synthetic::time_steps(scene)) steps.records.push_back(r);
  }
  for (Record& r : sweeps.records) {
    r.spec.overrides = {"cloth.grid=[4, 4]"};
    r.values["reference.rms"] = 1e-3, r.values["reference.floor"] = 1e-5;
    r.values["tunnelling.events"] = 0;
  }
  Record refused = sweeps.records.front();
  refused.key += "r", refused.status = {Status::Kind::unsupported, "moving pins", -1, -1};
  for (const char* substeps : {"1", "5"}) {  // other work than everybody else's
    Record other = refused;
    other.solver = "xpbd", other.key += substeps, other.status = {};
    other.params = {{"iterations", "3"}, {"substeps", substeps}};
    sweeps.records.push_back(other);
  }
  sweeps.records.push_back(refused);
  input.studies = {sweeps, steps};
  input.question = "?", input.command = "taut run";
  input.provenance = {{"program", "0"}, {"toolchain", "g++"}, {"made", "now"}, {"preset", "quick"}};
  input.solvers = {{"jakobsen", "Verlet", "2001", {{"moving pins", {"twist"}}}}};
  input.scenes = {{"hang", "A sheet"}};
  const Record& r = sweeps.records.front();
  input.series = {{"hang", r.solver, "J", "stretch.rms", {0, 1, 2}, {0, 1, 1}, r.key}};
  const auto object = [](const std::vector<std::string>& keys) {
    Json made;
    for (const std::string& key : keys) made[key] = "?";
    return made;
  };
  input.media = {{.scene = "hang", .duration = 2, .bar = object({"title", "stops", "ticks"})},
                 {.scene = "twist", .refused = {{"bullet", "moving pins"}}}};
  input.media[0].bar["ticks"] = {object({"at", "text"})};
  input.media[0].clips = {{"video/mp4", "x", "y", "image/png", "two", {{r.solver, "1", r.key}}},
                          {"video/mp4", std::string(6'000'000, 'x'), "", "", "", {}}};
  input.media[0].material = {{r.solver, {{1, 0.1, "png"}}}};
  Json row = object({"section", "statement", "source", "subject", "expected", "measured"});
  row.update({{"verdict", "deviates"}, {"why", "?"}});
  input.truths = Truths{{{"truths", 1}, {"findings", 1}, {"verdicts", {{"deviates", 1}}}}};
  input.truths->shown["rows"] = {row};
  input.truths->assertions[std::string(assertions()[0].assertion)] = {"holds", "1"};
  for (unsigned seed = 0; !input.bench; ++seed) input.bench = made_up::Maker(seed).input().bench;
  input.regressions = {{"cases", 1}, {"values", 1}};
  (*input.regressions)["rows"] = {object({"study", "case", "change"})};
  Record changed = r;
  changed.values["stretch.rms"] *= 2;
  input.differences = Differences{"a", "b", {{r, changed}}, {}, 0, 0, 0};
  input.required = {{"hang", "Jakobsen", "no", "shape", "a", "b", "34 %"}};
  input.frontiers = {ParameterFrontier{}};
  input.left_out = {{"x.json", "cut off"}};
  return input;
}

TEST(ModelKeys, EveryFieldIsDocumentedAndEveryDocumentedFieldIsWritten) {
  Keys written, known = documented();
  const ReportInput all = full();
  collect(parse_json(make_model(all)), written);
  ReportInput bare = all;
  bare.media.clear(), bare.differences.reset();
  collect(parse_json(make_model(bare)), written);  // series apart, what is missing
  for (unsigned seed = 0; seed < 20; ++seed)
    collect(parse_json(make_model(made_up::Maker(seed).input())), written);
  for (const auto& [part, keys] : written)
    for (const std::string& key : keys)
      EXPECT_TRUE(known[part].contains(key)) << part << ": " << key << " is not in MODEL.md";
  // Only in models of thousands of cases; an interval's; a word of a sentence.
  const std::set<std::string> elsewhere{"listed", "unlisted", "thinned", "low",
                                        "mid",    "high",     "n",       "taut"};
  for (const auto& [part, keys] : known)
    for (const std::string& key : keys)
      EXPECT_TRUE(written[part].contains(key) || elsewhere.contains(key))
          << part << ": " << key << " is never written";
}

}  // namespace
}  // namespace taut::report::model_keys_test
