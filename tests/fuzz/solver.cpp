// Solver with parameters of every kind that is never run. Without the real solvers the fuzz targets
// build in a tenth of the time.
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
