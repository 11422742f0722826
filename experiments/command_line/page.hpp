#pragma once

#include <string>
#include <vector>

namespace taut {

/// What `taut report` writes.
struct PageRequest {
  /// None: the main job. The first two may be results folders: what differs between them.
  std::vector<std::string> studies;
  std::vector<std::string> films;  ///< scenes to film that no study ran
  std::string preset, results;
  std::string output;  ///< file that the text is for; "": none
  bool media = true;   ///< with pictures and videos
  bool model = false;  ///< the model of the page instead, without them
};

struct Page {
  std::string text;                       ///< HTML, or the model
  std::vector<std::string> in_few_lines;  ///< its answer, for a terminal
};

/// The page of stored results. Throws InputError, of an output that cannot be written before
/// anything is done.
Page make_page(const PageRequest&);

}  // namespace taut
