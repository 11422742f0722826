#include "experiments/case/reference_store.hpp"

#include "core/io/positions/positions.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char *kSchema = "taut-reference-1", *kMotionSchema = "taut-motion-1",
                     *kEnsembleSchema = "taut-ensemble-1";
constexpr std::tuple kFields{Field{"scene", &Reference::scene}, Field{"digest", &Reference::digest},
                             Field{"derivation", &Reference::derivation},
                             Field{"floor_m", &Reference::floor}};
constexpr std::tuple kMotionFields{Field{"scene", &MotionReference::scene},
                                   Field{"digest", &MotionReference::digest},
                                   Field{"derivation", &MotionReference::derivation},
                                   Field{"horizon_s", &MotionReference::horizon},
                                   Field{"floor", &MotionReference::floor},
                                   Field{"pushed_out", &MotionReference::pushed_out}};

constexpr std::tuple kEnsembleFields{Field{"scene", &Ensemble::scene},
                                     Field{"digest", &Ensemble::digest},
                                     Field{"derivation", &Ensemble::derivation},
                                     Field{"from_s", &Ensemble::from},
                                     Field{"to_s", &Ensemble::to},
                                     Field{"fall_m", &Ensemble::fall},
                                     Field{"floor", &Ensemble::floor},
                                     Field{"plate", &Ensemble::plate}};

Json json_of(const Vec3& v) { return Json{v.x(), v.y(), v.z()}; }

Vec3 vector_of(const JsonReader& j) {
  const std::vector<JsonReader> v = j.items(3);
  return {v[0].number(), v[1].number(), v[2].number()};
}

/// Digest that a reference's file names.
std::string digest_in(const std::filesystem::path& path) {
  return read_json(read_text(path), path.string(),
                   [](const JsonReader& j) { return j.at("digest").text(); });
}

std::filesystem::path array_of(std::filesystem::path description) {
  return description.replace_extension(".npy");
}

}  // namespace

std::filesystem::path reference_file(const std::string& kind, const std::string& digest,
                                     const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / (kind + ".json");
  if (!std::filesystem::exists(file) || digest_in(file) == digest) return file;
  return folder / (kind + "-" + digest.substr(0, 8) + ".json");
}

void write_reference(const Reference& reference, const std::filesystem::path& folder) {
  Json json{{"schema", kSchema}};
  json.update(json_of(reference, kFields));
  json["vertices"] = reference.x.size();
  std::string text = to_text(json, 1);
  text.resize(text.size() - 2);  // "\n}": the coordinates follow, one vertex a line
  text += ",\n \"x\": [";
  for (std::size_t i = 0; i < reference.x.size(); ++i) {
    const Vec3& x = reference.x[i];
    text += (i == 0 ? "\n  " : ",\n  ") + to_text(json_of(x));
  }
  text += "\n ]\n}\n";
  make_folder(folder);
  write_file(reference_file("static", reference.digest, folder), text);
}

Reference read_reference(const std::filesystem::path& path) {
  return read_json(read_text(path), path.string(), [](const JsonReader& j) {
    j.require_schema(kSchema);
    Reference reference = read_as(j, kFields);
    for (const JsonReader& vertex : j.at("x").items()) reference.x.push_back(vector_of(vertex));
    return reference;
  });
}

void write_motion(const MotionReference& motion, const std::filesystem::path& folder) {
  make_folder(folder);
  const std::filesystem::path file = reference_file("motion", motion.digest, folder);
  const auto array = create_rounded_npy(array_of(file));
  for (std::size_t k = 1; k < motion.states.size(); ++k) array->append(0, motion.states[k].x);
  for (std::size_t k = 1; k < motion.states.size(); ++k) array->append(0, motion.states[k].v);
  Json json{{"schema", kMotionSchema}};
  json.update(json_of(motion, kMotionFields));
  json["moments"] = motion.states.size() - 1;
  write_file(file, to_text(json, 1) + "\n");
}

MotionReference read_motion(const std::filesystem::path& path, const State& start) {
  std::size_t moments = 0;
  MotionReference motion = read_json(read_text(path), path.string(), [&](const JsonReader& j) {
    j.require_schema(kMotionSchema);
    moments = j.at("moments").count();
    MotionReference read = read_as(j, kMotionFields);
    if (!(read.horizon > 0)) j.at("horizon_s").fail("expected a number above 0");
    return read;
  });
  const auto array = open_positions(array_of(path));
  const PositionsHeader& header = array->header();
  if (moments == 0 || static_cast<std::size_t>(header.frames) != 2 * moments ||
      static_cast<std::size_t>(header.vertices) != start.x.size())
    throw InputError(array_of(path).string() + ": expected " + std::to_string(2 * moments) +
                     " frames of " + std::to_string(start.x.size()) +
                     " vertices: places, then velocities");
  motion.states.push_back(start);
  for (std::size_t k = 0; k < moments; ++k)
    motion.states.push_back(
        {array->read(static_cast<int>(k)), array->read(static_cast<int>(moments + k))});
  return motion;
}

void write_ensemble(const Ensemble& ensemble, const std::filesystem::path& folder) {
  make_folder(folder);
  Json json{{"schema", kEnsembleSchema}};
  json.update(json_of(ensemble, kEnsembleFields));
  json["centre_m"] = json_of(ensemble.mean.centre);
  json["lengths_m"] = json_of(ensemble.mean.lengths);
  json["in_contact"] = ensemble.mean.in_contact;
  write_file(reference_file("ensemble", ensemble.digest, folder), to_text(json, 1) + "\n");
}

Ensemble read_ensemble(const std::filesystem::path& path) {
  return read_json(read_text(path), path.string(), [](const JsonReader& j) {
    j.require_schema(kEnsembleSchema);
    Ensemble ensemble = read_as(j, kEnsembleFields);
    ensemble.mean = {vector_of(j.at("centre_m")), vector_of(j.at("lengths_m")),
                     j.at("in_contact").number()};
    return ensemble;
  });
}

std::string reference_digest(const Scene& scene, const std::string& kind) {
  Scene same = scene;
  same.dt = 1;
  same.steps = 1;
  if (kind == "static") {
    same.damping = same.link_damping = 0;
    for (Vec3& v : same.start.v) v.setZero();
  }
  return digest(same);
}

References find_references(const Scene& scene, const std::filesystem::path& root) {
  References known;
  if (scene.name.empty()) return known;
  const std::filesystem::path folder = root / scene.name;
  for (const std::string kind : {"static", "motion", "ensemble"}) {
    const std::string digest = reference_digest(scene, kind);
    const std::filesystem::path file = reference_file(kind, digest, folder);
    if (!std::filesystem::exists(file) || digest_in(file) != digest) continue;
    if (kind == "motion")
      known.motion = read_motion(file, scene.start);
    else if (kind == "ensemble")
      known.ensemble = read_ensemble(file);
    else if (Reference rest = read_reference(file); rest.x.size() == scene.start.x.size())
      known.rest = std::move(rest);
  }
  return known;
}

References known_references(const Scene& scene) {
  References known = find_references(scene, references_folder());
  const References own = find_references(scene, results_folder() / "references");
  if (!known.rest) known.rest = own.rest;
  if (!known.motion) known.motion = own.motion;
  if (!known.ensemble) known.ensemble = own.ensemble;
  return known;
}

}  // namespace taut
