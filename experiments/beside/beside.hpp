// What an adapter is made of: the net, and the measurement, the same for other people's code and
// for ours. C++17 and the standard library alone.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <functional>
#include <vector>

namespace beside {

/// A square sheet of 1 m and 0.2 kg with structural and shear links, held at two corners.
struct Net {
  static constexpr int kSide = 32;
  static constexpr double kStep = 1.0 / 64, kStiffness = 1e4, kGravity = 9.81;  // s, N/m, m/s^2

  struct Point {
    double x, y, z;  ///< m; y is up
  };
  struct Link {
    int a, b;
    double rest;  ///< m
  };
  std::vector<Point> points;
  std::vector<Link> links;
  std::vector<int> pins = {0, kSide - 1};
  double mass = 0.2 / (kSide * kSide);  ///< kg, of each vertex

  Net() {
    const double spacing = 1.0 / (kSide - 1);
    for (int v = 0; v < kSide; ++v)
      for (int u = 0; u < kSide; ++u) points.push_back({u * spacing, -v * spacing, 0});
    for (int v = 0; v < kSide; ++v)
      for (int u = 0; u < kSide; ++u) {
        link(u, v, u + 1, v, spacing);
        link(u, v, u, v + 1, spacing);
        link(u, v, u + 1, v + 1, std::sqrt(2.0) * spacing);
        link(u + 1, v, u, v + 1, std::sqrt(2.0) * spacing);
      }
  }

 private:
  void link(int u, int v, int other_u, int other_v, double rest) {
    if (u < kSide && v < kSide && other_u < kSide && other_v < kSide)
      links.push_back({v * kSide + u, other_v * kSide + other_u, rest});
  }
};

inline double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr int kFew = 2, kMany = 18, kSteps = 4;

/// ns an iteration and vertex: the difference between the least times of a step of many and of a
/// step of few iterations, timed in turns in `rounds`. Each of the two advances its own motion.
inline double iteration(const std::function<void()>& few, const std::function<void()>& many,
                        int rounds = 40) {
  const auto time_of = [](const std::function<void()>& step) {
    const double start = cpu_seconds();
    for (int i = 0; i < kSteps; ++i) step();
    return (cpu_seconds() - start) / kSteps;
  };
  double least_few = 1e300, least_many = 1e300;
  for (int i = 0; i < rounds; ++i) {
    least_few = std::fmin(least_few, time_of(few));
    least_many = std::fmin(least_many, time_of(many));
  }
  return 1e9 * (least_many - least_few) / (kMany - kFew) / (Net::kSide * Net::kSide);
}

/// Prints a number whatever locale the code that is measured has set.
inline void print(double value, char end) {
  char text[32];
  const char* const to = std::to_chars(text, text + sizeof text, value).ptr;
  std::fwrite(text, 1, static_cast<std::size_t>(to - text), stdout);
  std::putchar(end);
}

/// Answers each line of standard input, until that ends, with a measurement of a net that starts
/// from rest. So the reader can measure several programs in turns.
/// `Sheet(net).step(iterations)` is a step of the code that is measured; `lowest()` [m] is how far
/// down it is, which shows that it simulates the net.
template <class Sheet>
int serve() {
  const Net net;
  for (int c; (c = std::getchar()) != EOF;) {
    if (c != '\n') continue;
    Sheet few(net);
    Sheet many(net);
    const double each = iteration([&] { few.step(kFew); }, [&] { many.step(kMany); });
    print(each, ' ');
    print(many.lowest(), '\n');
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace beside
