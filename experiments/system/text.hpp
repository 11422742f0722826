#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

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

}  // namespace taut
