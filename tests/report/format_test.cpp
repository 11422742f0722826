// Text for people and for other programs, at the limits of its rules.
#include "experiments/report/chart/format.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/rows.hpp"

namespace taut::report::format_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Significant, HasNoExponentFromATenThousandthUpToAMillion) {
  EXPECT_EQ(significant(1e-4), "0.00010");
  EXPECT_EQ(significant(9.94e-5), "9.9×10⁻⁵");
  EXPECT_EQ(significant(123456), "123456");
  EXPECT_EQ(significant(999999), "10⁶") << "rounded first";
  EXPECT_EQ(significant(994999), "994999");
  EXPECT_EQ(significant(12.34, 3), "12.3");
  EXPECT_EQ(significant(0.05, 1), "0.05");
  EXPECT_EQ(significant(3e-13, 1), "3×10⁻¹³");
  EXPECT_EQ(significant(1.2e-13, 3), "1.2×10⁻¹³") << "no zeros at the end";
  EXPECT_EQ(significant(1e-13, 3), "10⁻¹³");
  EXPECT_EQ(significant(2.5e10), "2.5×10¹⁰");
  EXPECT_EQ(significant(0), "0");
  EXPECT_EQ(significant(kInfinity), "∞");
  EXPECT_EQ(significant(-kInfinity), "−∞");
}

TEST(Fixed, HasTheDecimalsThatItsWidthDeserves) {
  EXPECT_EQ(decimals_for(0.29), 2);
  EXPECT_EQ(decimals_for(0.31), 1);
  EXPECT_EQ(decimals_for(1), 1);
  EXPECT_EQ(decimals_for(5), 0);
  EXPECT_EQ(decimals_for(25), 0);
  EXPECT_EQ(decimals_for(2e-4), 5);
  EXPECT_EQ(decimals_for(1e-9), 6);
  EXPECT_EQ(decimals_for(kInfinity), 6);
  EXPECT_EQ(decimals_for(-1), 6);
  EXPECT_EQ(decimals_for(std::nan("")), 6);
  EXPECT_EQ(fixed(12.4, 0), "12");
  EXPECT_EQ(fixed(-12.5, 1), "−12.5");
  EXPECT_EQ(fixed(0, 1), "0.0");
  EXPECT_EQ(fixed(std::nan(""), 2), "–");
  EXPECT_EQ(fixed(-kInfinity, 2), "−∞");
}

TEST(Escapes, LeaveEveryTextAText) {
  using std::string_literals::operator""s;
  EXPECT_EQ(escape_html("a<b & \"c\" > 'd'"), "a&lt;b &amp; &quot;c&quot; &gt; &#39;d&#39;");
  EXPECT_EQ(escape_html("\x1f \n\t\r\0é"s), "\xEF\xBF\xBD \n\t\xEF\xBF\xBD\xEF\xBF\xBDé");
  EXPECT_EQ(csv_field("a\x1f b\nc"), "a  b c");
  for (const char* text : {"=1", "+1", "-1", "@x"}) EXPECT_EQ(csv_field(text), "'"s + text);
  EXPECT_EQ(csv_field("a=1"), "a=1");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("a\"b"), "\"a\"\"b\"");
  EXPECT_EQ(csv_field("=\"x\""), "\"'=\"\"x\"\"\"");
  EXPECT_EQ(csv_field(""), "");
  EXPECT_EQ(gnuplot_string("a b~"), "'a b~'");
  EXPECT_EQ(gnuplot_string("it's"), "\"it\\047s\"");
  EXPECT_EQ(gnuplot_string("\"\\`@$"), "\"\\042\\134\\140\\100\\044\"");
  EXPECT_EQ(gnuplot_string("a\x1f\nb"), "'a  b'");
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("Ma"), "TWE=");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
  EXPECT_EQ(base64("Many"), "TWFueQ==");
}

TEST(Slug, KeepsLettersAndDigitsAlone) {
  EXPECT_EQ(slug("azAZ09-._"), "azAZ09-._");
  EXPECT_EQ(slug("_x"), "_x");
  for (const char* text : {"a`b", "a{b", "a@b", "a[b", "a/b", "a:b", "a  b"})
    EXPECT_TRUE(slug(text).starts_with("a-b-")) << text;
  EXPECT_TRUE(slug(".x").starts_with("x-"));
  EXPECT_TRUE(slug("ab.").starts_with("ab-"));
  EXPECT_TRUE(slug("ab-").starts_with("ab-"));
  EXPECT_EQ(slug("a--b"), "a--b");
  const std::string most(120, 'a');
  EXPECT_EQ(slug(most), most);
  EXPECT_EQ(slug(most + "a").size(), 129u);
  EXPECT_EQ(slug(""), slug(""));
  EXPECT_EQ(slug("é").size(), 10u) << "x and the digest";
}

