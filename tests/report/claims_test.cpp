// Every sentence of made-up reports, read again and evaluated from the raw records by other code:
// none may be false, none may leave out a scene, none may contradict a chart.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <regex>
#include <set>

#include "experiments/report/claims/claim.hpp"
#include "experiments/report/model/model.hpp"
#include "experiments/system/json.hpp"
#include "tests/report/made_up.hpp"

namespace taut::report {
namespace {

using Names = std::vector<std::string>;
using Scenes = std::multiset<std::string>;

std::string solver_of(std::string label) {
  for (char& c : label) c = static_cast<char>(std::tolower(c));
  return label;
}

std::string label_of(std::string solver) {
  if (solver == "xpbd") return "XPBD";
  solver[0] = static_cast<char>(std::toupper(solver[0]));
  return solver;
}

/// Every match of a pattern, as the texts of its groups ("" where a group took no part).
std::vector<Names> matches(const std::string& text, const std::string& pattern) {
  static std::map<std::string, std::regex> known;
  const std::regex& regex = known.try_emplace(pattern, pattern).first->second;
  std::vector<Names> all;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at)
    all.emplace_back(at->begin(), at->end());
  return all;
}

/// "ball, box and hang"
Names names_in(const std::string& list) {
  Names names;
  for (const Names& m : matches(list, "([a-z]+)(, | and |$)")) names.push_back(m[1]);
  return names;
}

constexpr const char* kNumber = "(10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+|[0-9./]+(?:×10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)";
std::string pattern(std::string text) {  // "#": a number
  for (std::size_t at; (at = text.find('#')) != std::string::npos;) text.replace(at, 1, kNumber);
  return text;
}

/// A number as the page writes it: "0.31", "1.2×10⁻⁵", "1/11".
double number_in(const std::string& text) {
  if (text.starts_with("1/")) return 1 / std::stod(text.substr(2));
  const auto ten = text.find("10⁻");
  if (ten == std::string::npos) return std::stod(text);
  const std::vector<std::string> raised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  int power = 0;
  for (std::string rest = text.substr(ten + std::string("10⁻").size());;) {
    const auto digit =
        std::ranges::find_if(raised, [&](const std::string& d) { return rest.starts_with(d); });
    if (digit == raised.end()) break;
    power = 10 * power + static_cast<int>(digit - raised.begin());
    rest = rest.substr(digit->size());
  }
  return (ten == 0 ? 1 : std::stod(text)) * std::pow(10, -power);
}

/// Two digits are printed.
bool near(double printed, double true_value) {
  return std::abs(printed - true_value) <= 0.06 * std::abs(true_value) + 1e-12;
}

/// Some of `solvers` is not as `solver`, and so on: the raw records, asked without anything that
/// claims are made with.
class Raw {
 public:
  explicit Raw(const ReportInput& input) {
    std::set<std::string> keys;
    for (const StudyResult& study : input.studies)
      for (const Record& r : study.records)
        if (keys.insert(r.key).second)
          all.push_back(&r), scenes.insert(r.scene), solvers.insert(r.solver);
  }
  std::vector<const Record*> all;
  std::set<std::string> scenes, solvers;

  static int number(const Record& r, const char* name) {
    return r.params.contains(name) ? std::stoi(r.params.at(name)) : -1;
  }
  static bool good(const Record& r) {
    return r.status.kind == Status::Kind::ok || r.status.kind == Status::Kind::unsettled;
  }
  static std::optional<double> value(const Record* r, const std::string& metric) {
    if (!r || !good(*r) || !r->values.contains(metric)) return {};
    const double v = r->values.at(metric);
    return std::isnan(v) ? std::nullopt : std::optional(v);
  }
  /// (substeps, sweeps) of a case; -1: the solver has none.
  static std::pair<int, int> work(const Record& r) {
    return {number(r, "substeps"), number(r, "iterations")};
  }
  using Works = std::map<std::string, std::pair<int, int>>;  // by solver

  /// Of the cases at these works the one whose time step most solvers ran, of equals the nearest to
  /// 1/64 s.
  const Record* quoted(const std::string& scene, const std::string& solver,
                       const Works& works) const {
    std::map<double, std::map<std::string, const Record*>> at;
    for (const Record* r : all) {
      if (r->scene == scene && works.contains(r->solver) && work(*r) == works.at(r->solver))
        at[r->dt].try_emplace(r->solver, r);
    }
    const auto rank = [](const auto& entry) {
      return std::pair(-static_cast<int>(entry.second.size()),
                       std::abs(std::log(entry.first * 64)));
    };
    const auto best = std::ranges::min_element(at, {}, rank);
    return best != at.end() && best->second.contains(solver) ? best->second.at(solver) : nullptr;
  }

