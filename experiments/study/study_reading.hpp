#pragma once

#include <string>

#include "core/io/document.hpp"
#include "experiments/study/study.hpp"

// Parts of load_study() that do not depend on the study's keys.

namespace taut {

/// Whether text_of() can express the value: not a date, and a table only as TOML.
bool has_text(const Value&, bool toml);
/// A value as typed on a command line: bare for a solver's parameter, as TOML for a scene key.
/// Precondition: has_text().
std::string text_of(const Value&, bool toml);

/// Reports errors of the scenes of a study that itself has errors. Checks each scene with `set`,
/// and with each value of an axis by itself.
void judge_scenes(const Study&, Diagnostics&);

}  // namespace taut
