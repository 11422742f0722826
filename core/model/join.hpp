#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace taut {

/// The texts of all, one after the other; text_of(one) is what one of them says.
template <class All, class TextOf = std::identity>
std::string join(const All& all, std::string_view separator, const TextOf& text_of = {}) {
  std::string joined;
  bool first = true;
  for (const auto& one : all) {
    if (!first) joined += separator;
    joined += std::invoke(text_of, one);
    first = false;
  }
  return joined;
}

}  // namespace taut
