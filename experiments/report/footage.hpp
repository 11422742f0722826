#pragma once

#include <string>
#include <utility>
#include <vector>

namespace taut::report {

/// A colour bar to be drawn beside a film.
struct ColourBar {
  std::string title;
  std::vector<std::string> stops;                     ///< colours, evenly spaced: "#0B6BCB"
  std::vector<std::pair<double, std::string>> ticks;  ///< place, 0 to 1, and text
};

/// A picture or video of a scene, held as bytes so that the report stays one file.
struct Footage {
  std::string type;         ///< "video/mp4", "image/jpeg" or "image/png"
  std::string bytes;        ///< the file; "": there is no file
  std::string poster;       ///< picture shown before a video plays and in print; may be empty
  std::string poster_type;  ///< "image/jpeg" or "image/png"
  std::string alt;          ///< description for readers who cannot see it
  int columns = 1;          ///< panels side by side
  double duration = 0;      ///< s of simulated time that a video covers
  double speed = 1;         ///< simulated seconds per second of video
  double frame = 1.0 / 30;  ///< s of simulated time between two frames
  double poster_t = 0;      ///< s of simulated time that the poster shows
  ColourBar bar = {};       ///< without stops: none
};

}  // namespace taut::report
