#include "experiments/case/key.hpp"

#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/json.hpp"

namespace taut {

std::string case_key(const Scene& scene, const std::string& scene_digest,
                     const SolverChoice& choice) {
  const std::string_view own = choice.entry->implementation;
  const Json parts{{"schema", kRecordSchema},
                   {"scene", scene_digest},
                   {"solver", choice.canonical()},
                   {"implementation", own.empty() ? implementation(choice.entry->name) : own},
                   {"measurement", measurement()},
                   {"dt", scene.dt},
                   {"steps", scene.steps}};
  return sha256(to_text(parts));
}

std::string program_digest() {
  std::string text(measurement());
  for (const SolverEntry* entry : solvers())
    text += std::string(entry->name) + ":" + std::string(implementation(entry->name)) + "\n";
  return sha256(text);
}

}  // namespace taut
