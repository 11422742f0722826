// The test program, which is also the program that its tests start. Cases and timing workers are
// processes of the program that requests them, so it implements the two verbs of `taut` that run
// one.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <iostream>

#include "core/model/input_error.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/timing.hpp"

namespace {

/// Runs one of the verbs "case SCENE SOLVER --into FOLDER [--set KEY=VALUE]... [--frames N]",
/// "bench --worker SCENE SOLVER [--set KEY=VALUE]..."
int serve(std::vector<std::string> words) try {
  taut::CaseSpec spec;
  std::string folder, frames = "0";
  for (std::size_t i = words[0] == "case" ? 1 : 2; i < words.size(); ++i) {
    if (words[i] == "--set")
      spec.settings.push_back(words.at(++i));
    else if (words[i] == "--into")
      folder = words.at(++i);
    else if (words[i] == "--frames")
      frames = words.at(++i);
    else
      (spec.scene.empty() ? spec.scene : spec.solver) = words[i];
  }
  const taut::Case one = taut::make_case(spec);
  return words[0] == "case" ? run_into(one, folder, std::stoi(frames))
                            : taut::serve_timing(*one.scene, one.choice);
} catch (const taut::InputError& error) {
  std::cerr << error.what() << '\n';
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && (argv[1] == std::string("case") || argv[1] == std::string("bench")))
    return serve({argv + 1, argv + argc});
  const taut::Scratch scratch;  // what other programs leave behind is no test's input
  setenv("TEST_TMPDIR", (scratch.path().string() + "/").c_str(), 1);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
