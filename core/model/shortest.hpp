#pragma once

#include <charconv>
#include <string>

namespace taut {

/// The shortest text that reads back as the same number.
inline std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

}  // namespace taut
