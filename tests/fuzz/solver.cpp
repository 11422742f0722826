// A solver with parameters of every kind, which is never run: without those that are, the fuzz
// targets cost a tenth to build.
#include "core/model/solver.hpp"

namespace taut {
namespace {

constexpr ParamSpec kParams[] = {
    {.name = "iterations",
     .kind = ParamSpec::Kind::integer,
     .default_value = "8",
     .max = 1e6,
     .help = "a whole number"},
    {.name = "omega",
     .kind = ParamSpec::Kind::real,
     .default_value = "1",
     .min = 0.1,
     .max = 1.9,
     .help = "a number"},
    {.name = "order",
     .kind = ParamSpec::Kind::choice,
     .default_value = "mesh",
     .choices = "mesh|coloured|random",
     .help = "a choice"},
};

}  // namespace
}  // namespace taut

TAUT_SOLVER(named) = {.name = "jakobsen",
                      .summary = "Parameters without a solver",
                      .source = "tests/fuzz",
                      .params = taut::kParams};
