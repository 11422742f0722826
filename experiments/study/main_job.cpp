#include "experiments/study/main_job.hpp"

#include "core/io/section.hpp"
#include "experiments/system/data.hpp"

namespace taut {

MainJob main_job() {
  const Document document = read_document(data_folder() / "main-job.toml", {});
  Diagnostics diagnostics(document);
  Section section(diagnostics, document.root, "the main job");
  const auto names = [&](const char* key) {
    std::vector<std::string> all;
    const Value* list = section.find(key);
    if (!list || !list->is_array()) return section.missing(key), all;
    for (const Value& item : list->items)
      if (item.is_string())
        all.push_back(item.string);
      else
        diagnostics.report(item.place, "expected the name of a study");
    return all;
  };
  const auto text = [&](const char* key) {
    const auto value = section.string(key);
    if (!value) section.missing(key);
    return value.value_or("");
  };
  MainJob job{text("preset"), names("studies"), names("maps"), text("bench")};
  section.finish();
  diagnostics.throw_if_any();
  return job;
}

}  // namespace taut
