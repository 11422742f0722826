#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/params.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// One pass of a step: what it works on, how often, and what it holds.
struct PassCost {
  std::string pass;          ///< "verlet", "structural", "wind", ...
  std::size_t items = 0;     ///< particles, links, faces, contacts that one application visits
  std::size_t repeats = 1;   ///< applications in one step: sweeps times substeps
  std::size_t bytes = 0;     ///< memory that exists because of this pass
  bool projections = false;  ///< items are projections, the unit of work of every comparison
};

/// Advances one cloth. Built from a Scene; owns no clock, draws no unseeded random numbers, does no
/// I/O.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual void load(const State&) = 0;         ///< start or restart here (untimed)
  virtual void step(double t, double dt) = 0;  ///< advance [t, t + dt]: the only timed call
  virtual void store(State&) const = 0;  ///< copy out (untimed): step() has done all of the work
  virtual std::vector<PassCost> step_cost() const = 0;  ///< the passes of one step, in order

  /// What step() has cost so far, from any origin; by default this process's CPU clock and the
  /// largest size of its resident set, for a solver that computes in it.
  virtual double cpu_seconds() const;       ///< NaN: cannot be measured
  virtual std::size_t peak_bytes() const;   ///< 0: cannot be measured
  virtual std::string time_remark() const;  ///< why its time is doubtful or missing; "": neither
  /// The end of what the solver's own program, if it has one, wrote to standard error.
  virtual std::string log() const;

  /// Continues from the end of `before`, a solver of the same entry and parameters for the previous
  /// stage of the same scene (stages()). By default it takes over the state and nothing else.
  virtual void go_on(const Solver& before);

  /// Calls `visit` with the time at the end of every substep inside a step, where store() returns
  /// the state: for those who need the path between two step boundaries. Not while timing.
  void visit_substeps(std::function<void(double t)> visit) { visit_ = std::move(visit); }

 protected:
  /// For solvers with substeps: at the end of each but a step's last.
  void substep_ended(double t) const {
    if (visit_) visit_(t);
  }

 private:
  std::function<void(double)> visit_;
};

/// A solver that computes in a process of its own has failed there. `status` is the case's, by name
/// ("crash", "timeout", "oom", "protocol", "error"); `log` the end of its standard error.
struct SolverFailure : std::runtime_error {
  SolverFailure(std::string status_, const std::string& reason, std::string log_ = "")
      : std::runtime_error(reason), status(std::move(status_)), log(std::move(log_)) {}
  std::string status, log;
};

/// A setting as the solver applies it.
struct ResolvedSetting {
  std::string name;   ///< "time step"
  std::string text;   ///< for people: "1/64 s, as binary32"
  std::string token;  ///< by which solvers are compared: "coloured"; "": by `text`
  double number;      ///< value of `text` in SI; NaN: not a number

  ResolvedSetting(std::string_view name_, std::string_view text_, std::string_view token_ = {},
                  double number_ = std::numeric_limits<double>::quiet_NaN())
      : name(name_), text(text_), token(token_), number(number_) {}
  const std::string& compared() const { return token.empty() ? text : token; }
  /// NaN is NaN.
  bool operator==(const ResolvedSetting& other) const {
    return name == other.name && text == other.text && token == other.token &&
           (number == other.number || (number != number && other.number != other.number));
  }
};
using ResolvedSettings = std::vector<ResolvedSetting>;
/// A setting that the page shows with each solver, by its token.
inline constexpr std::string_view kLinkOrder = "link order";
/// The stiffness of links: its number is that of structural ones [N/m], NaN if they are rigid.
inline constexpr std::string_view kLinksSetting = "links";
/// The setting of that name; nullptr: there is none.
const ResolvedSetting* find_setting(const ResolvedSettings&, std::string_view name);

/// Names of parameters, or values, as typed: {"structural", "shear"}.
class Words {
 public:
  constexpr Words() = default;
  constexpr Words(std::initializer_list<std::string_view> words) {
    for (const std::string_view word : words) words_[size_++] = word;
  }
  constexpr const std::string_view* begin() const { return words_.data(); }
  constexpr const std::string_view* end() const { return words_.data() + size_; }
  constexpr bool empty() const { return size_ == 0; }

 private:
  std::array<std::string_view, 8> words_{};  // a longer list does not compile
  std::size_t size_ = 0;
};

