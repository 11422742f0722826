// Inputs that once broke a reader, and a valid input of each kind: each is read or refused.
#include <gtest/gtest.h>

#include <set>

#include "tests/fuzz/readers.hpp"

namespace taut::fuzz::corpus_test {
namespace {

const std::filesystem::path kCorpus = std::filesystem::path(TAUT_SOURCE_DIR) / "tests/fuzz/corpus";

TEST(FuzzCorpus, EveryInputIsReadOrRefusedAsItsNameSays) {
  std::set<std::string> folders;
  for (const Reader& reader : kReaders) {
    folders.emplace(reader.name);
    int good = 0, bad = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kCorpus / reader.name)) {
      SCOPED_TRACE(entry.path().string());
      const bool expected = entry.path().filename().string().starts_with("good");
      std::string refusal;
      try {
        reader.read(read_text(entry.path()));
      } catch (const InputError& error) {
        refusal = error.what();
      }
      EXPECT_EQ(refusal.empty(), expected) << refusal;
      ++(expected ? good : bad);
    }
    EXPECT_GE(good, 1) << reader.name;
    EXPECT_GE(bad, 1) << reader.name;
  }
  for (const auto& entry : std::filesystem::directory_iterator(kCorpus))
    EXPECT_TRUE(folders.contains(entry.path().filename())) << "nobody reads " << entry.path();
}

}  // namespace
}  // namespace taut::fuzz::corpus_test
