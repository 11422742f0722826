#pragma once

#include <string>
#include <vector>

namespace taut {

/// Request of `taut report`.
struct PageRequest {
  /// Studies; none: those of the main job. If the first two are results folders, the page shows
  /// what differs between them.
  std::vector<std::string> studies;
  std::vector<std::string> films;  ///< scenes to film that no study ran
  std::string preset, results;
  std::string output;  ///< file for which the text is meant; "": none
  bool media = true;   ///< whether to include pictures and videos
  /// Whether to return the model of the page instead, without pictures and videos.
  bool model = false;
};

struct Page {
  std::string text;                       ///< HTML, or the model
  std::vector<std::string> in_few_lines;  ///< its answer in a few lines, for a terminal
};

/// Makes the page of stored results. Throws InputError; if the output cannot be written, before
/// anything is done.
Page make_page(const PageRequest&);

}  // namespace taut
