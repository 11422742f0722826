// How cases end over two settings, and how often each solver is close to the cheapest.
#include <algorithm>
#include <cmath>
#include <set>

#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/plot/sheet.hpp"
#include "experiments/system/text.hpp"

namespace taut::report {

namespace {

/// Commands for ticks and range of an axis of cells that are one unit apart.
std::string cell_ticks(const char* axis, const Quantity& q, const std::vector<double>& values) {
  constexpr std::size_t kMost = 7;  // more labels would touch in a narrow panel
  const std::size_t every = (values.size() + kMost - 1) / kMost;
  std::string list;
  for (std::size_t k = 0; k < values.size(); k += std::max<std::size_t>(1, every))
    list += (k > 0 ? ", " : "") + gnuplot_string(tick_of(q, values[k])) + " " + std::to_string(k);
  return "set " + std::string(axis) + "tics (" + list + ")\nset " + axis +
         "range [-0.5:" + exact(static_cast<double>(values.size()) - 0.5) + "]\n";
}

/// Error of a case that completed; NaN if it did not or the error is unknown.
double error_of(const Record& r) {
  const bool ended = r.status.kind == Status::Kind::ok || r.status.kind == Status::Kind::unsettled;
  return ended ? value_of(r, kErrorMetric) : std::nan("");
}

/// Mixture of two colours "#RRGGBB".
std::string mixed(std::string_view colour, double share, std::string_view background) {
  const auto part = [](std::string_view of, std::size_t k) {
    return std::stoi(std::string(of.substr(1 + 2 * k, 2)), nullptr, 16);
  };
  std::string text = "#";
  for (std::size_t k = 0; k < 3; ++k) {
    const double mix = share * part(colour, k) + (1 - share) * part(background, k);
    text += formatted("%02X", static_cast<unsigned>(std::lround(mix)));
  }
  return text;
}

}  // namespace

Sheet map_sheet(const std::vector<StatusMap>& maps) {
  Sheet sheet;
  sheet.x_label = maps.front().x.label();
  sheet.y_label = maps.front().y.label();
  sheet.csv = "curve,solver,label,x,y,column,row,status,reason,case,stretch\n";
  std::set<Status::Kind> kinds, plain;  // plain: of a case without a shade, in its own colour
  for (const StatusMap& map : maps)
    for (const StatusMap::Cell& cell : map.cells) {
      kinds.insert(cell.record->status.kind);
      if (std::isnan(error_of(*cell.record))) plain.insert(cell.record->status.kind);
    }
  const auto fill = [](const std::string& colour) {
    return "with boxxyerror fs solid 1 noborder lc rgb '" + colour + "'";
  };
  const auto shaded = [](const StretchShade& shade) {
    return mixed(status_style(Status::Kind::ok).colour.light, shade.share, "#FFFFFF");
  };
  // the key has the shades in their order, whichever panel has them first
  for (double from = -1; const StretchShade& shade : stretch_shades()) {
    for (const StatusMap& map : maps)
      for (const StatusMap::Cell& cell : map.cells)
        if (const double error = error_of(*cell.record); error > from && error <= shade.end)
          sheet.explain(fill(shaded(shade)), std::string(shade.text));
    from = shade.end;
  }
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const StatusMap& map = maps[i];
    for (const StatusMap::Cell& cell : map.cells)
      sheet.csv += std::to_string(i) + "," + csv_field(map.solver) + "," + csv_field(map.label) +
                   "," + exact(map.columns[cell.column]) + "," + exact(map.rows[cell.row]) + "," +
                   std::to_string(cell.column) + "," + std::to_string(cell.row) + "," +
                   std::string(to_string(cell.record->status.kind)) + "," +
                   csv_field(cell.record->status.reason.text()) + "," + csv_field(cell.record->id) +
                   "," + exact(error_of(*cell.record)) + "\n";
    sheet.panels.push_back(
        {map.label, cell_ticks("x", map.x, map.columns) + cell_ticks("y", map.y, map.rows), ""});
    for (const Status::Kind kind : kinds) {
      const StatusStyle style = status_style(kind);
      const std::string cells = "'@CSV@' skip 1 using (column(1) == " + std::to_string(i) +
                                " && strcol(8) eq '" + std::string(to_string(kind)) +
                                "' ? column(6) : NaN):7:";
      sheet.draw(cells + "(0.45):(0.45)", fill(std::string(style.colour.light)),
                 plain.contains(kind) ? std::string(to_string(kind)) : "");
      sheet.draw(cells + "(" + gnuplot_string(style.glyph) + ")",
                 "with labels tc rgb '" + std::string(style.ink.light) + "'", "");
    }
    double from = -1;
    for (const StretchShade& shade : stretch_shades()) {
      const bool any = std::ranges::any_of(map.cells, [&](const StatusMap::Cell& cell) {
        const double error = error_of(*cell.record);
        return error > from && error <= shade.end;
      });
      const std::string cells = "'@CSV@' skip 1 using (column(1) == " + std::to_string(i) +
                                " && column(11) > " + exact(from) +
                                " && column(11) <= " + exact(std::min(shade.end, 1e300)) +
                                " ? column(6) : NaN):7:";
      from = shade.end;
      if (!any) continue;
      const StatusStyle ok = status_style(Status::Kind::ok);
      sheet.draw(cells + "(0.45):(0.45)", fill(shaded(shade)), std::string(shade.text));
      sheet.draw(cells + "(strcol(8) eq '" + std::string(to_string(Status::Kind::ok)) + "' ? " +
                     gnuplot_string(ok.glyph) + " : " +
                     gnuplot_string(status_style(Status::Kind::unsettled).glyph) + ")",
                 "with labels tc rgb '" +
                     std::string(shade.share == 1 ? ok.ink.light : kDarkInk.light) + "'",
                 "");
    }
  }
  return sheet;
}

Sheet profile_sheet(const std::vector<PerformanceProfile>& profiles) {
  Sheet sheet;
  double most = 2;  // largest finite factor
  for (const PerformanceProfile& profile : profiles)
    for (const double r : profile.ratios)
      if (std::isfinite(r)) most = std::max(most, r);
  sheet.x_label = "CPU time over that of the cheapest solver";
  sheet.y_label = "share of problems [%]";
  sheet.settings = "set logscale x\nset xrange [1:" + exact(1.1 * most) + "]\nset yrange [0:105]\n";
  sheet.csv = "curve,solver,factor,share\n";
  sheet.panels.emplace_back();
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    const PerformanceProfile& profile = profiles[i];
    std::set<double> factors{1, 1.1 * most};
    for (const double r : profile.ratios)
      if (std::isfinite(r)) factors.insert(r);
    for (const double factor : factors)
      sheet.csv += std::to_string(i) + "," + csv_field(profile.solver) + "," + exact(factor) + "," +
                   exact(profile.share(factor)) + "\n";
    sheet.draw("'@CSV@' skip 1 using (column(1) == " + std::to_string(i) +
                   " ? column(3) : NaN):(100*column(4))",
               "with steps lw 2 lc rgb '" + colour_of(profile.solver) + "' dt " +
                   gnuplot_dash(profile.solver, 0),
               solver_title(profile.solver));
  }
  return sheet;
}

}  // namespace taut::report
