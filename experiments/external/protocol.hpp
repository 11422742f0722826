#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "experiments/external/connection.hpp"

namespace taut::external {

/// What a program answers to "hello".
struct Hello {
  std::string name, version, summary, source;
  int version_spoken = 1;    ///< n of taut-solver/n
  std::string unmeasurable;  ///< why its time says nothing; "": it does
  std::vector<ParamSpec> params;
  std::deque<std::string> texts;  ///< what the views of `params` see
};

/// What a program answers to "scene".
struct SceneAnswer {
  std::vector<std::string> cannot;  ///< why it would misread the scene; empty: it has loaded it
  std::vector<PassCost> plan;
  ResolvedSettings settings;
};

/// The answers to "hello", "scene", "step" and "store". Each throws InputError that says what is
/// wrong; members that nobody knows are ignored.
std::unique_ptr<const Hello> read_hello(const Json&);
SceneAnswer read_scene_answer(const Json&, int vertices);
double read_step(const Json&);  ///< s of CPU time as the program says; NaN: it does not say
std::size_t read_store(const Json&, int vertices);  ///< bytes of a state that follow

/// Says hello. Throws SolverFailure with what is wrong in the answer.
std::unique_ptr<const Hello> say_hello(Connection&);

/// Gives the program a scene and the values of its own parameters.
SceneAnswer give_scene(Connection&, const Scene&, const Json& params);

/// The values of the program's own parameters: numbers for numbers, texts for the others.
Json own_params(const Hello&, const Params&);

/// load, step and store.
void load_state(Connection&, const State&);
/// Advances `count` steps of dt from t; returns the CPU seconds that the program says it took, NaN
/// if it does not say.
double take_steps(Connection&, double t, double dt, int count);
/// Whether a program's word about its time agrees with its CPU clock: within a tenth and two empty
/// exchanges, what a busy machine's caches cost. [s] a step.
bool agrees(double word, double clock, double empty);
void store_state(Connection&, int vertices, State&);

/// What of a scene came after that version of the protocol, a few words each. A program that speaks
/// no later one is not asked for such a scene.
std::vector<std::string> beyond(int version, const Scene&);

/// The scene as a program gets it: JSON, everything resolved, SI units, doubles in shortest exact
/// form. Every key stands in experiments/external/README.md.
std::string scene_file(const Scene&);

}  // namespace taut::external
