#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/text.hpp"

namespace taut {

/// Largest size of a file of each kind [bytes].
inline constexpr std::size_t kMostSceneBytes = std::size_t{16} << 20;
inline constexpr std::size_t kMostMeshBytes = std::size_t{1} << 30;
inline constexpr std::size_t kMostResultBytes = std::size_t{1} << 30;

/// The contents of a regular file. Throws InputError that names the file if it cannot be read, is
/// not a regular file (a folder, a pipe, a device; there is no waiting for one) or is larger than
/// `most` bytes.
std::string read_text(const std::filesystem::path&, std::size_t most = kMostResultBytes);

/// Opens a regular file for reading in parts. Throws InputError like read_text().
std::ifstream open_file(const std::filesystem::path&);

/// Throws InputError with what is wrong with a file, and where in it (1-based; 0: unknown).
[[noreturn]] void fail_in(const std::filesystem::path&, const std::string& why, int line = 0,
                          int column = 0);

/// The words of a line, separated by blanks, without what follows `comment`.
inline std::vector<std::string_view> words_of(std::string_view line, char comment = '#') {
  constexpr std::string_view kBlank = " \t\r\f\v";
  line = line.substr(0, line.find(comment));
  std::vector<std::string_view> words;
  for (auto begin = line.find_first_not_of(kBlank); begin != line.npos;) {
    const auto end = std::min(line.find_first_of(kBlank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlank, end);
  }
  return words;
}

/// Removes the first line from a text and returns it without its line feed.
inline std::string_view take_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace taut
