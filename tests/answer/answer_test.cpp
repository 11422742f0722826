// Answers: terminal, JSON, CSV and Markdown output of an answer agree.
#include "experiments/answer/answer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/model/input_error.hpp"
#include "experiments/system/json.hpp"
#include "tests/support/numbers.hpp"

namespace taut::answer_test {
namespace {

using Rows = std::vector<std::vector<std::string>>;

class MadeUp {
 public:
  explicit MadeUp(unsigned seed) : random_(seed) {}

  Answer answer() {
    Answer made{"made " + word(), word()};
    for (int i = up_to(5); i > 0; --i) made.add(column("fact" + std::to_string(i)), cell());
    for (int i = up_to(3); i > 0; --i) {
      Table& table = made.add(Table{"table" + std::to_string(i), maybe() ? word() : "", {}});
      for (int c = 1 + up_to(4); c > 0; --c)
        table.columns.push_back(column("column" + std::to_string(c)));
      for (int r = up_to(6); r > 0; --r) {
        auto& row = table.rows.emplace_back();
        for (std::size_t c = 0; c < table.columns.size(); ++c) row.push_back(cell());
      }
      if (maybe()) table.caption = word();
      table.detail = up_to(3) == 0;
      table.most = static_cast<std::size_t>(up_to(4));
    }
    return made;
  }

 private:
  int up_to(int most) { return static_cast<int>(random_() % static_cast<unsigned>(most + 1)); }
  bool maybe() { return up_to(1) == 0; }
  std::string word() {
    static const std::vector<std::string> kWords{
        "hang", "a | b", "x, y",      "\"quoted\"", "=1+1", "-3",        "two words",
        "<b>",  "käse",  "_a*`\\end", "1e3",        "null", "line\nfeed"};
    return kWords[static_cast<std::size_t>(up_to(static_cast<int>(kWords.size()) - 1))];
  }
  double number() {
    if (up_to(9) == 0) return up_to(1000);
    const double size = std::pow(10.0, up_to(40) - 20) * (1 + up_to(1 << 20) / 1048576.0);
    return maybe() ? size : -size;
  }
  Cell cell() {
    const double middle = number();
    const Cell kinds[] = {Cell(),          Cell(word()),
                          Cell(middle),    Cell(maybe()),
                          Cell(up_to(99)), Cell(Interval{middle - 1, middle, middle + 1e-9})};
    Cell made = kinds[up_to(5)];
    if (up_to(3) == 0) made.note = word();
    if (up_to(5) == 0) made.terms = {word(), word()};
    if (up_to(5) == 0) made.key = "0123abcd";
    if (up_to(5) == 0) made.state = static_cast<Cell::State>(up_to(4));
    if (up_to(5) == 0) made.scene = word();
    made.best = up_to(5) == 0;
    return made;
  }
  Column column(const std::string& name) {
    static constexpr Unit kUnits[] = {kNumber, kShare, kLength, kMilliseconds, kBytes, kMegabytes};
    Column made(name, maybe() ? word() : "", kUnits[up_to(5)], 1 + up_to(16));
    made.detail = up_to(4) == 0;
    if (made.detail) made.heading = "detail of " + name;
    return made;
  }
  std::mt19937 random_;
};

/// Fields of a CSV text by RFC 4180.
Rows csv_rows(const std::string& text) {
  Rows rows(1, {""});
  bool quoted = false;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && text[i + 1] == '"')
      rows.back().back() += text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && c == ',')
      rows.back().emplace_back();
    else if (!quoted && c == '\n')
      rows.push_back({""});
    else
      rows.back().back() += c;
  }
  return rows;
}

/// The text as a CSV field: without control characters, and safe in a spreadsheet.
std::string field(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text.find_first_of("=+-@") == 0 ? "'" + text : text;
}

void expect_csv(const Json& table, const Rows& csv) {
  ASSERT_EQ(csv.size(), table["rows"].size() + 1);
  for (std::size_t c = 0; c < table["columns"].size(); ++c) {
    const std::string name = table["columns"][c]["name"];
    const auto at = static_cast<std::size_t>(std::ranges::find(csv[0], name) - csv[0].begin());
    ASSERT_LT(at, csv[0].size()) << name;
    for (std::size_t r = 0; r < table["rows"].size(); ++r) {
      const Json& value = table["rows"][r][c];
      const auto& line = csv[r + 1];
      ASSERT_EQ(line.size(), csv[0].size());
      if (value.is_string())
        EXPECT_EQ(line[at], field(value.get<std::string>()));
      else if (value.is_boolean())
        EXPECT_EQ(line[at], value ? "true" : "false");
      else if (value.is_null())
        EXPECT_EQ(line[at], "");
      else if (value.is_number())
        EXPECT_EQ(number_at(line[at]), value.get<double>());
      else
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_EQ(number_at(line[at + k - 1]), value[k].get<double>());
    }
  }
}

