#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <sstream>

#include "core/io/document.hpp"
#include "core/io/text_file.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut::cluster {

namespace fs = std::filesystem;

namespace {

constexpr int kSchema = 1;
constexpr const char* kManifestFile = "manifest.jsonl";
// A case of a few hundred vertices holds 15 MB.
constexpr std::size_t kProgramBytes = std::size_t{64} << 20, kElementBytes = 2048;

/// Copies scene files of the user's own below `folder`, each once.
class SceneFiles {
 public:
  explicit SceneFiles(fs::path folder) : folder_(std::move(folder)) {}

  /// The scene's name within the folder, or as it is if it is a shipped one.
  std::string copied(const CaseSpec& spec) {
    const fs::path file = find_scene(spec.scene);
    if (file.parent_path() == data_folder() / "scenes" || !fs::exists(spec.scene))
      return spec.scene;
    auto [at, fresh] = copies_.try_emplace(spec.scene, "");
    if (fresh) {
      at->second = fs::path("scenes") / std::to_string(copies_.size()) / file.filename();
      make_folder((folder_ / at->second).parent_path());
      write_file(folder_ / at->second, read_text(file));
    }
    copy_mesh(file, spec.overrides, (folder_ / at->second).parent_path());
    return at->second;
  }

 private:
  void copy_mesh(const fs::path& scene, const std::vector<std::string>& overrides,
                 const fs::path& into) {
    std::string address = scene;
    for (const std::string& text : overrides) address += '\n' + text;
    if (!seen_.insert(address).second) return;
    const Document document = read_document(scene, overrides);
    const Value* cloth = document.root.find("cloth");
    const Value* mesh = cloth && cloth->is_table() ? cloth->find("mesh") : nullptr;
    if (!mesh || !mesh->is_string()) return;
    const fs::path name(mesh->string);
    if (name.is_absolute() || std::ranges::find(name, "..") != name.end())
      throw InputError({document.diagnostic(
          mesh->place, "a mesh that goes to other machines lies in the scene's folder or below")});
    make_folder((into / name).parent_path());
    write_file(into / name, read_text(scene.parent_path() / name, kMostMeshBytes));
  }

  fs::path folder_;
  std::map<std::string, fs::path> copies_;
  std::set<std::string> seen_;
};

Json line_of(const PlannedCase& one) {
  Json json{{"key", one.key}, {"shard", one.shard}, {"work", one.work}, {"id", one.id}};
  json.update(Json(one.spec));
  return json;
}

PlannedCase planned(const JsonReader& j, int shards) {
  PlannedCase one{j.at("key").text(),
                  j.at("id").text(),
                  {},
                  j.at("shard").integer(1, shards),
                  j.at("work").number()};
  read_into(j, one.spec);
  if (!is_key(one.key)) j.at("key").fail("expected 64 hexadecimal digits");
  return one;
}

constexpr std::tuple kFields{Field{"study", &Manifest::study}, Field{"preset", &Manifest::preset},
                             Field{"build", &Manifest::build}, Field{"digest", &Manifest::digest},
                             Field{"case_memory", &Manifest::case_memory}};

Manifest header_of(const JsonReader& j) {
  j.require_schema(kSchema);
  Manifest manifest = read_as(j, kFields);
  manifest.shards = j.at("shards").integer(1, kMostShards);
  manifest.limits = {j.at("case_seconds").number(), j.at("case_bytes").count()};
  return manifest;
}

}  // namespace

double estimated_seconds(double work) { return 0.1 + 1.5e-8 * work; }

double Manifest::seconds_of(int shard) const {
  double seconds = 0;
  for (const PlannedCase& one : cases)
    if (one.shard == shard) seconds += estimated_seconds(one.work);
  return seconds;
}

