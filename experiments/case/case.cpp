#include "experiments/case/case.hpp"

#include <cstdlib>
#include <utility>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

/// A setting in a case's id. The two common ones lose their section: time.dt="1/64" -> "dt=1/64".
std::string in_id(const SceneSetting& one) {
  const bool common = one.key() == "time.dt" || one.key() == "time.duration";
  std::string text =
      (common ? one.key().substr(std::size("time.") - 1) : one.key()) + "=" + one.value();
  std::erase_if(text, [](char c) { return c == '"' || c == ' '; });
  return text;
}

Case addressed(const CaseSpec& spec, std::shared_ptr<const Scene> scene, SolverChoice choice,
               const std::string& scene_digest) {
  Case one{spec, std::move(scene), std::move(choice), {}, {}, {}, {}};
  one.spec.solver = one.choice.canonical();
  one.key = case_key(*one.scene, scene_digest, one.choice);
  for (const SceneSetting& setting : spec.settings) one.setting += in_id(setting) + ' ';
  one.setting += one.choice.called();
  one.id = one.scene->name + ' ' + one.setting;
  one.build = one.choice.entry->build.empty() ? this_build() : one.choice.entry->build;
  return one;
}

}  // namespace

std::string this_build() {
  for (const char* name : {"TAUT_BUILD_ID", "TAUT_COMMIT"})
    if (const char* given = std::getenv(name); given && *given) return given;
  static const std::string kOwn = "taut-" + program_digest().substr(0, 10);
  return kOwn;
}

const CaseMaker::Loaded& CaseMaker::scene(const CaseSpec& spec) {
  Loaded& loaded = scenes_[{spec.scene, spec.settings}];
  if (!loaded.scene) {
    loaded.scene = std::make_shared<const Scene>(
        load_scene(find_scene(spec.scene), spec.settings, &loaded.remarks));
    loaded.digest = digest(*loaded.scene);
  }
  return loaded;
}

Case CaseMaker::make(const CaseSpec& spec) {
  SolverChoice choice;
  std::vector<Diagnostic> wrong;
  const auto collect = [&](const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      wrong.insert(wrong.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  };
  const Loaded* found = nullptr;
  collect([&] { found = &scene(spec); });
  collect([&] {
    choice = parse_solver(spec.solver);
    if (!choice.entry->make)
      throw InputError(spec.solver +
                       ": is not started, since neither the command line nor a study names it");
  });
  if (!wrong.empty()) throw InputError(wrong);
  Case one = addressed(spec, found->scene, std::move(choice), found->digest);
  one.remarks = found->remarks;
  return one;
}

Case case_of(const CaseSpec& spec, std::shared_ptr<const Scene> scene, SolverChoice choice) {
  const std::string scene_digest = digest(*scene);
  return addressed(spec, std::move(scene), std::move(choice), scene_digest);
}

}  // namespace taut
