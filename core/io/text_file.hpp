#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace taut {

/// Most that a file of each kind may have [bytes].
inline constexpr std::size_t kMostSceneBytes = std::size_t{16} << 20;
inline constexpr std::size_t kMostMeshBytes = std::size_t{1} << 30;
inline constexpr std::size_t kMostResultBytes = std::size_t{1} << 30;

/// Everything in a regular file. Throws InputError that names it: it cannot be read, is no regular
/// file (a folder, a pipe, a device; none is waited for) or is larger than `most` bytes.
std::string read_text(const std::filesystem::path&, std::size_t most = kMostResultBytes);

/// For those who read a regular file by parts. Throws InputError as read_text().
std::ifstream open_file(const std::filesystem::path&);

/// Throws InputError: what is wrong with a file, and where in it (1-based; 0: nowhere).
[[noreturn]] void fail_in(const std::filesystem::path&, const std::string& why, int line = 0,
                          int column = 0);

/// The words of a line, apart by blanks; without what follows `comment`.
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

/// The number that a whole word is, "nan" and "inf" included; nothing if it is not one.
template <class T>
std::optional<T> whole(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Takes the first line off a text, without its line feed.
inline std::string_view take_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace taut
