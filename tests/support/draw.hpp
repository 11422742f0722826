#pragma once

#include <array>
#include <random>

#include "core/model/vec3.hpp"

namespace taut {

/// Random numbers, the same on every machine.
class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double number(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random_);
  }
  Vec3 vector(double size) {  // braces evaluate from left to right with every compiler
    return Vec3{std::array{number(-size, size), number(-size, size), number(-size, size)}.data()};
  }

 private:
  std::mt19937 random_;
};

}  // namespace taut
