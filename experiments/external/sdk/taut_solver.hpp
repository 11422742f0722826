// taut-solver/1 for C++17: copy this file beside your solver. It needs nlohmann/json.hpp alone
// (Debian: nlohmann-json3-dev; elsewhere one file of https://github.com/nlohmann/json).
//
//     struct Mine {
//       using Json = taut_solver::Json;
//       // The answer to "hello", without its protocol: {{"name", "mine"}, {"version", "1.0"},
//       {"params",
//       // {{"iterations", {{"type", "integer"}, {"min", 1}, {"max", 1000}, {"default", 8}}}}}}
//       static Json about();
//       // Why the scene would be misread; empty: it is not.
//       static std::vector<std::string> cannot(const Json& scene, const Json& params);
//       Mine(const Json& scene, const Json& params);  // double dt = scene.at("dt"); ...
//       void load(const double* x, const double* v);  // start here: 3n [m] and 3n [m/s]
//       void step(double t, double dt);               // advance from t to t + dt [s]
//       void store(double* x, double* v) const;       // 3n each
//       Json extras() const;  // more members of the answer to "scene": its plan, its settings
//     };
//     int main() { return taut_solver::serve<Mine>(); }
//
// A new version for every change that moves results. Standard output belongs to the protocol: print
// to standard error. MIT licence, as taut.
#pragma once

#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace taut_solver {

using Json = nlohmann::ordered_json;

/// Answers requests until the input ends.
template <class Solver>
int serve() {
  std::unique_ptr<Solver> live;
  std::size_t n = 0;
  std::vector<double> state;
  const auto cpu = [] {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
  };
  const auto answer_to = [&](const Json& request) -> Json {
    const std::string op = request.at("op");
    if (op == "hello") {
      Json answer = Solver::about();
      answer["protocol"] = "taut-solver/1";
      return answer;
    }
    if (op == "scene") {
      const std::string path = request.at("file");
      std::ifstream file(path, std::ios::binary);
      if (!file) throw std::runtime_error("cannot read " + path);
      const Json scene = Json::parse(file), &params = request.at("params");
      const std::vector<std::string> reasons = Solver::cannot(scene, params);
      if (!reasons.empty()) return {{"cannot", reasons}};
      live = std::make_unique<Solver>(scene, params);
      n = scene.at("vertices");
      state.assign(6 * n, 0);
      Json answer = live->extras();
      answer["vertices"] = n;
      return answer;
    }
    if (op != "load" && op != "step" && op != "store") throw std::runtime_error("unknown op " + op);
    if (op == "load") {
      std::string bytes(request.at("bytes").get<std::size_t>(), '\0');
      std::cin.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      if (bytes.size() != state.size() * sizeof(double))
        throw std::runtime_error("the state has another size");
      std::memcpy(state.data(), bytes.data(), bytes.size());
    }
    if (!live) throw std::runtime_error("no scene yet");
    if (op == "load") {
      live->load(state.data(), state.data() + 3 * n);
      return Json::object();
    }
    if (op == "step") {
      const double before = cpu(), t = request.at("t"), dt = request.at("dt");
      const int count = request.at("count");
      for (int k = 0; k < count; ++k) live->step(t + k * dt, dt);
      return {{"cpu_ns", cpu() - before}};
    }
    live->store(state.data(), state.data() + 3 * n);
    return {{"bytes", state.size() * sizeof(double)}};
  };
  for (std::string line; std::getline(std::cin, line);) {
    Json answer;
    try {
      answer = answer_to(Json::parse(line));
    } catch (const std::exception& error) {
      answer = {{"error", error.what()}};
    }
    line = answer.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
    std::fwrite(line.data(), 1, line.size(), stdout);
    if (answer.contains("bytes")) std::fwrite(state.data(), sizeof(double), state.size(), stdout);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace taut_solver