void share_out(Manifest& manifest) {
  std::vector<PlannedCase*> longest;
  for (PlannedCase& one : manifest.cases) longest.push_back(&one);
  std::ranges::sort(longest, {}, [](const PlannedCase* one) {
    return std::pair(-one->work, std::string_view(one->key));
  });
  using Load = std::pair<double, int>;  // seconds and shard
  std::priority_queue<Load, std::vector<Load>, std::greater<>> least;
  for (int shard = 1; shard <= manifest.shards; ++shard) least.emplace(0, shard);
  for (PlannedCase* one : longest) {
    const auto [seconds, shard] = least.top();
    least.pop();
    one->shard = shard;
    least.emplace(seconds + estimated_seconds(one->work), shard);
  }
}

Manifest plan(const Study& study, const Limits& limits, const fs::path& folder) {
  Manifest manifest{study.name, study.preset, program_digest(), {}, 1, limits, 0, {}};
  SceneFiles files(folder);
  for (const Case& one : taut::cases_of(study)) {
    manifest.cases.push_back({one.key, one.id, one.spec, 1, estimated_work(one)});
    manifest.cases.back().spec.scene = files.copied(one.spec);
    manifest.case_memory = std::max(
        manifest.case_memory, kProgramBytes + kElementBytes * (to_index(one.scene->mesh.size()) +
                                                               one.scene->links.size()));
  }
  return manifest;
}

std::string manifest_text(Manifest& manifest) {
  std::string lines;
  for (const PlannedCase& one : manifest.cases) lines += to_text(line_of(one)) + '\n';
  manifest.digest = sha256(lines);
  Json head{{"schema", kSchema},
            {"cases", manifest.cases.size()},
            {"shards", manifest.shards},
            {"case_seconds", manifest.limits.seconds},
            {"case_bytes", manifest.limits.bytes}};
  head.update(json_of(manifest, kFields));
  return to_text(head) + '\n' + lines;
}

Manifest read_manifest(const fs::path& folder) {
  const fs::path file = folder / kManifestFile;
  const std::string text = read_text(file);
  const std::size_t head = text.find('\n') + 1;
  Manifest manifest = read_json(text.substr(0, head), file.string(), header_of, 1);
  if (sha256(std::string_view(text).substr(head)) != manifest.digest)
    throw InputError(file.string() + ": its cases do not match its digest: it was changed or cut");
  std::istringstream lines(text.substr(head));
  int number = 1;
  for (std::string line; std::getline(lines, line);)
    manifest.cases.push_back(read_json(
        line, file.string(), [&](const JsonReader& j) { return planned(j, manifest.shards); },
        ++number));
  return manifest;
}

std::vector<Case> cases_of(const Manifest& manifest, int shard, const fs::path& folder) {
  if (shard < 1 || shard > manifest.shards)
    throw InputError("--shard " + std::to_string(shard) + ": " + folder.string() +
                     " has shards 1 to " + std::to_string(manifest.shards));
  if (manifest.build != program_digest())
    throw InputError((folder / kManifestFile).string() + ": planned by build " +
                     manifest.build.substr(0, 10) + ", this is " + program_digest().substr(0, 10) +
                     " (`taut --version`): run that one, or submit the study again");
  CaseMaker maker;
  std::vector<Case> cases;
  for (std::size_t i = 0; i < manifest.cases.size(); ++i) {
    const PlannedCase& planned = manifest.cases[i];
    if (planned.shard != shard) continue;
    CaseSpec spec = planned.spec;
    if (spec.scene.starts_with("scenes/") && fs::exists(folder / spec.scene))
      spec.scene = (folder / spec.scene).string();
    cases.push_back(maker.make(spec));
    if (cases.back().key != planned.key)
      throw InputError({{(folder / kManifestFile).string(), static_cast<int>(i) + 2, 0,
                         planned.id + ": " + spec.scene + " is not the scene that was planned"}});
  }
  return cases;
}

fs::path shard_folder(const fs::path& folder, int shard) {
  const std::string number = std::to_string(shard);
  return folder / "shards" /
         (std::string(4 - std::min<std::size_t>(4, number.size()), '0') + number);
}

}  // namespace taut::cluster
