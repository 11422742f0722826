#include "experiments/baseline/assertion_baseline.hpp"

#include "experiments/system/files.hpp"

namespace taut {

std::filesystem::path assertion_baseline(const std::filesystem::path& folder) {
  return folder / "assertions.json";
}

void keep_assertions(const Answer& answer, const std::filesystem::path& file) {
  Answer kept{"verify", "assertions"};
  kept.add(answer.table("assertions"));
  make_folder(file.parent_path());
  write_durably(file, to_json(kept));
}

std::optional<std::vector<Difference>> changes_of_assertions(const Answer& answer,
                                                             const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  return differences(answer_from_json(read_text(file), file.string()).table("assertions"),
                     answer.table("assertions"), {"source", "assertion"}, {"verdict"});
}

}  // namespace taut
