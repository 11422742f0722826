#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
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
#include "core/model/status.hpp"

namespace taut {

/// Cost of one pass of a step: what it works on, how often, and its memory.
struct PassCost {
  std::string pass;          ///< "verlet", "structural", "wind", ...
  std::size_t items = 0;     ///< particles, links, faces, contacts that one application visits
  std::size_t repeats = 1;   ///< applications in one step: sweeps times substeps
  std::size_t bytes = 0;     ///< memory that exists because of this pass
  bool projections = false;  ///< items are projections, the unit of work of every comparison
};

/// Advances one cloth. It is built from a Scene, has no clock, draws no unseeded random numbers and
/// does no I/O.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual void load(const State&) = 0;         ///< starts or restarts from this state (untimed)
  virtual void step(double t, double dt) = 0;  ///< advances over [t, t + dt]: the only timed call
  /// Copies the state out (untimed): step() has done all of the work.
  virtual void store(State&) const = 0;
  /// The passes of one step, in order.
  virtual std::vector<PassCost> step_cost() const = 0;

  /// Cost of step() so far, from any origin. By default this process's CPU clock and the largest
  /// size of its resident set, for a solver that computes in this process.
  virtual double cpu_seconds() const;      ///< NaN: cannot be measured
  virtual std::size_t peak_bytes() const;  ///< 0: cannot be measured
  /// Why its time is doubtful or missing; "": neither.
  virtual std::string time_remark() const;
  /// End of the standard error of the solver's own program, if it has one.
  virtual std::string log() const;

  /// Number of steps so far whose iterations ended before their own criterion of convergence held;
  /// empty: their number is fixed.
  virtual std::optional<int> unconverged_steps() const { return {}; }

  /// Continues from the end of `before`, a solver of the same entry and parameters for the previous
  /// stage of the same scene (stages()). By default it takes over only the state.
  virtual void go_on(const Solver& before);
  /// Moves the vertices by `ways` [n] [m] without changing their velocities. By default it restarts
  /// from there.
  virtual void displace(const std::vector<Vec3>& ways);

  /// Calls `visit` with the time at the end of every substep inside a step, where store() returns
  /// the state, for callers that need the path between two step boundaries. Not for timed runs.
  void visit_substeps(std::function<void(double t)> visit) { visit_ = std::move(visit); }

 protected:
  /// Call it at the end of each substep except a step's last.
  void substep_ended(double t) const {
    if (visit_) visit_(t);
  }

 private:
  std::function<void(double)> visit_;
};

/// Failure of a solver, of most only if they compute in a process of their own. `status` is the
/// case's; `log` is the end of the process's standard error.
struct SolverFailure : std::runtime_error {
  SolverFailure(Status::Kind status_, StatusReason reason_, std::string log_ = "")
      : std::runtime_error(reason_.text()),
        status(status_),
        reason(std::move(reason_)),
        log(std::move(log_)) {}
  Status::Kind status;
  StatusReason reason;  ///< what() is its text
  std::string log;
};

/// A setting in the form in which the solver applies it.
struct ResolvedSetting {
  std::string name;   ///< "time step"
  std::string text;   ///< for people: "1/64 s, as binary32"
  std::string token;  ///< text by which solvers are compared: "coloured"; "": `text`
  double number;      ///< value of `text` in SI; NaN: not a number

  ResolvedSetting(std::string_view name_, std::string_view text_, std::string_view token_ = {},
                  double number_ = std::numeric_limits<double>::quiet_NaN())
      : name(name_), text(text_), token(token_), number(number_) {}
  const std::string& compared() const { return token.empty() ? text : token; }
  /// Compares NaN equal to NaN.
  bool operator==(const ResolvedSetting& other) const {
    return name == other.name && text == other.text && token == other.token &&
           (number == other.number || (number != number && other.number != other.number));
  }
};
using ResolvedSettings = std::vector<ResolvedSetting>;
/// Setting that the page shows with each solver, by its token.
inline constexpr std::string_view kLinkOrder = "link order";
/// Setting for the stiffness of links. Its number is that of structural links [N/m], NaN if rigid.
inline constexpr std::string_view kLinksSetting = "links";
/// The setting with that name; nullptr if there is no such setting.
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

