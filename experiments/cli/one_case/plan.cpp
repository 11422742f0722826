#include <algorithm>
#include <limits>

#include "core/model/membrane.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/clock.hpp"

namespace taut::verb::planning {

namespace {

struct Options {
  CaseOptions which;
  Format format;
};

struct SetUp {
  std::unique_ptr<Solver> solver;
  /// CPU time, the least of up to three samples.
  double seconds = std::numeric_limits<double>::infinity();
};

SetUp set_up(const Case& one) {
  SetUp made;
  constexpr double kLong = 1;  // s; if a sample takes longer, one is enough
  for (int n = 0; n < 3 && (n == 0 || made.seconds < kLong); ++n) {
    made.solver.reset();
    const double start = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
    made.solver = one.choice.entry->make(*one.scene, one.choice.params);
    made.seconds = std::min(made.seconds, seconds_of(CLOCK_PROCESS_CPUTIME_ID) - start);
  }
  return made;
}

std::string rounded(double value) { return general(value, 6); }

/// The membrane that the case's links are, in words; "": none is known.
std::string membrane_of(const Case& one) {
  const auto m = membrane_of_links(*one.scene, stiffness_of(*one.scene, one.choice.params));
  if (!m) return "";
  return rounded(m->warp) + " N/m along v, " + rounded(m->weft) +
         " N/m along u, Poisson's number " + rounded(m->poisson) + ", shear " + rounded(m->shear) +
         " N/m";
}

Answer answer_of(const Case& one, const SetUp& made) {
  Answer answer{"plan", one.id};
  Table table{"passes",
              "",
              {{"pass"}, {"items"}, {"repeats"}, {"bytes", "bytes", kBytes}, {"projections"}}};
  std::size_t bytes = 0, projections = 0;
  for (const PassCost& cost : made.solver->step_cost()) {
    const std::size_t work = cost.projections ? cost.items * cost.repeats : 0;
    bytes += cost.bytes;
    projections += work;
    table.rows.push_back({cost.pass, cost.items, cost.repeats, cost.bytes, work});
  }
  answer.add({"key"}, Cell(one.key));
  answer.add({"bytes", "bytes of a step", kBytes}, bytes);
  answer.add({"projections", "projections per step"}, projections);
  answer.add({"set_up", "set-up, CPU time", kMilliseconds},
             Cell(made.seconds).with("again when pins, masses or links change"));
  if (const std::string membrane = membrane_of(one); !membrane.empty())
    answer.add({"membrane", "its links as a membrane"}, Cell(membrane));
  answer.add(std::move(table));
  return answer;
}

int run(const Options& options) {
  const Case one = options.which.make();
  continue_in_right_program(one.choice);
  tell_remarks(one.remarks);
  if (const auto reasons = one.choice.entry->unsupported(*one.scene, one.choice.params);
      !reasons.empty()) {
    Answer answer{"plan", one.id};
    answer.add({"key"}, one.key);
    Table& table = answer.add(Table{"unsupported", "unsupported:", {{"why"}}});
    for (const std::string& reason : reasons) {
      table.rows.push_back({reason});
      std::cerr << one.id << " is unsupported: " << reason << '\n';
    }
    if (options.format.is_data()) print(answer, options.format);
    return kNothing;
  }
  constexpr int kLarge = 100'000;
  if (one.scene->mesh.size() > kLarge)
    progress() << "setting up " << one.scene->mesh.size() << " vertices and "
               << one.scene->links.size() << " links: it may take some seconds per million, with "
               << "bullet-deformable half a minute\n";
  const SetUp made = set_up(one);
  made.solver->load(one.scene->start);
  print(answer_of(one, made), options.format);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  o.which.bind(args);
  add_format(args, o.format);
}

}  // namespace
}  // namespace taut::verb::planning

TAUT_VERB(plan) = {
    .name = "plan",
    .group = VerbGroup::one_case,
    .summary =
        "Shows the passes of a step, what they visit and hold in memory, and what set-up costs",
    .example = "taut plan ball jakobsen:iterations=1,substeps=15",
    .answer = {{"facts", "key bytes projections set_up membrane"},
               {"passes", "pass items repeats bytes projections"},
               {"unsupported", "why"}},
    .bind = taut::bind_verb<taut::verb::planning::add_options, taut::verb::planning::run>};
