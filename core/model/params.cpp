#include "core/model/params.hpp"

#include <algorithm>
#include <cassert>
#include <optional>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

std::string in_quotes(std::string_view s) { return "'" + std::string(s) + "'"; }

/// A part of a text, and where it begins.
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

/// A value as it is written in a solver's text, in quotes if it needs them.
std::string quoted_if_needed(const ParamSpec& spec, const std::string& value) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+@%";
  if (spec.kind != ParamSpec::Kind::text ||
      (!value.empty() && value.find_first_not_of(kPlain) == value.npos))
    return value;
  std::string quoted = "'";
  for (const char c : value) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

/// The canonical text of a value. If it is not valid, sets `problem` to the reason.
std::string canonical_value(const ParamSpec& spec, std::string_view given, std::string& problem) {
  if (spec.kind == ParamSpec::Kind::text) return std::string(given);
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
  const bool is_whole = spec.kind == ParamSpec::Kind::integer;
  std::optional<double> value;
  std::string text;  // 100000, not 1e+05, which is not a whole number
  if (const auto number = whole<long>(given); is_whole && number) {
    value = static_cast<double>(*number);
    text = std::to_string(*number);
  } else if (!is_whole) {
    value = whole<double>(given);
    text = shortest(value.value_or(0) == 0 ? 0 : *value);
  }
  if (!value) {
    problem = is_whole ? "is not a whole number" : "is not a number";
    return {};
  }
  if (!(*value >= spec.min && *value <= spec.max)) {  // NaN too
    problem = "is outside " + as_typed(spec.min) + " to " + as_typed(spec.max);
    return {};
  }
  return text;
}

}  // namespace

std::vector<ParamItem> param_items(std::string_view text) {
  std::vector<ParamItem> items;
  for (std::size_t at = 0; !text.empty() && at <= text.size();) {
    ParamItem item;
    item.at = at;
    const auto start = at;
    const auto eq = text.find_first_of("=,", at);
    if (eq != text.npos && text[eq] == '=' && eq > at) {
      item.key = text.substr(at, eq - at);
      at = eq + 1;
      const char quote = at < text.size() ? text[at] : '\0';
      if (quote == '\'' || quote == '"') {
        for (++at; at < text.size(); ++at) {
          if (text[at] == quote && text.substr(at + 1, 1) != text.substr(at, 1)) break;
          if (text[at] == quote) ++at;
          item.value += text[at];
        }
        if (at == text.size()) item.problem = item.key + ": the quote " + quote + " is not closed";
        at = std::min(at + 1, text.size());
      }
    }
    const auto end = std::min(text.find(',', at), text.size());
    if (item.key.empty())
      item.problem = "expected key=value, got " + in_quotes(text.substr(start, end - start)) +
                     (text.substr(start, end - start).find(']') == text.npos
                          ? ""
                          : "; a value with a comma stands in quotes: key='[12, 12]'");
    else if (at > item.at + item.key.size() + 1 && at != end && item.problem.empty())
      item.problem = item.key + ": a comma has to follow the quote";
    else
      item.value += text.substr(at, end - at);
    items.push_back(std::move(item));
    at = end + 1;
  }
  return items;
}

Params::Params(std::string_view owner, std::span<const ParamSpec> specs, std::string_view text)
    : owner_(owner), specs_(specs) {
  std::vector<Diagnostic> problems;
  std::vector<std::string> names;
  for (const ParamSpec& spec : specs) {
    names.emplace_back(spec.name);
    std::string problem;
    values_.push_back(canonical_value(spec, spec.default_value, problem));
    assert(problem.empty() && "a default outside its own range");
  }
  given_.resize(specs.size());
  for (const auto& [key, given, at, wrong] : param_items(text)) {
    const auto report = [&, column = static_cast<int>(at) + 1](const std::string& message) {
      problems.push_back({std::string(text), 0, column, std::string(owner) + ": " + message});
    };
    const std::size_t i = find(key);
    if (!wrong.empty()) {
      report(wrong);
    } else if (i == specs.size()) {
      report("unknown parameter " + in_quotes(key) + suggestion(key, names));
    } else if (given_[i]) {
      report("parameter " + in_quotes(key) + " is given twice");
    } else {
      given_[i] = true;
      std::string problem;
      const std::string value = canonical_value(specs[i], given, problem);
      if (problem.empty())
        values_[i] = value;
      else
        report(key + "=" + given + " " + problem);
    }
  }
  if (!problems.empty()) throw InputError(problems);
  for (std::size_t i = 0; i < specs.size(); ++i)
    if (!given_[i]) values_[i] = default_of(specs[i]);
}

std::string Params::given_with(std::string_view name, const std::string& value) const {
  if (!has(name)) return std::string(name) + "=" + value;  // whose reader says what there is
  std::string all;
  for (std::size_t i = 0; i < specs_.size(); ++i)
    if (const bool is_it = specs_[i].name == name; is_it || given_[i])
      all += (all.empty() ? "" : ",") + std::string(specs_[i].name) + "=" +
             quoted_if_needed(specs_[i], is_it ? value : values_[i]);
  return all;
}

std::string Params::default_of(const ParamSpec& spec) const {
  std::string ignored;
  std::string_view value = spec.default_value;
  for (const auto& [where, default_there] : spec.elsewhere)
    if (const auto equals = where.find('=');
        equals != where.npos && is(where.substr(0, equals), where.substr(equals + 1)))
      value = default_there;
  return canonical_value(spec, value, ignored);
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
  const auto number = whole<double>(value(name));
  assert(number && "no number");
  return *number;
}
std::string_view Params::choice(std::string_view name) const { return value(name); }

std::string Params::text(bool only_changed, std::string_view but) const {
  const std::vector<std::string> left_out = parts_of(but);
  std::string all;
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    if (std::ranges::count(left_out, specs_[i].name) > 0) continue;
    if (only_changed && values_[i] == default_of(specs_[i])) continue;
    all += (all.empty() ? "" : ",") + std::string(specs_[i].name) + "=" +
           quoted_if_needed(specs_[i], values_[i]);
  }
  return all;
}

std::string_view parameter_with(ParamSpec::Role role, std::span<const ParamSpec> specs) {
  const auto found = std::ranges::find(specs, role, &ParamSpec::role);
  return found == specs.end() ? "" : found->name;
}

std::string_view usual_name(ParamSpec::Role role) {
  if (role == ParamSpec::Role::precision) return "precision";
  if (role == ParamSpec::Role::instructions) return "simd";
  return "";
}

}  // namespace taut
