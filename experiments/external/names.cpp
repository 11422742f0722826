#include "experiments/external/names.hpp"

#include <algorithm>
#include <cctype>

#include "experiments/case/digest.hpp"

namespace taut::external {

namespace {

bool allowed(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; }

}  // namespace

bool is_solver_name(std::string_view text) {
  return !text.empty() && text.size() <= 40 && std::isalpha(static_cast<unsigned char>(text[0])) &&
         std::ranges::all_of(text, allowed);
}

std::string name_for(std::string_view called, std::string_view told_by) {
  std::string name(called.substr(0, 30));
  std::ranges::replace_if(
      name, [](char c) { return !allowed(c); }, '-');
  if (!is_solver_name(name)) name = "external" + name;
  return name + "-" + sha256(std::string(told_by)).substr(0, 4);
}

}  // namespace taut::external
