#include "Solver.hpp"
