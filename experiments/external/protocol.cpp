#include "experiments/external/protocol.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <variant>

#include "core/model/body_frames.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/scene_keys.hpp"
#include "core/model/text.hpp"
#include "core/model/triangle_mesh.hpp"
#include "experiments/system/json.hpp"

namespace taut::external {

namespace {

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const std::vector<Vec3>& points) {
  Json all = Json::array();
  for (const Vec3& p : points) all.push_back(json_of(p));
  return all;
}

Json json_of(double value, const SceneKey&) { return value; }
Json json_of(bool value, const SceneKey&) { return value; }
Json json_of(const Vec3& value, const SceneKey&) { return json_of(value); }
template <class Enumeration>
requires std::is_enum_v<Enumeration> Json json_of(Enumeration value, const SceneKey& key) {
  return parts_of(key.choices)[static_cast<std::size_t>(value)];
}

/// Name of a key in the file. Those of a scene's sections lie side by side there, and two of them
/// are a `damping`.
std::string name_in_file(const SceneKey& key) {
  return (key.section() == "links" ? "link_" : "") + std::string(key.name());
}

template <class Value>
void add_key(Json& all, const SceneKey& key, const Value& value, const Value& initial) {
  if (key.counts(value, initial)) all[name_in_file(key)] = json_of(value, key);
}

/// Values of the keys that are members of `part`.
template <class Part>
Json keys_of(const Part& part) {
  Json all = Json::object();
  each_key(part, [&](const auto&... key) { add_key(all, key...); });
  return all;
}

Json motion_of(std::string_view section, const Motion& motion) {
  if (motion.at_rest()) return nullptr;
  Json all = Json::object(), path = Json::array();
  each_key(section, motion, [&](const auto&... key) { add_key(all, key...); });
  for (const Motion::Key& key : motion.path)
    path.push_back({{"t", key.t}, {"displacement", json_of(key.displacement)}});
  all["path"] = path;
  return all;
}

Json json_of(const Collider& collider) {
  Json one{{"type", type_name(collider.shape)}};
  one.update(std::visit([](const auto& shape) { return keys_of(shape); }, collider.shape));
  const auto turn = [&](const Eigen::Quaterniond& q) {
    one["rotation"] = {q.w(), q.x(), q.y(), q.z()};
  };
  if (const Box* box = std::get_if<Box>(&collider.shape)) turn(box->rotation);
  if (const MeshBody* body = std::get_if<MeshBody>(&collider.shape)) {
    turn(body->rotation);
    one["vertices"] = json_of(body->mesh->vertices());
    one["triangles"] = body->mesh->triangles();
  }
  if (collider.frames) {
    Json& frames = one["frames"] = Json::array();
    for (const std::vector<Vec3>& x : collider.frames->places) frames.push_back(json_of(x));
    one["fps"] = collider.frames->fps;
  }
  one.update(keys_of(collider));
  one["motion"] = motion_of("collider", collider.motion);
  return one;
}

/// The newest version of the protocol and of the scene file. Each version includes the ones before
/// it; later_parts() names what each adds.
int newest_version() { return std::ranges::max_element(scene_keys(), {}, &SceneKey::since)->since; }
std::string protocol_name(int version) { return "taut-solver/" + std::to_string(version); }

constexpr double kLargestInteger = 2147483647;

/// Returns read(). An error that `read` finds in an answer is a breach of the protocol.
template <class Read>
auto judged(Connection& connection, Read read) {
  try {
    return read();
  } catch (const EndedFromOutside&) {
    throw;
  } catch (const InputError& error) {
    connection.fail(Status::Kind::protocol, error.what());
  }
}

JsonReader reader(const Json& answer, const std::string& op) {
  return JsonReader(answer, "answer to '" + op + "'");
}

std::string text_or(const JsonReader& j, const char* key, const std::string& fallback = "") {
  const auto found = j.find(key);
  return found ? found->text() : fallback;
}

/// "cmd, timeout, folder or build"
std::string reserved_names() {
  constexpr std::span<const ParamSpec> kAll(kLeading);
  return join(kAll.first(kAll.size() - 1), ", ", &ParamSpec::name) + " or " +
         std::string(kAll.back().name);
}

/// Reads the specification of a parameter from a program's answer. Its default has to lie in its
/// own range.
class SpecReader {
 public:
  SpecReader(Hello& hello, const std::string& name, const JsonReader& j) : hello_(hello), j_(j) {
    if (!is_solver_name(name) || std::ranges::count(kLeading, name, &ParamSpec::name) > 0)
      j.fail("is no name for a parameter (letters, digits, _ and -; not " + reserved_names() + ")");
    spec_.name = keep(name);
    spec_.unit = keep(text_or(j, "unit"));
    spec_.help = keep(text_or(j, "doc"));
    const std::string type = j.at("type").text();
    if (type == "choice")
      read_choice();
    else if (type == "text") {
      spec_.kind = ParamSpec::Kind::text;
      spec_.default_value = keep(text_or(j, "default"));
    } else if (type == "integer" || type == "real")
      read_number(type == "integer");
    else
      j.at("type").fail("'" + type + "' is not one of integer, real, choice, text");
    for (const auto role : {ParamSpec::Role::precision, ParamSpec::Role::instructions})
      if (spec_.name == usual_name(role)) spec_.role = role;
    for (const Family family : kFamilies)
      if (spec_.name == to_string(family) && (spec_.unit == "N/m" || spec_.unit == "m/N")) {
        spec_.family = family;
        spec_.is_compliance = spec_.unit == "m/N";
      }
  }
  const ParamSpec& spec() const { return spec_; }

