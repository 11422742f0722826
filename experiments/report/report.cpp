#include "experiments/report/report.hpp"

#include <algorithm>
#include <stdexcept>

#include "experiments/report/chart/format.hpp"
#include "experiments/report/model/model.hpp"
#include "experiments/report/page.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

namespace {

/// JSON inside a script element: no text can close the element or open a comment.
std::string for_script(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

std::string_view page_file(std::string_view name) {
  const auto at = std::ranges::find(page_files(), name, &PageFile::name);
  if (at == page_files().end()) throw std::logic_error("no page file " + std::string(name));
  return at->text;
}

/// The headlines and how sure they are, a line each: what there is to read without JavaScript.
std::string headlines(const std::string& model) {
  std::string text;
  for (const Json& claim : parse_json(model).value("claims", Json::array()))
    if (claim["kind"] == "headline")
      text +=
          claim["sentence"].get<std::string>() + " (" + claim["sure"].get<std::string>() + ")\n";
  return escape_html(text);
}

}  // namespace

std::string make_report(const ReportInput& input) {
  const std::string json = make_model(input), model = for_script(json), answer = headlines(json);
  const std::string title = escape_html(report_title(input));
  const std::string_view page = page_file("index.html");
  std::string html;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t open = page.find("{{", at), close = page.find("}}", open);
    html += page.substr(at, open - at);
    if (open == std::string_view::npos) break;
    const std::string_view name = page.substr(open + 2, close - open - 2);
    html += name == "model"       ? model
            : name == "title"     ? title
            : name == "headlines" ? answer
                                  : page_file(name);
    at = close + 2;
  }
  return html;
}

}  // namespace taut::report
