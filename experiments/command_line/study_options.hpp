#pragma once

#include <string>
#include <vector>

#include "experiments/baseline/baseline_study.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"

namespace taut {

/// Options with the functions that run cases, print news and name values.
BaselineOptions baseline_options();

/// Options of all verbs about baselines: --baselines, --out, -j, and baseline_options().
void add_baseline_options(Arguments&, BaselineOptions&);

/// load_study(), which also throws InputError if a figure that the study requests cannot be drawn.
Study load_study_to_plot(const std::string& name_or_path, const std::string& preset);
/// load_study_to_plot() for several studies, each with these time steps (at_time_steps()).
std::vector<Study> load_studies_to_plot(const std::vector<std::string>& names_or_paths,
                                        const std::string& preset,
                                        const std::vector<std::string>& steps);
/// The cases of each study.
std::vector<StudyCases> cases_of_each(const std::vector<Study>&);

/// Hint at presets of a study whose cases are all stored: "; preset quick has all of its results:
/// --preset quick"; "" if there is no such preset.
std::string where_else(const Study&, const Store&);
/// The study as words of a command: "iterations --preset quick".
std::string study_words(const Study&);

}  // namespace taut
