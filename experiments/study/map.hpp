#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/study/campaign.hpp"
#include "experiments/study/refinement.hpp"

namespace taut {

/// A scene under a solver over both sweeps of a study.
struct MapPanel {
  std::string scene, solver;
  std::vector<std::optional<Case>> cells;  ///< [columns x rows], row by row; empty: left out
  Refinement found;                        ///< classes are Status::Kind
};

struct StudyMap {
  Sweep x, y;
  std::vector<MapPanel> panels;
  std::size_t ran = 0;  ///< cases that were not stored yet
  bool interrupted = false;

  std::size_t dense() const;  ///< cases of the full grids
  std::size_t known() const;  ///< of which these have a result
  const std::optional<Case>& cell(const MapPanel& panel, const MapCell& c) const {
    return panel.cells[c.y * x.values.size() + c.x];
  }
};

/// Names of the shipped studies that are maps ("map-..."), sorted.
std::vector<std::string> shipped_maps();

/// Nothing is run yet. Throws InputError if the study has not exactly two sweeps.
StudyMap map_of(const Study&);

/// Runs the cells that refinement asks for, all panels at once; the others stay without a record.
void explore(StudyMap&, const Store&, const Session&, const CampaignOptions&);

/// The cells of a finished map that were not run, with the outcome that their blocks say; reason
/// kInferred. Empty if the study is no map; a panel that the store does not have yet gives none.
std::vector<Record> inferred_records(const Study&, const Store&);
inline constexpr const char* kInferred = "not run: its neighbours say so";

}  // namespace taut