  /// Whether some work was run by all solvers, which then have to be compared at it.
  bool any_work_in_common() const {
    std::map<std::pair<int, int>, std::set<std::string>> who;
    for (const Record* r : all) who[work(*r)].insert(r->solver);
    return std::ranges::any_of(who, [&](const auto& w) { return w.second == solvers; });
  }
};

/// Reads one claim after the other; what is false is a failure of the test.
class Reader {
 public:
  explicit Reader(const ReportInput& input) : input_(input), raw_(input) {}

  void read(const Claim& claim, const std::vector<Claim>& all) {
    SCOPED_TRACE(claim.id + ": " + claim.sentence);
    text_ = claim.sentence;
    if (claim.about == "differences") return difference(claim.id);
    const bool of_work = claim.id.starts_with("stretch") || claim.id.starts_with("depth");
    if (of_work) read_work();
    if (claim.kind == ClaimKind::tile) return tile(claim, all);
    if (claim.id == "stretch") return stretch();
    if (claim.id == "depth") return depth();
    if (claim.id == "step") return step();
    if (claim.id == "failures") return failures();
    if (claim.id.starts_with("stretch-")) return scene_stretch(claim.about);
    if (claim.id.starts_with("depth-")) return scene_depth(claim.about);
    if (claim.id.starts_with("cost-")) return cost(claim.id.substr(5));
    if (claim.id.starts_with("work-")) return same_work(claim.id.substr(5));
    if (claim.id.starts_with("only-")) return only();
    ADD_FAILURE() << "nobody can read this claim";
  }

 private:
  /// What follows `opening` up to the full stop; "" if it is not said.
  std::string said(const std::string& opening) const {
    const auto at = text_.find(opening);
    if (at == std::string::npos) return "";
    const auto from = at + opening.size(), stop = text_.find(". ", from);
    return text_.substr(from, (stop == std::string::npos ? text_.size() - 1 : stop) - from);
  }

  /// "at 1 × 16 (substeps × sweeps)", "at unequal work (Jakobsen 5 × 16, XPBD 1 substeps; ...)".
  void read_work() {
    works_.clear();
    const std::string one = "(\\d+)( × (\\d+)| substeps)";
    const auto work = [](const Names& m, std::size_t at) {
      return std::pair(std::stoi(m[at]), m[at + 2].empty() ? -1 : std::stoi(m[at + 2]));
    };
    const auto unequal = matches(text_, " at unequal work \\(([^;)]*)");
    if (!unequal.empty()) {
      EXPECT_FALSE(raw_.any_work_in_common());
      for (const Names& m : matches(unequal[0][1], "([A-Z][A-Za-z]+) " + one))
        works_[solver_of(m[1])] = work(m, 2);
    } else {
      const auto equal = matches(text_, " at " + one);
      ASSERT_FALSE(equal.empty());
      for (const std::string& solver : raw_.solvers) works_[solver] = work(equal[0], 1);
    }
    EXPECT_EQ(works_.size(), raw_.solvers.size());
    for (const auto& [solver, its] : works_)
      EXPECT_TRUE(std::ranges::any_of(raw_.all,
                                      [&, solver = solver, its = its](const Record* r) {
                                        return r->solver == solver && Raw::work(*r) == its;
                                      }))
          << solver << " never ran that";
  }

  const Record* quoted(const std::string& scene, const std::string& solver) const {
    return raw_.quoted(scene, solver, works_);
  }
  bool everybody(const std::string& scene, const std::string& metric) const {
    return std::ranges::all_of(raw_.solvers, [&](const std::string& solver) {
      return Raw::value(quoted(scene, solver), metric).has_value();
    });
  }

  void check_reason(const Record* r, const std::string& reason) const {
    const std::string why = !r              ? "was not run like this"
                            : Raw::good(*r) ? "has no value"
                                            : "ended as " + std::string(to_string(r->status.kind));
    EXPECT_EQ(reason, why);
  }

  /// Of every scene that is left out the reasons are true; gives their names.
  Scenes left_out() const {
    Scenes names;
    for (const Names& one : matches(said(" Left out: "), "([a-z]+) \\(([^)]*)\\)")) {
      names.insert(one[1]);
      for (const Names& why : matches(one[2], "([A-Z][A-Za-z]+) ([^,]+)"))
        check_reason(quoted(one[1], solver_of(why[1])), why[2]);
    }
    return names;
  }

