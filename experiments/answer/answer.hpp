#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/model/status.hpp"
#include "experiments/answer/number.hpp"

namespace taut {

/// One value of an answer: nothing (meaningless or not measured), a text, a number or an interval
/// in SI units, or yes or no.
struct Cell {
  /// Whether there is a value. A cell without one may explain that in words ("not run"), which are
  /// then its text.
  enum class State {
    value,
    none,     ///< meaningless, not reached, or the case failed
    refused,  ///< the solver cannot run it
    not_run,  ///< not run, or not timed
    astray    ///< the cloth is not where it should be: a number is shown but not compared
  };
  /// Meaning of a verdict to a reader. A terminal shows it as a colour; data do not contain it.
  enum class Tone { plain, good, doubtful, bad };

  std::variant<std::monostate, std::string, double, Interval, bool> value;
  State state = State::none;
  std::string note;                ///< what a reader has to know about the value
  std::vector<std::string> terms;  ///< words of the note that a page explains
  std::string key;                 ///< key of the case that it comes from
  std::string scene;  ///< in a row's first cell: name of the scene to which the row belongs
  bool best = false;  ///< best of its row, by more than noise
  Tone tone = Tone::plain;

  Cell() = default;
  Cell(std::string text) : value(std::move(text)), state(State::value) {}
  Cell(std::string_view text) : Cell(std::string(text)) {}
  Cell(const char* text) : Cell(std::string(text)) {}
  Cell(bool yes) : value(yes), state(State::value) {}
  Cell(double number);  ///< empty if the number is not finite
  template <std::integral Number>
  requires(!std::same_as<Number, bool>) Cell(Number number) : Cell(static_cast<double>(number)) {}
  Cell(const Interval&);
  template <class Value>
  Cell(const std::optional<Value>& one) {
    if (one) *this = Cell(*one);
  }

  /// A cell with these words in place of a value.
  static Cell lacking(State why, std::string words);

  Cell with(std::string a_note) const;
  Cell of_scene(std::string name) const;
  Cell toned(Tone) const;
  bool empty() const { return value.index() == 0; }
  /// The text; "" for other values.
  std::string text() const;
  bool is_true() const { return value == decltype(value)(true); }
  /// The number or the middle of the interval; NaN for other values.
  double number() const;
  bool operator==(const Cell&) const = default;
};
/// The word of a status. `ok` is good; no other has a tone.
Cell cell_of(Status::Kind);
std::string_view to_string(Cell::State);
std::optional<Cell::State> cell_state(std::string_view);  ///< nothing: no state has that name

/// Description of a column: its name in data ("cpu"), its heading and its unit.
struct Column {
  std::string name;
  std::string heading;  ///< without the unit
  std::string unit = "1";
  std::string shown = {};  ///< the unit shown to people: `shown = scale * SI`
  double scale = 1;
  int digits = 3;        ///< significant digits shown to people
  bool detail = false;   ///< shown to people only if they ask for details; data always include it
  bool command = false;  ///< its texts stay on one line in a terminal, since people copy them

  /// An empty heading is replaced by the name, with blanks between its words.
  Column(std::string name, std::string heading = {}, const Unit& = kNumber, int digits = 3);
  Column in_detail() const;
  Column of_commands() const;
  bool operator==(const Column&) const = default;
};

/// A single value with its name.
struct Fact {
  Column column;
  Cell cell;
  bool operator==(const Fact&) const = default;
};

struct Table {
  std::string name;
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows = {};  ///< each has as many cells as there are columns
  std::string caption = {};  ///< what a reader has to know about the table; shown below it
  bool detail = false;
  std::size_t most = 0;  ///< most rows shown to people unless they ask for details; 0: all

  /// Whether people see any of the table.
  bool is_shown(bool details) const {
    return !rows.empty() &&
           (details || (!detail && !std::ranges::all_of(columns, &Column::detail)));
  }
  std::size_t rows_shown(bool details) const {
    return details || most == 0 ? rows.size() : std::min(most, rows.size());
  }

  /// The cell in this column. Throws InputError if there is no such column.
  const Cell& at(const std::vector<Cell>& row, std::string_view column) const;
  bool operator==(const Table&) const = default;
};

/// The findings of a verb. One piece of code each prints it on a terminal, writes it as JSON, CSV
/// and Markdown, keeps it and compares it. Facts, tables, and columns within a table have unique
/// names.
struct Answer {
  std::string kind;  ///< the verb: "check", "bench effects"
  /// Object of the verb: "regression", "hang jakobsen:iterations=8".
  std::string subject;
  std::vector<Fact> facts = {};
  std::vector<Table> tables = {};

  void add(Column, Cell);
  Table& add(Table);
  const Cell& fact(std::string_view name) const;    ///< an empty cell: no such fact
  const Table& table(std::string_view name) const;  ///< a table without rows: no such table
  bool operator==(const Answer&) const = default;
};

/// A cell for people, followed by its note. `with_unit` adds the unit, which a table has in the
/// heading instead: "2.3 (2.1 to 2.5) ms"; "-" if the cell is empty.
std::string text(const Cell&, const Column&, bool with_unit = true);
/// The heading with the unit: "CPU time [ms]".
std::string label(const Column&);

/// Text for a terminal: the subject, a line for each fact, and tables in columns. Words are wrapped
/// where a row would exceed `width` characters. Every part passes through `shown`, after the
/// widths of columns are known.
using Shown = std::function<std::string(std::string_view part, Cell::Tone)>;
std::string to_text(
    const Answer&, bool details = false, std::size_t width = std::string::npos,
    const Shown& shown = [](std::string_view part, Cell::Tone) { return std::string(part); });

/// JSON in the schema that all verbs share (experiments/cli/README.md), with every number in SI, to
/// the bit.
std::string to_json(const Answer&);
/// Inverse of to_json(), without tones. Throws InputError that names the file and the place in it.
Answer answer_from_json(std::string_view text, const std::string& file);

/// One table, by name, for spreadsheets and data frames; "facts" gives the facts, and "" the first
/// table, or the facts if there is no table. Numbers are in SI, to the bit. An interval takes three
/// columns, and a column with notes one more. Throws InputError if there is no such table.
std::string to_csv(const Answer&, std::string_view table = "");
/// A field of a CSV file. A text that a spreadsheet would take for a formula is marked as text.
std::string csv_field(std::string_view text);
/// A text that is safe as a file name and as an HTML id: only letters, digits, '-', '_' and '.',
/// without '-' or '.' at the start, at most 129 characters. If characters were replaced or cut off,
/// a digest is appended, so that different texts stay different.
std::string slug(std::string_view);

/// A row that differs between two tables.
struct Difference {
  std::string text;    ///< "jakobsen, mass ratio: bad 16.62 -> 18.1"
  bool moved = false;  ///< false: only one of the tables has the row
};
/// Compares the cells in the columns `held`; numbers agree within `relative` of the old value. Rows
/// are matched by their cells in the columns `names`.
std::vector<Difference> differences(const Table& before, const Table& now,
                                    const std::vector<std::string>& names,
                                    const std::vector<std::string>& held, double relative = 0);

/// Markdown for documents, with the content of to_text().
std::string to_markdown(const Answer&, bool details = false);

}  // namespace taut
