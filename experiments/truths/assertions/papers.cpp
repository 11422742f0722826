#include "experiments/truths/assertions/assertions.hpp"
#include "experiments/truths/quoted.hpp"

namespace taut {

namespace {

using enum AssertionVerdict;

constexpr const char* kJakobsen = "Jakobsen, Advanced Character Physics, GDC 2001";
constexpr const char* kLiu = "Liu et al., Fast Simulation of Mass-Spring Systems, 2013";
constexpr const char* kWang = "Wang, A Chebyshev Semi-Iterative Approach, 2015";
constexpr const char* kXpbd = "Macklin, Mueller, Chentanez, XPBD, MIG 2016";
constexpr const char* kSmallSteps = "Macklin et al., Small Steps in Physics Simulation, SCA 2019";
constexpr const char* kVbd = "Chen, Liu, Yang, Yuksel, Vertex Block Descent, 2024";
constexpr const char* kQuasi =
    "Liu, Bouaziz, Kavan, Quasi-Newton Methods for Real-Time Simulation, TOG 2017";
constexpr const char* kPrimal =
    "Chen et al., Primal residual reduction with XPBD and hyperelasticity, C&G 2024";
constexpr const char* kMgpbd = "Li et al., MGPBD, SIGGRAPH 2025";
constexpr const char* kGoldenthal =
    "Goldenthal et al., Efficient Simulation of Inextensible Cloth, SIGGRAPH 2007";
constexpr const char* kVolino =
    "Volino, Magnenat-Thalmann, Implicit Midpoint Integration and Adaptive Damping";
constexpr const char* kAvbd = "Giles, Diaz, Yuksel, Augmented Vertex Block Descent, 2025";
constexpr const char* kPbd =
    "Mueller, Heidelberger, Hennix, Ratcliff, Position Based Dynamics, 2007";
constexpr const char* kBridson =
    "Bridson, Fedkiw, Anderson, Robust Treatment of Collisions, SIGGRAPH 2002";
constexpr const char* kFibers = "Bertails-Descoubes et al., A Nonsmooth Newton Solver, ACM 2011";
constexpr const char* kAdaptive =
    "Li et al., An Implicit Frictional Contact Solver for Adaptive Cloth Simulation, SIGGRAPH 2018";
constexpr const char* kDryFriction =
    "Ly et al., Projective Dynamics with Dry Frictional Contact, 2020";
constexpr const char* kCodimensional =
    "Li, Kaufman, Jiang, Codimensional Incremental Potential Contact, SIGGRAPH 2021";
constexpr const char* kLagged =
    "Larionov et al., Implicit Frictional Dynamics with Soft Constraints, 2023";
constexpr const char* kObi = "Obi 6.1, manual";
constexpr const char* kBlender = "Blender, manual, Cloth";

constexpr Assertion kOfPapers[] = {
    {kJakobsen, "5", "three to four passes are enough for a tetrahedron", holds,
     "four leave less than a tenth of the strain", "tetrahedron"},
    {kJakobsen, "3", "after projection the velocity has no component along the normal", holds,
     "two steps after an impact a particle is at rest to 1e-12 m/s", "plane-rest",
     quoted::kSpeedAfterImpact},
    {kJakobsen, "5", "a stick penetrates a small bump with neither of its ends inside", holds,
     "over a ridge of half-angle a between two ends l apart it is (l/2) cos a deep", "ridge"},
    {kJakobsen, "7",
     "a tangential velocity reduced in proportion to the penetration depth is Coulomb friction",
     holds_if,
     "of single particles, which slide down a slope as they should to 1e-12 m; in the sweeps of "
     "XPBD, with the same friction, a rope slips at 0.9 of the capstan's ratio",
     "incline-friction"},
    {kJakobsen, "7", "inaccuracies are smallest or even nonexistent when there is little motion",
     holds_if,
     "smallest they are: a hanging chain at rest keeps a strain of (N-1) g dt^2/(k l), and has "
     "1.8 times that on the way",
     "legitimate-strain"},
    {kLiu, "abstract", "it converges to the same result as Newton's method", holds,
     "1000 iterations end within 1e-9 m of Newton's step", "liu-newton"},
    {kWang, "abstract", "it saves at least one order of magnitude of iterations", holds_if,
     "where the plain iteration is slow: 13 times on a sheet that swings, 3 times on a hung one",
     "wang-chebyshev", quoted::kIterationsSavedSwinging},
    {kXpbd, "Fig. 2", "a compliant spring moves the same for any number of iterations", holds,
     "it is implicit Euler's spring to 1e-10", "xpbd-spring"},
    {kXpbd, "abstract",
     "in PBD the stiffness of a constraint depends on the iteration count and the time step", holds,
     "the strain of a hanging chain falls as 1/k and faster with k sweeps, and as the time step "
     "squared",
     "hanging-chain-slopes", quoted::kSlopeInTimeStep},
    {kXpbd, "Fig. 1",
     "stiffness is controlled in a manner independent of time step and iteration count", holds_if,
     "once its sweeps have converged: 1000 of a step, and 100 of each of 16 substeps, leave "
     "springs longer by the load below over K",
     "stiffness", "", "xpbd"},
    {kXpbd, "Fig. 3a",
     "the force of a chain is off by 6, 2 and 0.5 % at 50, 100 and 1000 iterations",
     cannot_be_tested,
     "the chain's link length, its start and the time of comparison are not in the paper", ""},
    {kXpbd, "Fig. 3b", "the residual falls linearly (on its logarithmic axis) with the iterations",
     holds_if, "from some 200 iterations on; at first it falls 7 times as fast", "xpbd-residual"},
    {kXpbd, "Table 1", "at equal iterations it costs less than 3 % more than PBD", cannot_be_tested,
     "by a truth, for time depends on the machine; `taut bench hang --solver "
     "jakobsen:projection=exact,substeps=1,order=mesh --solver xpbd:substeps=1,order=mesh,"
     "structural=1e-8` measures it",
     ""},
    {kSmallSteps, "abstract",
     "one large step of n iterations is less effective than n smaller steps of one iteration each",
     holds_if, "in double: in float the fall of a small step is rounded away (float-gravity)",
     "small-steps", "", "xpbd"},
    {kSmallSteps, "6.1",
     "1:1e5 in mass, 1000 frames: 100 iterations stretch a chain by 322.1 m, 100 substeps by 3.2 m",
     holds_if, "at 30 ms a frame, which the paper does not print", "small-steps-metres"},
    {kSmallSteps, "Fig. 4, left",
     "substeps leave an error two orders of magnitude below that of as many iterations", holds_if,
     "from 200 on (93 times); with 20 it is 19 times", "small-steps-residual"},
    {kSmallSteps, "Fig. 4, right", "the top multiplier is the weight below it, 190 N", holds,
     "to 1e-6, with 1 and with 50 sweeps", "xpbd-chain-force", quoted::kForceOfTopLink},
    {kSmallSteps, "cloth", "40 substeps cost 2.4 ms where 40 iterations cost 1.8", cannot_be_tested,
     "by a truth, for time depends on the machine; `taut bench hang --solver "
     "xpbd:iterations=40,substeps=1 --solver xpbd:iterations=1,substeps=40` measures the ratio",
     ""},
    {kVbd, "abstract", "it can achieve numerical convergence", holds_if,
     "of springs of 100 N/m with 6000 iterations, in contact, too; with a friction of 0.7, 2 of "
     "200 steps do not converge (every-step-in-contact)",
     "steps-in-contact", "", "vbd"},
    {kVbd, "Fig. 16", "one iteration of one substep is stable", holds_if,
     "bounded it is, from 1e4 to 1e8 N/m, but a stiff sheet that swings gains energy",
     "vbd-bounded"},
    {kVbd, "Fig. 21", "a strand of 1:1000 in mass holds where XPBD does not", holds,
     "0.7 % of strain where XPBD with as many iterations has 145 %; and it falls as it should",
     "vbd-mass-ratio"},
    {kVbd, "Fig. 24", "it fails to converge at 1:10 000 in stiffness", holds,
     "100 iterations leave 99 % of the error, 0.2 % where all links are alike",
     "vbd-stiffness-ratio", quoted::kErrorLeftByVbd},
    {kQuasi, "abstract", "Projective Dynamics can be interpreted as a quasi-Newton method", holds,
     "L-BFGS without pairs is Projective Dynamics, to 1e-13 m", "lbfgs-factor",
     quoted::kLbfgsWithoutPairs},
    {kQuasi, "abstract", "it is further accelerated by L-BFGS updates", holds_if,
     "in iterations, of soft springs; where they are stiff both stand still (`taut run methods`)",
     "lbfgs-factor", quoted::kLbfgsWithPairs},
    {kQuasi, "abstract", "it is typically more than 10 times faster than one Newton iteration",
     cannot_be_tested,
     "by a truth, for time depends on the machine, and its materials are hyperelastic solids", ""},
    {kQuasi, "abstract", "its result is often more accurate than that of one Newton iteration",
     cannot_be_tested,
     "often names no scene; of springs `taut run methods --table step.error` shows both", ""},
    {kPrimal, "abstract", "XPBD does not always lead to convergent behaviors", holds,
     "its sweeps come to rest beside the step of implicit Euler", "xpbd-fixed-point",
     quoted::kRestOfXpbdSweeps},
    {kPrimal, "abstract", "the cause is the approximate linearization of backward Euler", holds,
     "solved all at once, with no error of sweeps, links rest as far from the step",
     "primal-residual", quoted::kRestOfXpbdSolutions},
    {kPrimal, "abstract",
     "its modifications allow convergence that rivals Newton's method, if the budget is large",
     holds_if,
     "solved all at once with a line search and what tension resists across links, as primal=on; "
     "its own two are modifications of sweeps and are not built here",
     "primal-residual", quoted::kRestWithPrimalResidual},
    {kPrimal, "abstract", "PBD treats only energies that are quadratic in a constraint",
     cannot_be_tested, "the links of all solvers here have such an energy", ""},
    {kGoldenthal, "abstract", "very low strain along the warp and weft direction", holds_if,
     "of taut cloth; a slack sheet stretches by more than a tenth", "fast-projection"},
    {kGoldenthal, "1", "its solver keeps stretching below 1 %", holds_if,
     "of taut cloth, with three solutions a step", "fast-projection"},
    {kGoldenthal, "abstract", "it is a velocity filter that easily integrates into existing code",
     cannot_be_tested, "easily has no measure", ""},
    {kVolino, "abstract", "implicit midpoint offers significantly better accuracy", holds,
     "second order, and less than a tenth of implicit Euler's error with 64 steps a radian",
     "integrator-orders", quoted::kErrorOfMidpointRule},
    {kVolino, "abstract", "it is often overlooked, because of its poor stability", holds,
     "a sheet that swings flies apart within 4 s", "midpoint-stability",
     quoted::kMidpointRuleFliesApart},
    {kVolino, "1", "errors of implicit methods appear as numerical damping alone", holds_if,
     "of implicit Euler and BDF2, w h/2 and (w h)^3/4; the midpoint rule has none",
     "integrator-damping", quoted::kDampingOfBdf2},
    {kVolino, "abstract", "moderate viscous damping restores the stability of implicit midpoint",
     cannot_be_tested, "integrator=midpoint takes no damping here", ""},
    {kVolino, "abstract", "implicit midpoint takes even less time", cannot_be_tested,
     "by a truth, for time depends on the machine", ""},
    {kMgpbd, "abstract", "XPBD's sweeps often struggle with low-frequency errors and stall",
     holds_if,
     "where sheets are fine: sweeps grow as the square of the links a side, and as many solutions "
     "of all links at once as ever are enough",
     "solutions-and-sweeps"},
    {kMgpbd, "abstract", "constructing prolongators takes up to two thirds of the time",
     cannot_be_tested, "its multigrid is not built here", ""},
    {kMgpbd, "abstract", "it improves convergence rates significantly", cannot_be_tested,
     "its multigrid is not built here", ""},
    {kAvbd, "parameters", "alpha 0.95, beta 10 and gamma 0.99 do for all examples", holds_if,
     "for the sheets that were tried, hung and swinging: 2 % RMS strain with 15 iterations",
     "avbd-defaults"},
    {kPbd, "abstract",
     "penetrations can be resolved completely by projecting points to valid locations", holds_if,
     "of the points: what lies between two of them still cuts a ridge (ridge)", "plane-rest",
     quoted::kHeightAtRest},
    {kPbd, "Collision with Rigid Bodies",
     "testing only vertices is not enough, for small bodies fall through large triangles", holds,
     "a thread falls through a rod that is thinner than its links are long, each of 12 times",
     "hook"},
    {kPbd, "Constraint Projection",
     "corrections along the gradient conserve linear and angular momentum if masses are equal",
     holds_if,
     "linear momentum, to 1e-12 kg m/s; a link that spins at 6 rad/s keeps 69 % of its angular "
     "momentum for a second",
     "free-spin", quoted::kAngularMomentumLeft},
    {kBridson, "abstract",
     "it works with any technique for simulating the internal dynamics of the cloth",
     cannot_be_tested, "its repulsions, impulses and impact zones are not built here", ""},
    {kFibers, "abstract",
     "Newton's method on a nonsmooth function solves contact with exact Coulomb friction", holds_if,
     "if projected Gauss-Seidel takes over where its rounds do not converge, as in `pd` and `admm`",
     "steps-in-contact", "", "pd"},
    {kAdaptive, "abstract",
     "frictional contact of a nodal system needs no computation of the Delassus operator", holds_if,
     "at bodies, by an augmented Lagrangian within Newton's method (`implicit`); the paper's own "
     "solver and exact contact of cloth with cloth are not built here",
     "every-step-in-contact", "", "implicit"},
    {kDryFriction, "abstract",
     "contact and dry friction have a reasonable precision within a few iterations only",
     cannot_be_tested, "its splitting of the matrix is not built here: `pd` couples its contacts",
     ""},
    {kCodimensional, "abstract",
     "mid-surfaces of shells will not move closer than the applied thickness", cannot_be_tested,
     "its barrier is not built here", ""},
    {kLagged, "abstract",
     "inaccuracies near the stick-slip threshold come from lagging friction, not from smoothing it",
     cannot_be_tested,
     "no solver of ours smooths friction; with Coulomb's law a rope holds at 0.99 of the "
     "threshold and slides at 1.01 (capstan-of-triangles)",
     ""},
    {kObi, "Surface collisions",
     "with simplices instead of particles, gaps in between particles disappear", holds_if,
     "of edges, with faces=edges: a chord over a ridge leaves it to 2 % of its depth; rigid links "
     "catch on edges that are narrower than they are long",
     "ridge", quoted::kDepthWithEdges},
    {kBlender, "Collisions, Troubleshooting",
     "smaller steps catch fast-moving collisions with a higher probability", holds,
     "1 - D/s of the points pass a plate of thickness D unseen, and none once the way s of a step "
     "is shorter than D",
     "tunnelling", quoted::kMissesThickPlate},
};

}  // namespace

std::span<const Assertion> assertions_of_papers() { return kOfPapers; }

}  // namespace taut