 private:
  std::string_view keep(std::string text) { return hello_.texts.emplace_back(std::move(text)); }

  void read_choice() {
    spec_.kind = ParamSpec::Kind::choice;
    const std::vector<std::string> choices = j_.at("choices").texts();
    for (const std::string& choice : choices)
      if (choice.empty() || choice.find_first_of("|,'\" ") != choice.npos)
        j_.at("choices").fail("'" + choice + "': a choice has no blank, comma, quote or bar");
    const std::string all = join(choices, "|");
    const std::string given = j_.at("default").text();
    if (std::ranges::find(choices, given) == choices.end())
      j_.at("default").fail("'" + given + "' is not one of " + all);
    spec_.choices = keep(all);
    spec_.default_value = keep(given);
  }

  void read_number(bool whole) {
    spec_.kind = whole ? ParamSpec::Kind::integer : ParamSpec::Kind::real;
    spec_.min = j_.at("min").number();
    spec_.max = j_.at("max").number();
    const double given = j_.at("default").number();
    if (!(spec_.min <= given && given <= spec_.max)) j_.at("default").fail("is outside min to max");
    if (whole && (spec_.min < -kLargestInteger || spec_.max > kLargestInteger))
      j_.fail("min to max is more than 32 bits hold");
    if (whole && given != std::floor(given)) j_.at("default").fail("is not a whole number");
    spec_.default_value = keep(whole ? std::to_string(std::lround(given)) : shortest(given));
  }

  Hello& hello_;
  const JsonReader& j_;
  ParamSpec spec_;
};

Json typed(const ParamSpec& spec, std::string_view value) {
  switch (spec.kind) {
    case ParamSpec::Kind::integer:
      return *whole<long>(value);
    case ParamSpec::Kind::real:
      return *whole<double>(value);
    default:
      return std::string(value);
  }
}

/// Stiffness by family [N/m]; null: rigid.
Json stiffness(const Scene& scene) {
  Json all;
  for (const Family family : kFamilies) {
    const double k = scene.stiffness[static_cast<std::size_t>(family)];
    all[std::string(to_string(family))] = std::isinf(k) ? Json() : Json(k);
  }
  return all;
}

/// A part of a scene that the first version of the protocol lacks, in a few words.
struct Later {
  int since;  ///< the version that introduced it
  std::string words;
};

template <class T>
bool is_there(const Scene& scene) {
  return std::ranges::any_of(scene.colliders,
                             [](const Collider& c) { return std::holds_alternative<T>(c.shape); });
}

/// Such parts of the scene, sorted by version.
std::vector<Later> later_parts(const Scene& scene) {
  std::vector<Later> all;
  for (std::string& links : elastic_links(scene)) all.push_back({2, std::move(links)});
  if (is_there<Capsule>(scene)) all.push_back({2, "a capsule"});
  if (scene.bending) all.push_back({2, "bending stiffness"});
  if (!scene.releases.empty()) all.push_back({2, "pins that let go"});
  if (std::ranges::any_of(scene.links, is_seam)) all.push_back({2, "a seam"});
  if (is_there<MeshBody>(scene)) all.push_back({3, "a body of triangles"});
  for (const LaterKey& key : later_keys(scene)) {
    const std::string words = key.path == kFramesKey         ? "a body that deforms"
                              : key.path == kMembraneKey     ? "a membrane"
                              : key.path == kLinkDamping     ? "damping of links"
                              : key.path == kMembraneDamping ? "damping of the membrane"
                                                             : key.path;
    if (std::ranges::find(all, words, &Later::words) == all.end())
      all.push_back({key.since, words});
  }
  std::ranges::stable_sort(all, {}, &Later::since);
  return all;
}

}  // namespace

