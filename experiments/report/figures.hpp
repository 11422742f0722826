#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/report/labels.hpp"

namespace taut::report {

/// A value of one case over simulated time.
struct TimeSeries {
  std::string scene;
  std::string solver;     ///< the entry's name
  std::string label;      ///< "Jakobsen, 8 sweeps"
  std::string value;      ///< "stretch.rms"
  std::vector<double> t;  ///< s
  std::vector<double> y;  ///< SI; NaN: no value at this moment
};

/// What figures are drawn from; every kind takes what it needs.
struct FigureData {
  std::span<const Record> records;
  std::span<const TimeSeries> series;
};

enum class Format { svg, pdf };

/// What to draw. Everything but `kind` has a default that the kind chooses.
struct FigureSpec {
  std::string kind;               ///< the name of a FigureEntry
  std::string x, y;               ///< names that value_of() knows; "": the kind's own
  std::string along;              ///< the setting that orders a curve; "": the kind's own
  std::string title;              ///< "": none
  std::string file;               ///< file name without extension; "": from kind, x and y
  std::optional<double> slope;    ///< the theory's exponent of y over x
  int width = 760, height = 470;  ///< px; a hundredth of an inch in PDF
  bool legend = true;             ///< false where the page around the figure explains it
  std::vector<Format> formats{Format::svg, Format::pdf};
};

/// The numbers behind a figure, for people: every cell is text.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// Where the data lie in an SVG [px], with the value range along x in shown units: what a playhead
/// needs.
struct PlotArea {
  double left = 0, right = 0, top = 0, bottom = 0;
  double low = 0, high = 1;
};

/// What a kind makes of its data, before gnuplot sees it.
struct Drawing {
  std::string script;       ///< gnuplot commands; reads its data from "@CSV@"
  std::string csv;          ///< SI units; two blank lines separate gnuplot's blocks
  std::string description;  ///< what is to be seen, for screen readers: one or two sentences
  Table table;
  PlotArea area;
  std::vector<Label> texts = {};  ///< of charts: every text with its place
  std::vector<Box> marks = {};    ///< of charts: every marker's place
};

/// A drawn figure.
struct Figure {
  std::string title, description;
  std::filesystem::path svg, pdf, gp, csv;  ///< pdf and svg are empty if they were not asked for
  Table table;
  PlotArea area;
};

/// How a kind of figure introduces itself: one per file, found by its TAUT_FIGURE line.
struct FigureEntry {
  std::string_view name;         ///< "error-iterations"
  std::string_view summary;      ///< one sentence
  std::string_view x, y, along;  ///< defaults; "": the kind has none
  /// Precondition: x, y and along of the spec are set. Throws InputError if there is nothing to
  /// draw.
  Drawing (*draw)(const FigureSpec&, const FigureData&);
};

/// All kinds, sorted by name (generated; see cmake/registry.cmake).
std::span<const FigureEntry* const> figures();

/// Throws InputError with a suggestion if there is no such kind.
const FigureEntry& find_figure(std::string_view name);

/// Draws into `out_dir` (made if missing): FILE.gp, FILE.csv and FILE.svg, FILE.pdf as asked.
/// Throws InputError (unknown kind, nothing to draw), PlotError (no gnuplot; .gp and .csv are there
/// all the same) or std::runtime_error (cannot write).
Figure make_figure(FigureSpec, const FigureData&, const std::filesystem::path& out_dir);

}  // namespace taut::report

#define TAUT_FIGURE(id)                 \
  namespace taut::report {              \
  extern const FigureEntry figure_##id; \
  }                                     \
  const taut::report::FigureEntry taut::report::figure_##id
