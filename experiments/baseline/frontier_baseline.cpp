#include "experiments/baseline/frontier_baseline.hpp"

#include "core/io/section.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"

namespace taut {

namespace {

FrontierQuestion question_of(Section& section) {
  section.need({"scene", "solver", "of", "from", "to"});
  FrontierQuestion question;
  question.base = {section.string("scene").value_or(""),
                   section.strings("set").value_or(std::vector<std::string>()),
                   section.string("solver").value_or("")};
  question.of = section.string("of").value_or("dt");
  const double from = section.number("from", {-1e9, 1e9}, 0);
  const double to = section.number("to", {-1e9, 1e9}, 0);
  const double tolerance = section.number("tolerance", {1e-9, 0.5}, SearchRange{}.tolerance);
  section.finish();
  section.diagnostics().throw_if_any();
  question.range = range_of(question.base, question.of, from, to);
  question.range.tolerance = tolerance;
  return question;
}

std::string options_of(const FrontierQuestion& question) {
  return "--of " + question.of + " --from " + shortest(question.range.from) + " --to " +
         shortest(question.range.to) + " --tolerance " + shortest(question.range.tolerance);
}

}  // namespace

std::vector<FrontierQuestion> read_frontiers(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "frontiers.toml";
  std::vector<FrontierQuestion> questions;
  if (!std::filesystem::exists(file)) return questions;
  const Document document = read_document(file, {});
  Diagnostics diagnostics(document);
  Section root(diagnostics, document.root, "the frontiers");
  for (const Value* table : root.tables("frontier")) {
    Section section(diagnostics, *table, "[[frontier]]");
    questions.push_back(question_of(section));
  }
  root.finish();
  diagnostics.throw_if_any();
  return questions;
}

std::string frontier_id(const FrontierQuestion& question) {
  return make_case(question.base).id + ", frontier of " + question.of;
}

BaselineRow frontier_row(const FrontierQuestion& question, const CaseFrontier& found) {
  const Case base = make_case(question.base);
  BaselineRow row;
  row.id = frontier_id(question);
  row.spec = base.spec;
  row.spec.solver = base.choice.brief();
  row.scene = digest(*base.scene);
  row.frontier = options_of(question);
  row.status = to_string(found.frontier.kind);
  row.values["frontier.stable_above"] = static_cast<double>(found.frontier.stable_above.size());
  if (found.frontier.kind == Frontier::Kind::bracketed) {
    row.values["frontier.stable"] = found.frontier.stable;
    row.values["frontier.unstable"] = found.frontier.unstable;
  }
  return row;
}

}  // namespace taut
