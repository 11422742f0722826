// Frontiers as JSON lines: in the baseline, and in a results folder for the report.
#include <sstream>

#include "core/io/text_file.hpp"
#include "experiments/extremes/extremes.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-frontiers-1";

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

KnobFrontier knob_of(const JsonReader& json) {
  KnobFrontier knob;
  knob.solver = json.at("solver").text();
  knob.knob = json.at("knob").text(), knob.unit = json.at("unit").text();
  knob.lacks = json.at("lacks").text();
  knob.downwards = json.at("downwards").flag();
  knob.from = json.at("from").number(), knob.to = json.at("to").number();
  knob.good = json.at("good").number_or_null(), knob.bad = json.at("bad").number_or_null();
  knob.symptom = json.at("symptom").text(), knob.at_start = json.at("at_start").text();
  knob.theory = json.at("theory").number_or_null(), knob.law = json.at("law").text();
  const JsonReader beyond = json.at("beyond");
  knob.beyond = {beyond.at("scene").text(), beyond.at("overrides").texts(),
                 beyond.at("solver").text()};
  knob.cases = json.at("cases").count();
  return knob;
}

Json json_of(const KnobFrontier& k) {
  return {
      {"solver", k.solver},
      {"knob", k.knob},
      {"unit", k.unit},
      {"lacks", k.lacks},
      {"downwards", k.downwards},
      {"from", k.from},
      {"to", k.to},
      {"good", number(k.good)},
      {"bad", number(k.bad)},
      {"symptom", k.symptom},
      {"at_start", k.at_start},
      {"theory", number(k.theory)},
      {"law", k.law},
      {"beyond",
       {{"scene", k.beyond.scene}, {"overrides", k.beyond.overrides}, {"solver", k.beyond.solver}}},
      {"cases", k.cases}};
}

}  // namespace

std::string to_json_lines(const std::vector<KnobFrontier>& knobs) {
  std::string text;
  for (const KnobFrontier& knob : knobs) text += to_text(json_of(knob)) + "\n";
  return text;
}

std::string to_json(const std::vector<KnobFrontier>& knobs, std::string_view program) {
  Json all{{"schema", kSchema}, {"program", program}, {"knobs", Json::array()}};
  for (const KnobFrontier& knob : knobs) all["knobs"].push_back(json_of(knob));
  return to_text(all, 1) + "\n";
}

std::vector<KnobFrontier> read_knobs(const std::filesystem::path& file) {
  std::vector<KnobFrontier> knobs;
  std::istringstream in(read_text(file));
  int number = 0;
  for (std::string line; std::getline(in, line);)
    knobs.push_back(read_json(line, file.string(), knob_of, ++number));
  return knobs;
}

std::optional<std::vector<KnobFrontier>> read_frontiers(const std::filesystem::path& file,
                                                        std::string_view program) {
  return read_json(read_text(file), file.string(), [&](const JsonReader& root) {
    root.require_schema(kSchema);
    std::optional<std::vector<KnobFrontier>> knobs;
    if (root.at("program").text() != program) return knobs;
    knobs.emplace();
    for (const JsonReader& knob : root.at("knobs").items()) knobs->push_back(knob_of(knob));
    return knobs;
  });
}

}  // namespace taut
