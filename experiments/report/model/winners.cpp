#include "experiments/report/questions/winners.hpp"

#include <cmath>
#include <iterator>

#include "experiments/baseline/baseline.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

namespace {

Json json_of(const Contender& one) {
  Json json{{"solver", one.solver},
            {"setting", one.setting.text()},
            {"arithmetic", one.arithmetic.brief()},
            {"cost", one.cost},
            {"error", one.error},
            {"case", one.key},
            {"command", reproduce(one.again)}};
  add_if(json, "terms", one.setting.terms());
  add_if(json, "links", one.links);
  if (std::isfinite(one.motion)) json["motion"] = one.motion;
  if (std::isfinite(one.stretch)) json["stretch"] = one.stretch;
  if (std::isfinite(one.largest)) json["largest"] = one.largest;
  if (one.bound) json["at_most"] = true;
  return json;
}

Json json_of(const WinnerCell& cell) {
  Json json = Json::object();
  for (const Contender& one : cell.cheapest) json["cheapest"].push_back(json_of(one));
  if (cell.next) {
    json["next"] = json_of(*cell.next);
    json["times"] = cell.times;
  }
  if (cell.bullet) json["bullet"] = json_of(cell.bullet->one);
  if (cell.bullet && cell.bullet->times) json["bullet_times"] = *cell.bullet->times;
  add_if(json, "why", cell.why);
  for (const auto& [solver, why] : cell.excluded)
    json["excluded"].push_back({{"solver", solver}, {"why", why}});
  return json;
}

Json json_of(const std::vector<Said>& sentence) {
  Json json = Json::array();
  for (const Said& one : sentence) {
    Json part{{"text", one.text}};
    add_if(part, "case", one.key);
    if (one.of_map) part["map"] = true;
    json.push_back(std::move(part));
  }
  return json;
}

Json json_of(const WinnerMap& map) {
  const auto levels = levels_of(map.metric);
  Json json{{"metric", map.metric}, {"levels", std::vector<double>(levels.begin(), levels.end())}};
  for (const WinnerRow& row : map.rows) {
    Json one{{"scene", row.scene}, {"title", row.title}, {"by", to_string(row.by)}};
    for (const WinnerCell& cell : row.cells) one["cells"].push_back(json_of(cell));
    if (row.has_bullet)
      one["bullet"] =
          row.bullet_refused.empty() ? "no setting that was timed reaches it" : row.bullet_refused;
    json["rows"].push_back(std::move(one));
  }
  return json;
}

}  // namespace

Json json_of_winners(const ReportInput& input, const Answer& answer, CaseList& list,
                     Answer& tables) {
  const WinnerMap map = winners_of(input, list);
  if (map.rows.empty()) return {};
  Json json = json_of(map);
  json["frame"] = kFrame;
  json["rules"] = rules_of(map);
  json["certainty"] = certainty_text(map.noise);
  json["noise"] = shown(kShare, map.noise);
  add_if(json, "authors", authors_text(map));
  json["by_stretch"] = json_of(winners_of(input, list, std::string(kStretch)));
  for (const std::vector<Said>& sentence : sentences_of(map))
    json["sentences"].push_back(json_of(sentence));
  add_table(json, losses_of(map, answer), tables);
  return json;
}

}  // namespace taut::report
