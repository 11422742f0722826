#include "experiments/case/question.hpp"

#include <algorithm>

#include "core/model/text.hpp"

namespace taut {

Question question_of(const Record& r) {
  Question question{r.scene, r.spec.overrides, r.dt};
  std::erase_if(question.overrides, [](const auto& text) { return text.starts_with("time.dt="); });
  std::ranges::sort(question.overrides);
  return question;
}

std::string title_among(const Question& question, const std::set<Question>& asked) {
  std::vector<std::string> own;
  for (const std::string& setting : question.overrides)
    if (std::ranges::any_of(asked, [&](const Question& other) {
          return other.scene == question.scene &&
                 std::ranges::find(other.overrides, setting) == other.overrides.end();
        }))
      own.push_back(setting);
  return question.scene + (own.empty() ? "" : " (" + join(own, ", ") + ")");
}

}  // namespace taut
