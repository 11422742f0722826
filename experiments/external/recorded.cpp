#include "experiments/external/recorded.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/external/command.hpp"

namespace taut::external {

namespace {

using Kind = ParamSpec::Kind;

constexpr ParamSpec kParams[] = {
    {.name = "file", .kind = Kind::text, .help = "Positions: .npy, .pc2, .mdd, .obj, .ply, .traj"},
    {.name = "fps",
     .default_value = "0",
     .max = 1e6,
     .help = "frames in a second; 0: what the file says, else one a step"},
    {.name = "scale",
     .unit = "m",
     .default_value = "0",
     .max = 1e6,
     .help = "the file's unit; 0: of m, cm, mm and inch the one that fits"},
    {.name = "up",
     .kind = Kind::choice,
     .default_value = "auto",
     .choices = "auto|y|z",
     .help = "the axis that points up; auto: the one that fits"},
    {.name = "rest",
     .kind = Kind::text,
     .help =
         "a file with the cloth at rest in the file's order, if it does not begin as the scene"},
};

MotionOptions options_of(const Params& params) {
  return {.file = params.value("file"),
          .fps = params.real("fps"),
          .scale = params.real("scale"),
          .up = std::string(params.choice("up")),
          .rest = params.value("rest")};
}

/// Plays a motion as a solver would compute it.
class Playback final : public Solver {
 public:
  Playback(const Scene& scene, const MotionOptions& options) : motion_(scene, options) {
    if (!motion_.misfits().empty()) throw InputError(motion_.misfits().front());
  }
  void load(const State& state) override { state_ = state; }
  void step(double t, double dt) override {
    std::vector<Vec3> next = motion_.frame(static_cast<int>(std::lround(t / dt)) + 1);
    for (std::size_t i = 0; i < next.size(); ++i) state_.v[i] = (next[i] - state_.x[i]) / dt;
    state_.x = std::move(next);
  }
  void store(State& state) const override { state = state_; }
  std::vector<PassCost> step_cost() const override { return {}; }
  double cpu_seconds() const override { return std::numeric_limits<double>::quiet_NaN(); }
  std::size_t peak_bytes() const override { return 0; }
  std::string time_remark() const override { return "positions from a file: cost not measured"; }

 private:
  MotionFile motion_;
  State state_;
};

/// Of all bytes that the results depend on.
std::string digest_of(const MotionOptions& options) {
  std::string all;
  for (const std::filesystem::path& file : {options.file, options.rest}) {
    if (file.empty()) continue;
    const std::unique_ptr<PositionReader> reader = open_motion(file);
    for (const std::filesystem::path& part : reader->header().files)
      all += sha256(read_text(part, std::size_t{1} << 32));
  }
  return sha256(all);
}

struct Entry {
  std::string name, implementation;
  SolverEntry entry;
};

}  // namespace

const SolverEntry kPositions = {
    .name = "positions",
    .summary = "Positions that another program computed: positions:file=mine.npy",
    .source = "experiments/external/FILES.md",
    .params = kParams,
    .make = [](const Scene& scene, const Params& params) -> std::unique_ptr<Solver> {
      return std::make_unique<Playback>(scene, options_of(params));
    },
    .unsupported = [](const Scene& scene, const Params& params) -> std::vector<std::string> {
      const MotionOptions options = options_of(params);
      if (options.file.empty()) return {"no file is named: positions:file=mine.npy"};
      return MotionFile(scene, options).misfits();
    },
    .resolved_settings =
        [](const Scene& scene, const Params& params) {
          return MotionFile(scene, options_of(params)).settings(scene);
        }};

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
    one.entry.name = one.name, one.entry.implementation = one.implementation;
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
         ",scale=" + shortest(o.scale) + ",up=" + o.up +
         (o.rest.empty() ? "" : ",rest=" + quoted(o.rest));
}

}  // namespace taut::external
