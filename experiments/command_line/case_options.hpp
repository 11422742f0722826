#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/case/record.hpp"

namespace taut {

/// How verbs name one case: SCENE SOLVER [--dt] [--duration] [--set key=value ...].
class CaseOptions {
 public:
  void bind(CLI::App&);
  CaseSpec spec() const;  ///< as typed
  /// Throws InputError.
  Case make() const;

 private:
  std::string scene_, solver_, dt_, duration_;
  std::vector<std::string> settings_;
};

/// Replaces this process by the program that can run the choice (same arguments), if it is another
/// one; returns if it is this. Throws InputError if the other is not installed.
void continue_in_right_program(const SolverChoice&);

/// A record for people, on standard output: what ran, how it ended, every value that has a meaning.
void print_record(const Record&);

}  // namespace taut
