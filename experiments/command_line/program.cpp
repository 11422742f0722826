#include "experiments/command_line/program.hpp"

#include "core/model/solver.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"

namespace taut {

std::string program_digest() {
  std::string text(measurement());
  for (const SolverEntry* entry : solvers())
    text += std::string(entry->name) + ":" + std::string(implementation(entry->name)) + "\n";
  return sha256(text);
}

}  // namespace taut
