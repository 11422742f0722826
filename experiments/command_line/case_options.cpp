#include "experiments/command_line/case_options.hpp"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>

#include "core/model/input_error.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/system/data.hpp"

namespace taut {

void CaseOptions::bind(CLI::App& app) {
  app.add_option("SCENE", scene_, "Name of a shipped scene, or a path")->required();
  app.add_option("SOLVER", solver_, "NAME or NAME:key=value,... (taut list solvers)")->required();
  app.add_option("--dt", dt_, "Time step [s], a number or a fraction such as 1/120");
  app.add_option("--duration", duration_, "Simulated time [s]");
  add_settings(app, settings_);
}

CaseSpec CaseOptions::spec() const {
  CaseSpec spec{scene_, settings_, solver_};
  if (!dt_.empty()) spec.overrides.push_back("time.dt=\"" + dt_ + "\"");
  if (!duration_.empty()) spec.overrides.push_back("time.duration=\"" + duration_ + "\"");
  return spec;
}

Case CaseOptions::make() const { return make_case(spec()); }

void continue_in_right_program(const SolverChoice& choice) {
  const std::string needed(choice.entry->program ? choice.entry->program(choice.params) : "");
  if (needed.empty() || needed == this_program().filename()) return;
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string program = sibling_program(needed);
  execv(program.c_str(), argv.data());
  throw InputError(choice.brief() + " needs the program " + program + ", which cannot be run");
}

void print_record(const Record& record) {
  std::cout << record.id << "\n  status       " << to_string(record.status.kind);
  if (!record.status.reason.empty()) std::cout << " (" << record.status.reason << ")";
  if (record.status.step >= 0) std::cout << ", step " << record.status.step;
  if (record.status.vertex >= 0) std::cout << ", vertex " << record.status.vertex;
  std::cout << "\n  steps        " << record.steps << " of " << record.dt << " s\n  cloth        "
            << record.vertices << " vertices, " << record.links << " links\n  work         "
            << record.projections << " projections per step\n  state        " << record.digest
            << '\n';
  for (const auto& [name, value] : record.values)
    if (!std::isnan(value)) {
      const ValueSpec* spec = find_value(name).second;
      std::cout << "  " << std::left << std::setw(26) << name << std::setprecision(6) << value
                << ' ' << (!spec || spec->unit.si == "1" ? "" : spec->unit.si) << '\n';
    }
}

}  // namespace taut