/// Cells of the tables in a Markdown text, with escapes removed.
std::vector<Rows> markdown_tables(const std::string& text) {
  std::vector<Rows> tables;
  std::istringstream lines(text);
  bool within = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| ")) {
      within = false;
      continue;
    }
    if (!within) tables.emplace_back();
    within = true;
    auto& row = tables.back().emplace_back(1);
    for (std::size_t i = 2; i + 1 < line.size(); ++i) {
      if (line[i] == '\\')
        row.back() += line[++i];
      else if (line.compare(i, 3, " | ") == 0) {
        row.emplace_back();
        i += 2;
      } else if (line.substr(i) != " |")
        row.back() += line[i];
      else
        break;
    }
  }
  return tables;
}

std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

void expect_people_see(const Answer& answer, bool details) {
  const std::string terminal = to_text(answer, details), document = to_markdown(answer, details);
  for (const auto& [column, cell] : answer.facts) {
    const std::string line = text(cell, column);
    if (column.detail && !details) continue;
    EXPECT_NE(terminal.find("  " + line + "\n"), std::string::npos) << line << "\n" << terminal;
  }
  if (!details) {
    EXPECT_EQ((terminal + document).find("detail of"), std::string::npos);
  }
  const std::vector<Rows> written = markdown_tables(document);
  auto at = written.begin();
  for (const Table& table : answer.tables) {
    std::vector<std::size_t> seen;
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      if (details || !table.columns[c].detail) seen.push_back(c);
    if (table.rows.empty() || (table.detail && !details) || seen.empty()) continue;
    ASSERT_NE(at, written.end()) << document;
    ASSERT_EQ(at->size(), table.rows_shown(details) + 2) << document;
    for (std::size_t r = 0; r < table.rows_shown(details); ++r)
      for (std::size_t i = 0; i < seen.size(); ++i) {
        const std::string shown = text(table.rows[r][seen[i]], table.columns[seen[i]], false);
        EXPECT_EQ((*at)[r + 2].at(i), one_line(shown)) << document;
        EXPECT_NE(terminal.find(shown), std::string::npos) << shown;
      }
    ++at;
  }
}

TEST(Answers, OfAnyKindComeBackFromJson) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Answer answer = MadeUp(seed).answer();
    const std::string json = to_json(answer);
    EXPECT_EQ(answer_from_json(json, "made"), answer) << json;
    const Json read = parse_json(json);
    for (const Table& table : answer.tables)
      expect_csv(read["tables"][table.name], csv_rows(to_csv(answer, table.name)));
    if (!answer.tables.empty()) {
      EXPECT_EQ(to_csv(answer), to_csv(answer, answer.tables[0].name));
    }
    const Rows facts = csv_rows(to_csv(answer, "facts"));
    ASSERT_EQ(facts.size(), answer.facts.size() + 1);
    for (std::size_t i = 0; i < answer.facts.size(); ++i)
      EXPECT_EQ(facts[i + 1][0], answer.facts[i].column.name);
    for (const bool details : {false, true}) expect_people_see(answer, details);
    if (HasFailure()) FAIL() << "seed " << seed;
  }
}

