#include "experiments/system/data.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "core/model/input_error.hpp"

namespace taut {

namespace fs = std::filesystem;

fs::path this_program() { return fs::read_symlink("/proc/self/exe"); }

fs::path sibling_program(const std::string& name) {
  return name.empty() ? this_program() : this_program().parent_path() / name;
}

namespace {
fs::path g_data_folder;
}

void set_data_folder(fs::path folder) { g_data_folder = std::move(folder); }

fs::path data_folder() {
  if (const char* given = std::getenv("TAUT_DATA"); given && *given) {
    if (!fs::is_directory(given))
      throw InputError("TAUT_DATA is '" + std::string(given) + "', which is no folder");
    return given;
  }
  if (!g_data_folder.empty()) return g_data_folder;
  const fs::path installed = this_program().parent_path().parent_path() / TAUT_INSTALLED_DATA;
  return fs::is_directory(installed) ? installed : fs::path(TAUT_SOURCE_DATA);
}

fs::path references_folder() {
  const fs::path installed = data_folder() / "references";
  return fs::is_directory(installed) ? installed
                                     : data_folder().parent_path() / "results" / "references";
}

fs::path results_folder() {
  const char* given = std::getenv("TAUT_RESULTS");
  return given && *given ? given : "results";
}

fs::path baselines_folder() {
  const fs::path own = results_folder() / "baselines",
                 shared = references_folder().parent_path() / "baselines";
  const bool moved = results_folder() != "results" && !fs::is_directory(own);
  return moved && fs::is_directory(shared) ? shared : own;
}

std::vector<std::string> shipped(const std::string& kind) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(data_folder() / kind, none))
    if (file.path().extension() == ".toml") names.push_back(file.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

/// Whether it is a shipped file in a subfolder, such as "torture/wind".
bool is_shipped_below(const std::string& kind, const std::string& text) {
  return text.find('/') != std::string::npos && text.find("..") == std::string::npos &&
         fs::is_regular_file(data_folder() / kind / (text + ".toml"));
}

bool is_path(const std::string& text) {
  return text.find('/') != std::string::npos || text.ends_with(".toml");
}

fs::path find_file(const std::string& kind, const std::string& one, const std::string& text) {
  if (is_shipped_below(kind, text)) return data_folder() / kind / (text + ".toml");
  if (is_path(text)) {
    if (fs::is_directory(text)) throw InputError(text + " is a folder, not a " + one + " file");
    if (!fs::is_regular_file(text)) {
      const bool from_here = fs::path(text).is_relative();
      throw InputError(text + ": no such " + one + " file" +
                       (from_here ? ", seen from " + fs::current_path().string() : ""));
    }
    return text;
  }
  if (const std::size_t colon = text.find(':'); kind == "scenes" && colon != text.npos)
    throw InputError("unknown scene '" + text + "'; settings of a scene stand alone: " +
                     text.substr(0, colon) + " --set " + text.substr(colon + 1));
  const std::vector<std::string> names = shipped(kind);
  if (std::find(names.begin(), names.end(), text) == names.end())
    throw InputError("unknown " + one + " '" + text + "'" + suggestion(text, names) +
                     " (`taut list " + kind + "` names all; a path has a '/' or ends in .toml)");
  return data_folder() / kind / (text + ".toml");
}

}  // namespace

fs::path find_scene(const std::string& text) { return find_file("scenes", "scene", text); }
fs::path find_study(const std::string& text) { return find_file("studies", "study", text); }

std::string scene_seen_from(const fs::path& file, const std::string& text) {
  if (!is_path(text) || fs::path(text).is_absolute() || is_shipped_below("scenes", text) ||
      !file.has_parent_path() || file.parent_path() == ".")
    return text;
  return (file.parent_path() / text).lexically_normal();
}

}  // namespace taut
