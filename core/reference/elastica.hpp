#pragma once

namespace taut::reference {

/// An inextensible strip that is clamped level at one end and bent by its own weight and by a
/// weight at its free end. Lengths are divided by its length L.
struct Elastica {
  double reach = 0;   ///< W/L: horizontal distance of the free end from the clamp
  double drop = 0;    ///< H/L: depth of the free end below the clamp
  double moment = 0;  ///< M L/B at the clamp, per width
};

/// Solves for the strip. With theta the angle below the level at s from the clamp, B the bending
/// stiffness [N m], w the
/// weight per area [N/m^2] and P the weight per width at the free end [N/m],
///
///     B theta'' = -(w (L - s) + P) cos(theta),   theta(0) = 0,   theta'(L) = 0.
///
/// gamma = w L^3/B, force = P L^2/B, not both zero. Shoots from the free end, where the angle to
/// the vertical only grows, by Runge-Kutta's fourth-order method in `steps` equal steps. The error
/// is of order steps^-4, below 1e-9 at gamma = 100.
Elastica elastica(double gamma, double force = 0, int steps = 2000);

/// Bending length over overhang, c/L = (B/w)^(1/3)/L, of a strip whose free end is seen from the
/// clamp at this angle below the level [rad] (ISO 9073-7, ASTM D1388). By bisection on gamma.
double bending_length(double angle);

/// Bending length over overhang after Peirce, The Handle of Cloth as a Measurable Quantity (J.
/// Text. Inst. 1930): (cos(angle/2)/(8 tan(angle)))^(1/3).
double peirce_bending_length(double angle);

}  // namespace taut::reference
