#include "experiments/report/figures.hpp"

#include <algorithm>

#include "core/model/input_error.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/gnuplot.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace fs = std::filesystem;

namespace {

std::string header(const FigureSpec& spec, const std::string& stem) {
  return "# " + spec.kind + ": " + spec.y + " over " + spec.x +
         "\n# Redraw: gnuplot -e \"set terminal svg noenhanced size " + std::to_string(spec.width) +
         "," + std::to_string(spec.height) + "; set output '" + stem + ".svg'\" " + stem + ".gp\n";
}

std::string terminal(Format format, const FigureSpec& spec) {
  if (format == Format::svg)
    return "svg noenhanced size " + std::to_string(spec.width) + "," + std::to_string(spec.height) +
           " font 'sans-serif,13' background '#ffffff'";
  return "pdfcairo noenhanced size " + exact(spec.width / 100.0) + "in," +
         exact(spec.height / 100.0) + "in font 'sans,13' fontscale 0.72 linewidth 0.72";
}

}  // namespace

const FigureEntry& find_figure(std::string_view name) {
  std::vector<std::string> names;
  for (const FigureEntry* entry : figures()) {
    if (entry->name == name) return *entry;
    names.emplace_back(entry->name);
  }
  throw InputError("unknown kind of figure '" + std::string(name) + "'" +
                   suggestion(std::string(name), names));
}

Figure make_figure(FigureSpec spec, const FigureData& data, const fs::path& out_dir) {
  const FigureEntry& entry = find_figure(spec.kind);
  if (spec.x.empty()) spec.x = entry.x;
  if (spec.y.empty()) spec.y = entry.y;
  if (spec.along.empty())
    spec.along =
        spec.x == "dt" || spec.x == "substeps" || spec.x == "vertices" ? spec.x : entry.along;
  if (spec.file.empty()) spec.file = slug(spec.kind + "-" + spec.y + "-over-" + spec.x);
  Drawing drawing = entry.draw(spec, data);

  make_folder(out_dir);
  const auto path = [&](const char* extension) { return out_dir / (spec.file + extension); };
  Figure figure{spec.title,   drawing.description, {},          {}, path(".gp"),
                path(".csv"), drawing.table,       drawing.area};
  for (std::size_t at; (at = drawing.script.find("@CSV@")) != std::string::npos;)
    drawing.script.replace(at, 5, spec.file + ".csv");
  write_file(figure.csv, drawing.csv);
  write_file(figure.gp, header(spec, spec.file) + drawing.script);
  for (const Format format : spec.formats) {
    fs::path& out = format == Format::svg ? figure.svg : figure.pdf;
    out = path(format == Format::svg ? ".svg" : ".pdf");
    run_gnuplot(figure.gp, terminal(format, spec), out);
  }
  return figure;
}

}  // namespace taut::report
