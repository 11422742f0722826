#include "experiments/study/missing.hpp"

#include <algorithm>

#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace fs = std::filesystem;

void mark_missing(const fs::path& root, const std::string& name,
                  const std::vector<ManifestEntry>& entries) {
  make_folder(root / "missing");
  std::string lines;
  for (const ManifestEntry& one : entries) lines += to_text(one) + '\n';
  write_durably(root / "missing" / (name + ".jsonl"), lines);
}

std::string Missing::sentence() const {
  constexpr std::size_t kShown = 10;
  std::string text = "merged although " + std::to_string(cases) + " planned cases were missing; " +
                     std::to_string(ids.size()) + " still are: ";
  for (std::size_t i = 0; i < std::min(kShown, ids.size()); ++i) text += (i ? ", " : "") + ids[i];
  return text + (ids.size() > kShown ? ", ..." : "");
}

std::vector<Missing> still_missing(const Store& store) {
  std::vector<Missing> all;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(store.root() / "missing", none)) {
    if (file.path().extension() != ".jsonl") continue;
    Missing one{file.path(), {}, 0};
    for (const ManifestEntry& entry : read_manifest_lines(file.path())) {
      ++one.cases;
      if (!store.find(entry.key)) one.ids.push_back(entry.id);
    }
    if (!one.ids.empty()) all.push_back(std::move(one));
  }
  std::ranges::sort(all, {}, &Missing::file);
  return all;
}

}  // namespace taut
