#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/solver.hpp"
#include "experiments/external/connection.hpp"
#include "experiments/external/protocol.hpp"

namespace taut::external {

/// A value of the parameters of a solver's text; "": it has none.
std::string value_in(std::string_view params, std::string_view key);

/// One program as a solver: its entry, for as long as this program lives.
class Program {
 public:
  /// Says hello. A program that answers it badly has an entry all the same, whose cases end as the
  /// hello did: it costs its own cases, not the study. `name`: "" names it after itself
  /// (name_for). `leading` are the parameters that come before its own, `given` the text of all,
  /// `files` what it is made of beside the files that the command names. Throws InputError if it
  /// cannot be started.
  Program(std::string name, Command, std::vector<ParamSpec> leading, std::string_view given,
          const std::vector<std::string>& files);
  /// A program that did not introduce itself, called with other parameters.
  Program(const Program& silent, std::vector<ParamSpec> leading, std::string_view given);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  const SolverEntry& entry() const { return entry_; }
  /// Why it did not introduce itself; "": it did.
  std::string silence() const { return failure_ ? failure_->what() : ""; }

 private:
  struct Loaded {
    std::unique_ptr<Connection> connection;
    SceneAnswer answer;
  };
  void introduce(std::string_view given);
  Loaded load(const Scene&, const Params&) const;
  std::vector<std::string> unsupported(const Scene&, const Params&);
  std::unique_ptr<Solver> make(const Scene&, const Params&);
  ResolvedSettings resolved_settings(const Scene&, const Params&);
  void require_probed(const Params&);

  std::string name_, implementation_, build_;
  bool told_ = false;  ///< the build, by whoever starts it
  Command command_;
  std::unique_ptr<const Hello> hello_;
  std::optional<SolverFailure> failure_;  ///< of the hello
  std::deque<std::string> texts_;
  std::vector<ParamSpec> specs_;
  SolverEntry entry_;

  std::mutex mutex_;
  std::map<std::string, std::optional<SolverFailure>> probed_;  ///< by values of its parameters
  std::map<std::string, Loaded> waiting_;  ///< asked whether it can, until make() takes it
  std::map<std::string, ResolvedSettings> settings_;
};

}  // namespace taut::external
