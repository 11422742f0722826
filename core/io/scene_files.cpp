#include "core/io/scene_files.hpp"

#include "core/model/scene_keys.hpp"

namespace taut {

std::vector<Value*> file_names(Value& root) {
  std::vector<Value*> found;
  const auto look = [&](const SceneKey& key, Value& table) {
    for (std::size_t i = 0; i < table.keys.size(); ++i)
      if (table.keys[i].text == key.name() && table.items[i].is_string())
        found.push_back(&table.items[i]);
  };
  for (const SceneKey& key : scene_keys()) {
    if (key.type != "file") continue;
    for (std::size_t i = 0; i < root.keys.size(); ++i) {
      if (root.keys[i].text != key.section()) continue;
      Value& section = root.items[i];
      if (section.is_table()) look(key, section);
      if (!section.is_array()) continue;
      for (Value& table : section.items) look(key, table);
    }
  }
  return found;
}

}  // namespace taut
