#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/io/document.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/trajectory.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/statistics.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// A scene and a solver as texts that can be changed before they become a case.
class Draft {
 public:
  /// Throws InputError as make_case() does.
  explicit Draft(const CaseSpec&);

  /// Replaces or adds [section] key of the scene; the value as TOML, or as it was read.
  void set(const std::string& section, const std::string& key, const std::string& toml);
  void set(const std::string& section, const std::string& key, Value);
  /// Takes away [section], or a key of it or of each [[section]]; what is not there stays away.
  void remove(const std::string& section);
  void remove(const std::string& section, const std::string& key);
  /// The array of tables [[section]]; nullptr: the scene has none. A table that is left empty is
  /// not written: the numbers of the others stay while several change.
  std::vector<Value>* tables(const std::string& section);
  bool has(const std::string& section) const { return scene_.root.find(section); }
  const Value* find(const std::string& section, const std::string& key) const;

  /// Replaces a parameter of the solver. Precondition: it has one of this name.
  void set_parameter(const std::string& name, const std::string& value);

  /// The case's spec: as it was given if the scene is unchanged, else the scene as a file of this
  /// name in `folder`, which is written. With a comment, in lines with #, it is written anyway.
  /// Throws InputError if it cannot be.
  CaseSpec write(const std::filesystem::path& folder, const std::string& name,
                 const std::string& comment = "") const;

 private:
  Value& section(const std::string& name);
  /// What a fabric sets, key by key, so that each may go.
  void unfold_fabric();
  CaseSpec spec_;
  std::filesystem::path file_;  ///< of the scene
  Document scene_;
  std::string solver_;  ///< the entry's name
  std::map<std::string, std::string> changed_;
  bool scene_changed_ = false;
};

/// The value that a text is in TOML. Throws InputError.
Value toml_value(const std::string& toml);

/// One step towards less: what it does, in words, and to a draft.
struct Reduction {
  std::string change;  ///< "gone", "5 -> 2"
  std::function<void(Draft&)> apply;
};

/// A part of a model that may not be needed, or a number that may be coarser than it is.
struct Effect {
  std::string name;                   ///< "bend links", "substeps"
  std::vector<Reduction> reductions;  ///< from the weakest to the strongest; one at least
};

/// What there is to take away or to coarsen in a case: bend and shear links, bending, wind and its
/// law, damping, friction, each collider, self-collision, contact of faces, continuous detection,
/// thickness, tethers, levels, substeps, sweeps, precision, resolution, duration. What the case
/// does not have is not listed.
std::vector<Effect> effects_of(const Case&);

/// The same simulation with differences that nobody asked for.
struct Perturbations {
  /// One free vertex starts off by 2^-23 of the cloth's extent: what that moves is noise.
  std::vector<CaseSpec> rounding;
  /// The links in another order: another path to the same model, whose results may differ by more
  /// than rounding where sweeps do not converge; empty: the solver offers none.
  std::vector<CaseSpec> order;
};

/// Scenes that are made for it are written to `folder`. Throws InputError if they cannot be.
Perturbations perturbations(const Case&, const std::filesystem::path& folder);

/// Distance to a missing answer.
inline constexpr double kNoAnswer = std::numeric_limits<double>::infinity();

/// The name of the answer that is no metric: where the cloth is at the end, as the largest distance
/// [m] of a vertex from where it is in the full model.
inline constexpr const char* kShapeAnswer = "shape";

/// What a smaller model has to keep, and how nearly.
struct KeptAnswer {
  std::string name;      ///< "shape" or a metric value
  double tolerance = 0;  ///< in the unit of the value, >= 0

  bool is_shape() const { return name == kShapeAnswer; }
};
Unit unit_of(const KeptAnswer&);
/// "1.2 mm", "0.3 %": as the unit is shown; "-" for what is not a number.
std::string text(const KeptAnswer&, double value);

/// A case that was run, with its motion.
struct Observation {
  Case one;
  Record record;
  std::vector<Frame> frames;  ///< as the store keeps them
};

/// "METRIC" or "METRIC:TOLERANCE". A tolerance is a number in SI units, or with the unit in which
/// the value is shown ("2mm"), or in "%": of the cloth's extent for lengths, of the duration for
/// times, of the full model's value for other quantities; of strains and shares, points. Without
/// one: the shape 1 % of the extent, other lengths 0.1 %, strains and shares 1 point, times 10 % of
/// the duration, counts none, all else 10 % of the value. Throws InputError: unknown name, or no
/// number of at least 0.
KeptAnswer parse_answer(const std::string&, const Observation& full);
/// The METRIC alone. Throws InputError: unknown name.
std::string name_of_answer(const std::string& asked);

/// "METRIC:LIMIT", the largest size of a value that is accepted of a scene: in SI units, in the
/// unit shown, or in "%" of the cloth's extent and of the duration; of shares, points. Throws
/// InputError.
KeptAnswer parse_limit(const std::string&, const Scene&);
/// The largest RMS stretch of a cloth that can be shown to anybody.
inline constexpr double kMostStretch = 0.1;

