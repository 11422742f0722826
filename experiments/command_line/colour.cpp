#include "experiments/command_line/colour.hpp"

#include <unistd.h>

#include <cstdlib>

namespace taut {

std::string coloured(std::string_view text, Colour colour) {
  static const bool terminal = isatty(1) == 1 && std::getenv("NO_COLOR") == nullptr;
  if (!terminal) return std::string(text);
  return "\033[" + std::to_string(static_cast<int>(colour)) + "m" + std::string(text) + "\033[0m";
}

}  // namespace taut