TEST(Answers, BreakWordsWhereATerminalIsNarrowAndLoseNone) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Answer answer = MadeUp(seed).answer();
    const auto words = [](const std::string& text) {
      std::istringstream in(text);
      return std::multiset<std::string>{std::istream_iterator<std::string>(in), {}};
    };
    EXPECT_EQ(words(to_text(answer, true, 40)), words(to_text(answer, true))) << seed;
  }
  const Answer answer{"list",
                      "",
                      {},
                      {{"scenes",
                        "scenes",
                        {Column("name"), Column("n", "vertices", kCount), Column("summary")},
                        {{"hang", 1024, "held by two corners, so every strain is error"},
                         {"ball-and-chain", 7, "falls"}},
                        "a caption of more words than a line has"}}};
  EXPECT_EQ(to_text(answer, false, 42),
            "scenes\n"
            "  name            vertices  summary\n"
            "  hang                1024  held by two\n"
            "                            corners, so\n"
            "                            every strain\n"
            "                            is error\n"
            "  ball-and-chain         7  falls\n"
            "  a caption of more words than a line has\n");
  Answer again{"frontier", ""};
  again.add(Column("command").of_commands(),
            "taut case swing mass-spring --set cloth.size.0=0.0665646");
  EXPECT_EQ(to_text(again, false, 30),
            "  command  taut case swing mass-spring --set cloth.size.0=0.0665646\n");
  EXPECT_EQ(answer_from_json(to_json(again), "made"), again);
  again.facts.clear();
  again.add({"code"}, "taut jakobsen:substeps=1,order=coloured");
  EXPECT_EQ(to_text(again, false, 30), "  code  taut\n        jakobsen:substeps=1,order=coloured\n")
      << "no command";
  EXPECT_NE(to_text(answer, false, 24).find("\n  a caption of more\n  words than a line has\n"),
            std::string::npos);
}

TEST(Answers, ShowTheToneOfACellAndNotOfItsWords) {
  const Cell verdict = Cell("not applicable").toned(Cell::Tone::doubtful);
  const Answer answer{"check",
                      "ok",
                      {{Column("status"), cell_of(Status::Kind::ok)}},
                      {{"studies",
                        "moved",
                        {Column("study"), Column("verdict"), Column("moved")},
                        {{"ok", verdict, 3}, {"passed", Cell("x").toned(Cell::Tone::bad), "ok"}}}}};
  const auto marked = [](std::string_view part, Cell::Tone tone) {
    constexpr const char* kMarks[] = {"", "+", "~", "!"};
    return kMarks[static_cast<std::size_t>(tone)] + std::string(part);
  };
  EXPECT_EQ(to_text(answer, false, std::string::npos, marked),
            "ok\n"
            "  status  +ok\n"
            "\n"
            "moved\n"
            "  study   verdict         moved\n"
            "  ok      ~not applicable      3\n"
            "  passed  !x                  ok\n")
      << "a mark takes no column, like the code of a colour";
  Answer plain = answer;
  plain.facts[0].cell = "ok";
  plain.tables[0].rows[0][1] = "not applicable";
  plain.tables[0].rows[1][1] = "x";
  EXPECT_EQ(to_json(answer), to_json(plain)) << "data contain no tone";
  EXPECT_EQ(to_text(answer), to_text(plain));
}

TEST(Answers, ShowACellInTheUnitOfItsColumn) {
  const Column time("cost", "CPU time", kMilliseconds);
  EXPECT_EQ(text(Cell(0.00123456), time), "1.23 ms");
  EXPECT_EQ(text(Cell(0.00123456), time, false), "1.23");
  EXPECT_EQ(text(Cell(Interval{0.001, 0.002, 0.004}), time), "2 (1 to 4) ms");
  EXPECT_EQ(label(time), "CPU time [ms]");
  EXPECT_EQ(text(Cell(), time), "-");
  EXPECT_EQ(text(Cell().with("not timed"), time), "not timed");
  EXPECT_EQ(text(Cell("ok").with("late"), time), "ok (late)");
  EXPECT_EQ(text(Cell(1234567), Column("vertices")), "1234567");
  EXPECT_EQ(text(Cell(true), Column("good")), "yes");
  EXPECT_TRUE(Cell(std::nan("")).empty());
  EXPECT_TRUE(Cell(std::numeric_limits<double>::infinity()).empty());
  EXPECT_EQ(Cell(Interval{-std::numeric_limits<double>::infinity(), 2, 3}), Cell(2.0));
  EXPECT_EQ(Column("cpu_per_step").heading, "cpu per step");
  EXPECT_EQ(Cell(1).state, Cell::State::value);
  EXPECT_EQ(Cell("a name").state, Cell::State::value);
  EXPECT_EQ(Cell(std::nan("")).state, Cell::State::none);
  const Cell cannot = Cell::lacking(Cell::State::refused, "cannot: no balls");
  EXPECT_EQ(cannot.state, Cell::State::refused);
  EXPECT_EQ(text(cannot, Column("a")), "cannot: no balls");
}