/// The parameters that decide how accurate a result is and what it costs, and what a search for a
/// setting may try of them (experiments/timing/search.hpp).
struct AccuracyParameters {
  /// Parameters that take one of the values together: {"structural", "shear"}, {"50", "200"}.
  struct Ladder {
    Words parameters, values;
  };
  std::string_view substeps;    ///< steps of dt / substeps; "": the solver has none
  std::string_view sweeps;      ///< more of them need fewer substeps; "": the solver has none
  std::string_view link_order;  ///< the parameter that kLinkOrder resolves; "": there is none
  bool all_at_once = false;     ///< an iteration solves for all links at once: it is no sweep
  /// Springs that may be softer or stiffer. Without sweeps each value needs its own substeps; with
  /// sweeps, a stiffer one is tried where the default misses the error, and each as an alternative.
  Ladder stiffness;
  std::span<const Ladder> alternatives;  ///< tried one at a time, at the best of the others
  /// All that may vary along a curve of error over cost, in the order in which labels name it.
  Words labelled{"substeps", "iterations"};
  /// Accelerators, off at their defaults, that others may lack: costs are compared without them.
  Words accelerators;
};

/// A choice that a scene may not need (experiments/require).
struct OptionalEffect {
  std::string_view name;  ///< "contact of faces"
  std::string_view parameter;
  Words values = {};        ///< dearest first; empty for an integer, which is halved down to 1
  bool of_contact = false;  ///< means something with colliders only
};

/// What a solver does to small displacements of links at their rest length, without gravity, wind
/// or contact: what linear stability needs to know (core/reference/linear_stability.hpp).
struct LinearSprings {
  std::array<double, kFamilies.size()> stiffness{};  ///< N/m, by family; 0: no spring
  double drag = 0;                                   ///< N s/m, c of F = -c v
  bool central_drag = false;    ///< at the mean of the velocities before and after, else before
  bool explicit_euler = false;  ///< else symplectic Euler or Verlet
  int substeps = 1;
};
/// Hard links, relaxed in the scene's order.
struct LinearSweeps {
  bool jacobi = false;  ///< all links at once, corrections added; else Gauss-Seidel
  double omega = 1;     ///< relaxation factor
  int sweeps = 1;       ///< per substep
  int substeps = 1;
};
/// Neither: no theory is known.
using LinearModel = std::variant<std::monostate, LinearSprings, LinearSweeps>;

/// Creates solvers. A scene with releases gets one solver per stage (stages()), so that no solver
/// has to handle releases; for any other scene the wrapped function is called.
class MakeSolver {
 public:
  MakeSolver() = default;
  template <class Function>
  requires std::is_invocable_r_v < std::unique_ptr<Solver>, Function,
  const Scene&, const Params& > MakeSolver(Function bare) : bare_(std::move(bare)) {}
  explicit operator bool() const { return static_cast<bool>(bare_); }
  /// The same without stages, for solvers that handle releases themselves.
  MakeSolver whole() const {
    MakeSolver same = *this;
    same.whole_ = true;
    return same;
  }
  std::unique_ptr<Solver> operator()(const Scene&, const Params&) const;

 private:
  std::function<std::unique_ptr<Solver>(const Scene&, const Params&)> bare_;
  bool whole_ = false;
};

/// How a solver introduces itself: one per file, found by its TAUT_SOLVER line. Its functions may
/// throw SolverFailure.
struct SolverEntry {
  std::string_view name;
  std::string_view title = "";        ///< what people call it; "": the name in words
  std::string_view summary;           ///< one sentence
  std::string_view source;            ///< paper or library, with version
  std::span<const ParamSpec> params;  ///< drives the command line, the documentation and the errors
  /// Null: it must not run, since only a stored text names it (admit_solver).
  MakeSolver make;
  /// Why it would misread this scene, a sentence each; empty: it would not.
  std::function<std::vector<std::string>(const Scene&, const Params&)> unsupported;
  std::function<ResolvedSettings(const Scene&, const Params&)> resolved_settings;
  DeclaredStep (*declared_step)(const Scene&, const Params&) = nullptr;  ///< null: it declares none
  /// Which program can run this choice: "taut", "taut-f32", or "" for either. Null: either.
  /// Bullet's float and double builds share their symbols, so each has a program of its own; in the
  /// other one, make() throws InputError.
  std::string_view (*program)(const Params&) = nullptr;
  AccuracyParameters accuracy = {};
  std::span<const OptionalEffect> optional_effects = {};
  LinearModel (*linear_model)(const Scene&, const Params&) = nullptr;  ///< null: none is known
  /// Digest of the code of a solver outside this program; "": it is part of this program.
  std::string_view implementation = "";
  /// Version of the sources of such a solver, for people; "": that of this program.
  std::string_view build = "";
  /// Parameters that only locate such a solver; `implementation` identifies it.
  std::string_view place = "";
};

