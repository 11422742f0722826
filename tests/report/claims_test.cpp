// Every sentence of made-up reports, read again and evaluated from the raw records by other code:
// none may be false, none may leave out a scene, none may contradict a chart.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "experiments/report/chart/wording.hpp"
#include "experiments/report/claims/claim.hpp"
#include "tests/report/cost_reader.hpp"
#include "tests/report/made_up.hpp"

namespace taut::report::claims_test {
namespace {

using namespace reading;

/// Reads one claim after the other; what is false is a failure of the test.
class Reader {
 public:
  explicit Reader(const ReportInput& input) : input_(input), raw_(input) {}

  void read(const Claim& claim, const std::vector<Claim>& all) {
    SCOPED_TRACE(claim.id + ": " + claim.sentence);
    text_ = claim.sentence;
    const CostReader costs(input_, claim);
    if (claim.id.starts_with("differences-cost-"))
      return costs.difference_of_cost(claim.id.substr(17));
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
    if (claim.id.starts_with("cost-")) return costs.cost(claim.id.substr(5));
    if (claim.id.starts_with("work-")) return costs.same_work(claim.id.substr(5));
    if (claim.id.starts_with("only-")) return costs.only(claim.id.substr(claim.id.rfind('-') + 1));
    ADD_FAILURE() << "nobody can read this claim";
  }

 private:
  std::string said(const std::string& opening) const { return said_after(text_, opening); }

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

