#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>

#include "core/io/positions/positions.hpp"

/// Code that the formats share, for the sources of this folder and for the frames of a results
/// file.
namespace taut {

/// The number at these bytes, in the file's byte order.
template <class T>
T number_at(const char* from, std::endian order) {
  char bytes[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i)
    bytes[i] = from[order == std::endian::native ? i : sizeof(T) - 1 - i];
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <class T>
void append_number(std::string& out, T value, std::endian order) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof value);
  const std::string_view text(bytes, sizeof bytes);
  order == std::endian::native ? out.append(text) : out.append(text.rbegin(), text.rend());
}

template <class Real>
void append_vectors(std::string& out, const std::vector<Vec3>& vectors, std::endian order) {
  for (const Vec3& v : vectors)
    for (const double c : v) append_number(out, static_cast<Real>(c), order);
}

/// Fills `vectors` from these bytes.
template <class Real>
void read_vectors(const char* from, std::vector<Vec3>& vectors, std::endian order) {
  for (Vec3& v : vectors)
    for (double& c : v) {
      c = static_cast<double>(number_at<Real>(from, order));
      from += sizeof(Real);
    }
}

/// A file being written. Throws InputError with the system's reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path);
  void write_at(std::uint64_t offset, std::string_view bytes);

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

/// Sequences with one file per frame.
std::unique_ptr<PositionReader> open_sequence(const std::filesystem::path&);
std::unique_ptr<PositionWriter> create_sequence(const std::filesystem::path&, const Mesh&);

}  // namespace taut
