// Jakobsen's algorithm (Advanced Character Physics, GDC 2001), link after link: a complete solver.
//     g++ -std=c++17 -O2 toy.cpp -o toy
#include <cmath>

#include "taut_solver.hpp"

struct Toy {
  static constexpr const char* kAbout =
      R"("name": "toy-cpp", "version": "1", "summary": "Jakobsen's algorithm in C++",
         "source": "Jakobsen, Advanced Character Physics, GDC 2001", "params": {"iterations":
         {"type": "integer", "min": 0, "max": 1000000, "default": 8, "doc": "Sweeps over all links in a step"}})";

  static std::vector<std::string> cannot(const taut_solver::Json& scene, const taut_solver::Json&) {
    for (const char* effect : {"colliders", "wind", "self_collision", "pin_motions", "damping"})
      if (scene[effect].something())
        return {"gravity, links and pins at rest are all that it knows"};
    return {};
  }

  struct Link {
    std::size_t a, b;
    double rest;
  };

  Toy(const taut_solver::Json& scene, const taut_solver::Json& params)
      : w(scene["inverse_mass"].numbers()),
        gravity(scene["gravity"].numbers()),
        h(scene["dt"].number),
        sweeps(params["iterations"].integer()) {
    for (const taut_solver::Json& l : scene["links"].items)
      links.push_back({static_cast<std::size_t>(l[0].integer()),
                       static_cast<std::size_t>(l[1].integer()), l[2].number});
  }

  void load(const double* now, const double* v) {
    x.assign(now, now + 3 * w.size());
    before = x;
    for (std::size_t k = 0; k < x.size(); ++k) before[k] -= h * v[k];
  }

  void step(double, double dt) {
    for (std::size_t k = 0; k < x.size(); ++k) {  // Verlet; pins have inverse mass 0
      const double now = x[k];
      if (w[k / 3] > 0) x[k] += now - before[k] + dt * dt * gravity[k % 3];
      before[k] = now;
    }
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (const auto& [a, b, rest] : links) {  // restores each rest length in turn
        double *p = &x[3 * a], *q = &x[3 * b];
        const double d[] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, both = w[a] + w[b];
        const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        if (both == 0 || length == 0) continue;
        const double share = (length - rest) / (length * both);
        for (int k = 0; k < 3; ++k) {
          p[k] += w[a] * share * d[k];
          q[k] -= w[b] * share * d[k];
        }
      }
  }

  void store(double* now, double* v) const {
    for (std::size_t k = 0; k < x.size(); ++k) {
      now[k] = x[k];
      v[k] = (x[k] - before[k]) / h;
    }
  }

  std::string extras() const {
    return R"(, "plan": [{"pass": "links", "items": )" + std::to_string(links.size()) +
           R"(, "repeats": )" + std::to_string(sweeps) + R"(, "projections": true}],
           "settings": {"projection": "exact", "precision": "double"})";
  }

  std::vector<double> w, gravity, x, before;  // 1/kg, m/s^2; m, now and a step ago
  std::vector<Link> links;
  double h;  // s
  int sweeps;
};

int main() { return taut_solver::serve<Toy>(); }
