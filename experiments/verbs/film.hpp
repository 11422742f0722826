#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/report/input.hpp"

namespace taut {

/// Videos, posters and material space of every scene of a report: each contender under the settings
/// at which single cases are quoted, side by side in the order of the report. Two scenes at a time.
/// `say` is told, from any thread but one at a time, which scene is done. A scene that cannot be
/// drawn is left out and `say` is told why; so it is with all of them where there is no renderer.
std::vector<report::SceneMedia> film_scenes(const report::ReportInput&,
                                            const std::function<void(const std::string&)>& say);

}  // namespace taut