/// A parameter of solvers whose links may comply.
inline constexpr ParamSpec kMaterial = ParamSpec::choice(
    "material", "scene", "scene|own",
    "stiffness of links: the scene's, where it has one, or that of the solver's own parameters");
/// Whether the links' stiffness is the scene's.
inline bool takes_stiffness(const Scene& scene, const Params& params) {
  return scene.stiffness != kRigid && params.is("material", "scene");
}

/// The spring constants of the solver's links, the scene's or its own parameters'; infinite: rigid.
Stiffness stiffness_of(const Scene&, const Params&);

/// SolverEntry::declared_step of a solver that approximates implicit Euler of each substep, with
/// its links and contact of vertices.
DeclaredStep implicit_euler(const Scene&, const Params&);
/// The same for stored positions, one frame a step, made by an unknown method.
DeclaredStep implicit_euler_of_a_frame(const Scene&, const Params&);
/// What the entry declares.
DeclaredStep declared_step(const SolverEntry&, const Scene&, const Params&);

/// Constraint projections in one step: sum of items x repeats over the passes that project.
std::size_t projections_per_step(const Solver&);

/// All solvers of this program, sorted by name (generated; see cmake/registry.cmake).
std::span<const SolverEntry* const> solvers();

/// A source of solvers that are not part of this program (experiments/external). Entries live as
/// long as the program does.
struct SolverSource {
  std::vector<std::string> (*names)() = nullptr;
  /// The entry of "name:params"; null: there is none of that name. A solver that was not admitted
  /// is neither started nor opened: its entry has no `make`. Throws InputError.
  const SolverEntry* (*find)(std::string_view name, std::string_view params) = nullptr;
  /// Null: what it finds needs no admission.
  void (*admit)(std::string_view name, std::string_view params) = nullptr;
};
void set_solver_source(SolverSource);

/// Allows the program or file that a solver's text names to be started or opened from now on. Call
/// it only for texts of the command line or of a study: a stored text is data.
void admit_solver(std::string_view text);

/// solvers() and all that the source names; the latter are admitted.
std::vector<const SolverEntry*> all_solvers();

/// Throws InputError with a suggestion if there is no such solver. `params` is what follows the
/// name and its colon: it tells which external program is meant.
const SolverEntry& find_solver(std::string_view name, std::string_view params = "");

/// "name" or "name:key=value,..."; every parameter gets its value or its default. Throws
/// InputError.
struct SolverChoice {
  const SolverEntry* entry = nullptr;
  Params params;
  /// "name:key=value,...": every parameter spelt out in declared order; equal choices, equal text.
  std::string canonical() const;
  /// The same, but only the parameters that differ from their defaults: for people.
  std::string brief() const;
  /// The same with this value of one of its parameters. Throws InputError.
  SolverChoice with(std::string_view name, const std::string& value) const;
  /// Both without the parameters of the entry's `place`: the address and the name of a result.
  std::string addressed() const { return with_params(false, entry->place); }
  std::string called() const { return with_params(true, entry->place); }
  /// Substeps of a step, and sweeps of a substep, by the entry's AccuracyParameters: at least 1.
  int substeps() const { return count(entry->accuracy.substeps); }
  int sweeps() const { return count(entry->accuracy.sweeps); }

 private:
  std::string with_params(bool only_changed, std::string_view but) const;
  int count(std::string_view parameter) const {
    return parameter.empty() ? 1 : std::max(1, params.integer(parameter));
  }
};
SolverChoice parse_solver(std::string_view text);

/// The name in "name" or "name:key=value,...".
std::string solver_name(std::string_view text);

/// The text with `more`, "key=value,...", behind its parameters; "" adds nothing.
std::string with(std::string_view solver, std::string_view more);

}  // namespace taut

/// Defines the entry under the name by which the generated registry finds it:
///     TAUT_SOLVER(jakobsen) = {.name = "jakobsen", ...};
#define TAUT_SOLVER(id)                 \
  namespace taut {                      \
  extern const SolverEntry solver_##id; \
  }                                     \
  const taut::SolverEntry taut::solver_##id