  double floored(const std::string& scene, const std::string& solver) const {
    const auto v = Raw::value(quoted(scene, solver), "stretch.rms");
    EXPECT_TRUE(v) << scene << " " << solver << " has no value";
    return std::max(v.value_or(1e9), 1e-3);
  }

  void stretch() {
    const std::string means = said("geometric mean over ");
    const Names common = names_in(means.substr(0, means.find(": ")));
    Scenes named(common.begin(), common.end()), judged;
    std::size_t solvers = 0;
    for (const Names& m : matches(means, pattern("#\u00A0% with ([A-Za-z]+)"))) {
      double sum = 0;
      for (const std::string& scene : common) sum += std::log(floored(scene, solver_of(m[2])));
      EXPECT_PRED2(near, number_in(m[1]) / 100, std::exp(sum / static_cast<double>(common.size())));
      ++solvers;
    }
    EXPECT_TRUE(common.empty() || solvers == raw_.solvers.size());
    for (const std::string& solver : raw_.solvers)
      for (const char* word : {" Less with ", " Least with "})
        for (const std::string& scene : names_in(said(word + label_of(solver) + " on "))) {
          judged.insert(scene);
          for (const std::string& other : raw_.solvers)
            EXPECT_TRUE(other == solver || floored(scene, solver) * 1.049 < floored(scene, other))
                << scene;
        }
    for (const char* words :
         {" Within 5\u00A0% of each other on ", " The two least within 5\u00A0% on "})
      for (const std::string& scene : names_in(said(words))) {
        judged.insert(scene);
        std::vector<double> v;
        for (const std::string& solver : raw_.solvers) v.push_back(floored(scene, solver));
        std::ranges::sort(v);
        EXPECT_LT(v[1], 1.0501 * v[0]) << scene;
      }
    EXPECT_TRUE(raw_.solvers.size() == 1 || judged == named);
    for (const std::string& scene : names_in(said(" Below 0.1\u00A0% with all on "))) {
      named.insert(scene);
      for (const std::string& solver : raw_.solvers)
        EXPECT_LT(Raw::value(quoted(scene, solver), "stretch.rms").value_or(1), 1e-3) << scene;
    }
    named.merge(left_out());
    EXPECT_EQ(named, Scenes(raw_.scenes.begin(), raw_.scenes.end()));
  }

  void depth() {
    const auto colon = text_.find(": "), of = text_.find("deepest of ");
    const Scenes out = left_out();
    std::set<std::string> named(out.begin(), out.end());
    if (of < colon)
      for (const std::string& name : names_in(text_.substr(of + 11, colon - of - 11)))
        named.insert(name);
    for (const std::string& scene : raw_.scenes) {
      const bool any = std::ranges::any_of(raw_.solvers, [&](const std::string& solver) {
        return Raw::value(quoted(scene, solver), "penetration.peak").has_value();
      });
      EXPECT_EQ(named.contains(scene), any) << scene << " is not named";
    }
    int values = 0, expected = 0;
    for (const auto& [place, metric] :
         {std::pair<std::string, std::string>{"vertex", "penetration.peak"}, {"face", "face.peak"}})
      for (const std::string& solver : raw_.solvers) {
        double deepest = -1;
        for (const std::string& scene : raw_.scenes)
          if (everybody(scene, metric))
            deepest = std::max(deepest, *Raw::value(quoted(scene, solver), metric));
        expected += deepest >= 0;
        for (const Names& m :
             matches(text_, pattern("(: |; )" + label_of(solver) + " [^;]*?#\u00A0mm at a " +
                                    place + "( \\(([a-z]+)\\))?"))) {
          ++values;
          EXPECT_PRED2(near, number_in(m[2]) / 1e3, deepest) << solver << metric;
          if (m[4].empty()) continue;
          EXPECT_PRED2(near, Raw::value(quoted(m[4], solver), metric).value_or(-1), deepest);
        }
      }
    EXPECT_EQ(values, expected);
    for (const Names& m :
         matches(said("passages of vertices through a collider: "), "([A-Za-z]+) (\\d+)")) {
      double sum = 0;
      for (const std::string& scene : raw_.scenes)
        if (everybody(scene, "tunnelling.events"))
          sum += *Raw::value(quoted(scene, solver_of(m[1])), "tunnelling.events");
      EXPECT_EQ(std::stod(m[2]), sum);
    }
  }