std::vector<std::string> beyond(int version, const Scene& scene) {
  std::vector<std::string> all;
  for (Later& one : later_parts(scene))
    if (one.since > version) all.push_back(std::move(one.words));
  return all;
}

std::string scene_file(const Scene& scene) {
  Json links = Json::array(), motions = Json::array(), colliders = Json::array();
  for (const Link& link : scene.links)
    links.push_back({link.a, link.b, link.rest, to_string(link.family)});
  for (const PinMotion& group : scene.pin_motions)
    motions.push_back(
        {{"vertices", group.vertices}, {"motion", motion_of("pin_motion", group.motion)}});
  for (const Collider& collider : scene.colliders) colliders.push_back(json_of(collider));
  const auto& grid = scene.mesh.grid;
  const std::vector<Later> later = later_parts(scene);
  const int version = later.empty() ? 1 : later.back().since;
  Json file{{"format", "taut-scene/" + std::to_string(version)},
            {"name", scene.name},
            {"vertices", scene.mesh.size()},
            {"grid", grid ? Json{grid->nu, grid->nv} : Json()},
            {"dt", scene.dt},
            {"steps", scene.steps},
            {"x", json_of(scene.start.x)},
            {"v", json_of(scene.start.v)},
            {"rest", json_of(scene.mesh.rest)},
            {"mass", scene.mesh.mass},
            {"inverse_mass", inverse_masses(scene)},
            {"pins", scene.pins},
            {"pin_motions", motions},
            {"links", links},
            {"triangles", scene.mesh.triangles},
            {"colliders", colliders},
            {"wind", scene.wind ? keys_of(*scene.wind) : Json()},
            {"self_collision", scene.self_collision ? keys_of(*scene.self_collision) : Json()}};
  file.update(keys_of(scene));
  if (!elastic_links(scene).empty()) file["stiffness"] = stiffness(scene);
  if (!scene.releases.empty()) {
    Json& releases = file["releases"] = Json::array();
    for (const Release& release : scene.releases)
      releases.push_back({{"t", release.step * scene.dt}, {"vertices", release.vertices}});
  }
  if (scene.bending) {
    // Its key `warp` is the direction of the warp.
    file["bending"] = keys_of(*scene.bending);
    file["bending"].update({{"warp", scene.bending->warp},
                            {"weft", scene.bending->weft},
                            {"direction", json_of(scene.bending->direction)}});
  }
  if (scene.membrane) {
    const Membrane& m = *scene.membrane;
    file["membrane"] = {{"law", m.law == Membrane::Law::arap ? "arap" : "stvk"},
                        {"warp", m.warp},
                        {"weft", m.weft},
                        {"poisson", m.poisson},
                        {"shear", m.shear},
                        {"direction", json_of(m.direction)}};
    if (m.damping > 0) file["membrane"]["damping"] = m.damping;
  }
  return to_text(file) + "\n";
}

static_assert(sizeof(Vec3) == 3 * sizeof(double), "states are sent as they lie in memory");
static_assert(std::endian::native == std::endian::little, "states are little-endian");

std::unique_ptr<const Hello> read_hello(const Json& answer) {
  const JsonReader j = reader(answer, "hello");
  const std::string protocol = j.at("protocol").text();
  std::vector<std::string> known;
  for (int version = 1; version <= newest_version(); ++version)
    known.push_back(protocol_name(version));
  const auto spoken = std::ranges::find(known, protocol);
  if (spoken == known.end())
    j.at("protocol").fail("'" + protocol + "' is not one of " + join(known, ", "));
  auto hello = std::make_unique<Hello>();
  hello->version_spoken = static_cast<int>(spoken - known.begin()) + 1;
  hello->name = j.at("name").text();
  hello->version = j.at("version").text();
  hello->summary = text_or(j, "summary", hello->name);
  hello->source = text_or(j, "source", hello->name + " " + hello->version);
  hello->unmeasurable = text_or(j, "unmeasurable");
  if (const auto params = j.find("params"))
    for (const auto& [name, spec] : params->members())
      hello->params.push_back(SpecReader(*hello, name, spec).spec());
  return hello;
}

