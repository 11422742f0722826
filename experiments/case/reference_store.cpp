#include "experiments/case/reference_store.hpp"

#include <algorithm>

#include "experiments/case/digest.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-reference-1";
constexpr std::tuple kFields{Field{"scene", &Reference::scene},
                             Field{"digest", &Reference::digest},
                             Field{"kind", &Reference::kind},
                             Field{"t", &Reference::t},
                             Field{"derivation", &Reference::derivation},
                             Field{"floor_m", &Reference::floor}};

std::string file_name(const Reference& reference) {
  if (reference.kind == "static") return "static";
  return "motion-" + to_text(Json(reference.t)) + "s";
}

}  // namespace

void write_reference(const Reference& reference, const std::filesystem::path& folder) {
  Json json{{"schema", kSchema}};
  json.update(json_of(reference, kFields));
  json["vertices"] = reference.x.size();
  std::string text = to_text(json, 1);
  text.resize(text.size() - 2);  // "\n}": the coordinates follow, one vertex a line
  text += ",\n \"x\": [";
  for (std::size_t i = 0; i < reference.x.size(); ++i) {
    const Vec3& x = reference.x[i];
    text += (i == 0 ? "\n  " : ",\n  ") + to_text(Json{x.x(), x.y(), x.z()});
  }
  text += "\n ]\n}\n";
  make_folder(folder);
  write_file(reference_file(reference, folder), text);
}

std::filesystem::path reference_file(const Reference& reference,
                                     const std::filesystem::path& folder) {
  const std::string name = file_name(reference);
  const std::filesystem::path file = folder / (name + ".json");
  if (!std::filesystem::exists(file) || read_reference(file).digest == reference.digest)
    return file;
  return folder / (name + "-" + reference.digest.substr(0, 8) + ".json");
}

Reference read_reference(const std::filesystem::path& path) {
  return read_json(read_text(path), path.string(), [](const JsonReader& j) {
    j.require_schema(kSchema);
    Reference reference = read_as(j, kFields);
    for (const JsonReader& vertex : j.at("x").items()) {
      const std::vector<JsonReader> x = vertex.items(3);
      reference.x.emplace_back(x[0].number(), x[1].number(), x[2].number());
    }
    return reference;
  });
}

std::string reference_digest(const Scene& scene, const std::string& kind) {
  Scene same = scene;
  same.dt = 1;
  same.steps = 1;
  if (kind == "static") {
    same.damping = 0;
    for (Vec3& v : same.start.v) v.setZero();
  }
  return digest(same);
}

References find_references(const Scene& scene, const std::filesystem::path& root) {
  References known;
  if (scene.name.empty()) return known;
  std::error_code none;
  for (const auto& file : std::filesystem::directory_iterator(root / scene.name, none)) {
    if (!file.is_regular_file() || file.path().extension() != ".json") continue;
    Reference reference = read_reference(file.path());
    if (reference.x.size() != scene.start.x.size() ||
        reference.digest != reference_digest(scene, reference.kind))
      continue;
    if (reference.kind == "static")
      known.rest = std::move(reference);
    else
      known.motion.push_back(std::move(reference));
  }
  std::ranges::sort(known.motion, {}, &Reference::t);
  return known;
}

References known_references(const Scene& scene) {
  References known = find_references(scene, references_folder());
  const References own = find_references(scene, results_folder() / "references");
  if (!known.rest) known.rest = own.rest;
  if (known.motion.empty()) known.motion = own.motion;
  return known;
}

}  // namespace taut
