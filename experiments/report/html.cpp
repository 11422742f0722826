#include "experiments/report/html.hpp"

namespace taut::report {

std::string solver_name(const std::string& solver, const std::string& label) {
  return "<b class=\"solver\" style=\"color:var(--" +
         std::string(solver_style(solver).colour.name) + ")\">" + escape_html(label) + "</b>";
}

std::string solver_name(const Contender& contender) {
  return solver_name(contender.solver, contender.label);
}

std::string solver_dot(const std::string& solver) {
  return "<i class=\"dot\" style=\"background:var(--" +
         std::string(solver_style(solver).colour.name) + ")\"></i>";
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t k = 0; k < names.size(); ++k)
    out += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + escape_html(names[k]);
  return out;
}

std::string status_legend(const std::set<Status::Kind>& kinds, bool explained) {
  std::string out;
  for (const Status::Kind kind : kinds) {
    const StatusStyle style = status_style(kind);
    out += "<span class=\"class\"><i aria-hidden=\"true\" style=\"background:var(--" +
           std::string(style.colour.name) + ");color:" + std::string(style.ink.light) + "\">" +
           std::string(style.glyph) + "</i>" + std::string(to_string(kind)) +
           (explained ? ": " + std::string(style.help) : "") + "</span> ";
  }
  return out;
}

std::string html_table(const Table& table, const std::string& caption) {
  std::string out = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" +
                    escape_html(caption) + "\"><table class=\"stacks\"><caption class=\"sr\">" +
                    escape_html(caption) + "</caption><thead><tr>";
  for (const std::string& cell : table.header)
    out += "<th scope=\"col\">" + escape_html(cell) + "</th>";
  out += "</tr></thead><tbody>";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      out += i == 0 ? "<th scope=\"row\">" + escape_html(row[i]) + "</th>"
                    : "<td data-label=\"" +
                          escape_html(i < table.header.size() ? table.header[i] : "") + "\">" +
                          escape_html(row[i]) + "</td>";
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>";
}

std::string download_link(const std::string& text, const std::string& file,
                          const std::string& label) {
  return "<a download=\"" + escape_html(file) + "\" href=\"data:text/csv;base64," + base64(text) +
         "\">" + escape_html(label) + "</a>";
}

std::string html_data(const Table& table, const std::string& caption, const std::string& csv,
                      const std::string& file) {
  return "<details class=\"data\"><summary>Data<span class=\"sr\"> of " + escape_html(caption) +
         "</span></summary>" + html_table(table, caption) +
         (csv.empty() ? "" : "<p>" + download_link(csv, file, file) + "</p>") + "</details>";
}

std::string absent(const std::string& what, const std::string& command) {
  return "<p class=\"absent\">" + escape_html(what) +
         (command.empty() ? "" : " <code>" + escape_html(command) + "</code>") + "</p>";
}

namespace {

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

void erase_between(std::string& text, std::string_view open, std::string_view close) {
  for (auto at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    const auto end = text.find(close, at + open.size());
    if (end == std::string::npos) return;
    text.erase(at, end + close.size() - at);
  }
}

/// "<g ...></g>" with nothing but white space inside, also those that become so.
void erase_empty_groups(std::string& svg) {
  for (auto end = svg.find("</g>"); end != std::string::npos;) {
    const auto inner = end == 0 ? std::string::npos : svg.find_last_not_of(" \t\n", end - 1);
    const auto open = inner == std::string::npos ? inner : svg.rfind('<', inner);
    if (open != std::string::npos && svg[inner] == '>' && svg.compare(open, 2, "<g") == 0) {
      svg.erase(open, end + 4 - open);
      end = svg.find("</g>", open);
    } else {
      end = svg.find("</g>", end + 4);
    }
  }
}

/// "rgb(200,  71,  12)" -> "var(--s-orange)", however gnuplot pads the numbers.
void use_variables(std::string& svg) {
  for (auto at = svg.find("rgb("); at != std::string::npos; at = svg.find("rgb(", at + 4)) {
    const auto end = svg.find(')', at);
    unsigned rgb = 0, channel = 0;
    for (auto i = at + 4; i <= end; ++i)
      if (svg[i] >= '0' && svg[i] <= '9')
        channel = channel * 10 + static_cast<unsigned>(svg[i] - '0');
      else if (svg[i] != ' ')
        rgb = rgb << 8U | channel, channel = 0;
    for (const Colour& colour : colours())
      if (std::stoul(std::string(colour.light.substr(1)), nullptr, 16) == rgb) {
        svg.replace(at, end + 1 - at, "var(--" + std::string(colour.name) + ")");
        break;
      }
  }
}

}  // namespace

