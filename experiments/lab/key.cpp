#include "experiments/lab/key.hpp"

#include "experiments/lab/digest.hpp"
#include "experiments/lab/fingerprint.hpp"
#include "experiments/lab/json.hpp"
#include "experiments/lab/record_io.hpp"

namespace taut {

std::string case_key(const Scene& scene, const std::string& scene_digest,
                     const SolverChoice& choice) {
  const Json parts{
      {"schema", kRecordSchema},      {"scene", scene_digest},
      {"solver", choice.canonical()}, {"implementation", implementation(choice.entry->name)},
      {"measurement", measurement()}, {"dt", scene.dt},
      {"steps", scene.steps}};
  return sha256(to_text(parts));
}

}  // namespace taut
