#pragma once

#include <string>

#include "experiments/answer/answer.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"

namespace taut {

/// Number of cases and how they ended: "20 cases: ok 18, exploded 2".
std::string ends_of(const std::vector<Record>&);

/// A metric value of a study's stored cases, with a row for each setting and a column for each
/// scene, both in the order of the study.
Table table_of(const Study&, const Store&, const std::string& value, const std::string& name);

}  // namespace taut
