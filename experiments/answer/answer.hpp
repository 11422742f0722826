#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "experiments/answer/number.hpp"

namespace taut {

/// One value of an answer: nothing (it has no meaning, or was not measured), a text, a number or an
/// interval in SI units, yes or no.
struct Cell {
  /// Whether there is a value. What has none may say so in words ("not run"), which are its text.
  enum class State {
    value,
    none,         ///< no meaning, not reached, or the case failed
    refused,      ///< the solver cannot run it
    not_run,      ///< nobody ran or timed it
    hardly_moves  ///< of cloth that stands still: where there is a number, it is not compared
  };

  std::variant<std::monostate, std::string, double, Interval, bool> value;
  State state = State::none;
  std::string note;   ///< what a reader has to know of it
  std::string key;    ///< of the case that it comes from
  std::string scene;  ///< of a row's first cell: the name of the scene that the row is of
  bool best = false;  ///< of its row, by more than what is noise

  Cell() = default;
  Cell(std::string text) : value(std::move(text)), state(State::value) {}
  Cell(std::string_view text) : Cell(std::string(text)) {}
  Cell(const char* text) : Cell(std::string(text)) {}
  Cell(bool yes) : value(yes), state(State::value) {}
  Cell(double number);  ///< nothing if it is not finite
  template <std::integral Number>
  requires(!std::same_as<Number, bool>) Cell(Number number) : Cell(static_cast<double>(number)) {}
  Cell(const Interval&);
  template <class Value>
  Cell(const std::optional<Value>& one) {
    if (one) *this = Cell(*one);
  }

  /// These words in place of a value.
  static Cell lacking(State why, std::string words);

  Cell with(std::string a_note) const;
  Cell of_scene(std::string name) const;
  bool empty() const { return value.index() == 0; }
  /// The text; "" of anything else.
  std::string text() const;
  bool is_true() const { return value == decltype(value)(true); }
  /// The number, or the middle of the interval; NaN of anything else.
  double number() const;
  bool operator==(const Cell&) const = default;
};
std::string_view to_string(Cell::State);
std::optional<Cell::State> cell_state(std::string_view);  ///< nothing: it is none of them

/// What a cell says: its name in data ("cpu"), in words, and its unit.
struct Column {
  std::string name;
  std::string heading;  ///< without the unit
  std::string unit = "1";
  std::string shown = {};  ///< the unit that people are shown: `shown = scale * SI`
  double scale = 1;
  int digits = 3;       ///< significant ones that people are shown
  bool detail = false;  ///< people see it if they ask for details; data always have it

  /// Without a heading: the name, with blanks for what separates its words.
  Column(std::string name, std::string heading = {}, const Unit& = kNumber, int digits = 3);
  Column in_detail() const;
  Unit as_unit() const { return {unit, shown, scale}; }
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
  std::string caption = {};                  ///< what a reader has to know of it, below
  bool detail = false;
  std::size_t most = 0;  ///< rows that people see unless they ask for details; 0: all

  /// Whether people see any of it.
  bool is_shown(bool details) const {
    return !rows.empty() &&
           (details || (!detail && !std::ranges::all_of(columns, &Column::detail)));
  }
  std::size_t rows_shown(bool details) const {
    return details || most == 0 ? rows.size() : std::min(most, rows.size());
  }

  /// The cell of that column; throws InputError: there is no such column.
  const Cell& at(const std::vector<Cell>& row, std::string_view column) const;
  bool operator==(const Table&) const = default;
};

/// What a verb found: a value that is printed on a terminal, written as JSON, CSV and Markdown,
/// kept and compared, each by one piece of code. Names of facts, of tables and of a table's columns
/// are unique.
struct Answer {
  std::string kind;     ///< the verb: "check", "bench effects"
  std::string subject;  ///< of what: "regression", "hang jakobsen:iterations=8"
  std::vector<Fact> facts = {};
  std::vector<Table> tables = {};

  void add(Column, Cell);
  Table& add(Table);
  const Cell& fact(std::string_view name) const;    ///< an empty one: there is none
  const Table& table(std::string_view name) const;  ///< one without rows: there is none
  bool operator==(const Answer&) const = default;
};

/// The cell for people, with its unit or, as in a column whose heading has it, without:
/// "2.3 (2.1 to 2.5) ms"; "-": nothing. A note follows.
std::string text(const Cell&, const Column&, bool with_unit = true);
/// The heading with the unit: "CPU time [ms]".
std::string label(const Column&);

/// For a terminal: the subject, a line for every fact, tables in columns. Words are broken into
/// lines where a row would have more than `width` characters.
std::string to_text(const Answer&, bool details = false, std::size_t width = std::string::npos);

/// The schema of all verbs (experiments/cli/README.md): every number in SI, to the bit.
std::string to_json(const Answer&);
/// The answer of that text; throws InputError that names the file and the place in it.
Answer answer_from_json(std::string_view text, const std::string& file);

/// One table for spreadsheets and data frames, by name; "facts" or "": the facts, or the first
/// table where there is one. Numbers in SI, to the bit; an interval has three columns, what has
/// notes one more. Throws InputError: no such table.
std::string to_csv(const Answer&, std::string_view table = "");
/// A field of a CSV file; what a spreadsheet would take for a formula is marked as text.
std::string csv_field(std::string_view text);
/// Letters, digits, '-', '_' and '.' only, '-' and '.' not first, at most 129: safe as a file name
/// and as an HTML id. A text of which something was replaced or cut off gets a digest: two texts
/// never share one.
std::string slug(std::string_view);

/// A row that differs between two tables.
struct Difference {
  std::string text;    ///< "jakobsen, mass ratio: bad 16.62 -> 18.1"
  bool moved = false;  ///< both tables have the row; false: one alone
};
/// Rows have the name that their cells of `names` make. Compared are the cells of `held`, numbers
/// within `relative` of what they were.
std::vector<Difference> differences(const Table& before, const Table& now,
                                    const std::vector<std::string>& names,
                                    const std::vector<std::string>& held, double relative = 0);

/// As on a terminal, for documents.
std::string to_markdown(const Answer&, bool details = false);

}  // namespace taut
