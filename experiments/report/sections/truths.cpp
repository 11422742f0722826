#include <map>

#include "experiments/report/format.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::truths {

namespace {

std::string csv(const Truths& truths) {
  std::string out = "section,statement,source,subject,expected,measured,verdict,why\n";
  for (const TruthRow& row : truths.rows) {
    std::string line;
    for (const std::string* cell : {&row.section, &row.statement, &row.source, &row.subject,
                                    &row.expected, &row.measured, &row.verdict, &row.why})
      line += (line.empty() ? "" : ",") + csv_field(*cell);
    out += line + "\n";
  }
  return out;
}

/// Narrow columns break a text at spaces only.
std::string breakable(const std::string& settings) {
  std::string out;
  for (const char c : settings) out += c == ',' ? ", " : std::string(1, c);
  return out;
}

/// A table whose first cell stands once for all rows that share it, and so does the last one within
/// them.
std::string grouped_table(const Table& table, const std::string& caption) {
  const std::vector<std::vector<std::string>>& rows = table.rows;
  const std::size_t last = table.header.size() - 1;
  const auto run = [&](std::size_t from, const auto& same) {
    std::size_t n = 1;
    while (from + n < rows.size() && same(rows[from], rows[from + n])) ++n;
    return n;
  };
  const auto same_first = [](const auto& a, const auto& b) { return a.front() == b.front(); };
  const auto same_ends = [&](const auto& a, const auto& b) {
    return a.front() == b.front() && a[last] == b[last];
  };
  const auto span = [](std::size_t n) {
    return n > 1 ? " rowspan=\"" + std::to_string(n) + "\"" : std::string();
  };
  std::string out = html_table({table.header, {}}, caption), body;
  std::size_t first_until = 0, last_until = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    body += "<tr>";
    if (i == first_until) {
      const std::size_t n = run(i, same_first);
      body += "<th scope=\"row\"" + span(n) + ">" + escape_html(rows[i].front()) + "</th>";
      first_until += n;
    }
    for (std::size_t k = 1; k < last; ++k)
      body += "<td data-label=\"" + table.header[k] + "\">" + escape_html(rows[i][k]) + "</td>";
    if (i == last_until) {
      const std::size_t n = run(i, same_ends);
      body += "<td data-label=\"" + table.header[last] + "\"" + span(n) + ">" +
              escape_html(rows[i][last]) + "</td>";
      last_until += n;
    }
    body += "</tr>\n";
  }
  return out.insert(out.find("<tbody>") + 7, body);
}

/// What is not simply as theory has it stays in sight; the rest is behind a click.
std::string body(const ReportInput& input) {
  if (!input.truths)
    return absent(
        "Closed forms and published numbers were not evaluated by this build; this does it:",
        "taut verify --out results/verify.json");
  const Truths& truths = *input.truths;
  Table apart{{"truth", "solver", "expected", "measured", "verdict"}, {}}, all = apart;
  std::map<std::string, int> verdicts;
  for (const TruthRow& row : truths.rows) {
    const std::vector<std::string> cells{
        typeset(row.statement + " (" + row.source + ")"), breakable(row.subject),
        typeset(row.expected), typeset(row.measured),
        typeset(row.verdict + (row.why.empty() ? "" : ": " + row.why))};
    all.rows.push_back(cells);
    if (row.verdict == "passed") continue;
    ++verdicts[row.verdict];
    if (apart.rows.empty() || apart.rows.back() != cells) apart.rows.push_back(cells);
  }
  const auto broken = verdicts["broken"];
  std::string out = "<p><b class=\"" + std::string(broken == 0 ? "good" : "bad") + "\">" +
                    (broken == 0 ? "No truth is broken." : std::to_string(broken) + " broken.") +
                    "</b> " + std::to_string(truths.truths) + " truths, " +
                    std::to_string(truths.findings) + " numbers compared";
  for (const auto& [verdict, n] : verdicts)
    if (n > 0)
      out += ", " + std::to_string(n) + " " +
             (verdict == "deviates" && n > 1 ? std::string("deviate") : verdict);
  out += ".</p>";
  if (!apart.rows.empty())
    out += grouped_table(apart, "Where a solver differs from theory, and why");
  return out + html_data(all, "each truth, the number nearest to its tolerance", csv(truths),
                         "truths.csv");
}

std::string render(Page& page, const std::string&) {
  return "<section id=\"truths\"><h2>Truths</h2><p class=\"lead\">Where theory gives a number, the "
         "solvers are held to it.</p><div class=\"card\">" +
         body(page.input()) + "</div></section>\n";
}

}  // namespace
}  // namespace taut::report::section::truths

TAUT_SECTION(truths) = {
    .name = "truths", .order = 90, .render = taut::report::section::truths::render};
