#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/study/extremes/extreme_settings.hpp"

namespace taut {

/// How far one parameter goes under one solver.
struct ParameterFrontier {
  std::string solver;  ///< "bullet:iterations=4"
  std::string parameter, unit;
  std::string lacks;             ///< why there is nothing below; "": there is
  bool downwards = false;        ///< smaller is harder
  double from = 0, to = 0;       ///< the easiest and the hardest setting asked for
  double good = std::nan("");    ///< hardest setting up to which nothing was wrong; NaN: none
  double bad = std::nan("");     ///< easiest setting found at which something is; NaN: none
  std::string symptom;           ///< what is wrong at `bad`, the gravest first
  std::string at_start;          ///< what is wrong at `from` already, and therefore not counted
  double theory = std::nan("");  ///< where it ends in theory; NaN: not within the range
  std::string law;               ///< of the theory; "": there is none
  CaseSpec beyond;               ///< the case at `bad`
  std::size_t cases = 0, ran = 0;

  /// How many times harder than its start it may be made; NaN: not at all.
  double headroom() const { return downwards ? from / good : good / from; }
};

/// All frontiers of a solver on the standard scene.
struct Extremes {
  std::vector<ParameterFrontier> frontiers;
  bool interrupted = false;
};

/// Every probe is a case of the store, judged by symptoms(). `progress` is told after each of them.
Extremes find_extremes(const std::string& solver, const Store&, const Session&,
                       const CampaignOptions&,
                       const std::function<void(std::size_t done, std::size_t all)>& progress);

/// One JSON text with what this program found: what `taut frontier --all` prints and leaves below
/// kFrontiersFolder for the report.
std::string to_json(const std::vector<ParameterFrontier>&, std::string_view program);
/// Nothing if another program wrote the file. Throws InputError if it is damaged.
std::optional<std::vector<ParameterFrontier>> read_frontiers(const std::filesystem::path& file,
                                                             std::string_view program);

/// Where `taut frontier --all` leaves what it found in a results folder, for the report.
inline constexpr std::string_view kFrontiersFolder = "frontiers";

}  // namespace taut
