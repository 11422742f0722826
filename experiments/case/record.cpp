#include "experiments/case/record.hpp"

#include <cmath>

namespace taut {

double Record::value(const std::string& name) const {
  const auto at = values.find(name);
  return at == values.end() ? std::nan("") : at->second;
}

}  // namespace taut
