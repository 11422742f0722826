#include "experiments/command_line/solver_texts.hpp"

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"

namespace taut {

void check_solvers(const std::vector<std::string>& texts) {
  std::vector<Diagnostic> wrong;
  for (const std::string& text : texts) try {
      parse_solver(text);
    } catch (const InputError& error) {
      wrong.insert(wrong.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  if (!wrong.empty()) throw InputError(wrong);
}

}  // namespace taut
