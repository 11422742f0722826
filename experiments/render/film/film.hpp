#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/report/input.hpp"

namespace taut {

/// A scene that no study ran.
struct OtherScene {
  std::string name;    ///< or path
  bool still = false;  ///< its poster is enough
};

/// Adds videos and posters of every scene of a report to it: each contender under
/// the settings at which single cases are quoted, side by side in the order of the report, beside
/// the reason of whoever refuses the scene. `others` are scenes that no study ran:
/// they get smaller films or pictures of their own and, from the same runs, strain over time. Two
/// scenes at a time. A film is kept in `folder` under a key of all that it depends on, and made
/// once. `say` is told, from any thread but one at a time, which scene was made. A scene that
/// cannot be drawn is left out and `say` is told why; so it is with all of them where there is no
/// renderer. Throws InputError if one of the others is no scene.
void film_scenes(report::ReportInput&, const std::vector<OtherScene>& others,
                 const std::filesystem::path& folder,
                 const std::function<void(const std::string&)>& say);

}  // namespace taut
