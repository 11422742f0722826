#include <array>

#include "core/model/index.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Strain e of a group of links at one moment.
struct Strain {
  double square = 0;   ///< sum of e^2
  double tension = 0;  ///< maximum of e, at least 0
  double shortening = 0;
  std::size_t count = 0;

  void add(double e) {
    square += e * e;
    ++count;
    tension = std::max(tension, e);
    shortening = std::max(shortening, -e);
  }
  void add(const Strain& s) {
    square += s.square;
    count += s.count;
    tension = std::max(tension, s.tension);
    shortening = std::max(shortening, s.shortening);
  }
  double mean_square() const {
    return count > 0 ? square / static_cast<double>(count) : Summary::kNone;
  }
};

/// A group of links over the whole run.
struct Group {
  bool exists = false;
  Summary square, tension, shortening, p95;
  std::vector<double> magnitudes;  ///< scratch

  void add(int step, bool at_end, const Strain& s) {
    if (!exists) return;
    square.add(step, at_end, s.mean_square());
    tension.add(step, at_end, s.tension);
    shortening.add(step, at_end, s.shortening);
  }
  /// Samples the 95th percentile by nearest rank: the smallest magnitude that at least 95 % of the
  /// links do not exceed.
  void sample(int step) {
    if (!exists) return;
    const auto rank = (magnitudes.size() * 95 + 99) / 100 - 1;
    const auto nth = magnitudes.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(magnitudes.begin(), nth, magnitudes.end());
    p95.add(step, true, *nth);
    magnitudes.clear();
  }
  double rms() const { return std::sqrt(square.mean()); }
  double rms_peak() const { return std::sqrt(square.peak()); }
};

/// The links whose strain a solver can change: no seams, and no links between two pins.
std::vector<Link> movable_links(const Scene& scene) {
  std::vector<Link> links;
  for (const Link& link : scene.links)
    if (!is_seam(link) && (!is_pinned(scene, link.a) || !is_pinned(scene, link.b)))
      links.push_back(link);
  return links;
}

