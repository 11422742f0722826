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

/// A requested picture of a study.
struct FigureRequest {
  PlotSpec spec;
  std::optional<double> slope = {};  ///< exponent of a theory, if the request names one
  /// Whether the figure has a title. Panels of a figure with several always have titles of their
  /// own.
  enum class Title { single, always, none };
  Title title = Title::single;  ///< `single`: only with a single panel
};

/// The pictures that the study's file requests. Throws InputError if there is no picture or a slope
/// is not a number.
std::vector<FigureRequest> figures_of(const Study&);

/// Keeps only the records of these solvers and scenes; an empty list stands for all. Throws
/// InputError if the study has no results for one of them.
void keep_chosen(StudyResult&, const std::vector<std::string>& solvers,
                 const std::vector<std::string>& scenes);

struct StudyFigures {
  std::vector<PlotFiles> files;
  std::vector<std::string> not_drawn;  ///< a sentence for each figure that could not be drawn
};

/// Draws the first study of the input with a panel for each scene. A map has a figure for each
/// scene, with a panel for each solver. Calls `remark` with what a figure leaves out. Throws
/// PlotError and FigureNotWritten.
StudyFigures draw_figures(const std::vector<FigureRequest>&, const ReportInput&, const Store&,
                          const std::filesystem::path& folder,
                          const std::function<void(const std::string&)>& remark);

}  // namespace taut::report
