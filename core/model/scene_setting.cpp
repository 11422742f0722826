#include "core/model/scene_setting.hpp"

#include <algorithm>
#include <utility>

namespace taut {

SceneSetting::SceneSetting(std::string text) : written_(std::move(text)), text_(written_) {
  const std::size_t equals = written_.find('=');
  key_ = written_.substr(0, equals);
  std::erase_if(key_, [](char c) { return c == ' ' || c == '\t' || c == '"' || c == '\''; });
  if (equals == written_.npos) return;
  const std::size_t first = written_.find_first_not_of(" \t", equals + 1);
  if (first != written_.npos)
    value_ = written_.substr(first, written_.find_last_not_of(" \t") + 1 - first);
  text_ = key_ + "=" + value_;
}

bool is_of_scene(std::string_view name) { return name == "fabric" || name.find('.') != name.npos; }

SceneSettings scene_settings(const std::vector<std::string>& texts) {
  return {texts.begin(), texts.end()};
}

const SceneSetting* find_setting(const SceneSettings& settings, std::string_view key) {
  const SceneSetting* last = nullptr;
  for (const SceneSetting& one : settings)
    if (one.key() == key) last = &one;
  return last;
}

SceneSettings without(SceneSettings settings, std::string_view key) {
  std::erase_if(settings, [&](const SceneSetting& one) { return one.key() == key; });
  return settings;
}

SceneSettings replaced(SceneSettings settings, const SceneSettings& more) {
  for (const SceneSetting& one : more) {
    settings = without(std::move(settings), one.key());
    settings.push_back(one);
  }
  return settings;
}

}  // namespace taut
