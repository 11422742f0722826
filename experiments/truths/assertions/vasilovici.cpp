#include "experiments/truths/assertions/assertions.hpp"
#include "experiments/truths/quoted.hpp"

namespace taut {

namespace {

using enum AssertionVerdict;

constexpr const char* kReport = "Vasilovici, Cloth Simulation Report";

constexpr Assertion kOfVasilovici[] = {
    {kReport, "3", "stretch, shear and bend springs together give cloth its behaviour", holds_if,
     "of shear links: without them a square hung by two corners sags; bend links do little to a "
     "flat sheet",
     "spring-families"},
    {kReport, "3", "damping brings the system back to rest", holds,
     "the velocity of a free particle decays as exp(-damping t)", "damping-factor"},
    {kReport, "3", "without damping springs oscillate for ever", holds,
     "Verlet conserves the discrete energy of a spring", "hooke-oscillator"},
    {kReport, "3", "gravity is G = m g", holds,
     "everything falls alike, as the Verlet recurrence says", "free-fall"},
    {kReport, "3", "wind acts on a face as F = c (n . d) n, d the direction of the wind", holds_if,
     "with d relative to the face a sheet has a terminal speed; with d as printed it accelerates "
     "without end",
     "wind-literal"},
    {kReport, "3", "Verlet is more stable than Euler as printed", holds,
     "Verlet holds a spring up to a step of 2/w; the explicit Euler scheme gains energy at every "
     "step",
     "spring-step-limit"},
    {kReport, "3", "x - x' is a velocity while the time step is fixed", holds,
     "with steps h and h/2 by turns a free particle gets 4/3 as far as it should",
     "verlet-fixed-step"},
    {kReport, "4", "one sweep is mostly enough for good-looking animations (Jakobsen)",
     cannot_be_tested,
     "good-looking has no measure; one sweep leaves 21 % RMS stretch on a 16x16 sheet hung by two "
     "corners, dt = 1/64 s",
     ""},
    {kReport, "4, 4.1", "three sweeps suffice for a good result", holds_if,
     "to look right; they leave 6 % RMS stretch on a 16x16 sheet hung by two corners, dt = 1/64 s",
     "three-sweeps"},
    {kReport, "4", "the listing with the square root keeps the rest length", holds,
     "one projection of an isolated link gives it exactly", "exact-projection"},
    {kReport, "4", "the listing without the square root, as printed, keeps the rest length",
     does_not_hold, "it pushes the particles apart in every reading: two listings are spliced",
     "wrong-signs"},
    {kReport, "4", "the square root can be replaced by its first-order expansion", holds_if,
     "near the rest length: a strain e leaves -e^2/2; at five rest lengths the link collapses to "
     "0.385 of it",
     "sqrt-free-projection"},
    {kReport, "4", "without the square root a frame takes N divisions", holds_if,
     "with one sweep a frame; the three that the report takes make 3 N", "divisions"},
    {kReport, "4", "the time usage depends mostly on N square roots and N divisions",
     cannot_be_tested,
     "by a truth, for time depends on the machine; `taut_bench` (tests/bench) finds loads and "
     "stores of "
     "the "
     "particles to be what a projection of colour batches costs",
     ""},
    {kReport, "4", "without the square root the algorithm is hugely more efficient",
     cannot_be_tested,
     "by a truth, for time depends on the machine; `taut bench hang --solver "
     "jakobsen:projection=exact --solver jakobsen` measures it",
     ""},
    {kReport, "4.1", "strong springs make a system unstable", holds,
     "Verlet is stable up to a step of 2/w, which falls as the root of the stiffness",
     "spring-step-limit"},
    {kReport, "4.1", "weak springs make cloth look like rubber", holds,
     "a hanging chain of N links is m g N (N + 1)/(2 K) longer than at rest", "elastic-chain"},
    {kReport, "4.1", "stiff springs become solvable in a stable way if they are infinitely stiff",
     holds_if,
     "with a relaxation factor of at most 4/3 for one sweep, and not in plain Jacobi sweeps",
     "over-relaxation"},
    {kReport, "4.1", "relaxation converges to the expected lengths as the sweeps increase", holds,
     "the strain of a hanging chain falls as 1/k and faster", "hanging-chain-slopes"},
    {kReport, "4.1", "how many sweeps are needed depends on the simulation", holds,
     "what k sweeps leave of a hanging chain's strain grows with its links and as the time step "
     "squared",
     "hanging-chain-sweeps"},
    {kReport, "4.1", "Jacobi or Gauss-Seidel iteration, as implemented", holds_if,
     "plain Jacobi with an odd number of sweeps grows up to 2.41 times a step; averaged it does "
     "not",
     "plain-jacobi"},
    {kReport, "4.2.1", "a particle below the plane is put on it and stays", holds,
     "at rest within two steps", "plane-rest"},
    {kReport, "4.2.2", "cloth is kept out of a ball by moving its particles to the surface",
     holds_if, "of the particles; faces between them sink in by l^2/(4R)", "ball-drape"},
    {kReport, "4.2.3", "a box is created by four planes", does_not_hold,
     "it has six sides, and each has to keep particles out", "box-sides"},
    {kReport, "4.2.3", "a particle can only intersect one side at a time", holds_if,
     "if its way is tested: of where it is, the nearest side is found, not the one it came in by",
     "box-nearest-side"},
    {kReport, "4.2.3", "a test at every step finds each particle inside the box", holds_if,
     "if the way of a step is shorter than the box: of a thinner plate 1 - D/s of them pass",
     "tunnelling"},
    {kReport, "4.2.3", "relaxed after the collision, cloth passes through the box", holds_if,
     "it sinks 4 cm into a box of 40 cm, dt = 1/64 s, and not through", "box-before-relaxation"},
    {kReport, "4.2.3", "making the particle immovable cures it", holds_if,
     "if the cloth may stretch: it stays out, and to three times its length where it cannot slide",
     "box-freeze"},
    {kReport, "4.2.3", "stopping the integration for a step cures it, but depends on the time step",
     holds_if, "as to the dependence: it still sinks in, 5.6 times as deep at four times the step",
     "box-halt"},
    {kReport, "4.2.3", "stopped for a step, particles pop at large time steps", holds_if,
     "they pop at every step; the acceleration of a pop grows as the step shrinks", "box-halt",
     quoted::kPopOfHaltedCloth},
    {kReport, "4.2.4", "self-collision with an octree gives nice results", holds_if,
     "no faces of a folding sheet cross, where 120 do without; but its particles overlap by half "
     "their size",
     "octree-crossings"},
    {kReport, "4.2.4", "an octree fails where opposite corners collide", holds,
     "two particles that meet across a split pass as if there were no test", "octree-split"},
    {kReport, "4.2.4", "too large a particle radius keeps the cloth from moving at all", holds,
     "twice the spacing hangs in the air; with overlaps at rest left alone it falls", "octree-jam"},
    {kReport, "4.3", "particles that are not integrated hold the cloth", holds,
     "a sheet hung by two corners stays a flat square", "flat-square"},
};

}  // namespace

std::span<const Assertion> assertions_of_vasilovici() { return kOfVasilovici; }

}  // namespace taut
