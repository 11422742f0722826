#include "core/io/drawn_scene.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <string_view>

#include "core/model/text.hpp"

namespace taut {

namespace {

/// Whole numbers only, whose text is the same everywhere. The standard says what this engine
/// returns, but not what its distributions do.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  int between(int least, int most) {
    return least + static_cast<int>(engine_() % (static_cast<std::uint64_t>(most - least) + 1));
  }
  bool once_in(int n) { return between(1, n) == 1; }
  template <class One, std::size_t n>
  One of(const std::array<One, n>& all) {
    return all[static_cast<std::size_t>(between(0, static_cast<int>(n) - 1))];
  }

 private:
  std::mt19937_64 engine_;
};

constexpr std::string_view kBoth = R"(["top-left", "top-right"])";

/// Metres, kilograms or a share of so many thousandths.
std::string thousandths(int n) { return shortest(n / 1000.0); }
std::string truth(bool it) { return it ? "true" : "false"; }
std::string line(std::string_view key, const std::string& value) {
  return std::string(key) + " = " + value + "\n";
}

/// A cloth in its first place: u along x from 0, v down or, level, along z.
struct Cloth {
  std::string kind, shape;  ///< shape: the keys of [cloth] that say it
  std::string pins, held;   ///< held: in words
  bool shear = true, bend = false, grid = true;
  int wide = 0, high = 0;  ///< mm
  std::string obj;
};

/// Vertices [n][n] a cell apart, the inner ones displaced by up to a quarter of a cell, and quads
/// cut along either diagonal.
std::string irregular(Draw& draw, int n, int cell, bool level) {
  std::string out;
  const auto place = [&](int i) {
    const int quarters = draw.between(-250, 250);  // thousandths of a cell
    return shortest((i * 1000 + (i > 0 && i < n - 1 ? quarters : 0)) * cell / 1e6);
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const std::string u = place(i), v = place(j);
      out += "v " + u + (level ? " 0 " + v : " " + (v == "0" ? v : "-" + v) + " 0") + "\n";
    }
  const auto face = [&](int a, int b, int c) {
    out += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  };
  for (int j = 0; j < n - 1; ++j)
    for (int i = 0; i < n - 1; ++i) {
      const int a = 1 + i + j * n, b = a + 1, c = b + n, d = a + n;
      const bool falling = draw.once_in(2);
      face(a, d, falling ? c : b);
      falling ? face(a, c, b) : face(b, d, c);
    }
  return out;
}

Cloth mesh_of(Draw& draw, const std::string& name, bool level) {
  const int n = draw.between(10, 28), cell = draw.between(15, 60);
  Cloth cloth{.kind = "irregular triangles, " + std::to_string(n * n) + " vertices", .grid = false};
  cloth.wide = cloth.high = (n - 1) * cell;
  cloth.obj = irregular(draw, n, cell, level);
  cloth.shape = line("mesh", "\"" + name + ".obj\"");
  cloth.held = "its upper row";
  std::string all;
  for (int i = 0; i < n; ++i) all += (i > 0 ? ", " : "") + std::to_string(i);
  cloth.pins = "[" + all + "]";
  return cloth;
}

Cloth grid_of(Draw& draw, std::string_view kind, bool level) {
  const int cell = draw.between(15, 60);
  const int first = draw.between(10, 36), narrow = draw.between(8, 12),
            length = draw.between(20, 36);
  const int nu = kind == "strip" ? narrow : first, nv = kind == "strip" ? length : first;
  Cloth cloth{.wide = (nu - 1) * cell, .high = (nv - 1) * cell};
  cloth.kind = "a " + std::string(kind) + " of " + std::to_string(nu) + " x " + std::to_string(nv) +
               " vertices";
  cloth.shape = line("grid", "[" + std::to_string(nu) + ", " + std::to_string(nv) + "]") +
                line("size", "[" + thousandths(cloth.wide) + ", " + thousandths(cloth.high) + "]");
  if (level) cloth.shape += "v = [0, 0, 1]\n";
  struct Hold {
    std::string_view pins, words;
  };
  constexpr std::array kHolds{Hold{kBoth, "its upper corners"}, Hold{R"(["top"])", "its upper row"},
                              Hold{R"(["top-left", "bottom-right"])", "opposite corners"},
                              Hold{R"(["top-left", "top-right", { edge = "top", at = 0.5 }])",
                                   "three places of its upper row"}};
  const Hold hold = kind == "net" ? kHolds[0] : draw.of(kHolds);
  cloth.pins = hold.pins;
  cloth.held = hold.words;
  const int span = draw.between(700, 950);
  if (kind == "net")
    cloth.shape += line("span", shortest(static_cast<double>(cloth.wide) * span / 1e6));
  cloth.shear = kind != "net" && !draw.once_in(6);
  cloth.bend = kind != "net" && draw.once_in(5);
  cloth.shape += line("lumping", draw.once_in(2) ? "\"equal\"" : "\"area\"");
  constexpr std::array kFactors{3, 10, 30};
  const int factor = draw.of(kFactors);
  if (draw.once_in(5))
    cloth.shape +=
        "weights = [{ vertices = [\"bottom\"], factor = " + std::to_string(factor) + " }]\n";
  return cloth;
}

