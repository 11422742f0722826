#include "experiments/case/digest.hpp"

#include <openssl/evp.h>

#include <array>
#include <cassert>

namespace taut {

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, 32> hash{};
  unsigned length = 0;
  [[maybe_unused]] const int done =
      EVP_Digest(bytes.data(), bytes.size(), hash.data(), &length, EVP_sha256(), nullptr);
  assert(done == 1 && length == hash.size());
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : hash) {
    text += kHex[byte >> 4];
    text += kHex[byte & 15];
  }
  return text;
}

std::string digest(const Scene& scene) { return sha256(content(scene)); }

std::string digest(const State& state) {
  std::string bytes;
  for (const auto* values : {&state.x, &state.v}) {
    for (const Vec3& value : *values)
      bytes.append(reinterpret_cast<const char*>(value.data()), 3 * sizeof(double));
    bytes += '|';
  }
  return sha256(bytes);
}

}  // namespace taut