class Stretch final : public Metric {
  static constexpr ValueSpec::Floor kRounding{kStrainFloor, "rounding of the file of positions"};

 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "stretch.rms",
       .unit = kErrorShare,
       .help =
           "strain (d - r)/r of the structural and shear links, RMS over links and the last second",
       .in_series = true,
       .role = Role::error,
       .negligible = 1e-3,
       .shown_over_time = true,
       .floor = kRounding,
       .falls_with_sweeps = true},
      {.name = "stretch.max",
       .unit = kErrorShare,
       .help = "largest stretch of a structural or shear link in the last second",
       .in_series = true,
       .kept = true,
       .floor = kRounding,
       .falls_with_sweeps = true},
      {.name = "stretch.p95",
       .unit = kErrorShare,
       .help = "95th percentile of |strain| of those links, mean of ten moments of the last second",
       .floor = kRounding,
       .falls_with_sweeps = true},
      {.name = "stretch.peak",
       .unit = kErrorShare,
       .help = "largest stretch of a structural or shear link over the run",
       .window = Window::run,
       .floor = kRounding,
       .falls_with_sweeps = true},
      {.name = kRmsStretchPeak,
       .unit = kErrorShare,
       .help = "strain of the structural and shear links, RMS over links, at the moment of the run "
               "at which it is largest",
       .window = Window::run,
       .title = "largest RMS stretch of the run",
       .floor = kRounding,
       .falls_with_sweeps = true},
      {"compression.max", kErrorShare, "largest shortening of those links in the last second",
       true},
      {"compression.peak", kErrorShare, "largest shortening of those links over the run", false,
       Window::run},
      {"structural.rms", kErrorShare, "strain of the structural links, RMS over the last second",
       true},
      {"structural.max", kErrorShare, "their largest stretch in the last second", true},
      {"structural.p95", kErrorShare, "95th percentile of their |strain|, mean of ten moments"},
      {"structural.compression", kErrorShare, "their largest shortening in the last second"},
      {"shear.rms", kErrorShare, "strain of the shear links, RMS over the last second", true},
      {"shear.max", kErrorShare, "their largest stretch in the last second", true},
      {"shear.p95", kErrorShare, "95th percentile of their |strain|, mean of ten moments"},
      {"shear.compression", kErrorShare, "their largest shortening in the last second"},
      {"bend.rms", kShare, "strain of the bend links, RMS over the last second", true},
      {"bend.max", kShare, "their largest stretch in the last second", true},
      {"bend.p95", kShare, "95th percentile of their |strain|, mean of ten moments"},
      {"bend.compression", kShare, "their largest shortening in the last second"},
  };
  static bool measures(const Scene& scene) { return !movable_links(scene).empty(); }
  explicit Stretch(const Scene& scene) : links_(movable_links(scene)), end_(scene) {
    for (const Link& link : links_) family(link).exists = true;
    in_plane_.exists = families_[0].exists || families_[1].exists;
  }

  void observe(const Snapshot& m) override {
    const bool at_end = end_.contains(m.step), sampled = end_.samples(m.step);
    std::array<Strain, kFamilies.size()> strains;
    for (const Link& link : links_) {
      const double e = strain(link, m.state);
      strains[index(link)].add(e);
      if (!sampled) continue;
      family(link).magnitudes.push_back(std::abs(e));
      if (link.family != Family::bend) in_plane_.magnitudes.push_back(std::abs(e));
    }
    for (std::size_t f = 0; f < strains.size(); ++f) families_[f].add(m.step, at_end, strains[f]);
    in_plane_.add(m.step, at_end, in_plane(strains));
    if (!sampled) return;
    for (Group& group : families_) group.sample(m.step);
    in_plane_.sample(m.step);
  }

  std::vector<double> finish() override {
    const Group& s = in_plane_;
    std::vector<double> values{
        s.rms(),      s.tension.max(),    s.p95.mean(),       s.tension.peak(),
        s.rms_peak(), s.shortening.max(), s.shortening.peak()};
    for (const Group& f : families_)
      values.insert(values.end(), {f.rms(), f.tension.max(), f.p95.mean(), f.shortening.max()});
    return values;
  }

  std::vector<double> now(const Snapshot& m) const override {
    constexpr double none = Summary::kNone;
    std::array<Strain, kFamilies.size()> strains;
    for (const Link& link : links_) strains[index(link)].add(strain(link, m.state));
    const auto rms = [](const Strain& s) { return std::sqrt(s.mean_square()); };
    const auto max = [](const Strain& s) { return s.count > 0 ? s.tension : none; };
    const Strain all = in_plane(strains);
    std::vector<double> values{
        rms(all), max(all), none, none, none, all.count > 0 ? all.shortening : none, none};
    for (const Strain& s : strains) values.insert(values.end(), {rms(s), max(s), none, none});
    return values;
  }

 private:
  static std::size_t index(const Link& link) { return static_cast<std::size_t>(link.family); }
  static double strain(const Link& l, const State& state) {
    const Vec3& a = state.x[to_index(l.a)];
    const Vec3& b = state.x[to_index(l.b)];
    return ((b - a).norm() - l.rest) / l.rest;
  }
  /// Strain of structural and shear links. Bend links are left out: they shorten when the cloth
  /// folds, which is no strain of the cloth.
  static Strain in_plane(const std::array<Strain, kFamilies.size()>& strains) {
    Strain sum = strains[static_cast<std::size_t>(Family::structural)];
    sum.add(strains[static_cast<std::size_t>(Family::shear)]);
    return sum;
  }
  Group& family(const Link& link) { return families_[index(link)]; }

  std::vector<Link> links_;
  LastSecond end_;
  std::array<Group, kFamilies.size()> families_;
  Group in_plane_;
};

}  // namespace

TAUT_METRIC(stretch, Stretch, "How far the links are from their rest lengths, by family",
            "engineering strain (d - r)/r; links between two pins left out");

}  // namespace taut
