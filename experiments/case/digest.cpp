#include "experiments/case/digest.hpp"

#define OPENSSL_SUPPRESS_DEPRECATED  // what takes its place reads a configuration at every start
#include <openssl/sha.h>

#include <array>

#include "experiments/case/fingerprint.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {
/// Part of every key. If this number changes, every stored result is computed again.
constexpr int kKeySchema = 2;
}  // namespace

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  SHA256_CTX state;
  SHA256_Init(&state);
  SHA256_Update(&state, bytes.data(), bytes.size());
  SHA256_Final(hash.data(), &state);
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

std::string case_key(const Scene& scene, const std::string& scene_digest,
                     const SolverChoice& choice) {
  const std::string_view own = choice.entry->implementation;
  Json parts{{"schema", kKeySchema},
             {"scene", scene_digest},
             {"solver", choice.addressed()},
             {"implementation", own.empty() ? implementation(choice.entry->name) : own},
             {"measurement", measurement()},
             {"dt", scene.dt},
             {"steps", scene.steps}};
  if (!own.empty()) parts["client"] = external_client();
  return sha256(to_text(parts));
}

std::string program_digest() {
  std::string text(measurement());
  for (const SolverEntry* entry : solvers())
    text += std::string(entry->name) + ":" + std::string(implementation(entry->name)) + "\n";
  return sha256(text);
}

}  // namespace taut
