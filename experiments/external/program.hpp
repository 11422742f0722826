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

/// Whether a program has to pass the quick probe before it runs a scene; true at first.
void set_probe_required(bool);

/// Value of a key in the parameters of a solver text; "" if it is absent.
std::string value_in(std::string_view params, std::string_view key);

/// An external program as a solver. Its entry lives until this program ends.
class Program {
 public:
  /// Starts the program and sends "hello". After a bad answer the entry exists all the same, and
  /// its cases end as the hello did: a bad program costs its own cases, not the study. An empty
  /// `name` is replaced by one from name_for(). `leading` are parameters that come before the
  /// program's own, `given` is the text of all parameters, and `files` belong to the program beside
  /// the files that the command names. Throws InputError if the program cannot be started.
  Program(std::string name, Command, std::vector<ParamSpec> leading, std::string_view given,
          const std::vector<std::string>& files);
  /// The same program as `silent`, which did not introduce itself, with other parameters.
  Program(const Program& silent, std::vector<ParamSpec> leading, std::string_view given);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  const SolverEntry& entry() const { return entry_; }
  /// Why the program did not introduce itself; "" if it did.
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
  bool told_ = false;  ///< whether the user named the build
  Command command_;
  std::unique_ptr<const Hello> hello_;
  std::optional<SolverFailure> failure_;  ///< why the hello failed
  std::deque<std::string> texts_;
  std::vector<ParamSpec> specs_;
  SolverEntry entry_;

  std::mutex mutex_;
  /// Result of the quick probe, by parameter values.
  std::map<std::string, std::optional<SolverFailure>> probed_;
  /// Started and given a scene by unsupported(), until make() takes them.
  std::map<std::string, Loaded> waiting_;
  std::map<std::string, ResolvedSettings> settings_;
};

}  // namespace taut::external
