#include "experiments/study/map.hpp"

#include "core/model/input_error.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

/// Class of a cell that the study leaves out or that could not be run.
constexpr int kNoResult = -1;

std::vector<std::optional<Case>> cells_of(const Study& study, const MapPanel& panel) {
  Study one = study;
  one.scenes = {panel.scene};
  one.solvers = {panel.solver};
  std::vector<std::optional<Case>> cells;
  for (const std::string& y : study.sweeps[1].values)
    for (const std::string& x : study.sweeps[0].values) {
      one.sweeps[0].values = {x};
      one.sweeps[1].values = {y};
      std::vector<Case> cases = cases_of(one);
      cells.push_back(cases.empty() ? std::nullopt : std::optional(std::move(cases.front())));
    }
  return cells;
}

/// Tells the panel what the store has; false if it lacks a cell that refinement asks for.
bool replay(const StudyMap& map, MapPanel& panel, const Store& store) {
  for (auto cells = panel.found.next(); !cells.empty(); cells = panel.found.next())
    for (const MapCell& c : cells) {
      const auto& one = map.cell(panel, c);
      const auto record = one ? store.find(*one) : std::nullopt;
      if (one && !record) return false;
      panel.found.tell(c, record ? static_cast<int>(record->status.kind) : kNoResult);
    }
  return true;
}

}  // namespace

std::size_t StudyMap::dense() const {
  std::size_t count = 0;
  for (const MapPanel& panel : panels)
    for (const auto& cell : panel.cells) count += cell ? 1 : 0;
  return count;
}

std::size_t StudyMap::known() const {
  std::size_t count = 0;
  for (const MapPanel& panel : panels)
    for (std::size_t j = 0; j < y.values.size(); ++j)
      for (std::size_t i = 0; i < x.values.size(); ++i)
        count += cell(panel, {i, j}) && panel.found.measured({i, j}) ? 1 : 0;
  return count;
}

std::vector<std::string> shipped_maps() {
  std::vector<std::string> names = shipped("studies");
  std::erase_if(names, [](const std::string& name) { return !name.starts_with("map-"); });
  return names;
}

StudyMap map_of(const Study& study) {
  if (study.sweeps.size() != 2)
    throw InputError("study '" + study.name + "' has " + std::to_string(study.sweeps.size()) +
                     " sweeps: a map has two");
  StudyMap map{study.sweeps[0], study.sweeps[1], {}};
  for (const std::string& scene : study.scenes)
    for (const std::string& solver : study.solvers) {
      MapPanel panel{scene, solver, {}, {map.x.values.size(), map.y.values.size()}};
      panel.cells = cells_of(study, panel);
      map.panels.push_back(std::move(panel));
    }
  return map;
}

std::vector<Record> inferred_records(const Study& study, const Store& store) {
  std::vector<Record> records;
  if (study.sweeps.size() != 2) return records;
  StudyMap map = map_of(study);
  for (MapPanel& panel : map.panels) {
    if (!replay(map, panel, store)) continue;
    for (std::size_t j = 0; j < map.y.values.size(); ++j)
      for (std::size_t i = 0; i < map.x.values.size(); ++i) {
        const auto& one = map.cell(panel, {i, j});
        const std::optional<int> said = panel.found.inferred({i, j});
        if (!one || panel.found.measured({i, j}) || !said || *said == kNoResult || store.find(*one))
          continue;
        records.push_back(unfinished(*one, {static_cast<Status::Kind>(*said), kInferred, -1, -1}));
      }
  }
  return records;
}

void explore(StudyMap& map, const Store& store, const Session& session,
             const CampaignOptions& options) {
  while (!map.interrupted) {
    std::vector<Case> cases;
    std::vector<std::pair<MapPanel*, MapCell>> asked;
    for (MapPanel& panel : map.panels)
      for (const MapCell& c : panel.found.next()) {
        asked.emplace_back(&panel, c);
        if (const auto& one = map.cell(panel, c)) cases.push_back(*one);
      }
    if (asked.empty()) return;
    const Tally tally = run_cases(cases, store, session, options);
    map.ran += tally.ran;
    map.interrupted = tally.interrupted;
    for (auto& [panel, c] : asked) {
      const auto& one = map.cell(*panel, c);
      const auto record = one ? store.find(*one) : std::nullopt;
      if (one && !record && map.interrupted) continue;
      panel->found.tell(c, record ? static_cast<int>(record->status.kind) : kNoResult);
    }
  }
}

}  // namespace taut
