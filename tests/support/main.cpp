// The test program, which is also the program that its tests start. Cases and timing workers are
// processes of the program that requests them, so it implements the two verbs of `taut` that run
// one.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <locale>

#include "core/model/input_error.hpp"
#include "experiments/study/isolate.hpp"
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
  // tests/cli/locales_test.py: what a program that embeds the library may have done.
  if (const char* locale = std::getenv("TAUT_TESTS_LOCALE"))
    std::locale::global(std::locale(locale));
  if (argc > 1 && (argv[1] == std::string("case") || argv[1] == std::string("bench")))
    return serve({argv + 1, argv + argc});
  // What other programs leave behind is no test's input. No Scratch: it starts a thread, which a
  // forked death test does not have.
  std::string folder = (std::filesystem::temp_directory_path() / "taut-tests.XXXXXX").string();
  if (!mkdtemp(folder.data())) {
    std::cerr << "cannot make a folder like " << folder << '\n';
    return 1;
  }
  setenv("TEST_TMPDIR", (folder + "/").c_str(), 1);
  testing::InitGoogleTest(&argc, argv);
  const int status = RUN_ALL_TESTS();
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return status;
}
