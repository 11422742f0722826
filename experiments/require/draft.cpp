#include "experiments/require/draft.hpp"

#include <algorithm>

#include "core/io/fabrics.hpp"
#include "core/io/scene_files.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

Value& slot(Value& table, const std::string& key) {
  for (std::size_t i = 0; i < table.keys.size(); ++i)
    if (table.keys[i].text == key) return table.items[i];
  table.keys.push_back({key, {}});
  return table.items.emplace_back();
}

void erase_key(Value& table, const std::string& key) {
  for (std::size_t i = 0; i < table.keys.size(); ++i)
    if (table.keys[i].text == key) {
      table.keys.erase(table.keys.begin() + static_cast<std::ptrdiff_t>(i));
      table.items.erase(table.items.begin() + static_cast<std::ptrdiff_t>(i));
      return;
    }
}

/// Removes the tables of arrays that were emptied.
Value without_empty(Value root) {
  for (std::size_t i = root.items.size(); i-- > 0;) {
    Value& one = root.items[i];
    if (!one.is_array() || one.items.empty()) continue;
    std::erase_if(one.items, [](const Value& v) { return v.is_table() && v.keys.empty(); });
    if (one.items.empty()) erase_key(root, root.keys[i].text);
  }
  return root;
}

}  // namespace

Draft::Draft(const CaseSpec& spec)
    : spec_(spec), file_(find_scene(spec.scene)), scene_(read_document(file_, spec.settings)) {
  unfold_fabric();
  scene_changed_ = false;
}

void Draft::unfold_fabric() {
  const Value* name = scene_.root.find("fabric");
  std::string problem;
  const Fabric* fabric = name ? find_fabric(name->string, problem) : nullptr;
  if (!fabric) return;
  remove("cloth", "mass");
  set("cloth", "area_density", shortest(fabric->mass));
  set("bending", "stiffness",
      "{ warp = " + shortest(fabric->warp) + ", weft = " + shortest(fabric->weft) + " }");
  remove("fabric");
}

Value& Draft::section(const std::string& name) {
  scene_changed_ = true;
  return slot(scene_.root, name);
}

void Draft::set(const std::string& name, const std::string& key, const std::string& toml) {
  set(name, key, toml_value(toml));
}

void Draft::set(const std::string& name, const std::string& key, Value value) {
  slot(section(name), key) = std::move(value);
}

void Draft::remove(const std::string& name) {
  scene_changed_ = true;
  erase_key(scene_.root, name);
}

void Draft::remove(const std::string& name, const std::string& key) {
  if (std::vector<Value>* all = tables(name))
    for (Value& table : *all) erase_key(table, key);
  else if (find(name, key))
    erase_key(section(name), key);
}

std::vector<Value>* Draft::tables(const std::string& name) {
  const Value* found = scene_.root.find(name);
  return found && found->is_array() ? &section(name).items : nullptr;
}

const Value* Draft::find(const std::string& name, const std::string& key) const {
  const Value* found = scene_.root.find(name);
  return found ? found->find(key) : nullptr;
}

void Draft::set_parameter(const std::string& name, const std::string& value) {
  changed_[name] = value;
}

CaseSpec Draft::write(const fs::path& folder, const std::string& name,
                      const std::string& comment) const {
  SolverChoice choice = parse_solver(spec_.solver);
  for (const auto& [parameter, value] : changed_) choice = choice.with(parameter, value);
  const std::string solver = choice.canonical();
  if (!scene_changed_ && comment.empty()) return {spec_.scene, spec_.settings, solver};
  Value root = without_empty(scene_.root);
  for (Value* value : file_names(root)) {
    const fs::path there = fs::absolute(file_.parent_path() / value->string);
    value->string = fs::proximate(there, fs::absolute(folder)).string();
  }
  make_folder(folder);
  const fs::path file = folder / (name + ".toml");
  write_durably(file, comment + to_toml(root));
  return {file.string(), {}, solver};
}

Value toml_value(const std::string& toml) {
  return parse_document("a value", "value = " + toml, {}).root.items.front();
}

}  // namespace taut
