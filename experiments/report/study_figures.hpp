#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/report/input.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"

namespace taut::report {

/// A picture of a study.
struct FigureRequest {
  PlotSpec spec;
  std::optional<double> slope = {};  ///< exponent of a theory that it names
  /// Several panels have titles of their own.
  enum class Title { single, always, none };
  Title title = Title::single;  ///< above a figure of a single panel, or of any
};

/// The pictures that the study's file asks for. Throws InputError: none, or a slope that is no
/// number.
std::vector<FigureRequest> figures_of(const Study&);

/// Leaves only the records of these solvers and scenes; none named: of all. Throws InputError: the
/// study has no results of one.
void keep_chosen(StudyResult&, const std::vector<std::string>& solvers,
                 const std::vector<std::string>& scenes);

struct StudyFigures {
  std::vector<PlotFiles> files;
  std::vector<std::string> not_drawn;  ///< a sentence for each figure that could not be drawn
};

/// Draws the first study of the input, panels by scene; of a map, whose panels are by solver, a
/// figure for each scene. Calls `remark` with what a figure leaves out. Throws PlotError and
/// FigureNotWritten.
StudyFigures draw_figures(const std::vector<FigureRequest>&, const ReportInput&, const Store&,
                          const std::filesystem::path& folder,
                          const std::function<void(const std::string&)>& remark);

}  // namespace taut::report
