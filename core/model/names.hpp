#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace taut {

/// Names of the values of an enumeration, in its order. It compiles only with one text for each
/// value up to `last`.
template <auto last>
class Names {
 public:
  using Enumeration = decltype(last);

  template <class... Texts>
  consteval Names(Texts... texts) : all_{texts...} {
    static_assert(sizeof...(texts) == kCount, "one text for each value");
  }
  constexpr std::string_view operator[](Enumeration value) const {
    return all_[static_cast<std::size_t>(value)];
  }
  /// The value of that name; nothing if no value has it.
  constexpr std::optional<Enumeration> find(std::string_view name) const {
    const auto at = std::ranges::find(all_, name);
    if (at == all_.end()) return {};
    return static_cast<Enumeration>(at - all_.begin());
  }

 private:
  static constexpr std::size_t kCount = static_cast<std::size_t>(last) + 1;
  std::array<std::string_view, kCount> all_;
};

}  // namespace taut
