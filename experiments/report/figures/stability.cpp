#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/report/chart.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/palette.hpp"

namespace taut::report::figure::stability {

namespace {

constexpr double kGap = 0.045;  ///< between cells, in cells
constexpr double kBeside = 56;  ///< px between panels side by side
constexpr double kBelow = 60;   ///< px between panels one below the other

/// One solver's map: a case for each (column, row).
struct Panel {
  std::string label, solver;
  std::map<std::pair<std::size_t, std::size_t>, const Record*> cells;
};

struct Map {
  std::vector<Record> records;
  std::vector<double> columns, rows;  ///< SI values, ascending
  std::vector<Panel> panels;
};

/// "worst" of two cases in one cell, so that nothing hides behind a success.
bool worse(const Record& a, const Record& b) { return a.status.kind > b.status.kind; }

/// The record without its two swept settings, so that all cells of a panel share the others.
Record held(Record r, const FigureSpec& spec) {
  r.dt = 1;
  for (const std::string& swept : {spec.x, spec.y}) {
    r.params.erase(swept);
    const std::string key = swept == "vertices" ? "cloth.grid" : swept == "dt" ? "time.dt" : swept;
    std::erase_if(r.spec.overrides,
                  [&](const std::string& text) { return text.starts_with(key + "="); });
  }
  return r;
}

Map make_map(const FigureSpec& spec, const FigureData& data) {
  Map map;
  map.records.assign(data.records.begin(), data.records.end());
  std::set<double> columns, rows;
  for (const Record& r : map.records)
    if (const double x = value_of(r, spec.x), y = value_of(r, spec.y);
        std::isfinite(x) && std::isfinite(y))
      columns.insert(x), rows.insert(y);
  map.columns.assign(columns.begin(), columns.end());
  map.rows.assign(rows.begin(), rows.end());
  const auto index = [](const std::vector<double>& all, double value) {
    return static_cast<std::size_t>(std::ranges::lower_bound(all, value) - all.begin());
  };
  // Curves that share a solver and its settings, whatever the two swept ones are, are one panel.
  std::vector<Record> flat;
  for (const Record& r : map.records) flat.push_back(held(r, spec));
  for (const Curve& curve : make_curves(flat, spec.x, spec.y, spec.x)) {
    Panel panel{curve.label, curve.solver, {}};
    for (const Point& p : curve.points) {
      const Record& r = map.records[static_cast<std::size_t>(p.record - flat.data())];
      const double x = value_of(r, spec.x), y = value_of(r, spec.y);
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      const Record*& cell = panel.cells[{index(map.columns, x), index(map.rows, y)}];
      if (cell == nullptr || worse(r, *cell)) cell = &r;
    }
    if (!panel.cells.empty()) map.panels.push_back(std::move(panel));
  }
  if (map.panels.empty())
    throw InputError("no case has both '" + spec.x + "' and '" + spec.y + "'");
  return map;
}

std::string make_csv(const Map& map) {
  std::string out = "panel,column,row,x,y,status,reason,case\n";
  for (const Panel& panel : map.panels) {
    if (&panel != &map.panels.front()) out += "\n\n";
    for (const auto& [at, cell] : panel.cells)
      out += csv_field(panel.label) + "," + std::to_string(at.first) + "," +
             std::to_string(at.second) + "," + exact(map.columns[at.first]) + "," +
             exact(map.rows[at.second]) + "," + std::string(to_string(cell->status.kind)) + "," +
             csv_field(cell->status.reason) + "," + csv_field(cell->id) + "\n";
  }
  return out;
}

std::string cell_text(const Quantity& q, double si) {
  const double shown = si * q.scale;
  const bool whole = std::abs(shown - std::round(shown)) < 1e-6 * shown && shown < 9999.5;
  return whole ? exact(std::round(shown)) : tick_text(shown, 2);
}

std::string muted() { return "'" + std::string(neutral("muted").light) + "'"; }

std::string index_ticks(const std::string& which, const Quantity& q, const std::vector<double>& at,
                        double room) {
  const auto stride = static_cast<std::size_t>(
      std::max(1.0, std::ceil(static_cast<double>(at.size()) * 34 / std::max(room, 34.0))));
  std::string out = "set " + which + "tics scale 0 (";
  for (std::size_t i = 0; i < at.size(); i += stride)
    out += (i > 0 ? ", " : "") + gnuplot_string(cell_text(q, at[i])) + " " + std::to_string(i);
  return out + ") textcolor rgb " + muted() + " font ',12'\nset " + which +
         "range [-0.5:" + exact(static_cast<double>(at.size()) - 0.5) + "]\n";
}

/// Axis titles, placed by hand: gnuplot's own would leave the picture.
std::string panel_titles(const FigureSpec& spec, const PlotArea& whole, const PlotArea& panel,
                         bool lowest, bool first) {
  const auto at = [&](double x, double y) {
    return " at screen " + exact(x / spec.width) + ",screen " +
           exact((spec.height - y) / spec.height) + " center tc rgb " + muted() + " font ',12'";
  };
  std::string out;
  if (lowest)
    out += "set label 101 " + gnuplot_string(quantity(spec.x).label()) +
           at((panel.left + panel.right) / 2, panel.bottom + 38) + "\n";
  if (first)
    out += "set label 102 " + gnuplot_string(quantity(spec.y).label()) +
           at(14, (whole.top + whole.bottom) / 2) + " rotate by 90\n";
  return out;
}

std::set<Status::Kind> kinds_in(const Map& map) {
  std::set<Status::Kind> kinds;
  for (const Panel& panel : map.panels)
    for (const auto& [at, cell] : panel.cells) kinds.insert(cell->status.kind);
  return kinds;
}

/// A glyph fits its cell [px]; where it could not be read the colour stands alone.
std::string glyph_font(const Map& map, const PlotArea& at) {
  const double cell = std::min((at.right - at.left) / static_cast<double>(map.columns.size()),
                               (at.bottom - at.top) / static_cast<double>(map.rows.size()));
  const double size = std::min(13.0, std::floor(cell * 0.95));
  return size < 6 ? "" : "' font '," + exact(size) + "' notitle";
}

std::string plot_panel(const Map& map, std::size_t index, const PlotArea& at) {
  const std::string font = glyph_font(map, at);
  std::string out = "plot ";
  bool first = true;
  for (const Status::Kind kind : kinds_in(map)) {
    const StatusStyle style = status_style(kind);
    const std::string name(to_string(kind));
    const std::string source = std::string(first ? "" : ", \\\n  ") + "'@CSV@' index " +
                               std::to_string(index) + " using (strcol(6) eq '" + name +
                               "' ? $2 : 1/0):3:";
    first = false;
    const std::string half = "(" + exact(0.5 - kGap) + ")";
    out += source + half + ":" + half + " with boxxyerror fs solid 1 noborder lc rgb '" +
           std::string(style.colour.light) + "' notitle";
    if (!style.glyph.empty() && !font.empty())
      out += ", \\\n  '@CSV@' index " + std::to_string(index) + " using (strcol(6) eq '" + name +
             "' ? $2 : 1/0):3:(" + gnuplot_string(style.glyph) + ") with labels center tc rgb '" +
             std::string(style.ink.light) + font;
  }
  return out + "\n";
}

/// A square and a word for each class that occurs.
std::string legend(const Map& map, const FigureSpec& spec, double y) {
  std::string out;
  double x = 64;
  int tag = 0;
  for (const Status::Kind kind : kinds_in(map)) {
    const StatusStyle style = status_style(kind);
    std::string text(to_string(kind));
    if (!style.glyph.empty()) text += " " + std::string(style.glyph);
    const auto sx = [&](double px) { return exact(px / spec.width); };
    const auto sy = [&](double px) { return exact((spec.height - px) / spec.height); };
    out += "set object " + std::to_string(++tag) + " rect from screen " + sx(x) + ",screen " +
           sy(y + 6) + " to screen " + sx(x + 12) + ",screen " + sy(y - 6) +
           " fs solid 1 noborder fc rgb '" + std::string(style.colour.light) + "'\nset label " +
           gnuplot_string(text) + " at screen " + sx(x + 18) + ",screen " + sy(y) +
           " left tc rgb '" + std::string(neutral("muted").light) + "' font ',12'\n";
    x += 18 + text_width(text) + 16;
  }
  return out;
}

std::string panel_name(const Panel& panel) {
  return "set label 100 " + gnuplot_string(panel.label) +
         " at graph 0,graph 1 offset 0,0.9 left tc rgb '" +
         std::string(solver_style(panel.solver).colour.light) + "' font ',13'\n";
}

/// Room above the cells [px]: title, legend, names of the panels.
double head_room(const Map& map, const FigureSpec& spec) {
  return (spec.title.empty() ? 8 : 46) + (spec.legend ? 18 : 0) +
         (spec.legend || map.panels.size() > 1 ? 22 : 0);
}

/// The place of a panel: side by side, in a narrow figure one below the other.
PlotArea place(const PlotArea& whole, const FigureSpec& spec, std::size_t index,
               std::size_t count) {
  PlotArea panel = whole;
  const auto k = static_cast<double>(index), n = static_cast<double>(count);
  if (spec.width < kNarrow) {
    const double pitch = (whole.bottom - whole.top + kBelow) / n;
    panel.top = whole.top + k * pitch, panel.bottom = panel.top + pitch - kBelow;
  } else {
    const double pitch = (whole.right - whole.left + kBeside) / n;
    panel.left = whole.left + k * pitch, panel.right = panel.left + pitch - kBeside;
  }
  return panel;
}

std::string make_script(const Map& map, const FigureSpec& spec, const PlotArea& whole) {
  const std::size_t count = map.panels.size();
  const bool stacked = spec.width < kNarrow;
  std::string out = script_preamble(spec.title, whole, spec.width, spec.height) +
                    "unset border\nset multiplot\n" +
                    (spec.legend ? legend(map, spec, spec.title.empty() ? 12 : 46) : "");
  for (std::size_t i = 0; i < count; ++i) {
    const PlotArea at = place(whole, spec, i, count);
    const Panel& panel = map.panels[i];
    out += "set lmargin at screen " + exact(at.left / spec.width) + "\nset rmargin at screen " +
           exact(at.right / spec.width) + "\nset tmargin at screen " +
           exact(1 - at.top / spec.height) + "\nset bmargin at screen " +
           exact(1 - at.bottom / spec.height) + "\n" +
           (spec.legend || map.panels.size() > 1 ? panel_name(panel) : "") +
           index_ticks("x", quantity(spec.x), map.columns, at.right - at.left) +
           index_ticks("y", quantity(spec.y), map.rows, (at.bottom - at.top) * 1.6);
    out += panel_titles(spec, whole, at, !stacked || i + 1 == count, i == 0);
    out += plot_panel(map, i, at);
    if (i == 0)
      out +=
          "unset label 102\nunset for [k=1:90] label k\n"
          "unset for [k=1:90] object k\n";
  }
  return out + "unset multiplot\n";
}

Drawing draw(const FigureSpec& spec, const FigureData& data) {
  const Map map = make_map(spec, data);
  Drawing drawing;
  const Quantity qx = quantity(spec.x), qy = quantity(spec.y);
  double ticks = 0;
  for (const double row : map.rows) ticks = std::max(ticks, text_width(cell_text(qy, row)));
  drawing.area = {std::max(64.0, ticks + 36),
                  spec.width - 12.0,
                  head_room(map, spec),
                  spec.height - 50.0,
                  0,
                  static_cast<double>(map.columns.size())};
  drawing.csv = make_csv(map);
  drawing.script = make_script(map, spec, drawing.area);
  drawing.table.header = {"solver", qx.title, qy.title, "status"};
  drawing.description = "Outcome for each " + qx.title + " and " + qy.title + ". ";
  for (const Panel& panel : map.panels) {
    std::map<Status::Kind, int> counts;
    for (const auto& [at, cell] : panel.cells) {
      const Status& outcome = cell->status;
      ++counts[outcome.kind];
      std::string status(to_string(outcome.kind));
      if (!outcome.reason.empty()) status += ": " + outcome.reason;
      drawing.table.rows.push_back({panel.label, qx.text(map.columns[at.first], 3),
                                    qy.text(map.rows[at.second], 4), status});
    }
    drawing.description += panel.label + ":";
    for (const auto& [kind, n] : counts)
      drawing.description += " " + std::to_string(n) + " " + std::string(to_string(kind)) + ",";
    drawing.description.back() = '.';
    drawing.description += ' ';
  }
  return drawing;
}

}  // namespace
}  // namespace taut::report::figure::stability

TAUT_FIGURE(stability) = {
    .name = "stability",
    .summary = "Which time steps and sweeps survive: a cell and a glyph for each outcome",
    .x = "dt",
    .y = "iterations",
    .along = "",
    .draw = taut::report::figure::stability::draw};