  /// Whether every solver that has sweeps anywhere ran this question at this work.
  bool in_all(const Record& r) const {
    for (const std::string& solver : raw_.solvers) {
      bool has_sweeps = false, ran = false;
      for (const Record* other : raw_.all) {
        if (other->solver != solver) continue;
        has_sweeps = has_sweeps || other->params.contains("iterations");
        ran = ran || (other->scene == r.scene && other->dt == r.dt && other->params == r.params);
      }
      if (has_sweeps && !ran) return false;
    }
    return true;
  }

  void step() {
    int parts = 0;
    for (const Names& clause :
         matches(text_, "on ([a-z, ]+) \\([^)]* tried, each at ([^)]*)\\) ([^;]*?)(;|\\.$)"))
      for (const std::string& scene : names_in(clause[1]))
        for (const Names& m : matches(
                 clause[3], "([A-Z][A-Za-z]+) (none|([0-9.]+)\u00A0ms( \\(the largest tried\\))?)"))
          largest_step(scene, clause[2], m), ++parts;
    EXPECT_GT(parts, 0);
  }

  void largest_step(const std::string& scene, const std::string& works, const Names& m) const {
    std::map<double, bool> good;  // over all cases that every solver with sweeps has
    for (const Record* r : raw_.all) {
      if (r->scene != scene || r->solver != solver_of(m[1]) || !in_all(*r)) continue;
      const std::string work = std::to_string(Raw::number(*r, "substeps")) + " × " +
                               std::to_string(Raw::number(*r, "iterations"));
      if (matches(works, "(^|[^0-9])" + work + "($|[^0-9])").empty()) continue;
      const auto at = good.try_emplace(r->dt, true).first;
      at->second = at->second && Raw::good(*r);
    }
    double largest = 0;
    for (const auto& [dt, completed] : good) {
      if (!completed) break;
      largest = dt;
    }
    EXPECT_EQ(m[2] == "none", largest == 0) << scene << m[1];
    EXPECT_PRED2(near, m[2] == "none" ? 0 : std::stod(m[3]) / 1e3, largest) << scene;
    EXPECT_EQ(!m[4].empty(), !good.empty() && largest == good.rbegin()->first) << scene;
  }

  void failures() {
    std::set<std::string> named;
    for (const Names& m :
         matches(said("Cases that failed: "), "([A-Z][A-Za-z]+) (none|\\d+) of (\\d+)")) {
      int failed = 0, total = 0;
      for (const Record* r : raw_.all) {
        if (r->solver != solver_of(m[1])) continue;
        ++total;
        failed += !Raw::good(*r) && r->status.kind != Status::Kind::unsupported;
      }
      named.insert(solver_of(m[1]));
      EXPECT_EQ(m[2] == "none" ? 0 : std::stoi(m[2]), failed);
      EXPECT_EQ(std::stoi(m[3]), total);
    }
    EXPECT_EQ(named, raw_.solvers);
  }

  /// "Jakobsen 1.2 %; Bullet ended as exploded": `check` reads what follows a name.
  void side_by_side(const std::string& scene,
                    const std::function<void(const Record*, const std::string&)>& check) const {
    std::set<std::string> named;
    std::string list = text_.substr(text_.find(": ", text_.find("time step")) + 2);
    list.pop_back();
    for (const Names& m : matches(list, "([A-Z][A-Za-z]+) ([^;]+)")) {
      named.insert(solver_of(m[1]));
      const Record* r = quoted(scene, solver_of(m[1]));
      if (std::isdigit(static_cast<unsigned char>(m[2][0])))
        check(r, m[2]);
      else
        check_reason(r, m[2]);
    }
    EXPECT_EQ(named, raw_.solvers);
  }

  void scene_stretch(const std::string& scene) const {
    side_by_side(scene, [](const Record* r, const std::string& what) {
      const auto m = matches(what, pattern("^#(\u00A0%)?$"));
      ASSERT_EQ(m.size(), 1U) << what;
      EXPECT_PRED2(near, number_in(m[0][1]) / 100, Raw::value(r, "stretch.rms").value_or(-1));
    });
  }

  void scene_depth(const std::string& scene) const {
    side_by_side(scene, [](const Record* r, const std::string& what) {
      for (const auto& [suffix, metric, scale] :
           {std::tuple<std::string, std::string, double>{"\u00A0mm at a vertex", "penetration.peak",
                                                         1e3},
            {"\u00A0mm at a face", "face.peak", 1e3},
            {" passages of", "tunnelling.events", 1}}) {
        const auto v = Raw::value(r, metric);
        const auto m = matches(what, pattern("#" + suffix));
        EXPECT_EQ(m.size(), v ? 1U : 0U) << metric;
        for (const Names& one : m) EXPECT_PRED2(near, number_in(one[1]) / scale, v.value_or(-1));
      }
    });
  }

