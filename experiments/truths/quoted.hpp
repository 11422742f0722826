#pragma once

/// Quantities of truths whose numbers assertions quote (Assertion::figure). The truth that measures
/// a quantity and the assertion that quotes it both use its constant, so that a new wording loses
/// no number.
namespace taut::quoted {

inline constexpr const char* kIterationsSavedSwinging =
    "swinging: iterations to 0.03 of the step over those with rho 0.9999";
inline constexpr const char* kForceOfTopLink =
    "force of the top link of 20 at rest over the weight";
inline constexpr const char* kErrorLeftByVbd =
    "share of the first step's error left by 100 iterations, 1:10000";
inline constexpr const char* kLbfgsWithoutPairs = "distance after ten iterations over pd's";
inline constexpr const char* kLbfgsWithPairs = "distance after 60 iterations over pd's";
inline constexpr const char* kRestOfXpbdSweeps = "distance after 16384 over 8192 sweeps";
inline constexpr const char* kRestOfXpbdSolutions =
    "farthest vertex from it after 64 solutions, 32 x 32";
inline constexpr const char* kRestWithPrimalResidual = "distance after 64 solutions";
inline constexpr const char* kErrorOfMidpointRule =
    "error over implicit Euler's, 64 steps of 1/64 rad";
inline constexpr const char* kMidpointRuleFliesApart = "RMS strain after 4 s is above 1";
inline constexpr const char* kDampingOfBdf2 = "damping ratio over (w h)^3/4, w h = 0.1";
inline constexpr const char* kPopOfHaltedCloth = "largest acceleration at rest, 1/256 s: it pops";
inline constexpr const char* kSpeedAfterImpact = "speed two steps after the impact";
inline constexpr const char* kHeightAtRest = "height at rest";
inline constexpr const char* kMissesThickPlate =
    "share that misses a plate thicker than the travel";
inline constexpr const char* kDepthWithEdges = "depth of the chord, faces=edges";
inline constexpr const char* kSlopeInTimeStep = "slope in dt";
inline constexpr const char* kAngularMomentumLeft =
    "angular momentum after 64 steps of 1/64 s over that at 6 rad/s";

}  // namespace taut::quoted
