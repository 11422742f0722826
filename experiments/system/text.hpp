#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace taut {

/// Text formatted as by printf(), cut to 500 bytes.
[[gnu::format(printf, 1, 2)]] inline std::string formatted(const char* format, ...) {
  char text[501];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

}  // namespace taut