  // Costs: the bench's samples, of cases that completed, without what only one solver has.
  static bool tethered(const BenchedCase& c) {
    return c.record.params.contains("tethers") && c.record.params.at("tethers") == "on";
  }
  static bool counts(const BenchedCase& c) {
    return Raw::good(c.record) && c.timing.failure.empty();
  }
  static double cost_of(const BenchedCase& c) { return median(c.timing.samples) / c.record.dt; }
  static bool cheaper(const BenchedCase& a, const BenchedCase* b) {
    return !b || cost_of(a) < cost_of(*b);
  }
  static bool has(const SceneBench& scene, const std::string& solver) {
    return std::ranges::any_of(scene.cases,
                               [&](const auto& c) { return c.record.solver == solver; });
  }
  static double noise_of(const SceneBench& scene) {
    return std::max(1 / scene.control.low, scene.control.high) - 1;
  }
  static double ratio_of(const BenchedCase& a, const BenchedCase& b) {
    return interleaved_ratio(a.timing.samples, b.timing.samples).mid;
  }
  const SceneBench& bench(const std::string& scene) const {
    return *std::ranges::find(input_.bench->scenes, scene, &SceneBench::scene);
  }
  const BenchedCase* cheapest(const SceneBench& scene, const std::string& solver, bool with) const {
    const BenchedCase* best = nullptr;
    for (const BenchedCase& c : scene.cases)
      if (c.record.solver == solver && counts(c) && tethered(c) == with &&
          c.record.values.at("stretch.rms") <= 0.01 && cheaper(c, best))
        best = &c;
    return best;
  }
  /// Who is compared with `other`: the first by place that was timed.
  std::string first_beside(const std::string& other) const {
    for (const char* name : {"jakobsen", "bullet", "xpbd"})
      for (const SceneBench& scene : input_.bench->scenes)
        if (has(scene, name)) return name;
    return other;
  }
  /// Tried at the last value of both knobs that a search would try.
  static bool searched(const SceneBench& scene, const std::string& solver) {
    int substeps = 0, sweeps = 0;
    for (const BenchedCase& c : scene.cases)
      if (c.record.solver == solver)
        substeps = std::max(substeps, Raw::number(c.record, "substeps")),
        sweeps = std::max(sweeps, Raw::number(c.record, "iterations"));
    return substeps >= 1024 && sweeps >= 128;
  }

  /// Who is said to need less where, by how much and how sure; gives the scenes judged.
  Scenes directions(const std::string& first, const std::string& other,
                    const std::map<std::string, double>& ratios) const {
    Scenes judged;
    double noise = 0, sum = 0;
    for (const auto& [scene, ratio] : ratios)
      noise = std::max(noise, noise_of(bench(scene))), sum += std::log(ratio);
    const auto each = [&](const std::string& words, const auto& check) {
      for (const std::string& scene : names_in(said(words))) {
        judged.insert(scene);
        ASSERT_TRUE(ratios.contains(scene)) << scene;
        check(std::log(ratios.at(scene)), std::log(1 + noise_of(bench(scene))));
      }
    };
    const double tolerance = std::log(1.05) - 1e-9;
    each(" Less with " + label_of(first) + " on ", [&](double change, double stray) {
      EXPECT_LT(change, -std::max(tolerance, stray - 1e-9));
    });
    each(" Less with " + label_of(other) + " on ", [&](double change, double stray) {
      EXPECT_GT(change, std::max(tolerance, stray - 1e-9));
    });
    each(" Too noisy to judge on ",
         [&](double change, double stray) { EXPECT_LE(std::abs(change), stray + 1e-9); });
    each(" No difference that can be told on ", [](double, double) {});
    const double mean = ratios.empty() ? std::nan("")  // and no sentence may state one
                                       : std::exp(sum / static_cast<double>(ratios.size()));
    const auto factor = matches(
        text_,
        pattern("([A-Z][A-Za-z]+) uses #(\u00A0%)? of the CPU time of ([A-Z][A-Za-z]+) \\([^;]*; "
                "geometric mean over ([^)]*)\\)"));
    if (!factor.empty()) {
      const Names& m = factor[0];
      const double share = number_in(m[2]) / (m[3].empty() ? 1 : 100);
      EXPECT_LT(share, 1);
      EXPECT_PRED2(near, share, solver_of(m[1]) == first ? mean : 1 / mean);
      EXPECT_EQ(solver_of(solver_of(m[1]) == first ? m[4] : m[1]), other);
      EXPECT_EQ(names_in(m[5]).size(), ratios.size());
    } else if (!ratios.empty()) {
      const auto even = matches(text_, pattern(" over [A-Za-z]+ #,"));
      EXPECT_EQ(even.size(), 1U);
      for (const Names& m : even) EXPECT_PRED2(near, number_in(m[1]), mean);
    }
    if (!ratios.empty()) {
      const auto stray = matches(text_, pattern("identical code differed by up to #\u00A0%"));
      EXPECT_EQ(stray.size(), 1U);
      for (const Names& m : stray) EXPECT_PRED2(near, number_in(m[1]) / 100, noise);
    }
    return judged;
  }

