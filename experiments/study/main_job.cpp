#include "experiments/study/main_job.hpp"

#include "core/io/document.hpp"
#include "experiments/system/data.hpp"

namespace taut {

MainJob main_job() {
  const Document document = read_document(data_folder() / "main-job.toml", {});
  Diagnostics diagnostics(document);
  Section section(diagnostics, document.root, "the main job");
  section.need({"preset", "studies", "maps", "bench"});
  const auto text = [&](const char* key) { return section.string(key).value_or(""); };
  const auto names = [&](const char* key) {
    return section.strings(key).value_or(std::vector<std::string>());
  };
  MainJob job{text("preset"), names("studies"), names("maps"), text("bench"), names("steps")};
  section.finish();
  diagnostics.throw_if_any();
  return job;
}

std::vector<std::string> MainJob::studies_to_run() const {
  std::vector<std::string> all = studies;
  all.insert(all.end(), maps.begin(), maps.end());
  return all;
}

}  // namespace taut
