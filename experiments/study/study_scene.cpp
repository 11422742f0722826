// A scene of a study, "drape:cloth.span=0.7": its text, its place in the file, and its errors.
#include <algorithm>
#include <set>

#include "core/io/scene_io.hpp"
#include "experiments/study/study_reading.hpp"
#include "experiments/system/data.hpp"

namespace taut {

StudyScene parse_study_scene(const std::string& text) {
  const auto colon = text.find(':');
  StudyScene scene{text.substr(0, colon), {}};
  if (colon == text.npos) return scene;
  const auto wrong = [&](const std::string& what) {
    throw InputError("scene '" + scene.name + "': " + what);
  };
  for (const ParamItem& item : param_items(std::string_view(text).substr(colon + 1))) {
    if (!item.problem.empty()) wrong(item.problem);
    const SceneSetting one(item.key, item.value);
    if (find_setting(scene.settings, one.key())) wrong("'" + one.key() + "' is given twice");
    scene.settings.push_back(one);
  }
  if (scene.settings.empty()) wrong("key=value is missing after the colon");
  return scene;
}

Diagnostic placed(const Study& study, const std::string& scene, const Diagnostic& d) {
  const bool own =
      std::ranges::count(parse_study_scene(scene).settings, d.file, &SceneSetting::text) > 0;
  const auto& places = own ? study.scene_places : study.places;
  const auto at = places.find(own ? scene : d.file);
  if (at == places.end()) return d;
  return {study.file.string(), at->second.line, at->second.column, d.file + ": " + d.message};
}

void judge_scenes(const Study& study, Diagnostics& diagnostics) {
  std::vector<SceneSettings> variants(1);
  for (const StudyAxis& axis : study.axes)
    for (const std::string& value : axis.values)
      if (axis.of_scene()) variants.push_back({SceneSetting(axis.name, value)});
  std::set<std::string> said;
  for (const std::string& scene : study.scenes)
    for (const SceneSettings& of_axis : variants) try {
        const StudyScene own = parse_study_scene(scene);
        SceneSettings settings = study.settings;
        settings.insert(settings.end(), own.settings.begin(), own.settings.end());
        settings.insert(settings.end(), of_axis.begin(), of_axis.end());
        load_scene(find_scene(own.name), settings);
      } catch (const InputError& error) {
        for (const Diagnostic& d : error.diagnostics())
          if (said.insert(d.text()).second && !d.file.empty())
            diagnostics.report({placed(study, scene, d)});
      }
}

}  // namespace taut
