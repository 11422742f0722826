#include "experiments/external/command.hpp"

#include <wordexp.h>

#include <algorithm>
#include <cctype>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/process.hpp"

namespace taut::external {

namespace fs = std::filesystem;

std::string Command::text() const { return join(words, " ", shell_word); }

Command split_command(const std::string& text, const fs::path& folder) {
  wordexp_t words{};
  const int problem = wordexp(text.c_str(), &words, WRDE_NOCMD);
  Command command;
  command.folder = folder;
  if (problem == 0) command.words.assign(words.we_wordv, words.we_wordv + words.we_wordc);
  wordfree(&words);
  if (problem == WRDE_BADCHAR || problem == WRDE_CMDSUB)
    throw InputError("cmd='" + text +
                     "': no shell runs it; put | & ; < > ( ) { } $( ) in a script");
  if (problem == WRDE_SYNTAX) throw InputError("cmd='" + text + "': a quote is not closed");
  if (command.words.empty()) throw InputError("cmd='" + text + "' names no program");
  const std::string& program = command.words.front();
  const bool there =
      program.find('/') != program.npos ? fs::exists(folder / program) : on_path(program);
  if (!there) throw InputError("cmd='" + text + "': no program '" + program + "'");
  return command;
}

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
