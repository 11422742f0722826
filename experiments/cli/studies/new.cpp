#include <cctype>
#include <cstdint>

#include "core/io/drawn_scene.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::creating {

namespace {

struct Options {
  std::string kind, name, seed;
  bool contact = false, json = false;
};

/// File for a name: "mine" or "sub/mine.toml". Its name consists of letters, digits, '-', '_' and
/// '.'.
std::filesystem::path file_of(const std::string& name) {
  std::filesystem::path file = name.ends_with(".toml") ? name : name + ".toml";
  const std::string stem = file.stem();
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  };
  if (stem.empty() || stem.front() == '.' || !std::ranges::all_of(stem, plain))
    throw InputError("'" + name + "': a name has letters, digits, '-', '_' and '.' only");
  if (std::filesystem::exists(file)) throw InputError(file.string() + " already exists");
  return file;
}

/// Writes the scene of the seed and its mesh, if it has one.
std::vector<std::string> draw(const Options& o, const std::filesystem::path& file) {
  if (o.kind != "scene") throw InputError("--seed draws a scene: taut new scene NAME --seed N");
  const auto seed = whole<std::uint64_t>(o.seed);
  if (!seed) throw InputError("--seed: '" + o.seed + "' is not a whole number from 0 to 2^64 - 1");
  const DrawnScene drawn = drawn_scene(file.stem().string(), *seed, o.contact);
  if (drawn.obj.empty()) {
    write_durably(file, drawn.toml);
    return {file.string()};
  }
  const std::filesystem::path mesh = std::filesystem::path(file).replace_extension(".obj");
  if (std::filesystem::exists(mesh)) throw InputError(mesh.string() + " already exists");
  write_durably(mesh, drawn.obj);
  write_durably(file, drawn.toml);
  return {file.string(), mesh.string()};
}

/// Fills in the template of the kind, which has @ in place of the name.
int run(const Options& o) {
  const std::filesystem::path file = file_of(o.name);
  std::vector<std::string> written{file.string()};
  if (o.seed.empty()) {
    std::string text = read_text(data_folder() / "templates" / (o.kind + ".toml"));
    for (auto at = text.find('@'); at != std::string::npos; at = text.find('@'))
      text.replace(at, 1, file.stem().string());
    write_durably(file, text);
  } else {
    written = draw(o, file);
  }
  print_files(written, o.json);
  progress() << "next: taut " << (o.kind == "study" ? "run " : "case ")
             << (file.has_parent_path() ? file : "." / file).string()
             << (o.kind == "scene" ? " jakobsen" : "") << '\n';
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("KIND", o.kind, "study: of one scene and two solvers; scene: a sheet and a ball")
      .required()
      .check(known("kind", {"study", "scene"}));
  args.add_option("NAME", o.name, "NAME or path; the file is NAME.toml").required();
  args.add_option("--seed", o.seed,
                  "Draw the scene at random: sheet, strip, net or mesh, pins, masses, links, step; "
                  "a seed is the same scene everywhere");
  args.add_flag("--contact", o.contact, "Draw it above a ball, a box or a capsule").needs("--seed");
  add_json(args, o.json, "the name of the file");
}

}  // namespace
}  // namespace taut::verb::creating

TAUT_VERB(new) = {
    .name = "new",
    .group = VerbGroup::studies,
    .summary = "Writes a commented study or scene to start from",
    .example =
        "taut new study mine\n  taut new scene my/cloth\n"
        "  taut new scene drawn --seed 7 --contact",
    .bind = taut::bind_verb<taut::verb::creating::add_options, taut::verb::creating::run>};
