#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>

#include "core/model/input_error.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/progress.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::creating {

namespace {

constexpr const char* kStudy = R"(# A study asks one question: scenes x solvers x settings.
# Run it:    taut run ./@.toml
# Draw it:   taut plot ./@.toml
# Table:     taut export ./@.toml -o @.csv

question = "How much stretch is left after how many sweeps?"

# Names of shipped scenes (taut list scenes), or paths: "./mine.toml".
scenes = ["hang"]

# "name" or "name:parameter=value,..." (taut list solvers).
solvers = ["jakobsen:substeps=1", "bullet"]

# Keys of the scene that every case has instead of its own.
set = ["cloth.grid=[12, 12]", "time.duration=1"]

# What varies: parameters of solvers, or keys of the scene, whose names have a dot and stand in
# quotes. A list, or a range such as { from = 1, to = 64, steps = 7, scale = "log" }.
[axes]
iterations = [1, 4, 16]
# "time.dt" = ["1/60", "1/120"]

# A smaller or larger version: taut run ./@.toml --preset large
[preset.large]
set = ["cloth.grid=[48, 48]", "time.duration=4"]

# Figures of `taut plot`. Values: taut list metrics.
[[plot]]
kind = "error-iterations"
x = "iterations"
y = "stretch.rms"
title = "RMS stretch against sweeps"
)";

constexpr const char* kScene =
    R"(# A scene says what exists and what acts on it; lengths in m, masses in kg, times in s.
# Look at it:   taut render ./@.toml --solver jakobsen
# Run it:       taut case ./@.toml jakobsen

summary = "A sheet hung by two corners that the wind blows against a ball"

[cloth]
grid = [16, 16]               # vertices along x and down
size = [1.0, 1.0]             # rest lengths
mass = 0.2
pins = ["top-left", "top-right"]
# weights = [{ vertices = ["bottom"], factor = 10 }]

[links]
structural = true
shear = true
bend = false

[forces]
gravity = [0, -9.81, 0]
damping = 0.1                 # 1/s

[wind]
velocity = [0, 0, 4]
strength = 0.1

[[collider]]
type = "ball"                 # or "plane", "box"
center = [0.5, -0.6, 0.5]
radius = 0.3
friction = 0.3

[time]
dt = "1/60"
duration = 2
)";

/// "mine" or "sub/mine.toml" -> the file; letters, digits, '-', '_' and '.' in its name.
std::filesystem::path file_of(const std::string& name) {
  std::filesystem::path file = name.ends_with(".toml") ? name : name + ".toml";
  const std::string stem = file.stem();
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  };
  if (stem.empty() || stem.front() == '.' || !std::ranges::all_of(stem, plain))
    throw InputError("'" + name + "': a name has letters, digits, '-', '_' and '.' only");
  if (std::filesystem::exists(file)) throw InputError(file.string() + " is there already");
  return file;
}

int write(const std::string& name, std::string text, const std::string& next, bool json) {
  const std::filesystem::path file = file_of(name);
  for (auto at = text.find('@'); at != std::string::npos; at = text.find('@'))
    text.replace(at, 1, file.stem().string());
  write_durably(file, text);
  print_files({file.string()}, json);
  progress() << "next: taut " << next << ' '
             << (file.has_parent_path() ? file : "." / file).string()
             << (next == "case" ? " jakobsen" : "") << '\n';
  return kPass;
}

std::function<int()> bind(CLI::App& app) {
  app.require_subcommand(1);
  const auto name = std::make_shared<std::string>();
  CLI::App* study = app.add_subcommand("study", "A commented study of one scene and two solvers");
  CLI::App* scene = app.add_subcommand("scene", "A commented scene of a sheet and a ball");
  for (CLI::App* sub : {study, scene})
    sub->add_option("NAME", *name, "NAME or path; the file is NAME.toml")->required();
  const auto json = std::make_shared<bool>(false);
  for (CLI::App* sub : {study, scene})
    add_json(*sub->fallthrough(), *json, "The name of the file");  // --quiet is the verb's own
  return [name, study, json] {
    return study->parsed() ? write(*name, kStudy, "run", *json)
                           : write(*name, kScene, "case", *json);
  };
}

}  // namespace
}  // namespace taut::verb::creating

TAUT_VERB(new) = {.name = "new",
                  .group = VerbGroup::studies,
                  .summary = "Writes a commented study or scene that runs, to begin with",
                  .example = "taut new study mine\n  taut new scene my/cloth",
                  .bind = taut::verb::creating::bind};
