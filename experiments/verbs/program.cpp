#include "experiments/verbs/program.hpp"

#include "core/model/solver.hpp"
#include "experiments/lab/digest.hpp"
#include "experiments/lab/fingerprint.hpp"

namespace taut {

std::string program_digest() {
  std::string text(measurement());
  for (const SolverEntry* entry : solvers())
    text += std::string(entry->name) + ":" + std::string(implementation(entry->name)) + "\n";
  return sha256(text);
}

}  // namespace taut
