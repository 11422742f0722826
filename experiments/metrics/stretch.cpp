#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
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
  double rms() const { return std::sqrt(mean_square()); }
  double max() const { return count > 0 ? tension : Summary::kNone; }
  double compression() const { return count > 0 ? shortening : Summary::kNone; }
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
  double max() const { return tension.max(); }
  double peak() const { return tension.peak(); }
  double percentile() const { return p95.mean(); }
  double compression() const { return shortening.max(); }
  double compression_peak() const { return shortening.peak(); }
};

constexpr ValueSpec::Floor kRounding{kStrainFloor, "rounding of the file of positions"};

/// A value of some links: what it is of a run and, if it is in series, of a moment.
struct StretchValue {
  ValueSpec spec;
  std::optional<Family> family;  ///< nothing: structural and shear
  double (Group::*of_run)() const;
  double (Strain::*of_moment)() const = nullptr;
};
constexpr StretchValue kStretchValues[] = {
    {{.name = "stretch.rms",
      .unit = kErrorShare,
      .help =
          "strain (d - r)/r of the structural and shear links, RMS over links and the last second",
      .in_series = true,
      .role = Role::error,
      .negligible = 1e-3,
      .shown_over_time = true,
      .floor = kRounding,
      .falls_with_sweeps = true},
     {},
     &Group::rms,
     &Strain::rms},
    {{.name = "stretch.max",
      .unit = kErrorShare,
      .help = "largest stretch of a structural or shear link in the last second",
      .in_series = true,
      .kept = true,
      .floor = kRounding,
      .falls_with_sweeps = true},
     {},
     &Group::max,
     &Strain::max},
    {{.name = "stretch.p95",
      .unit = kErrorShare,
      .help = "95th percentile of |strain| of those links",
      .floor = kRounding,
      .falls_with_sweeps = true},
     {},
     &Group::percentile},
    {{.name = "stretch.peak",
      .unit = kErrorShare,
      .help = "largest stretch of a structural or shear link over the run",
      .window = Window::run,
      .floor = kRounding,
      .falls_with_sweeps = true},
     {},
     &Group::peak},
    {{.name = kRmsStretchPeak,
      .unit = kErrorShare,
      .help = "strain of the structural and shear links, RMS over links, at the moment of the run "
              "at which it is largest",
      .window = Window::run,
      .title = "largest RMS stretch of the run",
      .floor = kRounding,
      .falls_with_sweeps = true},
     {},
     &Group::rms_peak},
    {{"compression.max", kErrorShare, "largest shortening of those links in the last second", true},
     {},
     &Group::compression,
     &Strain::compression},
    {{"compression.peak", kErrorShare, "largest shortening of those links over the run", false,
      Window::run},
     {},
     &Group::compression_peak},
    {{"structural.rms", kErrorShare, "strain of the structural links, RMS over the last second",
      true},
     Family::structural,
     &Group::rms,
     &Strain::rms},
    {{"structural.max", kErrorShare, "their largest stretch in the last second", true},
     Family::structural,
     &Group::max,
     &Strain::max},
    {{"structural.p95", kErrorShare, "95th percentile of their |strain|"},
     Family::structural,
     &Group::percentile},
    {{"structural.compression", kErrorShare, "their largest shortening in the last second"},
     Family::structural,
     &Group::compression},
    {{"shear.rms", kErrorShare, "strain of the shear links, RMS over the last second", true},
     Family::shear,
     &Group::rms,
     &Strain::rms},
    {{"shear.max", kErrorShare, "their largest stretch in the last second", true},
     Family::shear,
     &Group::max,
     &Strain::max},
    {{"shear.p95", kErrorShare, "95th percentile of their |strain|"},
     Family::shear,
     &Group::percentile},
    {{"shear.compression", kErrorShare, "their largest shortening in the last second"},
     Family::shear,
     &Group::compression},
    {{"bend.rms", kShare, "strain of the bend links, RMS over the last second", true},
     Family::bend,
     &Group::rms,
     &Strain::rms},
    {{"bend.max", kShare, "their largest stretch in the last second", true},
     Family::bend,
     &Group::max,
     &Strain::max},
    {{"bend.p95", kShare, "95th percentile of their |strain|"}, Family::bend, &Group::percentile},
    {{"bend.compression", kShare, "their largest shortening in the last second"},
     Family::bend,
     &Group::compression},
};

