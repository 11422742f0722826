#pragma once

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <string>
#include <vector>

namespace taut {

/// What printf() writes, at most 500 bytes of it.
[[gnu::format(printf, 1, 2)]] inline std::string formatted(const char* format, ...) {
  char text[501];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

/// Appends what the list does not have yet: each once, in their order of appearance.
template <class T, class Value>
void add_new(std::vector<T>& list, const Value& value) {
  if (std::ranges::find(list, value) == list.end()) list.emplace_back(value);
}

}  // namespace taut