  void cost(const std::string& other) const {
    const std::string first = first_beside(other);
    std::map<std::string, double> ratios;
    std::map<std::string, double> logs;
    Scenes expected;
    for (const SceneBench& scene : input_.bench->scenes) {
      if (!has(scene, first)) continue;
      expected.insert(scene.scene);
      const BenchedCase *ours = cheapest(scene, first, false),
                        *theirs = cheapest(scene, other, false);
      if (!ours || !theirs) continue;
      ratios[scene.scene] = ratio_of(*ours, *theirs);
      logs[first] += std::log(cost_of(*ours)), logs[other] += std::log(cost_of(*theirs));
    }
    Scenes named = directions(first, other, ratios);
    const auto check = [&](const std::string& words, bool ours, bool theirs, bool timed) {
      for (const std::string& name : names_in(said(words))) {
        named.insert(name);
        EXPECT_EQ(cheapest(bench(name), other, false) != nullptr, theirs) << words << name;
        EXPECT_EQ(has(bench(name), other), timed) << words << name;
        EXPECT_TRUE(!timed || (cheapest(bench(name), first, false) != nullptr) == ours) << name;
      }
    };
    for (const auto& [missing, having] : {std::pair(other, first), {first, other}})
      for (const bool to_the_end : {false, true}) {
        const std::string words =
            (to_the_end ? " Never reached by " : " Reached by no setting tried of ") +
            label_of(missing) + (to_the_end ? ", tried to the end of its knobs" : "") +
            ", but by " + label_of(having) + " on ";
        check(words, having == first, having == other, true);
        for (const std::string& name : names_in(said(words)))
          EXPECT_EQ(searched(bench(name), missing), to_the_end) << words << name;
      }
    const std::string b = label_of(other);
    check(" Reached by no setting tried on ", false, false, true);
    check(" Not timed with " + b + " on ", false, false, false);
    EXPECT_EQ(named, expected);
    for (const Names& m :
         matches(said(" CPU time per simulated second: "), pattern("([A-Z][A-Za-z]+) #\u00A0ms")))
      EXPECT_PRED2(near, number_in(m[2]) / 1e3,
                   std::exp(logs[solver_of(m[1])] / static_cast<double>(ratios.size())));
  }

  void same_work(const std::string& other) const {
    const std::string first = first_beside(other);
    std::map<std::string, double> ratios;
    for (const SceneBench& scene : input_.bench->scenes) {
      double sum = 0;
      int n = 0;
      for (const auto& [substeps, sweeps] :
           {std::pair{1, 4}, {1, 16}, {4, 1}, {8, 2}, {1024, 1}, {1, 128}}) {
        const BenchedCase *ours = nullptr, *theirs = nullptr;
        for (const BenchedCase& c : scene.cases) {
          if (!counts(c) || tethered(c) || Raw::number(c.record, "substeps") != substeps ||
              Raw::number(c.record, "iterations") != sweeps)
            continue;
          if (c.record.solver == first) ours = &c;
          if (c.record.solver == other) theirs = &c;
        }
        if (ours && theirs) sum += std::log(ratio_of(*ours, *theirs)), ++n;
      }
      if (n > 0) ratios[scene.scene] = std::exp(sum / n);
    }
    EXPECT_EQ(directions(first, other, ratios).size(), ratios.size());
  }