const auto kSpecs = [] {
  std::array<ValueSpec, std::size(kStretchValues)> all{};
  std::ranges::transform(kStretchValues, all.begin(), [](const StretchValue& value) {
    ValueSpec spec = value.spec;
    if (value.of_run == &Group::percentile)
      spec.help = lasting(std::string(spec.help) + ", mean of " + LastSecond::samples_text() +
                          " of the last second");
    return spec;
  });
  return all;
}();
static_assert(std::ranges::all_of(kStretchValues, [](const StretchValue& value) {
  return value.spec.in_series == (value.of_moment != nullptr);
}));

/// The links whose strain a solver can change: no seams, and no links between two pins.
std::vector<Link> movable_links(const Scene& scene) {
  std::vector<Link> links;
  for (const Link& link : scene.links)
    if (!is_seam(link) && (!is_pinned(scene, link.a) || !is_pinned(scene, link.b)))
      links.push_back(link);
  return links;
}

class Stretch final : public Metric {
 public:
  static constexpr const auto& kValues = kSpecs;
  static bool measures(const Scene& scene) { return !movable_links(scene).empty(); }
  explicit Stretch(const Scene& scene) : links_(movable_links(scene)), end_(scene) {
    for (const Link& link : links_) family(link.family).exists = true;
    in_plane_.exists = family(Family::structural).exists || family(Family::shear).exists;
  }

  void observe(const Snapshot& m) override {
    const bool at_end = end_.contains(m.step), sampled = end_.samples(m.step);
    std::array<Strain, kFamilies.size()> strains;
    for (const Link& link : links_) {
      const double e = strain(link, m.state);
      strains[index(link.family)].add(e);
      if (!sampled) continue;
      family(link.family).magnitudes.push_back(std::abs(e));
      if (link.family != Family::bend) in_plane_.magnitudes.push_back(std::abs(e));
    }
    for (std::size_t f = 0; f < strains.size(); ++f) families_[f].add(m.step, at_end, strains[f]);
    in_plane_.add(m.step, at_end, in_plane(strains));
    if (!sampled) return;
    for (Group& group : families_) group.sample(m.step);
    in_plane_.sample(m.step);
  }

  std::vector<double> finish() override {
    std::vector<double> values;
    for (const StretchValue& value : kStretchValues)
      values.push_back(((value.family ? family(*value.family) : in_plane_).*value.of_run)());
    return values;
  }

  std::vector<double> now(const Snapshot& m) const override {
    std::array<Strain, kFamilies.size()> strains;
    for (const Link& link : links_) strains[index(link.family)].add(strain(link, m.state));
    const Strain all = in_plane(strains);
    std::vector<double> values;
    for (const StretchValue& value : kStretchValues)
      values.push_back(value.of_moment ? ((value.family ? strains[index(*value.family)] : all).*
                                          value.of_moment)()
                                       : Summary::kNone);
    return values;
  }

 private:
  static std::size_t index(Family of) { return static_cast<std::size_t>(of); }
  static double strain(const Link& l, const State& state) {
    const Vec3& a = state.x[to_index(l.a)];
    const Vec3& b = state.x[to_index(l.b)];
    return ((b - a).norm() - l.rest) / l.rest;
  }
  /// Strain of structural and shear links. Bend links are left out: they shorten when the cloth
  /// folds, which is no strain of the cloth.
  static Strain in_plane(const std::array<Strain, kFamilies.size()>& strains) {
    Strain sum = strains[index(Family::structural)];
    sum.add(strains[index(Family::shear)]);
    return sum;
  }
  Group& family(Family of) { return families_[index(of)]; }

  std::vector<Link> links_;
  LastSecond end_;
  std::array<Group, kFamilies.size()> families_;
  Group in_plane_;
};

}  // namespace

TAUT_METRIC(stretch, Stretch, "How far the links are from their rest lengths, by family",
            "engineering strain (d - r)/r; links between two pins left out");

}  // namespace taut
