#pragma once

#include <limits>
#include <vector>

namespace taut::reference {

/// A chain of equal links between two supports of equal height, an equal load at every joint.
struct Catenary {
  std::vector<double> x, y;     ///< [links + 1] m, from (0, 0) to (span, 0)
  std::vector<double> tension;  ///< [links] N
  double horizontal = 0;        ///< N, the same in every link
  double sag() const;           ///< m, depth of the lowest joint
};

/// tan(theta_i) = (P/H)(i - (N+1)/2) and sum of l_i cos(theta_i) = span: one monotone root H, by
/// bisection to the last bit. Links lengthen by T/stiffness; infinite stiffness [N/m] = rods.
/// Preconditions: links >= 2, load [N] > 0, 0 < span, and span < links * link for rods.
Catenary discrete_catenary(int links, double span, double link, double load,
                           double stiffness = std::numeric_limits<double>::infinity());

/// Sag [m] of an inextensible rope of `length` over `span`: 2a sinh(span/2a) = length.
double continuum_sag(double length, double span);

}  // namespace taut::reference
