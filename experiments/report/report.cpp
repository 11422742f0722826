#include "experiments/report/report.hpp"

#include <algorithm>

#include "core/model/input_error.hpp"
#include "experiments/report/assets.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace fs = std::filesystem;

namespace {

std::string title_text(const ReportInput& input, const Comparison& facts) {
  if (!input.title.empty()) return input.title;
  std::string title;
  for (const Contender& c : facts.contenders)
    title += (title.empty() ? "" : " vs ") + solver_title(c.solver);
  return title;
}

/// Nothing may be fetched; the page's own style, script and embedded media are all there is.
constexpr std::string_view kPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
    "media-src data: blob:; base-uri 'none'; form-action 'none'";

std::string head(const std::string& title) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
         std::string(kPolicy) +
         "\">\n<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>" +
         escape_html(title) + " – taut report</title>\n<style>\n" + theme_css() + report_css +
         "</style></head>\n<body>" + svg_markers() +
         "<a class=\"skip\" href=\"#main\">Skip to the results</a>\n";
}

std::string scene_part(Page& page, const std::string& scene,
                       const std::vector<const SectionEntry*>& parts) {
  std::string inner;
  for (const SectionEntry* part : parts)
    if (part->per_scene) inner += part->render(page, scene);
  if (inner.empty()) return "";
  std::string summary;
  for (const SceneInfo& info : page.input().scenes)
    if (info.name == scene) summary = info.summary;
  const std::string id = "scene-" + slug(scene);
  return "<section class=\"scene\" id=\"" + id + "\" aria-labelledby=\"" + id + "-h\"><h3 id=\"" +
         id + "-h\">" + escape_html(solver_title(scene)) + "</h3><p class=\"lead\">" +
         escape_html(summary) + "</p><div class=\"cards\">" + inner + "</div></section>\n";
}

std::string scenes_part(Page& page, const std::vector<const SectionEntry*>& parts) {
  std::string links, all;
  for (const std::string& scene : page.scenes()) {
    const std::string part = scene_part(page, scene, parts);
    if (part.empty()) continue;
    all += part;
    links += "<a href=\"#scene-" + slug(scene) + "\">" + escape_html(scene) + "</a>";
  }
  std::set<Status::Kind> kinds;
  for (const StudyResult& study : page.input().studies)
    for (const Record& r : study.records) kinds.insert(r.status.kind);
  return "<section id=\"scenes\"><h2>Scene by scene</h2><p class=\"lead\">How cases ended: " +
         status_legend(kinds, true) +
         "</p><p class=\"lead\">On curves a failed case is its glyph above the plot, an exact zero "
         "a triangle on the "
         "floor.</p><nav class=\"jump\" "
         "aria-label=\"Scenes\">" +
         links + "</nav>" + all + "</section>\n";
}

}  // namespace

std::string make_report(const ReportInput& input) {
  if (std::ranges::all_of(input.studies, [](const auto& s) { return s.records.empty(); }))
    throw InputError("there is no result of this build to report; `taut run` makes some");
  const Scratch scratch;
  Page page(input, scratch.path());
  std::vector<const SectionEntry*> parts(sections().begin(), sections().end());
  std::ranges::stable_sort(parts, {}, &SectionEntry::order);
  std::string html = head(title_text(input, page.facts()));
  bool scenes_done = false;
  for (const SectionEntry* part : parts) {
    if (!part->per_scene) {
      html += part->render(page, "");
    } else if (!scenes_done) {
      html += scenes_part(page, parts);
      scenes_done = true;
    }
  }
  return html + "</main>\n<script>\n" + report_js + "</script></body></html>\n";
}

fs::path write_report(const ReportInput& input, const fs::path& path) {
  const std::string html = make_report(input);
  if (path.has_parent_path()) make_folder(path.parent_path());
  write_file(path, html);
  return path;
}

}  // namespace taut::report
