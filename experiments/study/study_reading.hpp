#pragma once

#include <string>

#include "core/io/document.hpp"
#include "experiments/study/study.hpp"

// The parts of load_study() that know nothing of its keys.

namespace taut {

/// Whether text_of() can say the value: no date, and a table as TOML only.
bool has_text(const Value&, bool toml);
/// A value as a command line would have it: for a solver's parameter bare, for a scene key as TOML.
/// Precondition: has_text().
std::string text_of(const Value&, bool toml);

/// Reports what is wrong with the scenes of a study that is itself wrong: each with `set`, and with
/// every value of an axis by itself.
void judge_scenes(const Study&, Diagnostics&);

}  // namespace taut
