#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>

#include "core/model/input_error.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/progress.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::creating {

namespace {

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

/// `kind`: "study" or "scene"; its template has @ where the name goes.
int write(const std::string& name, const std::string& kind, const std::string& next, bool json) {
  const std::filesystem::path file = file_of(name);
  std::string text = read_text(data_folder() / "templates" / (kind + ".toml"));
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
  const auto json = std::make_shared<bool>(false);
  for (CLI::App* sub : {study, scene}) {
    sub->add_option("NAME", *name, "NAME or path; the file is NAME.toml")->required();
    add_json(*sub, *json, "The name of the file");
  }
  return [name, study, json] {
    return study->parsed() ? write(*name, "study", "run", *json)
                           : write(*name, "scene", "case", *json);
  };
}

}  // namespace
}  // namespace taut::verb::creating

TAUT_VERB(new) = {.name = "new",
                  .group = VerbGroup::studies,
                  .summary = "Writes a commented study or scene that runs, to begin with",
                  .example = "taut new study mine\n  taut new scene my/cloth",
                  .bind = taut::verb::creating::bind};