std::unique_ptr<const Hello> say_hello(Connection& connection) {
  const Json answer = connection.ask({{"op", "hello"}, {"protocol", protocol_name(1)}});
  return judged(connection, [&] { return read_hello(answer); });
}

Json own_params(const Hello& hello, const Params& params) {
  Json all = Json::object();
  for (const ParamSpec& spec : hello.params)
    all[std::string(spec.name)] = typed(spec, params.value(spec.name));
  return all;
}

SceneAnswer read_scene_answer(const Json& answer, int vertices) {
  const JsonReader j = reader(answer, "scene");
  SceneAnswer told;
  if (const auto cannot = j.find("cannot")) told.cannot = cannot->texts();
  if (!told.cannot.empty()) return told;
  if (const int n = j.at("vertices").integer(); n != vertices)
    j.at("vertices").fail(std::to_string(n) + " is not the scene's " + std::to_string(vertices));
  if (const auto plan = j.find("plan"))
    for (const JsonReader& p : plan->items()) {
      const auto repeats = p.find("repeats"), bytes = p.find("bytes"),
                 projections = p.find("projections");
      told.plan.push_back({.pass = p.at("pass").text(),
                           .items = p.at("items").count(),
                           .repeats = repeats ? repeats->count() : 1,
                           .bytes = bytes ? bytes->count() : 0,
                           .projections = projections && projections->flag()});
    }
  if (const auto settings = j.find("settings"))
    for (const auto& [name, value] : settings->members())
      told.settings.emplace_back(name, value.text());
  return told;
}

SceneAnswer give_scene(Connection& connection, const Scene& scene, const Json& params) {
  const auto file = connection.folder() / "scene.json";
  write_file(file, scene_file(scene));
  const Json answer =
      connection.ask({{"op", "scene"}, {"file", file.string()}, {"params", params}});
  return judged(connection, [&] { return read_scene_answer(answer, scene.mesh.size()); });
}

void load_state(Connection& connection, const State& state) {
  const std::size_t half = state.x.size() * sizeof(Vec3);
  std::string bytes(2 * half, '\0');
  if (half > 0) {
    std::memcpy(bytes.data(), state.x.data(), half);
    std::memcpy(bytes.data() + half, state.v.data(), half);
  }
  connection.ask({{"op", "load"}, {"bytes", bytes.size()}}, bytes);
}

double read_step(const Json& answer) {
  const auto said = reader(answer, "step").find("cpu_ns");
  return said ? 1e-9 * said->number() : std::numeric_limits<double>::quiet_NaN();
}

double take_steps(Connection& connection, double t, double dt, int count) {
  const Json answer = connection.ask({{"op", "step"}, {"t", t}, {"dt", dt}, {"count", count}});
  return judged(connection, [&] { return read_step(answer); });
}

bool agrees(double word, double clock, double empty) {
  return std::abs(word - clock) <= 0.1 * clock + 2 * empty;
}

std::size_t read_store(const Json& answer, int vertices) {
  const JsonReader j = reader(answer, "store");
  const std::size_t bytes = j.at("bytes").count(), all = 2 * to_index(vertices) * sizeof(Vec3);
  if (bytes != all)
    j.at("bytes").fail("a state of " + std::to_string(vertices) + " vertices has " +
                       std::to_string(all) + " bytes, not " + std::to_string(bytes));
  return all;
}

void store_state(Connection& connection, int vertices, State& state) {
  const Json answer = connection.ask({{"op", "store"}});
  const std::size_t half = judged(connection, [&] { return read_store(answer, vertices); }) / 2,
                    n = to_index(vertices);
  const std::string bytes = connection.take(2 * half);
  state.x.resize(n);
  state.v.resize(n);
  if (half == 0) return;
  std::memcpy(static_cast<void*>(state.x.data()), bytes.data(), half);
  std::memcpy(static_cast<void*>(state.v.data()), bytes.data() + half, half);
}

}  // namespace taut::external
