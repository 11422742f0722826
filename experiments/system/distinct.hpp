#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace taut {

/// The different values of key(item), in order of appearance.
template <class Range, class Key = std::identity>
auto distinct(const Range& range, const Key& key = {}) {
  std::vector<std::decay_t<decltype(std::invoke(key, *std::begin(range)))>> keys;
  for (const auto& item : range)
    if (const auto& one = std::invoke(key, item); std::ranges::find(keys, one) == keys.end())
      keys.push_back(one);
  return keys;
}

/// The values grouped under `name`; adds an empty group if there is no such group. Groups stay in
/// order of appearance.
template <class Value>
std::vector<Value>& group_of(std::vector<std::pair<std::string, std::vector<Value>>>& groups,
                             const std::string& name) {
  auto at = std::ranges::find(groups, name, &std::pair<std::string, std::vector<Value>>::first);
  if (at == groups.end()) at = groups.insert(at, {name, {}});
  return at->second;
}

/// Appends the value unless the list already contains it.
template <class T, class Value>
void push_unique(std::vector<T>& list, const Value& value) {
  if (std::ranges::find(list, value) == list.end()) list.emplace_back(value);
}

}  // namespace taut
