#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/render/film/recorded_runs.hpp"

namespace taut {

/// How recorded runs are drawn side by side.
struct Drawing {
  enum class Kind {
    stills,  ///< a picture for each moment
    sheet,   ///< one picture, a row for each moment
    video    ///< H.264 in real time
  };
  Kind kind = Kind::stills;
  std::vector<double> times;                ///< s, ascending; of stills and sheets, at least one
  std::optional<std::pair<int, int>> size;  ///< pixels, of a picture; of a panel of a sheet
  std::optional<RenderQuality> quality;
  View view;
  ColourBy colour_by = ColourBy::strain;
  double range = 0;  ///< end of the colour bar, in the unit that it shows; 0: chosen from the runs
  bool dark = false;
};

struct Drawn {
  std::vector<std::string> files;
  std::string
      no_video;  ///< why a picture of the end stands in the place of a video; "": it does not
};

/// Draws into `file`, whose name gets the time where there are stills of several moments:
/// ball-t0.50.png. `progress` counts stills or frames.
Drawn draw(const RunSet&, const Drawing&, const std::filesystem::path& file,
           const std::function<void(std::size_t done, std::size_t all)>& progress);

}  // namespace taut
