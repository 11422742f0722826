#pragma once

#include <string>

namespace taut {

/// Bytes from hexadecimal digits; blanks are ignored.
inline std::string bytes(const std::string& digits) {
  std::string all, pair;
  for (const char c : digits) {
    if (c == ' ') continue;
    pair += c;
    if (pair.size() == 2) {
      all += static_cast<char>(std::stoi(pair, nullptr, 16));
      pair.clear();
    }
  }
  return all;
}

}  // namespace taut
