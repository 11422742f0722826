#include "experiments/study/session.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>
#include <sstream>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

int shard_of(const std::string& key, int count) {
  unsigned long number = 0;
  std::from_chars(key.data(), key.data() + 8, number, 16);
  return static_cast<int>(number % static_cast<unsigned long>(count)) + 1;
}

ManifestEntry manifest_entry(const JsonReader& j) {
  ManifestEntry one{j.at("key").text(), printable(j.at("id").text()), j.at("shard").integer(1),
                    j.at("shards").integer(1)};
  if (!is_key(one.key)) j.at("key").fail("expected 64 hexadecimal digits");
  return one;
}

int from_environment(const char* name, int fallback) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : fallback;
}

}  // namespace

bool Shard::has(const std::string& key) const { return shard_of(key, count) == index; }

Shard Shard::parse(const std::string& text) {
  Shard shard;
  if (text.empty()) {
    shard.count = from_environment("SLURM_ARRAY_TASK_COUNT", 1);
    shard.index = from_environment("SLURM_ARRAY_TASK_ID", 1) -
                  from_environment("SLURM_ARRAY_TASK_MIN", 1) + 1;
  } else {
    char slash = 0, rest = 0;
    std::istringstream in(text);
    if (!(in >> shard.index >> slash >> shard.count) || slash != '/' || in >> rest)
      throw InputError("--shard " + text + ": expected i/n, such as 1/4");
  }
  if (shard.count < 1 || shard.index < 1 || shard.index > shard.count)
    throw InputError("shard " + std::to_string(shard.index) + "/" + std::to_string(shard.count) +
                     " does not exist: the first is 1/n, the last n/n");
  return shard;
}

fs::path begin_session(const Store& store, const std::string& command,
                       const std::vector<Case>& cases, const Shard& shard) {
  fs::path folder = store.root() / "sessions" / (utc_stamp() + "-" + unique_suffix());
  make_folder(folder);
  const Json session{{"schema", kRecordSchema},  {"command", command},
                     {"started", utc_stamp()},   {"host", host_name()},
                     {"toolchain", toolchain()}, {"shard", shard.index},
                     {"shards", shard.count},    {"cases", cases.size()}};
  std::string manifest;
  for (const Case& one : cases)
    manifest +=
        to_text(ManifestEntry{one.key, one.id, shard_of(one.key, shard.count), shard.count}) + '\n';
  try {
    write_durably(folder / "session.json", to_text(session, 1) + "\n");
    write_durably(folder / "manifest.jsonl", manifest);
  } catch (const InputError&) {  // of a session that cannot be recorded nothing stays
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    throw;
  }
  return folder;
}

std::string to_text(const ManifestEntry& one) {
  return to_text(
      Json{{"key", one.key}, {"id", one.id}, {"shard", one.shard}, {"shards", one.shards}});
}

std::vector<ManifestEntry> read_manifest_lines(const fs::path& file) {
  return read_json_lines(file, manifest_entry);
}

std::vector<ManifestEntry> read_manifests(const fs::path& root) {
  std::map<std::string, ManifestEntry> all;
  std::error_code none;
  for (const auto& session : fs::directory_iterator(root / "sessions", none)) {
    const fs::path file = session.path() / "manifest.jsonl";
    if (!fs::exists(file)) continue;
    for (ManifestEntry& one : read_manifest_lines(file)) all.emplace(one.key, std::move(one));
  }
  std::vector<ManifestEntry> list;
  for (auto& [key, one] : all) list.push_back(std::move(one));
  return list;
}

void mark_missing(const fs::path& root, const std::string& name,
                  const std::vector<ManifestEntry>& entries) {
  make_folder(root / "missing");
  std::string lines;
  for (const ManifestEntry& one : entries) lines += to_text(one) + '\n';
  write_durably(root / "missing" / (name + ".jsonl"), lines);
}

std::string Missing::sentence() const {
  constexpr std::size_t kShown = 10;
  std::string text = "merged although " + std::to_string(cases) + " planned cases were missing; " +
                     std::to_string(ids.size()) + " still are: ";
  for (std::size_t i = 0; i < std::min(kShown, ids.size()); ++i) text += (i ? ", " : "") + ids[i];
  return text + (ids.size() > kShown ? ", ..." : "");
}

std::vector<Missing> still_missing(const Store& store) {
  std::vector<Missing> all;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(store.root() / "missing", none)) {
    if (file.path().extension() != ".jsonl") continue;
    Missing one{file.path(), {}, 0};
    for (const ManifestEntry& entry : read_manifest_lines(file.path())) {
      ++one.cases;
      if (!store.find(entry.key)) one.ids.push_back(entry.id);
    }
    if (!one.ids.empty()) all.push_back(std::move(one));
  }
  std::ranges::sort(all, {}, &Missing::file);
  return all;
}

}  // namespace taut
