#include "core/model/body_frames.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

std::vector<Vec3> BodyFrames::at(double t) const {
  const double last = static_cast<double>(places.size() - 1);
  const double moment = std::clamp(t * fps, 0.0, last), before = std::floor(moment);
  const std::vector<Vec3>& from = places[static_cast<std::size_t>(before)];
  const double share = moment - before;
  if (share == 0) return from;
  const std::vector<Vec3>& to = places[static_cast<std::size_t>(before) + 1];
  std::vector<Vec3> x(from.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = from[i] + share * (to[i] - from[i]);
  return x;
}

}  // namespace taut
