#pragma once

#include <string>

#include "experiments/report/section.hpp"

namespace taut::report {

/// The film of a scene, its colour bar and controls, with strain over time below: the playhead
/// follows the film and scrubs it. Without pictures a line says which command makes them; "" if
/// there is neither film nor curve. `half`: as wide as half the page.
std::string scene_player(Page&, const std::string& scene, bool half = false);

}  // namespace taut::report
