#pragma once

#include <compare>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// "key=value" that replaces a value of the scene's file: a dotted key and a value in TOML, such as
/// cloth.grid=[16, 16] or time.dt="1/120". A text without "=" is a key without a value; whoever
/// reads the scene refuses it (core/io/document.hpp).
class SceneSetting {
 public:
  SceneSetting(std::string text);
  SceneSetting(const char* text) : SceneSetting(std::string(text)) {}
  explicit SceneSetting(const std::string& key, const std::string& value)
      : SceneSetting(key + "=" + value) {}

  const std::string& written() const { return written_; }  ///< as the user typed it
  const std::string& text() const { return text_; }        ///< "key=value"
  const std::string& key() const { return key_; }          ///< without blanks and quotes
  const std::string& value() const { return value_; }      ///< without blanks around it
  bool is_of_time() const { return key_.starts_with("time."); }

  /// Two that differ in blanks alone are equal.
  bool operator==(const SceneSetting& other) const { return text_ == other.text_; }
  auto operator<=>(const SceneSetting& other) const { return text_ <=> other.text_; }

 private:
  std::string written_, text_, key_, value_;
};

/// Whether a setting of this name is a scene's, and no parameter of a solver: it has a dot, or it
/// is the fabric.
bool is_of_scene(std::string_view name);

/// Settings of a scene in the order in which they are applied.
using SceneSettings = std::vector<SceneSetting>;

SceneSettings scene_settings(const std::vector<std::string>& texts);

/// The last setting with this key, which is the one that applies; nullptr if none has it.
const SceneSetting* find_setting(const SceneSettings&, std::string_view key);
/// The settings without those of this key.
SceneSettings without(SceneSettings, std::string_view key);
/// The settings with `more`, each in place of those of the same key.
SceneSettings replaced(SceneSettings, const SceneSettings& more);

}  // namespace taut
