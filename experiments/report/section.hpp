#pragma once

#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "experiments/report/comparison.hpp"
#include "experiments/report/input.hpp"

namespace taut::report {

/// Every chart is drawn twice: shrunk onto a phone its text could not be read.
constexpr int kPhoneWidth = 340;  ///< px

/// What sections share while one report is being written.
class Page {
 public:
  Page(const ReportInput&, std::filesystem::path scratch);

  const ReportInput& input() const { return input_; }
  const Comparison& facts() const { return facts_; }

  /// Names of all scenes that have records, in the studies' order.
  const std::vector<std::string>& scenes() const { return scenes_; }
  /// The scene on top: one with a film if there is any, else with a curve over time, else the
  /// first; among equals the one that shows most.
  const std::string& hero() const { return hero_; }
  /// The study with most distinct values of `setting` on `scene`, cut to that scene; empty if none
  /// has two. `needs`: only records with this value count ("": all).
  std::vector<Record> sweep(const std::string& scene, const std::string& setting,
                            const std::string& needs) const;

  /// A card with a figure, drawn for pages and for phones, its description and its numbers. Without
  /// gnuplot the card has a note and the numbers. Empty text if there is nothing to draw.
  std::string figure(FigureSpec, const FigureData&, const std::string& heading,
                     const std::string& caption, const std::string& classes = "");
  /// The SVG alone, in the page's colours; throws as make_figure does.
  Figure draw(FigureSpec, const FigureData&, std::string& svg);

  /// Bytes of media that may still be embedded; sections take from it.
  std::size_t media_budget;

 private:
  const ReportInput& input_;
  std::filesystem::path scratch_;
  Comparison facts_;
  std::vector<std::string> scenes_;
  std::string hero_;
  int figures_ = 0;
};

/// A part of the report: one per file in experiments/report/sections, found by its TAUT_SECTION
/// line.
struct SectionEntry {
  std::string_view name;   ///< its id in the page
  int order = 0;           ///< ascending from top to bottom
  bool per_scene = false;  ///< rendered once for each scene, inside that scene's part
  /// HTML; "" if there is nothing to say. `scene` is empty unless per_scene.
  std::string (*render)(Page&, const std::string& scene);
};

/// All sections, sorted by name (generated; see cmake/registry.cmake).
std::span<const SectionEntry* const> sections();

}  // namespace taut::report

#define TAUT_SECTION(id)                  \
  namespace taut::report {                \
  extern const SectionEntry section_##id; \
  }                                       \
  const taut::report::SectionEntry taut::report::section_##id
