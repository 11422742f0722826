#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "experiments/external/connection.hpp"

namespace taut::external {

/// Parameters that taut gives to every external program. They come before the program's own
/// parameters, which may not use the same names.
inline constexpr ParamSpec kTimeout = ParamSpec::real(
    "timeout", "s", "30", 0.01, 86400, "Longest time in which the program may answer");
static_assert(kAnswerSeconds == 30 && kTimeout.default_value == "30");
inline constexpr ParamSpec kBuildName{
    .name = "build",
    .kind = ParamSpec::Kind::text,
    .help = "Name of the state of its sources, in place of command, files and version"};
inline constexpr ParamSpec kLeading[] = {
    {.name = "cmd", .kind = ParamSpec::Kind::text, .help = "The program to be called"},
    kTimeout,
    {.name = "folder",
     .kind = ParamSpec::Kind::text,
     .help = "Folder in which the command runs; by default that of taut"},
    kBuildName};

/// A program's answer to "hello".
struct Hello {
  std::string name, version, summary, source;
  int version_spoken = 1;    ///< n of taut-solver/n
  std::string unmeasurable;  ///< why its time means nothing; "" if it is valid
  std::vector<ParamSpec> params;
  std::deque<std::string> texts;  ///< storage behind the views in `params`
};

/// A program's answer to "scene".
struct SceneAnswer {
  /// Why it would misread the scene; empty: it has loaded the scene.
  std::vector<std::string> cannot;
  std::vector<PassCost> plan;
  ResolvedSettings settings;
};

/// Readers of the answers to "hello", "scene", "step" and "store". Each throws InputError that says
/// what is wrong and ignores unknown members.
std::unique_ptr<const Hello> read_hello(const Json&);
SceneAnswer read_scene_answer(const Json&, int vertices);
double read_step(const Json&);  ///< s of CPU time that the program reports, or NaN
std::size_t read_store(const Json&, int vertices);  ///< size in bytes of the state that follows

/// Says hello. Throws SolverFailure that says what is wrong with the answer.
std::unique_ptr<const Hello> say_hello(Connection&);

/// Gives the program a scene and the values of its own parameters.
SceneAnswer give_scene(Connection&, const Scene&, const Json& params);

/// Values of the program's own parameters: numbers as JSON numbers, all others as texts.
Json own_params(const Hello&, const Params&);

/// Gives the program a state to start from.
void load_state(Connection&, const State&);
/// Advances `count` steps of dt from t. Returns the CPU seconds that the program reports, or NaN.
double take_steps(Connection&, double t, double dt, int count);
/// Whether the time that a program reports (`word`) agrees with its CPU clock, all in s per step.
/// The tolerance is a tenth plus the cost of two empty exchanges, which allows for the caches of a
/// busy machine.
bool agrees(double word, double clock, double empty);
void store_state(Connection&, int vertices, State&);

/// Features of a scene that came after that version of the protocol, in a few words each. A program
/// that speaks an earlier version is not asked to run such a scene.
std::vector<std::string> beyond(int version, const Scene&);

/// The scene as a program gets it: JSON with everything resolved, in SI units, each double in its
/// shortest exact form. experiments/external/README.md explains every key.
std::string scene_file(const Scene&);

}  // namespace taut::external