std::string inline_svg(std::string svg, const std::string& id, const std::string& title,
                       const std::string& description) {
  const auto view_at = svg.find("viewBox=\"");
  if (view_at == std::string::npos) return "";
  const std::string view = svg.substr(view_at, svg.find('"', view_at + 9) + 1 - view_at);
  const auto body = svg.find('>', svg.find("<svg")) + 1;
  svg = svg.substr(body, svg.rfind("</svg>") - body);
  for (const auto& [open, close] : {std::pair("<defs>", "</defs>"),
                                    {"<title>", "</title>"},
                                    {"<desc>", "</desc>"},
                                    {"<rect x=\"0\" y=\"0\"", "/>"},
                                    {" id=\"", "\""},
                                    {" class=\"", "\""},
                                    {" font-family=\"", "\""}})
    erase_between(svg, open, close);
  replace_all(svg, " stroke-width=\"1.00\" stroke-linecap=\"butt\" stroke-linejoin=\"miter\"", "");
  erase_empty_groups(svg);
  use_variables(svg);
  return "<svg class=\"chart\" role=\"img\" " + view + " aria-labelledby=\"" + id + "-t " + id +
         "-d\"><title id=\"" + id + "-t\">" + escape_html(title) + "</title><desc id=\"" + id +
         "-d\">" + escape_html(description) + "</desc>" + svg + "</svg>";
}

std::string svg_markers() {
  // gnuplot's own shapes, so that a figure's file and its copy in the page look alike.
  return R"(<svg width="0" height="0" aria-hidden="true" style="position:absolute"><defs>
<path id="gpPt0" stroke-width=".2" stroke="currentColor" d="M-1,0h2M0,-1v2"/>
<path id="gpPt1" stroke-width=".2" stroke="currentColor" d="M-1,-1L1,1M1,-1L-1,1"/>
<path id="gpPt2" stroke-width=".2" stroke="currentColor" d="M-1,0h2M0,-1v2M-1,-1L1,1M-1,1L1,-1"/>
<rect id="gpPt3" stroke-width=".2" stroke="currentColor" x="-1" y="-1" width="2" height="2"/>
<rect id="gpPt4" stroke-width=".2" stroke="currentColor" fill="currentColor" x="-1" y="-1" width="2" height="2"/>
<circle id="gpPt5" stroke-width=".2" stroke="currentColor" r="1"/>
<circle id="gpPt6" fill="currentColor" r="1"/>
<path id="gpPt7" stroke-width=".2" stroke="currentColor" d="M0,-1.33L-1.33,.67 1.33,.67z"/>
<path id="gpPt8" fill="currentColor" d="M0,-1.33L-1.33,.67 1.33,.67z"/>
<path id="gpPt9" stroke-width=".2" stroke="currentColor" d="M0,1.33L-1.33,-.67 1.33,-.67z"/>
<path id="gpPt10" fill="currentColor" d="M0,1.33L-1.33,-.67 1.33,-.67z"/>
<path id="gpPt11" stroke-width=".2" stroke="currentColor" d="M0,-1.41L1.41,0 0,1.41 -1.41,0z"/>
<path id="gpPt12" fill="currentColor" d="M0,-1.41L1.41,0 0,1.41 -1.41,0z"/>
<path id="gpPt13" stroke-width=".2" stroke="currentColor" d="M0,1.33L1.265,.411 .782,-1.067 -.782,-1.076 -1.265,.411z"/>
<path id="gpPt14" fill="currentColor" d="M0,1.33L1.265,.411 .782,-1.067 -.782,-1.076 -1.265,.411z"/>
</defs></svg>)";
}

std::string theme_css() {
  std::string light, dark;
  for (const Colour& colour : colours()) {
    const std::string name = "--" + std::string(colour.name) + ":";
    light += name + std::string(colour.light) + ";";
    dark += name + std::string(colour.dark) + ";";
  }
  light +=
      "--bg:#FCFCFC;--line:#E3E5EA;--code:#F1F2F5;--good:#0F7A45;--bad:#B3341F;--link:#0B5CAD;";
  dark += "--bg:#14171C;--line:#2B323C;--code:#262D36;--good:#4CC38A;--bad:#FF8F73;--link:#7AB8FF;";
  return ":root{color-scheme:light;" + light + "}\n@media (prefers-color-scheme:dark){:root{" +
         "color-scheme:dark;" + dark + "}}\n:root[data-theme=light]{color-scheme:light;" + light +
         "}\n:root[data-theme=dark]{color-scheme:dark;" + dark +
         "}\n@media print{:root,:root[data-theme]{" + "color-scheme:light;" + light +
         "--bg:#FFF;}}\n";
}

}  // namespace taut::report
