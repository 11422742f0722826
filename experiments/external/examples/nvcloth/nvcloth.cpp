// NvCloth's CPU solver (NVIDIA, github.com/NVIDIAGameWorks/NvCloth) as a solver in float32. It uses
// the scene's links, rest lengths and inverse masses with stiffness 1, and its gravity, damping,
// pins, colliders at rest and self-collision. How to build it: experiments/external/README.md.
#include <NvCloth/Callbacks.h>
#include <NvCloth/Cloth.h>
#include <NvCloth/Fabric.h>
#include <NvCloth/Factory.h>
#include <NvCloth/PhaseConfig.h>
#include <NvCloth/Solver.h>
#include <foundation/PxErrorCallback.h>
#include <foundation/PxQuat.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "taut_solver.hpp"

namespace {

using nv::cloth::Range;
using physx::PxVec4;
using taut_solver::Json;

struct Allocator : physx::PxAllocatorCallback {
  void* allocate(std::size_t size, const char*, const char*, int) override {
    return std::aligned_alloc(16, (size + 15) / 16 * 16);
  }
  void deallocate(void* block) override { std::free(block); }
};

struct Log : physx::PxErrorCallback, nv::cloth::PxAssertHandler {
  void reportError(physx::PxErrorCode::Enum, const char* message, const char*, int) override {
    std::fprintf(stderr, "%s\n", message);
  }
  void operator()(const char* assertion, const char*, int, bool&) override {
    std::fprintf(stderr, "%s\n", assertion);
  }
};

template <class T>
Range<const T> range(const std::vector<T>& all) {
  return {all.data(), all.data() + all.size()};
}

PxVec4 vector4(const Json& v, double w) {
  const std::vector<double> x = v.numbers();
  return {float(x[0]), float(x[1]), float(x[2]), float(w)};
}

nv::cloth::Factory& factory() {
  static nv::cloth::Factory* one = NvClothCreateFactoryCPU();
  return *one;
}

/// Sets of links of one family that share no vertex. Each link goes into the first set of its
/// family that has room.
std::vector<std::vector<std::uint32_t>> sets_of(const std::vector<Json>& links) {
  struct Set {
    std::string family;
    std::map<std::uint32_t, bool> taken;
  };
  std::vector<Set> sets;
  std::vector<std::vector<std::uint32_t>> members;
  for (std::uint32_t k = 0; k < links.size(); ++k) {
    const auto a = std::uint32_t(links[k][0].integer()), b = std::uint32_t(links[k][1].integer());
    std::size_t s = 0;
    while (s < sets.size() &&
           (sets[s].family != links[k][3].text || sets[s].taken.count(a) || sets[s].taken.count(b)))
      ++s;
    if (s == sets.size()) {
      sets.push_back({links[k][3].text, {}});
      members.emplace_back();
    }
    members[s].push_back(k);
    sets[s].taken[a] = sets[s].taken[b] = true;
  }
  return members;
}

struct NvCloth {
  static constexpr const char* kAbout =
      R"("name": "nvcloth", "version": "1.1.6", "summary": "NvCloth's solver on the CPU",
         "source": "NVIDIA, NvCloth 1.1.6", "params": {"substeps": {"type": "integer", "min": 1,
         "max": 10000, "default": 5, "doc": "NvCloth's iterations: substeps of one sweep each"}})";

  static std::vector<std::string> cannot(const Json& scene, const Json&) {
    std::vector<std::string> reasons;
    if (scene["wind"].something()) reasons.push_back("its wind follows another law");
    if (scene["pin_motions"].something()) reasons.push_back("moving pins: not mapped to NvCloth");
    std::size_t planes = 0;
    for (const Json& collider : scene["colliders"].items) {
      planes += collider["type"].text == "plane" ? 1 : collider["type"].text == "box" ? 6 : 0;
      if (collider["motion"].something())
        reasons.push_back("moving colliders: not mapped to NvCloth");
      if (collider["friction"].number != scene["colliders"][0]["friction"].number)
        reasons.push_back("one coefficient of friction for all colliders");
    }
    if (planes > 32) reasons.push_back("at most 32 planes, six for a box");
    if (scene["vertices"].integer() > 65000) reasons.push_back("indices of 16 bits");
    return reasons;
  }