  void only() const {
    EXPECT_EQ(text_.find("With tethers, which "), 0U);
    EXPECT_NE(text_.find(" does not have, Jakobsen reaches"), std::string::npos);
    const auto clauses =
        matches(text_, pattern("on ([a-z]+) #\u00A0ms(, #(\u00A0%)? of without)?"));
    EXPECT_FALSE(clauses.empty());
    for (const Names& m : clauses) {
      const BenchedCase *with = cheapest(bench(m[1]), "jakobsen", true),
                        *without = cheapest(bench(m[1]), "jakobsen", false);
      ASSERT_TRUE(with);
      EXPECT_PRED2(near, number_in(m[2]) / 1e3, cost_of(*with));
      if (m[3].empty()) continue;
      ASSERT_TRUE(without);
      EXPECT_PRED2(near, number_in(m[4]) / (m[5].empty() ? 1 : 100), ratio_of(*with, *without));
    }
  }

  /// Two folders: counts, directions and the largest change, from the pairs themselves.
  void difference(const std::string& id) const {
    const Differences& d = *input_.differences;
    if (id == "differences-statuses") {
      const auto of = matches(text_, "Of (\\d+) cases that both have, (\\d+) end alike");
      ASSERT_EQ(of.size(), 1U);
      std::map<std::string, int> changed;
      for (const auto& [a, b] : d.pairs)
        ++changed[std::string(to_string(a.status.kind)) + " in A and " +
                  std::string(to_string(b.status.kind)) + " in B"];
      int named = 0;
      for (const Names& m : matches(text_, "(\\d+) ([a-z]+ in A and [a-z]+ in B)")) {
        EXPECT_EQ(std::stoi(m[1]), changed[m[2]]);
        named += std::stoi(m[1]);
      }
      EXPECT_EQ(std::stoul(of[0][1]), d.pairs.size());
      EXPECT_EQ(std::stoi(of[0][2]) + named, std::stoi(of[0][1]));
      return;
    }
    if (id.starts_with("differences-cost-")) return difference_of_cost(id.substr(17));
    const std::map<std::string, std::pair<std::string, double>> metrics{
        {"differences-stretch.rms", {"stretch.rms", 100}},
        {"differences-penetration.peak", {"penetration.peak", 1e3}},
        {"differences-face.peak", {"face.peak", 1e3}},
        {"differences-tunnelling.events", {"tunnelling.events", 1}}};
    ASSERT_TRUE(metrics.contains(id));
    const auto& [metric, scale] = metrics.at(id);
    int both = 0, less = 0, more = 0;
    double largest = 0;
    for (const auto& [one, other] : d.pairs) {
      const auto a = Raw::value(&one, metric), b = Raw::value(&other, metric);
      if (!a || !b) continue;
      ++both;
      if (*b < *a) ++less;
      if (*b > *a) ++more;
      if (*a != *b) largest = std::max(largest, std::abs(*b - *a) / std::max(*a, *b));
    }
    const auto same = matches(text_, ", (\\d+) cases? [a-z ]*: the same to the bit");
    if (less + more == 0) {
      ASSERT_EQ(same.size(), 1U);
      EXPECT_EQ(std::stoi(same[0][1]), both);
      return;
    }
    const auto m = matches(
        text_, pattern(", (\\d+) cases? that completed in both: less in B in (\\d+), more in "
                       "(\\d+); [^:]*: #[^,]* in A, #"));
    ASSERT_EQ(m.size(), 1U);
    EXPECT_EQ(std::stoi(m[0][1]), both);
    EXPECT_EQ(std::stoi(m[0][2]), less);
    EXPECT_EQ(std::stoi(m[0][3]), more);
    const double a = number_in(m[0][4]) / scale, b = number_in(m[0][5]) / scale;
    EXPECT_NEAR(std::abs(b - a) / std::max({a, b, 1e-300}), largest, 0.02);
  }

  void difference_of_cost(const std::string& solver) const {
    double sum = 0;
    int n = 0;
    for (const auto& [a, b] : input_.differences->timed)
      if (a.record.solver == solver && counts(a) && counts(b))
        sum += std::log(cost_of(b) / cost_of(a)), ++n;
    const auto cases = matches(text_, ", (\\d+) cases? in sessions");
    ASSERT_EQ(cases.size(), 1U);
    EXPECT_EQ(std::stoi(cases[0][1]), n);
    if (n == 0) return;
    const double change = sum / n, stray = std::log1p(input_.differences->noise);
    const auto uses = matches(text_, pattern("(A|B) uses #(\u00A0%)? of the CPU time of"));
    EXPECT_EQ(uses.size(), std::abs(change) > std::max(std::log(1.05), stray) ? 1U : 0U);
    for (const Names& m : uses) {
      const double share = number_in(m[2]) / (m[3].empty() ? 1 : 100);
      EXPECT_PRED2(near, share, std::exp(m[1] == "B" ? change : -change));
    }
  }