/// Parameters that decide how accurate a result is and what it costs, and the values that a search
/// for a setting may try (experiments/timing/search.hpp).
struct AccuracyParameters {
  /// Values that a group of parameters takes together: {"structural", "shear"}, {"50", "200"}.
  struct Ladder {
    Words parameters, values;
  };
  std::string_view substeps;    ///< steps of dt / substeps; "": the solver has none
  std::string_view sweeps;      ///< more sweeps need fewer substeps; "": the solver has none
  std::string_view link_order;  ///< parameter that kLinkOrder resolves; "": no parameter
  bool all_at_once = false;     ///< an iteration solves for all links at once and is not a sweep
  /// Springs that may be softer or stiffer. Without sweeps, each value needs its own substeps. With
  /// sweeps, stiffer values are tried where the default misses the error; then every value is tried
  /// as an alternative.
  Ladder stiffness;
  std::span<const Ladder> alternatives;  ///< tried one at a time, with the others at their best
  /// All parameters that may vary along a curve of error over cost, in the order in which labels
  /// name them.
  Words labelled{"substeps", "iterations"};
  /// Accelerators that other solvers may lack. They are off by default, and costs are compared
  /// without them.
  Words accelerators;
};

/// A parameter that a scene may not need (experiments/require).
struct OptionalEffect {
  std::string_view name;  ///< "contact of faces"
  std::string_view parameter;
  Words values = {};        ///< dearest first; empty for an integer, which is halved down to 1
  bool of_contact = false;  ///< only matters with colliders
};

/// How a solver treats small displacements of links at their rest length, without gravity, wind or
/// contact, as linear stability needs to know it (core/reference/linear_stability.hpp).
struct LinearSprings {
  std::array<double, kFamilies.size()> stiffness{};  ///< N/m, by family; 0: no spring
  double drag = 0;                                   ///< N s/m, c of F = -c v
  /// Drag at the mean of the velocities before and after, otherwise at that before.
  bool central_drag = false;
  bool explicit_euler = false;  ///< otherwise symplectic Euler or Verlet
  int substeps = 1;
};
/// Rigid links, relaxed in the scene's order.
struct LinearSweeps {
  bool jacobi = false;  ///< all links at once, corrections added; otherwise Gauss-Seidel
  double omega = 1;     ///< relaxation factor
  int sweeps = 1;       ///< per substep
  int substeps = 1;
};
/// Linear model of a solver; monostate: no theory is known.
using LinearModel = std::variant<std::monostate, LinearSprings, LinearSweeps>;

/// Creates solvers. A scene with releases gets one solver per stage (stages()), so that solvers
/// need not handle releases. For any other scene the wrapped function is called.
class MakeSolver {
 public:
  MakeSolver() = default;
  template <class Function>
  requires std::is_invocable_r_v < std::unique_ptr<Solver>, Function,
  const Scene&, const Params& > MakeSolver(Function bare) : bare_(std::move(bare)) {}
  explicit operator bool() const { return static_cast<bool>(bare_); }
  /// A copy that makes no stages, for solvers that handle releases themselves.
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

/// The programs that run solvers; kFloatProgram holds the float build of Bullet.
inline constexpr std::string_view kProgram = "taut", kFloatProgram = "taut-f32";

/// Description of a solver: one per file, found by its TAUT_SOLVER line. Its functions may throw
/// SolverFailure.
struct SolverEntry {
  std::string_view name;
  std::string_view title = "";        ///< what people call it; "": the name in words
  std::string_view summary;           ///< one sentence
  std::string_view source;            ///< paper or library, with version
  std::span<const ParamSpec> params;  ///< drives the command line, the documentation and the errors
  /// Null: it must not run, because only a stored text names it (admit_solver).
  MakeSolver make;
  /// Reasons why it would get this scene wrong, a sentence each; empty: it supports the scene.
  std::function<std::vector<std::string>(const Scene&, const Params&)> unsupported;
  std::function<ResolvedSettings(const Scene&, const Params&)> resolved_settings;
  /// The start of a run that does not begin as the scene does. Null: all begin as the scene does.
  std::function<State(const Scene&, const Params&)> start = nullptr;
  /// Null: it declares none.
  DeclaredStep (*declared_step)(const Scene&, const Params&) = nullptr;
  /// The program that can run this choice: kProgram, kFloatProgram, or "" for either. Null: either.
  /// Bullet's float and double builds share their symbols, so each has a program of its own; in the
  /// other program, make() throws InputError.
  std::string_view (*program)(const Params&) = nullptr;
  AccuracyParameters accuracy = {};
  std::span<const OptionalEffect> optional_effects = {};
  LinearModel (*linear_model)(const Scene&, const Params&) = nullptr;  ///< null: none is known
  /// Digest of the code of a solver outside this program; "": it is part of this program.
  std::string_view implementation = "";
  /// Version of the sources of an external solver, for people; "": that of this program.
  std::string_view build = "";
  /// Parameters that only say where an external solver is; `implementation` identifies it.
  std::string_view place = "";
  /// Largest distance [m] of a pin from its place. Null: rounding in its precision.
  double (*pins_within)(const Scene&) = nullptr;

