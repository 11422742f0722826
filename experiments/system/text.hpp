#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace taut {

/// Text formatted as by printf(), cut to 500 bytes. For whole numbers and words: of a real it would
/// use the locale's decimal point, so core/model/text.hpp has other functions for reals.
[[gnu::format(printf, 1, 2)]] inline std::string formatted(const char* format, ...) {
  char text[501];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

}  // namespace taut