  /// One number for one thing: what a tile's bar says stands in the headline.
  static void tile(const Claim& claim, const std::vector<Claim>& all) {
    const auto headline =
        std::ranges::find_if(all, [&](const Claim& c) { return "tile-" + c.id == claim.id; });
    ASSERT_NE(headline, all.end());
    EXPECT_FALSE(claim.bars().empty());
    for (const Bar& bar : claim.bars())
      EXPECT_NE(headline->sentence.find(bar.text), std::string::npos) << bar.text;
  }

  const ReportInput& input_;
  Raw raw_;
  std::string text_;
  Raw::Works works_;
};

std::vector<Claim> claims_of(const ReportInput& input) {
  const Rivals rivals = rivals_of(input);
  std::vector<Claim> all;
  for (const Claim& c : difference_claims(input)) all.push_back(c);
  for (const Claim& c : physics_claims(rivals)) all.push_back(c);
  for (const Claim& c : cost_claims(input)) all.push_back(c);
  return all;
}

constexpr unsigned kSets = 2000;

TEST(Claims, NoneIsFalseInThousandsOfMadeUpReports) {
  std::map<std::string, int> read;
  for (unsigned seed = 0; seed < kSets && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const ReportInput input = made_up::Maker(seed).input();
    const std::vector<Claim> all = claims_of(input);
    Reader reader(input);
    for (const Claim& claim : all) {
      reader.read(claim, all);
      ++read[claim.id.substr(0, claim.id.find('-'))];
    }
  }
  for (const char* id :
       {"stretch", "depth", "step", "failures", "cost", "work", "only", "tile", "differences"})
    EXPECT_GT(read[id], 50) << id << " is hardly ever said: the test says nothing about it";
}

TEST(Claims, NoneContradictsAChartOfTheModel) {
  std::size_t compared = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Json model = parse_json(make_model(made_up::Maker(seed).input()));
    std::map<std::pair<std::string, std::string>, Json> drawn;  // (case, metric) -> y
    std::map<std::string, std::string> statuses;
    for (const Json& one : model["cases"]) statuses[one["key"]] = one["status"];
    for (const Json& chart : model.value("charts", Json::array()))
      for (const Json& series : chart["series"])
        for (const Json& p : series["points"]) {
          EXPECT_EQ(p["status"], statuses.at(p["case"]));
          EXPECT_EQ(p["failed"].get<bool>(), p["y"].is_null());
          drawn[{p["case"], chart["y"]["metric"]}] = p["y"];
        }
    for (const Json& claim : model["claims"])
      for (const Json& basis : claim["basis"])
        for (const Json& value : basis["values"]) {
          if (!value.contains("case")) continue;  // of another results folder
          EXPECT_EQ(value["status"], statuses.at(value["case"])) << claim["id"];
          const auto at = drawn.find({value["case"], basis["metric"]});
          if (at == drawn.end()) continue;
          ++compared;
          EXPECT_EQ(at->second, value["value"]) << claim["sentence"];
        }
  }
  EXPECT_GT(compared, 300U);
}

TEST(Claims, NoneIsMadeWithoutItsBasis) {
  EXPECT_THROW(Claim("x", ClaimKind::note, "all", "Better.", Sure::clear, {}), std::logic_error);
  EXPECT_THROW(Claim("x", ClaimKind::note, "all", "Better.", Sure::clear,
                     {Evidence("stretch.rms", "looked at nothing")}),
               std::logic_error);
}

TEST(Claims, ADifferenceExceedsTheToleranceAndTheNoise) {
  const Interval quiet{0.99, 1, 1.01}, noisy{0.7, 1, 1.4};
  EXPECT_EQ(judge_ratio({0.45, 0.5, 0.55}, quiet), Sure::clear);
  EXPECT_EQ(judge_ratio({0.45, 0.5, 0.55}, noisy), Sure::likely);
  EXPECT_EQ(judge_ratio({0.70, 0.8, 0.90}, noisy), Sure::too_noisy);
  EXPECT_EQ(judge_ratio({0.90, 0.94, 0.98}, quiet), Sure::likely);
  EXPECT_EQ(judge_ratio({0.97, 0.98, 0.99}, quiet), std::nullopt);
  EXPECT_EQ(judge_ratio({0.50, 0.8, 1.20}, quiet), std::nullopt);
}

}  // namespace
}  // namespace taut::report
