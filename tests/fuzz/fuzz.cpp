// Entry point for libFuzzer: taut_fuzz --reader=NAME [CORPUS ...] [-max_total_time=SECONDS ...]
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "tests/fuzz/readers.hpp"

namespace {
const taut::fuzz::Reader* g_reader = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  for (int i = 1; i < *argc; ++i)
    for (const taut::fuzz::Reader& reader : taut::fuzz::kReaders)
      if ((*argv)[i] == "--reader=" + std::string(reader.name)) g_reader = &reader;
  if (!g_reader) {
    std::fprintf(stderr, "--reader=NAME, one of:");
    for (const taut::fuzz::Reader& reader : taut::fuzz::kReaders)
      std::fprintf(stderr, " %s", std::string(reader.name).c_str());
    std::fprintf(stderr, "\n");
    std::exit(2);
  }
  std::fprintf(stderr, "a finding runs again with: %s --reader=%s FILE\n", (*argv)[0],
               std::string(g_reader->name).c_str());
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    g_reader->read(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const taut::InputError&) {
  }
  return 0;
}