  /// Whether its code is not part of this program.
  bool foreign() const { return !implementation.empty(); }
};

/// A parameter of solvers whose links may be compliant.
inline constexpr ParamSpec kMaterial = ParamSpec::choice(
    "material", "scene", "scene|own",
    "stiffness of links: the scene's, where it has one, or that of the solver's own parameters");
/// Whether the links have the scene's stiffness.
inline bool takes_stiffness(const Scene& scene, const Params& params) {
  return scene.stiffness != kRigid && params.is("material", "scene");
}

/// Spring constants of the solver's links, from the scene or from the parameters that say of which
/// family they are; infinite: rigid.
Stiffness stiffness_of(const Scene&, const Params&);

/// SolverEntry::declared_step of stored positions, one frame a step, made by an unknown method.
DeclaredStep implicit_euler_of_a_frame(const Scene&, const Params&);
/// The step that the entry declares.
DeclaredStep declared_step(const SolverEntry&, const Scene&, const Params&);

/// Number of constraint projections in a step: sum of items x repeats over the passes that project.
std::size_t projections_per_step(const Solver&);

/// All solvers of this program, sorted by name (generated; see cmake/registry.cmake).
std::span<const SolverEntry* const> solvers();

/// A source of solvers that are not part of this program (experiments/external). Entries live as
/// long as the program.
struct SolverSource {
  std::vector<std::string> (*names)() = nullptr;
  /// The entry of "name:params"; null if there is no such name. A solver that was not admitted
  /// is neither started nor opened: its entry has no `make`. Throws InputError.
  const SolverEntry* (*find)(std::string_view name, std::string_view params) = nullptr;
  /// Null: the source's solvers need no admission.
  void (*admit)(std::string_view name, std::string_view params) = nullptr;
};
void set_solver_source(SolverSource);

/// Allows the program or file that a solver's text names to be started or opened from now on. Call
/// it only for texts from the command line or a study: a stored text is only data.
void admit_solver(std::string_view text);

/// solvers() and all solvers that the source names, which this call admits.
std::vector<const SolverEntry*> all_solvers();

/// Throws InputError with a suggestion if there is no such solver. `params` is the text after the
/// name and its colon; it decides which external program is meant.
const SolverEntry& find_solver(std::string_view name, std::string_view params = "");

/// A solver and its parameters: "name" or "name:key=value,...", where every parameter gets its
/// value or its default.
struct SolverChoice {
  const SolverEntry* entry = nullptr;
  Params params;
  /// "name:key=value,...": every parameter in declared order. Equal choices have equal text.
  std::string canonical() const;
  /// Like canonical(), but with only the parameters that differ from their defaults: for people.
  std::string brief() const;
  /// The choice with this value of one of its parameters. Throws InputError.
  SolverChoice with(std::string_view name, const std::string& value) const;
  /// canonical() and brief() without the parameters of the entry's `place`: the address and the
  /// name of a result.
  std::string addressed() const { return with_params(false, entry->place); }
  std::string called() const { return with_params(true, entry->place); }
  /// Number of substeps of a step and of sweeps of a substep, by the entry's AccuracyParameters: at
  /// least 1.
  int substeps() const { return count(entry->accuracy.substeps); }
  int sweeps() const { return count(entry->accuracy.sweeps); }

 private:
  std::string with_params(bool only_changed, std::string_view but) const;
  int count(std::string_view parameter) const {
    return parameter.empty() ? 1 : std::max(1, params.integer(parameter));
  }
};
/// Throws InputError.
SolverChoice parse_solver(std::string_view text);

/// The name in "name" or "name:key=value,...".
std::string solver_name(std::string_view text);

/// The text with `more`, "key=value,...", appended to its parameters; "" adds nothing.
std::string with(std::string_view solver, std::string_view more);

}  // namespace taut

/// Defines the entry, by the name under which the generated registry finds it:
///     TAUT_SOLVER(jakobsen) = {.name = "jakobsen", ...};
#define TAUT_SOLVER(id)                 \
  namespace taut {                      \
  extern const SolverEntry solver_##id; \
  }                                     \
  const taut::SolverEntry taut::solver_##id