/// [[collider]] of a body below the middle of a cloth that lies level at y = 0, and its floor.
std::string body_below(Draw& draw, const Cloth& cloth, bool floor) {
  const int smaller = std::min(cloth.wide, cloth.high), half = smaller * draw.between(20, 40) / 100,
            gap = draw.between(10, 150), friction = draw.between(0, 60) * 10,
            turned = draw.between(1, 89);
  const auto at = [&](int x, int y, int z) {
    return "[" + thousandths(x) + ", " + thousandths(y) + ", " + thousandths(z) + "]";
  };
  const int x = cloth.wide / 2, y = -gap - half, z = cloth.high / 2;
  const std::string radius = line("radius", thousandths(half));
  std::string body;
  switch (draw.between(0, 2)) {
    case 0:
      body = "type = \"ball\"\n" + line("center", at(x, y, z)) + radius;
      break;
    case 1:
      body = "type = \"box\"\n" + line("center", at(x, y, z)) +
             line("half_extents", at(half, half, half)) +
             line("rotation", "{ axis = [0, 1, 0], angle = " + std::to_string(turned) + " }");
      break;
    default:
      body = "type = \"capsule\"\n" + line("from", at(x - half, y, z)) +
             line("to", at(x + half, y, z)) + radius;
  }
  const std::string rough = line("friction", thousandths(friction));
  std::string out = "\n[[collider]]\n" + body + rough;
  if (floor)
    out += "\n[[collider]]\ntype = \"plane\"\n" + line("offset", thousandths(y - half)) + rough;
  return out;
}

}  // namespace

DrawnScene drawn_scene(const std::string& name, std::uint64_t seed, bool contact) {
  Draw draw(seed);
  constexpr std::array<std::string_view, 5> kKinds{"sheet", "sheet", "strip", "net", "mesh"};
  const std::string_view kind = draw.of(kKinds);
  // What contact adds is drawn by itself, so that without it the cloth is the same.
  Draw draw_of_contact(~seed);
  const Cloth cloth = kind == "mesh" ? mesh_of(draw, name, contact) : grid_of(draw, kind, contact);
  constexpr std::array kGrams{33, 47, 68, 100, 150, 220, 330, 470, 680, 1000};
  const int grams = draw.of(kGrams);
  constexpr std::array kRates{60, 120, 240};
  const int rate = draw.of(kRates);
  const bool free = contact && draw_of_contact.once_in(3);
  const int thickness = draw_of_contact.once_in(2) ? 5 : 0;
  const int damping = contact ? 100 * draw_of_contact.between(1, 10) : 2000;

  const std::string held = free ? "held by nothing" : "held by " + cloth.held;
  std::string out =
      "# Drawn by: taut new scene " + name + " --seed " + std::to_string(seed) +
      (contact ? " --contact" : "") + "\n\n" +
      line("summary", "\"" + cloth.kind + ", " + held + (contact ? ", above a body" : "") + "\"") +
      "\n[cloth]\n" + cloth.shape + line("mass", thousandths(grams));
  if (!free) out += line("pins", cloth.pins);
  if (contact && thickness > 0) out += line("thickness", thousandths(thickness));
  if (cloth.grid)
    out += "\n[links]\n" + line("shear", truth(cloth.shear)) + line("bend", truth(cloth.bend));
  out += "\n[forces]\n" + line("damping", thousandths(damping));
  if (contact) out += body_below(draw_of_contact, cloth, free);
  out += "\n[time]\n" + line("dt", "\"1/" + std::to_string(rate) + "\"") +
         line("duration", contact ? "4" : "8");
  return {std::move(out), cloth.obj};
}

}  // namespace taut