TEST(Answers, AreFoundByNameAndDamagedOnesAreNamed) {
  Answer answer{"made", "up"};
  answer.add({"a"}, 1);
  answer.add(Table{"t", "", {{"x"}, {"y"}}, {{"1", 2}}});
  EXPECT_EQ(answer.fact("a").number(), 1);
  EXPECT_TRUE(answer.fact("b").empty());
  EXPECT_EQ(answer.table("t").at(answer.table("t").rows[0], "y").number(), 2);
  EXPECT_THROW(answer.table("t").at(answer.table("t").rows[0], "z"), InputError);
  EXPECT_TRUE(answer.table("u").rows.empty());
  EXPECT_THROW(to_csv(answer, "u"), InputError);
  EXPECT_EQ(to_csv(answer), "x,y\n1,2\n");
  EXPECT_EQ(to_csv(answer, "facts"), "name,value,unit\na,1,1\n");
  const std::string json = to_json(answer);
  for (const auto& [good, bad] : std::vector<std::pair<std::string, std::string>>{
           {"taut-answer-1", "taut-answer-0"},
           {"\"kind\"", "\"kinds\""},
           {"\"notes\": []", R"("notes": [{"row": 0, "column": "x", "state": "gone"}])"},
           {"2.0", "{}"},
           {"\"rows\": [", "\"rows\": [[1],"},
           {"\"notes\": []", R"("notes": [{"row": 1, "column": "x", "note": ""}])"}}) {
    std::string damaged = json;
    ASSERT_NE(damaged.find(good), std::string::npos) << json;
    damaged.replace(damaged.find(good), good.size(), bad);
    try {
      answer_from_json(damaged, "file.json");
      ADD_FAILURE() << damaged;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("file.json"), std::string::npos);
    }
  }
}

TEST(Numbers, HaveTheirDigitsAndNoExponent) {
  for (const auto& [value, plain, print] :
       std::vector<std::tuple<double, std::string, std::string>>{{0, "0", "0"},
                                                                 {20, "20", "20.0"},
                                                                 {1234567, "1.23e6", "1.23×10⁶"},
                                                                 {123456, "123456", "123456"},
                                                                 {-0.0123456, "-0.0123", "−0.0123"},
                                                                 {9.996, "10", "10.0"},
                                                                 {1e-12, "1e-12", "10⁻¹²"},
                                                                 {3.4e-13, "3.4e-13", "3.4×10⁻¹³"},
                                                                 {std::nan(""), "-", "–"}}) {
    EXPECT_EQ(number_text(value), plain);
    EXPECT_EQ(significant(value, 3), print);
  }
  EXPECT_EQ(number_text(0.0123, kShare), "1.23 %");
  EXPECT_EQ(number_text(2000, kBytes), "2000 B");
  EXPECT_EQ(interval_text({0.001, 0.002, 0.004}, kMilliseconds), "2 (1 to 4)");
  EXPECT_EQ(clock_text(725.9), "12:05");
}

TEST(Differences, AreOfRowsByNameInWhatIsHeld) {
  const auto table = [](std::vector<std::vector<Cell>> rows) {
    return Table{"t", "", {{"who"}, {"what"}, {"says"}, {"good"}, {"other"}}, std::move(rows)};
  };
  const auto compared = [&](const Table& before, const Table& now) {
    std::string all;
    for (const Difference& one : differences(before, now, {"who", "what"}, {"says", "good"}, 0.02))
      all += std::string(one.moved ? "moved " : "alone ") + one.text + "\n";
    return all;
  };
  const Table before = table({{"a", "x", "ok", 100, 1}, {"a", "y", "ok", {}, 1}});
  EXPECT_EQ(compared(before, before), "");
  EXPECT_EQ(compared(before, table({{"a", "y", "ok", {}, 2}, {"a", "x", "ok", 101.9, "3"}})), "");
  EXPECT_EQ(compared(before, table({{"a", "x", "ok", 97.5, 1}, {"a", "y", "bad", 5, 1}})),
            "moved a, x: good 100 -> 97.5\nmoved a, y: says ok -> bad; good - -> 5\n");
  EXPECT_EQ(compared(before, table({{"a", "x", "ok", 100, 1}, {"b", "y", "ok", {}, 1}})),
            "alone b, y is not in the baseline\nalone a, y is gone\n");
  EXPECT_THROW(differences(before, before, {"nobody"}, {}), InputError);
}

}  // namespace
}  // namespace taut::answer_test
