#pragma once

#include <string_view>
#include <vector>

#include "core/io/text_file.hpp"

namespace taut {

/// A word of an OBJ file and its position (1-based).
struct ObjWord {
  std::string_view text;
  int line = 0, column = 0;
};

/// The lines of an OBJ file. A `\` at the end of a line continues it in the next; a byte order mark
/// before the first word is skipped.
class ObjLines {
 public:
  explicit ObjLines(std::string_view text) : rest_(without_mark(text)) {}

  /// Reads the words of the next line, which may be empty. Returns false at the end of the file.
  bool next(std::vector<ObjWord>& words) {
    words.clear();
    if (rest_.empty()) return false;
    for (bool more = true; more && !rest_.empty();) more = add_line(words);
    return true;
  }

 private:
  static std::string_view without_mark(std::string_view text) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
    return text;
  }

  /// Adds the words of a line. Returns whether the next line continues it.
  bool add_line(std::vector<ObjWord>& words) {
    const std::string_view line = take_line(rest_);
    ++line_;
    std::vector<std::string_view> all = words_of(line);
    const bool more = !all.empty() && all.back().ends_with('\\');
    if (more) all.back().remove_suffix(1);
    for (const std::string_view word : all)
      if (!word.empty())
        words.push_back({word, line_, static_cast<int>(word.data() - line.data()) + 1});
    return more;
  }

  std::string_view rest_;
  int line_ = 0;
};

}  // namespace taut
