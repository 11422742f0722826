#include "experiments/report/chart/format.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>

#include "core/model/shortest.hpp"

namespace taut::report {

namespace {

std::string print(const char* format, int precision, double value) {
  std::array<char, 400> text{};
  const int size = std::snprintf(text.data(), text.size(), format, precision, value);
  return {text.data(), static_cast<std::size_t>(std::max(0, size))};
}

constexpr std::array<const char*, 10> kRaised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};

/// 10 to this power.
std::string power_of_ten(int exponent) {
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent)))
    text += kRaised[static_cast<std::size_t>(digit - '0')];
  return text;
}

/// "3.40e-13" -> "3.4×10⁻¹³", "1e+06" -> "10⁶".
std::string powers(const std::string& scientific) {
  const auto e = scientific.find('e');
  std::string mantissa = scientific.substr(0, e);
  if (mantissa.find('.') != std::string::npos) {
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.back() == '.') mantissa.pop_back();
  }
  return (mantissa == "1" ? "" : mantissa + "×") +
         power_of_ten(std::stoi(scientific.substr(e + 1)));
}

}  // namespace

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return significant(value);
  const std::string text = print("%.*f", decimals, std::abs(value));
  const bool nothing = text.find_first_not_of("0.") == std::string::npos;
  return (value < 0 && !nothing ? "−" : "") + text;
}

int decimals_for(double width) {
  if (!(width > 0) || !std::isfinite(width)) return 6;
  const double exponent = std::floor(std::log10(width));
  const bool two = width / std::pow(10.0, exponent) < 3;
  return std::clamp(static_cast<int>(two ? 1 - exponent : -exponent), 0, 6);
}

std::string significant(double value, int digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  if (value == 0) return "0";
  const double magnitude = std::abs(value);
  // Rounded first, so that 9.96 with two digits becomes "10" and not "10.0".
  const std::string rounded = print("%.*e", digits - 1, magnitude);
  const int exponent = std::stoi(rounded.substr(rounded.find('e') + 1));
  std::string text;
  if (exponent < -4 || exponent > 5)
    text = powers(rounded);
  else
    text = print("%.*f", std::max(0, digits - 1 - exponent), magnitude);
  return (value < 0 ? "−" : "") + text;
}

std::string exact(double value) { return std::isnan(value) ? "" : shortest(value); }

std::string typeset(std::string_view plain) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kSigns{{{"^2", "²"},
                                                                                 {"^3", "³"},
                                                                                 {">=", "≥"},
                                                                                 {"<=", "≤"},
                                                                                 {"+-", "±"},
                                                                                 {" x ", " × "},
                                                                                 {" - ", " − "},
                                                                                 {"mu", "μ"},
                                                                                 {"pi", "π"}}};
  const auto at = [&](std::size_t i) { return i < plain.size() ? plain[i] : ' '; };
  const auto letter = [&](std::size_t i) {
    return at(i) == '_' || std::isalnum(static_cast<unsigned char>(at(i)));
  };
  const auto digit = [&](std::size_t i) { return std::isdigit(static_cast<unsigned char>(at(i))); };
  std::string out;
  for (std::size_t i = 0; i < plain.size();) {
    const auto found = std::ranges::find_if(kSigns, [&](const auto& sign) {
      const bool word = std::isalpha(static_cast<unsigned char>(sign.first[0]));
      return plain.substr(i).starts_with(sign.first) &&
             (!word || (!letter(i - 1) && !letter(i + sign.first.size())));
    });
    const bool minus = at(i) == '-' && digit(i + 1) && (at(i - 1) == ' ' || at(i - 1) == '(');
    std::size_t end = i + 1;  // of an exponent behind a digit: e-12
    if (at(end) == '-' || at(end) == '+') ++end;
    const std::size_t digits = end;
    while (digit(end)) ++end;
    if (found != kSigns.end()) {
      out += found->second, i += found->first.size();
    } else if (at(i) == 'e' && digit(i - 1) && end > digits && !letter(end)) {
      out += "×" + power_of_ten(std::stoi(std::string(plain.substr(i + 1, end - i - 1)))), i = end;
    } else {
      out += minus ? "−" : std::string(1, plain[i]), ++i;
    }
  }
  return out;
}

std::string escape_html(std::string_view text) {
  constexpr std::array<std::pair<char, std::string_view>, 5> kEntities{
      {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}}};
  std::string out;
  for (const char c : text) {
    const auto entity = std::ranges::find(kEntities, c, &std::pair<char, std::string_view>::first);
    if (entity != kEntities.end())
      out += entity->second;
    else if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t')
      out += "\xEF\xBF\xBD";
    else
      out += c;
  }
  return out;
}

std::string csv_field(std::string_view text) {
  std::string line(text);
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  if (!line.empty() && std::string_view("=+-@").find(line.front()) != std::string_view::npos)
    line.insert(0, "'");
  if (line.find_first_of(",\"") == std::string::npos) return line;
  std::string out = "\"";
  for (const char c : line) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string gnuplot_string(std::string_view text) {
  // gnuplot 5.4 ends '''x' after two quotes, and backquotes inside "..." run commands: whatever is
  // not plain goes in octal.
  std::string out;
  bool escaped = false;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20) {
      out += ' ';
    } else if (std::string_view("'\"\\`@$").find(c) != std::string_view::npos) {
      for (const unsigned shift : {6U, 3U, 0U})
        out += shift == 6U ? std::string("\\") + static_cast<char>('0' + (code >> 6U))
                           : std::string(1, static_cast<char>('0' + (code >> shift & 7U)));
      escaped = true;
    } else {
      out += c;
    }
  }
  return escaped ? '"' + out + '"' : "'" + out + "'";
}

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

std::string slug(std::string_view text) {
  constexpr std::size_t kMost = 120;  // a file name has 255 bytes, with extensions and more
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_';
    if (plain && !(out.empty() && (c == '-' || c == '.')))
      out += c;
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  out.resize(std::min(out.size(), kMost));
  while (!out.empty() && (out.back() == '-' || out.back() == '.')) out.pop_back();
  if (!out.empty() && out == text) return out;
  char digits[20];  // what was replaced or cut off still tells names apart
  std::snprintf(digits, sizeof digits, "-%08zx", std::hash<std::string_view>{}(text)&0xFFFFFFFFU);
  return (out.empty() ? "x" : out) + digits;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

}  // namespace taut::report
