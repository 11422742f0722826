// Section 4: a stiffness in N/m is the spring constant, for coupled links and any time step.
#include <cmath>

#include "core/model/shortest.hpp"
#include "experiments/truths/probe.hpp"

namespace taut {

namespace {

constexpr int kLinks = 8;            // from the pinned row to the last
constexpr double kVertexMass = 0.1;  // kg, of every vertex
constexpr double kHeight = 1;        // m

/// Columns of 8 links that hang from their first vertices; the links along the rows carry nothing.
Scene hung(int columns) {
  Scene s = bare::sheet(columns, kLinks + 1, {.structural = true}, Lumping::equal, kHeight, kHeight,
                        kVertexMass * columns * (kLinks + 1));
  for (int i = 0; i < columns; ++i) s.pins.push_back(i);
  s.gravity = {0, -kG, 0};
  s.damping = 8;
  return s;
}

/// How far off the extension of a column's link is at worst, over the least extension.
double worst(const Scene& s, const State& state, double stiffness) {
  const std::vector<double> extension = strains(s, state);
  double most = 0;
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    const int nu = s.mesh.grid->nu, upper = s.links[l].a / nu, lower = s.links[l].b / nu;
    const double expected = (lower - upper) * (kLinks - upper) * kVertexMass * kG / stiffness;
    const double off = std::abs(extension[l] - expected);
    if (!(off <= most)) most = off;  // keeps NaN
  }
  return most / (kVertexMass * kG / stiffness);
}

void stiffness(Findings& findings) {
  for (const double k : {500.0, 5000.0, 50000.0}) {
    const std::string springs = ",precision=double,structural=" + shortest(k),
                      compliant = ",precision=double,structural=" + shortest(1 / k),
                      implicit = ",precision=double,stiffness=" + shortest(k);
    for (const std::string& solver :
         {"mass-spring:substeps=64" + springs, "mass-spring:substeps=100" + springs,
          "xpbd:iterations=1000,substeps=1" + compliant,
          "xpbd:iterations=100,substeps=16" + compliant, "bullet-deformable:substeps=1" + implicit,
          "bullet-deformable:substeps=16" + implicit})
      for (const int columns : {1, 3}) {
        const Scene s = hung(columns);
        if (!claims(findings, solver, s)) continue;
        Probe probe(s, solver);
        settle(probe, 1e-10, 16, 20 * 64);
        findings.below(solver,
                       "distance of an extension from (N-j+1) m g/K, in m g/K, columns: " +
                           std::to_string(columns),
                       "1", worst(s, probe.state(), k), 1e-9);
      }
  }
  for (const char* solver : {"jakobsen", "bullet"})
    if (findings.wants(solver)) findings.not_claimed(solver, "its links are rigid");
}

}  // namespace
}  // namespace taut

TAUT_TRUTH(stiffness) = {
    .name = "stiffness",
    .section = 4,
    .row = 14,
    .statement =
        "K [N/m] is K in coupled links too, at any time step: chains and sheets of 8 "
        "links at 500, 5000, 50000",
    .source = "statics",
    .check = taut::stiffness};
