#include "experiments/report/chart/format.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <utility>

namespace taut::report {

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

std::string gnuplot_string(std::string_view text) {
  // gnuplot 5.4 ends '''x' after two quotes, and backquotes inside "..." run commands. Therefore
  // every character that is not plain is written in octal.
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
  std::string out((bytes.size() + 2) / 3 * 4, '\0');
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                  reinterpret_cast<const unsigned char*>(bytes.data()),
                  static_cast<int>(bytes.size()));
  return out;
}

}  // namespace taut::report
