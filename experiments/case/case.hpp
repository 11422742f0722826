#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/record.hpp"
#include "experiments/case/run_case.hpp"

namespace taut {

/// A CaseSpec with all that it names: ready to run, with its address.
struct Case {
  CaseSpec spec;
  std::shared_ptr<const Scene> scene;
  SolverChoice choice;
  std::string key;                        ///< case_key
  std::string setting;                    ///< for people: "dt=1/64 jakobsen:iterations=8"
  std::string id;                         ///< the scene and the setting
  std::string build;                      ///< which runs it: that of its solver, or this_build()
  std::vector<std::string> remarks = {};  ///< what was skipped of the scene's files
};

/// Which build of taut this is: what $TAUT_BUILD_ID says, as "ID" or "ID@TIME", else $TAUT_COMMIT
/// (`./taut` says the commit where nothing is changed), else "taut-" and ten digits of
/// program_digest().
std::string this_build();

/// Makes cases; a scene that many of them share is read once.
class CaseMaker {
 public:
  /// Throws InputError: unknown or malformed scene, unknown solver, bad parameter or setting.
  Case make(const CaseSpec&);

 private:
  struct Loaded {
    std::shared_ptr<const Scene> scene;
    std::string digest;
    std::vector<std::string> remarks;
  };
  const Loaded& scene(const CaseSpec&);
  std::map<std::pair<std::string, SceneSettings>, Loaded> scenes_;
};

/// A case of a scene that was read before; `spec` gives the case its names and settings.
Case case_of(const CaseSpec& spec, std::shared_ptr<const Scene>, SolverChoice);

/// One case on its own.
inline Case make_case(const CaseSpec& spec) { return CaseMaker().make(spec); }

/// Gives a record of this case all its names: spec, key, id, setting and the scene's name.
void name_it(Record&, const Case&);

/// run_case of its scene and solver; the record carries the case's spec, key and id.
CaseRun run_case(const Case&, const RunOptions& = {});

/// The record of a case that did not get to write its own.
Record unfinished(const Case&, const Status&);

}  // namespace taut