  /// ", time step 15.6 ms": of the cases quoted on these scenes.
  void time_steps(const Names& scenes) const {
    std::set<double> steps;
    for (const std::string& scene : scenes)
      for (const std::string& solver : raw_.solvers)
        if (const Record* r = quoted(scene, solver)) steps.insert(r->dt);
    const auto m = matches(text_, pattern(", time steps? #\u00A0ms( to #\u00A0ms)?[,:]"));
    ASSERT_EQ(m.size(), 1U);
    EXPECT_PRED2(near, number_in(m[0][1]) / 1e3, *steps.begin());
    EXPECT_EQ(m[0][2].empty(), steps.size() == 1);
    EXPECT_PRED2(near, number_in(m[0][m[0][2].empty() ? 1 : 3]) / 1e3, *steps.rbegin());
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

  /// Of every scene that is left out the reasons are true and one of these values is lacking; gives
  /// the scenes.
  Scenes left_out(const Names& metrics) const {
    Scenes names;
    for (const Names& one : matches(said(" Left out: "), "([a-z]+) \\(([^)]*)\\)")) {
      names.insert(one[1]);
      for (const Names& why : matches(one[2], "([A-Z][A-Za-z]+) ([^,]+)")) {
        const Record* r = quoted(one[1], solver_of(why[1]));
        check_reason(r, why[2]);
        const bool all = std::ranges::all_of(
            metrics, [&](const std::string& metric) { return Raw::value(r, metric).has_value(); });
        EXPECT_FALSE(all) << one[1] << ": " << why[1] << " has its values";
      }
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
    if (!common.empty()) time_steps(common);
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
    named.merge(left_out({"stretch.rms"}));
    EXPECT_EQ(named, Scenes(raw_.scenes.begin(), raw_.scenes.end()));
  }

  /// Over the scenes where everybody has the value [m]; -1: there is none.
  double deepest_of(const std::string& solver, const std::string& metric) const {
    double deepest = -1;
    for (const std::string& scene : raw_.scenes)
      if (everybody(scene, metric))
        deepest = std::max(deepest, *Raw::value(quoted(scene, solver), metric));
    return deepest;
  }

  void depth() {
    const auto colon = text_.find(": "), of = text_.find("deepest of ");
    const Scenes out = left_out({"penetration.peak", "face.peak", "tunnelling.events"});
    std::set<std::string> named(out.begin(), out.end());
    if (of < colon) {
      const Names common = names_in(text_.substr(of + 11, colon - of - 11));
      time_steps(common);
      named.insert(common.begin(), common.end());
    }
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
        const double deepest = deepest_of(solver, metric);
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
    std::map<std::string, std::vector<double>> found;
    for (const Names& clause :
         matches(text_, pattern("on ([a-z, ]+) \\(#\u00A0ms to #\u00A0ms tried, each at ([^)]*)\\) "
                                "([^;]*?)(;|\\.$)")))
      for (const std::string& scene : names_in(clause[1]))
        for (const Names& m : matches(
                 clause[5], "([A-Z][A-Za-z]+) (none|([0-9.]+)\u00A0ms( \\(the largest tried\\))?)"))
          found[m[1]].push_back(largest_step(scene, clause, m));
    EXPECT_FALSE(found.empty());
    for (const Names& m : matches(said("; geometric mean over these scenes "),
                                  pattern("([A-Z][A-Za-z]+) #\u00A0ms")))
      EXPECT_PRED2(near, number_in(m[2]) / 1e3, geometric_mean(found.at(m[1])));
  }

  double largest_step(const std::string& scene, const Names& clause, const Names& m) const {
    const std::string& works = clause[4];
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
    EXPECT_PRED2(near, number_in(clause[2]) / 1e3, good.begin()->first) << scene;
    EXPECT_PRED2(near, number_in(clause[3]) / 1e3, good.rbegin()->first) << scene;
    return largest;
  }

  void failures() {
    std::set<std::string> named;
    std::map<std::string, int> refused;
    for (const Names& m : matches(said(" Not supported: "), "([A-Z][A-Za-z]+) (\\d+)"))
      refused[solver_of(m[1])] = std::stoi(m[2]);
    for (const Names& m : matches(said("Cases that failed: "),
                                  "([A-Z][A-Za-z]+) (none|\\d+) of (\\d+)( \\([^)]*\\))?")) {
      int failed = 0, total = 0, unsupported = 0;
      std::map<std::string, int> kinds, said_kinds;
      for (const Record* r : raw_.all) {
        if (r->solver != solver_of(m[1])) continue;
        ++total;
        unsupported += r->status.kind == Status::Kind::unsupported;
        if (Raw::good(*r) || r->status.kind == Status::Kind::unsupported) continue;
        ++failed, ++kinds[std::string(to_string(r->status.kind))];
      }
      for (const Names& kind : matches(m[4], "(\\d+) ([a-z]+)"))
        said_kinds[kind[2]] = std::stoi(kind[1]);
      EXPECT_EQ(said_kinds, kinds);
      EXPECT_EQ(refused[solver_of(m[1])], unsupported);
      named.insert(solver_of(m[1]));
      for (const StudyResult& study : input_.studies)
        EXPECT_NE(said(" Counted in the studies ").find(study.name), std::string::npos);
      EXPECT_EQ(m[2] == "none" ? 0 : std::stoi(m[2]), failed);
      EXPECT_EQ(std::stoi(m[3]), total);
    }
    EXPECT_EQ(named, raw_.solvers);
  }

  /// "Jakobsen 1.2 %; Bullet ended as exploded": `check` reads what follows a name.
  void side_by_side(const std::string& scene,
                    const std::function<void(const Record*, const std::string&)>& check) const {
    time_steps({scene});
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
      const auto alone = matches(text_, " A alone has (\\d+) cases, B alone (\\d+)");
      ASSERT_EQ(alone.size(), 1U);
      EXPECT_EQ(std::stoul(alone[0][1]), d.only_a);
      EXPECT_EQ(std::stoul(alone[0][2]), d.only_b);
      return;
    }
    const std::map<std::string, std::pair<std::string, double>> metrics{
        {"differences-stretch.rms", {"stretch.rms", 100}},
        {"differences-penetration.peak", {"penetration.peak", 1e3}},
        {"differences-face.peak", {"face.peak", 1e3}},
        {"differences-tunnelling.events", {"tunnelling.events", 1}}};
    ASSERT_TRUE(metrics.contains(id));
    const auto& [metric, scale] = metrics.at(id);
    int both = 0, less = 0, more = 0;
    double largest = 0;
    const Record* where = nullptr;
    for (const auto& [one, other] : d.pairs) {
      const auto a = Raw::value(&one, metric), b = Raw::value(&other, metric);
      if (!a || !b) continue;
      ++both;
      if (*b < *a) ++less;
      if (*b > *a) ++more;
      const double change = *a == *b ? 0 : std::abs(*b - *a) / std::max(*a, *b);
      if (change > largest) largest = change, where = &other;
    }
    const auto same = matches(text_, ", (\\d+) cases? [a-z ]*: the same to the bit");
    if (less + more == 0) {
      ASSERT_EQ(same.size(), 1U);
      EXPECT_EQ(std::stoi(same[0][1]), both);
      return;
    }
    const auto m = matches(
        text_, pattern(", (\\d+) cases? that completed in both: less in B in (\\d+), more in "
                       "(\\d+); the largest change is that of ([a-z]+), ([A-Za-z]+) ([^:]*): #"
                       "[^,]* in A, #"));
    ASSERT_EQ(m.size(), 1U);
    EXPECT_EQ(std::stoi(m[0][1]), both);
    EXPECT_EQ(std::stoi(m[0][2]), less);
    EXPECT_EQ(std::stoi(m[0][3]), more);
    EXPECT_EQ(m[0][4], where->scene);
    EXPECT_EQ(solver_of(m[0][5]), where->solver);
    EXPECT_EQ(m[0][6], brief_settings(where->spec.solver));
    const double a = number_in(m[0][7]) / scale, b = number_in(m[0][8]) / scale;
    EXPECT_NEAR(std::abs(b - a) / std::max({a, b, 1e-300}), largest, 0.02);
  }

  /// One number for one thing: what a tile's bar says stands in the headline.
  void tile(const Claim& claim, const std::vector<Claim>& all) const {
    const auto headline =
        std::ranges::find_if(all, [&](const Claim& c) { return "tile-" + c.id == claim.id; });
    ASSERT_NE(headline, all.end());
    EXPECT_FALSE(claim.bars.empty());
    for (const Bar& bar : claim.bars) {
      EXPECT_NE(headline->sentence.find(bar.text), std::string::npos) << bar.text;
      EXPECT_EQ(label_of(bar.solver), bar.label);
      if (!bar.value) continue;
      const auto number = matches(bar.text, pattern("^#\u00A0(%|mm|ms)"));
      ASSERT_EQ(number.size(), 1U) << bar.text;
      EXPECT_PRED2(near, number_in(number[0][1]) / (number[0][2] == "%" ? 100 : 1e3), *bar.value);
      if (claim.id == "tile-depth") {
        EXPECT_EQ(*bar.value, std::max(deepest_of(bar.solver, "penetration.peak"),
                                       deepest_of(bar.solver, "face.peak")));
      }
    }
  }

  const ReportInput& input_;
  Raw raw_;
  std::string text_;
  Raw::Works works_;
};

std::vector<Claim> claims_of(const ReportInput& input) {
  const ComparedSolvers compared = compared_solvers_of(input);
  std::vector<Claim> all;
  for (const Claim& c : difference_claims(input)) all.push_back(c);
  for (const Claim& c : physics_claims(compared)) all.push_back(c);
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

TEST(Claims, NoneIsMadeWithoutItsBasis) {
  EXPECT_THROW(Claim("x", ClaimKind::note, "all", "Better.", Certainty::clear, {}),
               std::logic_error);
  EXPECT_THROW(Claim("x", ClaimKind::note, "all", "Better.", Certainty::clear,
                     {Evidence("stretch.rms", "looked at nothing")}),
               std::logic_error);
}

TEST(Claims, ADifferenceExceedsTheToleranceAndTheNoise) {
  const Interval quiet{0.99, 1, 1.01}, noisy{0.7, 1, 1.4};
  EXPECT_EQ(judge({0.45, 0.5, 0.55}, quiet), Certainty::clear);
  EXPECT_EQ(judge({0.45, 0.5, 0.55}, noisy), Certainty::likely);
  EXPECT_EQ(judge({0.70, 0.8, 0.90}, noisy), Certainty::too_noisy);
  EXPECT_EQ(judge({0.90, 0.94, 0.98}, quiet), Certainty::likely);
  EXPECT_EQ(judge({0.97, 0.98, 0.99}, quiet), Certainty::none);
  EXPECT_EQ(judge({0.50, 0.8, 1.20}, quiet), Certainty::none);
}

}  // namespace
}  // namespace taut::report::claims_test