TEST(Words, AreJoinedAndCapitalisedAsInASentence) {
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(joined({"a"}), "a");
  EXPECT_EQ(joined({"a", "b"}), "a and b");
  for (const auto& [plain, capital] : {std::pair<std::string, std::string>{"", ""},
                                       {"a", "A"},
                                       {"zebra x", "Zebra x"},
                                       {"`a", "`a"},
                                       {"{a", "{a"},
                                       {"é", "é"}})
    EXPECT_EQ(capitalised(plain), capital);
  EXPECT_EQ(typeset("1e99999999999 2e-07 3e+00"), "1×10⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹ 2×10⁻⁷ 3×10⁰");
  EXPECT_EQ(typeset("(-3) x^3 <= 1e+06, e-5, 2e5x, 3-4, a - b"),
            "(−3) x³ ≤ 1×10⁶, e-5, 2e5x, 3-4, a − b");
}

/// 2^n.
double power(double n) { return std::exp2(n); }

TEST(GeometricMean, AddsErrorsAsSquaresOfLogarithms) {
  // The means are 3 and 4 powers of two below, 6 and 8 above; together 5 and 10.
  const Interval mean =
      geometric_mean({{power(-1), power(2), power(8)}, {power(0), power(4), power(12)}});
  EXPECT_NEAR(mean.low, power(0.5), 1e-12);
  EXPECT_NEAR(mean.mid, power(3), 1e-12);
  EXPECT_NEAR(mean.high, power(8), 1e-9);
}

TEST(Places, AreSpreadFromTheFirstToTheLast) {
  using Places = std::vector<std::size_t>;
  EXPECT_EQ(places_of(10, 4), (Places{0, 3, 6, 9}));
  EXPECT_EQ(places_of(3, 3), (Places{0, 1, 2}));
  EXPECT_EQ(places_of(3, 5), (Places{0, 1, 2}));
  EXPECT_EQ(places_of(5, 2), (Places{0, 4}));
  EXPECT_EQ(places_of(0, 4), Places{});
  EXPECT_EQ(places_of(4, 0), Places{});
  EXPECT_EQ(places_of(4, 1), Places{0});
}

TEST(Palette, ColoursDifferAndReadOnTheirBackgrounds) {
  const auto channel = [](std::string_view hex, std::size_t i) {
    const double v = std::stoi(std::string(hex.substr(1 + 2 * i, 2)), nullptr, 16) / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  const auto contrast = [&](std::string_view a, std::string_view b) {  // WCAG 2
    const auto luminance = [&](std::string_view c) {
      return 0.2126 * channel(c, 0) + 0.7152 * channel(c, 1) + 0.0722 * channel(c, 2) + 0.05;
    };
    return std::max(luminance(a) / luminance(b), luminance(b) / luminance(a));
  };
  std::set<std::string> looks;
  for (const char* solver : {"jakobsen", "bullet", "mass-spring", "xpbd", "bullet-deformable",
                             "implicit", "pd", "admm", "vbd", "avbd"}) {
    const SolverStyle style = solver_style(solver);
    EXPECT_GE(contrast(style.colour.light, "#FFFFFF"), 4.5) << solver;
    EXPECT_GE(contrast(style.colour.dark, "#14171C"), 4.5) << solver;
    EXPECT_TRUE(looks.insert(std::string(style.colour.light)).second) << solver;
    EXPECT_TRUE(looks.insert(std::string(style.colour.dark)).second) << solver;
    const std::string_view light = style.colour.light, dark = style.colour.dark;
    // order of the channels: both themes keep the hue
    const auto order = [&](std::string_view hex) {
      return std::tuple(channel(hex, 0) < channel(hex, 1), channel(hex, 1) < channel(hex, 2),
                        channel(hex, 0) < channel(hex, 2));
    };
    EXPECT_EQ(order(light), order(dark)) << solver;
  }
  std::set<std::string_view> glyphs;
  for (const char* name : {"ok", "unsettled", "extreme", "exploded", "unsupported", "timeout",
                           "oom", "crash", "protocol", "error"}) {
    const StatusStyle style = status_style(status_kind(name));
    EXPECT_TRUE(looks.insert(std::string(style.colour.light)).second) << name;
    EXPECT_TRUE(glyphs.insert(style.glyph).second) << name;
    EXPECT_GE(contrast(style.ink.light, style.colour.light), 3) << name;
    EXPECT_GE(contrast(style.ink.dark, style.colour.dark), 3) << name;
  }
  EXPECT_EQ(status_style(Status::Kind::ok).glyph, "✓");
  EXPECT_EQ(status_style(Status::Kind::exploded).glyph, "×");
  EXPECT_EQ(status_style(Status::Kind::unsupported).glyph, "–");
  EXPECT_EQ(status_style(Status::Kind::unsettled).help, "still moving at the end");
  EXPECT_EQ(status_style(Status::Kind::error).glyph, "E");
}

}  // namespace
}  // namespace taut::report::format_test
