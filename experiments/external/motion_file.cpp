#include "experiments/external/motion_file.hpp"

#include <map>
#include <mutex>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/external/connection.hpp"

namespace taut::external {

namespace {

using Kind = ParamSpec::Kind;

constexpr ParamSpec kParams[] = {
    {.name = "file", .kind = Kind::text, .help = "Positions: .npy, .pc2 or .obj"},
    {.name = "fps",
     .default_value = "0",
     .max = 1e6,
     .help = "frames a second; 0: one for each step"},
    {.name = "scale",
     .unit = "m",
     .default_value = "1",
     .min = 1e-6,
     .max = 1e6,
     .help = "the file's unit: 0.01 for centimetres"},
    {.name = "up",
     .kind = Kind::choice,
     .default_value = "y",
     .choices = "y|z",
     .help = "the axis that points up"},
    {.name = "rest",
     .kind = Kind::text,
     .help = "a file of the cloth at rest, in the file's order of vertices, if the motion does not "
             "begin as the scene does"},
};

MotionOptions options_of(const Params& params) {
  return {.file = params.value("file"),
          .fps = params.real("fps"),
          .scale = params.real("scale"),
          .z_up = params.choice("up") == "z",
          .rest = params.value("rest")};
}

/// Digest of all bytes on which the results depend.
std::string digest_of(const MotionOptions& options) {
  std::string all;
  for (const std::filesystem::path& file : {options.file, options.rest}) {
    if (file.empty()) continue;
    const std::unique_ptr<PositionReader> reader = open_positions(file);
    for (const std::filesystem::path& part : reader->header().files)
      all += sha256(read_text(part, std::size_t{1} << 32));
  }
  return sha256(all);
}

struct Entry {
  std::string name, implementation;
  SolverEntry entry;
};

SolverEntry positions() {
  SolverEntry entry = player([](const Params& params) { return opened(options_of(params)); });
  entry.params = kParams;
  entry.unsupported = [fits = entry.unsupported](const Scene& scene, const Params& params) {
    if (params.value("file").empty())
      return std::vector<std::string>{"no file is named: positions:file=mine.npy"};
    return fits(scene, params);
  };
  return entry;
}

}  // namespace

const SolverEntry kPositions = positions();

ComputedFrames opened(const MotionOptions& options) {
  ComputedFrames frames{.name = options.file.string(),
                        .fps = options.fps,
                        .scale = options.scale,
                        .z_up = options.z_up};
  frames.positions = open_positions(options.file);
  if (options.rest.empty()) return frames;
  frames.rest = open_positions(options.rest);
  frames.rest_name = options.rest.string();
  return frames;
}

const SolverEntry* recorded(const std::string& name, std::string_view params) {
  static std::mutex mutex;
  static std::map<std::string, Entry> entries;
  const MotionOptions options = options_of(Params(name, kParams, params));
  const std::string digest = digest_of(options);
  const std::string called = name == kPositions.name ? name_for(name, options.file.string()) : name;
  const std::lock_guard lock(mutex);
  const auto [at, fresh] = entries.try_emplace(called + digest);
  Entry& one = at->second;
  if (fresh) {
    one = {called, digest, kPositions};
    one.entry.name = one.name;
    one.entry.implementation = one.implementation;
  }
  return &one.entry;
}

std::string solver_text(const MotionOptions& o) {
  const auto quoted = [](const std::filesystem::path& file) {
    std::string text = "'";
    for (const char c : file.string()) text += c == '\'' ? "''" : std::string(1, c);
    return text + "'";
  };
  return "positions:file=" + quoted(o.file) + ",fps=" + shortest(o.fps) +
         ",scale=" + shortest(o.scale) + ",up=" + (o.z_up ? "z" : "y") +
         (o.rest.empty() ? "" : ",rest=" + quoted(o.rest));
}

}  // namespace taut::external