/// What is accepted unless something is asked for: no passage and no crossing, depths below 0.1 %
/// of the cloth's extent, an RMS stretch up to kMostStretch, and, for a strain alone is small of a
/// cloth that stands still, a motion within 25 % of its way from the dynamic reference; as far as
/// the scene has them. No passages of edges and faces: past an edge of a box they happen to every
/// solver that keeps vertices alone outside (`--keep edge.passages:0` asks for none).
std::vector<KeptAnswer> default_limits(const Scene&);
/// What a case does beyond these limits: "penetration.peak 3.1 mm, more than 1 mm"; "": nothing.
std::string beyond(const Record&, const std::vector<KeptAnswer>&);

/// Marks the cases of a bench that go beyond the default limits of their scenes (not_accepted):
/// they are shown and win nothing. Throws InputError: a scene cannot be made.
void mark_not_accepted(StudyBench&);

/// What is kept unless something is asked for: shape, largest stretch, depth of vertices (and of
/// faces, if the solver keeps them out), crossings, settling time; as far as the case has them.
std::vector<std::string> default_answers(const Observation& full);

/// The value of an answer that is a metric; NaN if the case has none.
double value_of(const KeptAnswer&, const Observation&);

/// How far the answer is from that of the full model [unit of the answer]; infinite if the other
/// case did not run to its end or has no such value. Shapes of different grids are compared at the
/// vertices of the coarser one, between those of the finer one bilinearly. If the reduced scene no
/// longer produces the value, it is measured on the reduced motion, and the full model's value the
/// same way.
double distance(const KeptAnswer&, const Observation& full, const Observation& other);

/// Until when [s] two runs of one scene are within `tolerance` [m] of each other; nothing: to the
/// end.
std::optional<double> apart_after(const Observation&, const Observation&, double tolerance);

/// What a smaller model does to the kept answers.
struct ModelTrial {
  std::string change;          ///< "gone", "5 -> 2"
  CaseSpec spec;               ///< empty solver: it could not be made
  std::string why;             ///< why it cannot be: "exploded (energy) at step 3", ...; "": it can
  std::vector<double> moved;   ///< by answer; infinite if it cannot be
  bool done = false;           ///< false: the time was up before
  bool within = false;         ///< every answer stays within its tolerance or the noise
  std::vector<PassCost> cost;  ///< of its step
  int steps = 0;
};

/// One effect, tried by itself.
struct EffectTrial {
  std::string name;
  std::vector<ModelTrial> trials;     ///< from the weakest reduction on, up to the first that fails
  std::size_t allowed = 0;            ///< how many of them stay within; the last of them is taken
  std::optional<Interval> time;       ///< CPU time of the whole run without it over that with it
  std::optional<std::size_t> chosen;  ///< which trial is in the smallest model

  bool done() const { return !trials.empty() && trials.back().done; }
  bool may_go() const { return allowed > 0; }
  /// The trial that speaks for the effect: the strongest that stays within, else the weakest.
  const ModelTrial& representative() const { return trials[allowed > 0 ? allowed - 1 : 0]; }
};

/// What a scene requires of a model.
struct Requirement {
  Case full;
  std::vector<KeptAnswer> answers;  ///< kept
  std::vector<double> values;       ///< of the full model; 0 for the shape
  /// Largest difference between any two of the full model and the same started off by a rounding
  /// error: what an answer moves by without any reason.
  std::vector<double> noise;
  /// Largest difference from the full model of the same with its links in another order; empty: the
  /// solver offers none. No noise, so nothing is judged by it.
  std::vector<double> by_order;
  std::vector<std::string> given_up;  ///< answers that are not kept, and why
  bool chaotic = false;               ///< a rounding error moves the shape beyond its tolerance
  double horizon = 0;                 ///< until then [s] it does not; meaningful if chaotic
  std::vector<EffectTrial> effects;
  std::optional<ModelTrial> smallest;  ///< nothing can go: none
  std::filesystem::path file;          ///< of the smallest model's scene
  bool verified = false;               ///< run again from its file: the same bits
  std::optional<Interval> time_ratio;  ///< CPU time of the smallest model's run over the full one's
  Interval control;                    ///< the full model against itself in the same session
  std::size_t cases = 0, ran = 0;      ///< looked at; of which were not stored yet
  std::vector<std::string> not_done;   ///< what the time did not suffice for
  bool interrupted = false;
};

struct RequireOptions {
  CaseSpec full;
  std::vector<std::string> keep;  ///< parse_answer(); empty: default_answers()
  double patience = 120;          ///< s, in all
  int jobs = 1;
  std::function<void(const CampaignProgress&, const Record*)> progress;
};

/// Takes one effect away at a time, combines what may go (the one that saves most work first),
/// verifies and times the result. Every run is a case of the store, so that an interrupted search
/// goes on where it was. Scenes that it makes lie in `folder`. Throws InputError if the full model
/// cannot be run.
Requirement find_requirement(const RequireOptions&, Store&, const std::filesystem::path& folder);

/// Bytes that a step holds, and items that it visits.
std::size_t bytes_of(const std::vector<PassCost>&);
std::size_t work_of(const std::vector<PassCost>&);

}  // namespace taut
