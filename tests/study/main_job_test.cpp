// The main job, which `taut run` runs without a study: keys of main-job.toml and errors in that
// file.
#include "experiments/study/main_job.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"

namespace taut::main_job_test {
namespace {

class MainJobFile : public testing::Test {
 protected:
  MainJobFile() { setenv("TAUT_DATA", folder_.path().c_str(), 1); }
  ~MainJobFile() override { unsetenv("TAUT_DATA"); }
  MainJob read(const std::string& text) const {
    write_file(folder_.path() / "main-job.toml", text);
    return main_job();
  }
  /// Line, column and message of each error.
  std::vector<std::string> wrong(const std::string& text) const {
    std::vector<std::string> all;
    try {
      read(text);
    } catch (const InputError& error) {
      for (const Diagnostic& d : error.diagnostics())
        all.push_back(std::to_string(d.line) + ":" + std::to_string(d.column) + ": " + d.message);
    }
    return all;
  }
  const Scratch folder_;
};

TEST_F(MainJobFile, HasEveryPartOfTheJob) {
  const MainJob job =
      read("preset = \"p\"\nstudies = [\"b\", \"a\"]\nmaps = [\"m\"]\nbench = \"t\"\n");
  EXPECT_EQ(job.preset, "p");
  EXPECT_EQ(job.studies, (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(job.maps, std::vector<std::string>{"m"});
  EXPECT_EQ(job.bench, "t");
  EXPECT_TRUE(job.steps.empty());
}

TEST_F(MainJobFile, WhatIsWrongIsNamedAllAtOnce) {
  const auto all = wrong("studies = [\"b\", 3]\nmaps = \"m\"\nbenhc = \"t\"\n");
  ASSERT_EQ(all.size(), 5u);
  std::string text;
  for (const std::string& one : all) text += one + "\n";
  for (const char* said :
       {"1:17: 'studies' in the main job must be a list of strings, not a whole number",
        "2:8: 'maps' in the main job must be a list of strings", "missing key 'preset'",
        "missing key 'bench'", "3:1: unknown key 'benhc' in the main job; did you mean 'bench'?"})
    EXPECT_NE(text.find(said), std::string::npos) << said << " in\n" << text;
}

}  // namespace
}  // namespace taut::main_job_test
