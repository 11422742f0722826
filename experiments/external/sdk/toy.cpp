// Jakobsen's algorithm (Advanced Character Physics, GDC 2001), link after link: a complete solver.
//     g++ -std=c++17 -O2 toy.cpp -o toy
#include <cmath>

#include "taut_solver.hpp"

struct Toy {
  using Json = taut_solver::Json;

  static Json about() {
    const Json iterations{{"type", "integer"},
                          {"min", 0},
                          {"max", 1000000},
                          {"default", 8},
                          {"doc", "Sweeps over all links in a step"}};
    return {{"name", "toy-cpp"},
            {"version", "1"},
            {"summary", "Jakobsen's algorithm in C++"},
            {"source", "Jakobsen, Advanced Character Physics, GDC 2001"},
            {"params", {{"iterations", iterations}}}};
  }

  static std::vector<std::string> cannot(const Json& scene, const Json&) {
    for (const char* effect : {"colliders", "wind", "self_collision", "pin_motions", "damping"})
      if (!scene.at(effect).empty() && scene.at(effect) != 0)  // null and [] are empty
        return {"gravity, links and pins at rest are all that it knows"};
    return {};
  }

  struct Link {
    std::size_t a, b;
    double rest;
  };

  Toy(const Json& scene, const Json& params)
      : w(scene.at("inverse_mass")),
        gravity(scene.at("gravity")),
        h(scene.at("dt")),
        sweeps(params.at("iterations")) {
    for (const Json& link : scene.at("links")) links.push_back({link[0], link[1], link[2]});
  }

  void load(const double* now, const double* v) {
    x.assign(now, now + 3 * w.size()), before = x;
    for (std::size_t k = 0; k < x.size(); ++k) before[k] -= h * v[k];
  }

  void step(double, double dt) {
    for (std::size_t k = 0; k < x.size(); ++k) {  // Verlet; a pin has the inverse mass 0
      const double now = x[k];
      if (w[k / 3] > 0) x[k] += now - before[k] + dt * dt * gravity[k % 3];
      before[k] = now;
    }
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (const auto& [a, b, rest] : links) {  // each gets its rest length in turn
        double *p = &x[3 * a], *q = &x[3 * b];
        const double d[] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, both = w[a] + w[b];
        const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        if (both == 0 || length == 0) continue;
        const double share = (length - rest) / (length * both);
        for (int k = 0; k < 3; ++k) p[k] += w[a] * share * d[k], q[k] -= w[b] * share * d[k];
      }
  }

  void store(double* now, double* v) const {
    for (std::size_t k = 0; k < x.size(); ++k) now[k] = x[k], v[k] = (x[k] - before[k]) / h;
  }

  Json extras() const {
    const Json pass{
        {"pass", "links"}, {"items", links.size()}, {"repeats", sweeps}, {"projections", true}};
    return {{"plan", {pass}}, {"settings", {{"projection", "exact"}, {"precision", "double"}}}};
  }

  std::vector<double> w, gravity, x, before;  // 1/kg, m/s^2; m, now and a step ago
  std::vector<Link> links;
  double h;  // s
  int sweeps;
};

int main() { return taut_solver::serve<Toy>(); }
