#include "core/model/params.hpp"

#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "core/model/input_error.hpp"
#include "core/model/shortest.hpp"

namespace taut {

namespace {

std::string in_quotes(std::string_view s) { return "'" + std::string(s) + "'"; }

/// A part of a text and where it begins.
struct Part {
  std::string text;
  std::size_t at;
};

/// "a,,b" has three parts, "" has none.
std::vector<Part> split(std::string_view text, char separator) {
  std::vector<Part> parts;
  for (std::size_t at = 0; !text.empty() && at <= text.size();) {
    const auto end = std::min(text.find(separator, at), text.size());
    parts.push_back({std::string(text.substr(at, end - at)), at});
    at = end + 1;
  }
  return parts;
}

bool parse(std::string_view text, auto& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// The canonical text of a value, or the reason why it is not one.
std::string canonical_value(const ParamSpec& spec, std::string_view given, std::string& problem) {
  if (spec.kind == ParamSpec::Kind::choice) {
    std::vector<std::string> allowed;
    for (Part& choice : split(spec.choices, '|')) {
      if (choice.text == given) return choice.text;
      allowed.push_back(std::move(choice.text));
    }
    problem =
        "is not one of " + std::string(spec.choices) + suggestion(std::string(given), allowed);
    return {};
  }
  const bool whole = spec.kind == ParamSpec::Kind::integer;
  long integer = 0;
  double value = 0;
  if (whole ? !parse(given, integer) : !parse(given, value)) {
    problem = whole ? "is not a whole number" : "is not a number";
    return {};
  }
  if (whole) value = static_cast<double>(integer);
  const auto text = [&](double number) {  // 100000 and not 1e+05, which is no whole number
    return whole ? std::to_string(static_cast<long>(number)) : shortest(number == 0 ? 0 : number);
  };
  if (!(value >= spec.min && value <= spec.max)) {  // NaN too
    problem = "is outside " + text(spec.min) + " to " + text(spec.max);
    return {};
  }
  return text(value);
}

}  // namespace

Params::Params(std::string_view owner, std::span<const ParamSpec> specs, std::string_view text)
    : specs_(specs) {
  std::vector<Diagnostic> problems;
  std::vector<std::string> names;
  for (const ParamSpec& spec : specs) {
    names.emplace_back(spec.name);
    std::string problem;
    values_.push_back(canonical_value(spec, spec.default_value, problem));
    assert(problem.empty() && "a default outside its own range");
  }
  std::vector<bool> seen(specs.size());
  for (const auto& [item, at] : split(text, ',')) {
    const auto report = [&, column = static_cast<int>(at) + 1](const std::string& message) {
      problems.push_back({std::string(text), 0, column, std::string(owner) + ": " + message});
    };
    const auto eq = item.find('=');
    const std::string key = item.substr(0, eq);
    const std::size_t i = find(key);
    if (eq == std::string::npos || key.empty()) {
      report("expected key=value, got " + in_quotes(item));
    } else if (i == specs.size()) {
      report("unknown parameter " + in_quotes(key) + suggestion(key, names));
    } else if (seen[i]) {
      report("parameter " + in_quotes(key) + " is given twice");
    } else {
      seen[i] = true;
      std::string problem;
      const std::string value = canonical_value(specs[i], item.substr(eq + 1), problem);
      if (problem.empty())
        values_[i] = value;
      else
        report(key + "=" + item.substr(eq + 1) + " " + problem);
    }
  }
  if (!problems.empty()) throw InputError(problems);
}

std::size_t Params::find(std::string_view name) const {
  std::size_t i = 0;
  while (i < specs_.size() && specs_[i].name != name) ++i;
  return i;
}

std::string_view Params::value(std::string_view name) const {
  const std::size_t i = find(name);
  assert(i < specs_.size() && "no such parameter");
  return values_[i];
}

int Params::integer(std::string_view name) const { return static_cast<int>(real(name)); }
double Params::real(std::string_view name) const {
  return std::strtod(value(name).data(), nullptr);
}
std::string_view Params::choice(std::string_view name) const { return value(name); }

std::string Params::text(bool only_changed) const {
  std::string all;
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    std::string ignored;
    if (only_changed && values_[i] == canonical_value(specs_[i], specs_[i].default_value, ignored))
      continue;
    all += (all.empty() ? "" : ",") + std::string(specs_[i].name) + "=" + values_[i];
  }
  return all;
}

}  // namespace taut