  NvCloth(const Json& scene, const Json& params)
      : w(scene["inverse_mass"].numbers()),
        links(scene["links"].size()),
        substeps(params["substeps"].integer()),
        h(scene["dt"].number / substeps) {
    std::vector<std::uint32_t> phases, ends, ids;
    std::vector<float> rest;
    std::vector<nv::cloth::PhaseConfig> configs;
    for (const auto& set : sets_of(scene["links"].items)) {
      configs.emplace_back(std::uint16_t(phases.size()));
      phases.push_back(std::uint32_t(phases.size()));
      for (const std::uint32_t k : set) {
        const Json& link = scene["links"][k];
        ids.push_back(std::uint32_t(link[0].integer()));
        ids.push_back(std::uint32_t(link[1].integer()));
        rest.push_back(float(link[2].number));
      }
      ends.push_back(std::uint32_t(rest.size()));
    }
    std::vector<PxVec4> start, at_rest;
    for (std::size_t i = 0; i < w.size(); ++i) {
      start.push_back(vector4(scene["x"][i], w[i]));
      at_rest.push_back(vector4(scene["rest"][i], 0));
    }
    fabric = factory().createFabric(std::uint32_t(w.size()), range(phases), range(ends),
                                    range(rest), {}, range(ids), {}, {}, {});
    cloth.reset(factory().createCloth(range(start), *fabric));
    cloth->setPhaseConfig(range(configs));
    cloth->setGravity(vector4(scene["gravity"], 0).getXYZ());
    cloth->setSolverFrequency(float(1 / h));
    // NvCloth leaves a share 1 - (1 - stiffness)^(h f) of a correction, and treats damping
    // likewise. With f = 1/h both values hold for one substep. NvCloth's default of 10 Hz would
    // weaken every stiffness below 1.
    cloth->setStiffnessFrequency(float(1 / h));
    cloth->setAcceleationFilterWidth(1);  // full gravity from the first step on
    cloth->setDamping(physx::PxVec3(float(1 - std::exp(-scene["damping"].number * h))));
    set_colliders(scene["colliders"].items, scene["thickness"].number);
    if (scene["self_collision"].something()) {
      cloth->setRestPositions(range(at_rest));
      cloth->setSelfCollisionDistance(float(2 * scene["self_collision"]["radius"].number));
      cloth->setSelfCollisionStiffness(1);
    }
    solver.reset(factory().createSolver());
    solver->addCloth(cloth.get());
  }

  ~NvCloth() {
    solver->removeCloth(cloth.get());
    cloth.reset();
    fabric->decRefCount();
  }

  /// A plane, or six planes for a box, is a convex solid. The cloth has a single friction
  /// coefficient.
  void set_colliders(const std::vector<Json>& colliders, double thickness) {
    std::vector<PxVec4> balls, planes;
    std::vector<std::uint32_t> solids;
    const auto add_plane = [&](physx::PxVec3 normal, double offset) {
      planes.emplace_back(normal, float(-offset - thickness));
      return 1u << (planes.size() - 1);
    };
    for (const Json& collider : colliders) {
      const std::string& type = collider["type"].text;
      cloth->setFriction(float(collider["friction"].number));
      if (type == "plane") {
        solids.push_back(
            add_plane(vector4(collider["normal"], 0).getXYZ(), collider["offset"].number));
      } else if (type == "ball") {
        balls.push_back(vector4(collider["center"], collider["radius"].number + thickness));
      } else {
        const std::vector<double> q = collider["rotation"].numbers();
        const physx::PxQuat turn{float(q[1]), float(q[2]), float(q[3]), float(q[0])};
        const physx::PxVec3 center = vector4(collider["center"], 0).getXYZ();
        solids.push_back(0);
        for (unsigned k = 0; k < 6; ++k) {
          physx::PxVec3 normal(0);
          normal[k / 2] = k % 2 == 0 ? 1.f : -1.f;
          normal = turn.rotate(normal);
          solids.back() |=
              add_plane(normal, normal.dot(center) + collider["half_extents"][k / 2].number);
        }
      }
    }
    cloth->setSpheres(range(balls), 0, 0);
    cloth->setPlanes(range(planes), 0, 0);
    cloth->setConvexes(range(solids), 0, 0);
  }

  void load(const double* x, const double* v) {
    auto now = cloth->getCurrentParticles(), before = cloth->getPreviousParticles();
    for (std::uint32_t i = 0; i < w.size(); ++i, x += 3, v += 3) {
      now[i] = PxVec4(float(x[0]), float(x[1]), float(x[2]), float(w[i]));
      for (unsigned k = 0; k < 3; ++k) before[i][k] = float(x[k] - h * v[k]);
    }
  }

  void step(double, double dt) {
    solver->beginSimulation(float(dt));
    for (int k = 0; k < solver->getSimulationChunkCount(); ++k) solver->simulateChunk(k);
    solver->endSimulation();
  }

  void store(double* x, double* v) const {
    const nv::cloth::Cloth& after = *cloth;
    const auto now = after.getCurrentParticles(), before = after.getPreviousParticles();
    for (std::uint32_t i = 0; i < w.size(); ++i)
      for (unsigned k = 0; k < 3; ++k) {
        *x++ = now[i][k];
        *v++ = w[i] > 0 ? (double(now[i][k]) - before[i][k]) / h : 0;
      }
  }

  std::string extras() const {
    return R"(, "plan": [{"pass": "links", "items": )" + std::to_string(links) +
           R"(, "repeats": )" + std::to_string(substeps) +
           R"(, "projections": true}], "settings": {"precision": "float32",
              "order": "coloured by family", "projection": "exact, stiffness 1"})";
  }

  std::vector<double> w;  // 1/kg
  std::size_t links;
  int substeps;
  double h;  // s, length of a substep
  nv::cloth::Fabric* fabric = nullptr;
  std::unique_ptr<nv::cloth::Cloth> cloth;
  std::unique_ptr<nv::cloth::Solver> solver;
};

}  // namespace

int main() {
  Allocator allocator;
  Log log;
  nv::cloth::InitializeNvCloth(&allocator, &log, &log, nullptr);
  return taut_solver::serve<NvCloth>();
}
