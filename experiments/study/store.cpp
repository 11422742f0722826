#include "experiments/study/store.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr std::array kParts{"case.json", "series.csv", kFramesFile, "stderr.txt"};

EntryParts parts_in(const fs::path& folder) {
  EntryParts parts;
  for (const char* part : kParts)
    if (fs::exists(folder / part)) parts[part] = read_text(folder / part);
  return parts;
}

EntryParts parts_of(const StoredEntry& entry) {
  EntryParts parts;
  for (const char* name : kParts)
    if (entry.has(name)) parts[name] = entry.part(name);
  return parts;
}

std::string entry_text(const EntryParts& parts, const Record& record) {
  Json seal{{"schema", kRecordSchema},
            {"key", record.key},
            {"status", to_string(record.status.kind)},
            {"result", result_digest(record)}};
  for (const auto& [part, text] : parts) seal["files"][part] = sha256(text);
  for (const auto& [part, text] : parts) seal["sizes"][part] = text.size();
  std::string entry = to_text(seal) + '\n';
  for (const auto& [part, text] : parts) entry += text;
  return entry;
}

/// The record of an entry; throws if a part is not what its seal says.
Record open_entry(const StoredEntry& entry, const std::string& key) {
  read_json(entry.seal(), "its seal", [&](const JsonReader& seal) {
    for (const auto& [part, digest] : seal.at("files").members()) {
      if (std::ranges::find(kParts, part) == kParts.end()) digest.fail("is no part of an entry");
      if (sha256(entry.part(part)) != digest.text())
        throw InputError(part + " does not match its digest");
    }
    if (seal.at("key").text() != key) throw InputError("it belongs to another key");
  });
  Record record = record_from_json(entry.part("case.json"), "case.json");
  if (record.key != key) throw InputError("it belongs to another key");
  return record;
}

/// What becomes of a record beside the one that is there, if any.
Store::Commit beside(const std::optional<Record>& old, const Record& record, bool adds_frames) {
  using Commit = Store::Commit;
  if (!old) return Commit::stored;
  if (result_digest(*old) == result_digest(record))
    return adds_frames ? Commit::stored : Commit::same;
  if (!old->status.is_result()) return Commit::stored;
  return record.status.is_result() ? Commit::conflict : Commit::same;
}

/// A leftover of a process of this host that no longer exists: "<key>.<host>.<pid>.<rand>".
bool abandoned(const std::string& name) {
  const std::string mine = unique_suffix();
  const std::string host = mine.substr(0, mine.rfind('.', mine.rfind('.') - 1) + 1);
  const auto at = name.find("." + host);
  if (at == std::string::npos) return false;
  const int pid = std::atoi(name.c_str() + at + 1 + host.size());
  return pid > 0 && kill(pid, 0) != 0 && errno == ESRCH;
}

/// Whether entries are folders, as those of an earlier taut. Looks at one: all are alike.
bool holds_folders(const fs::path& store) {
  std::error_code none;
  for (const auto& shelf : fs::directory_iterator(store, none))
    for (const auto& entry : fs::directory_iterator(shelf.path(), none))
      return entry.is_directory();
  return false;
}

}  // namespace

fs::path default_results() { return results_folder() / "runs"; }

Store::Store(fs::path root, Notice notice) : root_(std::move(root)), notice_(std::move(notice)) {
  if (!notice_) notice_ = [](const std::string& text) { std::cerr << text << '\n'; };
}

fs::path Store::file(const std::string& key) const {
  return root_ / "store" / key.substr(0, 2) / key;
}

struct Store::Packs {
  PackIndex index;
  std::optional<PackWriter> writer;
  std::optional<Scratch> scratch;  ///< of a store that packs: where its cases write
};

Store::Packs& Store::packs() const {
  if (!packs_) {
    if (holds_folders(root_ / "store"))
      throw InputError((root_ / "store").string() +
                       ": entries of an earlier taut, folders; name another results folder");
    packs_ = std::make_shared<Packs>();
    packs_->index = PackIndex::of(root_);
    for (const std::string& sentence : packs_->index.damaged) notice_(sentence);
  }
  return *packs_;
}

void Store::pack_into(const std::string& name, std::size_t batch) {
  flush();
  packs().writer.emplace(root_ / "packs" / (name + ".pack"), batch);
  packs().index.packs.push_back(packs().writer->file());
  if (!packs().scratch) packs().scratch.emplace();
}

void Store::flush() const {
  if (packs().writer) packs().writer->flush();
}

const PackIndex::Place* Store::packed(const std::string& key) const {
  const auto at = packs().index.places.find(key);
  if (at == packs().index.places.end()) return nullptr;
  return at->second.result || !fs::exists(file(key)) ? &at->second : nullptr;
}

std::optional<StoredEntry> Store::entry(const std::string& key) const {
  if (const PackIndex::Place* place = packed(key))
    return StoredEntry(packs().index.packs[place->pack], place->offset);
  return StoredEntry::in(file(key));
}

std::optional<Record> Store::find(const std::string& key) const {
  for (;;) try {
      const std::optional<StoredEntry> found = entry(key);
      return found ? std::optional(open_entry(*found, key)) : std::nullopt;
    } catch (const std::exception& error) {
      if (!set_aside(key, error.what())) return {};
    }
}

std::optional<Record> Store::find(const Case& one) const {
  std::optional<Record> record = find(one.key);
  if (record) record->spec = one.spec, record->id = one.id, record->scene = one.scene->name;
  return record;
}

bool Store::set_aside(const std::string& key, const std::string& why) const {
  if (const PackIndex::Place* place = packed(key)) {
    notice_(packs().index.packs[place->pack].string() + ": corrupt entry at byte " +
            std::to_string(place->offset) + " (" + why + "), ignored");
    packs().index.places.erase(key);
    return true;
  }
  const fs::path place = root_ / "corrupt" / (key + "." + unique_suffix());
  std::error_code error;
  fs::create_directories(place.parent_path(), error);
  if (!error) {
    fs::rename(file(key), place, error);
    if (error == std::errc::no_such_file_or_directory) return true;  // another process took it
  }
  std::optional<Record> sound;  // that another process put there meanwhile
  EntryParts parts;
  if (!error) try {
      const StoredEntry entry(place);
      parts = parts_of(entry);
      sound = open_entry(entry, key);
    } catch (const std::exception&) {  // it is damaged indeed
    }
  if (sound) {
    commit(std::move(parts), *sound);
    flush();
    fs::remove(place);
    return true;
  }
  notice_(file(key).string() + ": corrupt entry (" + why + "), " +
          (error ? "ignored: " + error.message() : "set aside as " + place.string()));
  return !error;
}

Series Store::series(const std::string& key) const {
  const std::optional<StoredEntry> found = entry(key);
  const std::string text = found ? found->part("series.csv") : "";
  return text.empty() ? Series{} : series_from_csv(text);
}

EntryParts Store::parts(const std::string& key) const {
  const std::optional<StoredEntry> found = entry(key);
  return found ? parts_of(*found) : EntryParts{};
}

bool Store::has_frames(const std::string& key) const {
  const std::optional<StoredEntry> found = entry(key);
  return found && found->has(kFramesFile);
}

Trajectory Store::motion(const std::string& key) const {
  const Scratch scratch;
  write_file(scratch.path() / kFramesFile, entry(key).value().part(kFramesFile));
  return read_trajectory(scratch.path() / kFramesFile);
}

void Store::prepare() const {
  if (const fs::path store = root_ / "store", aside = root_ / "store.earlier";
      holds_folders(store)) {
    std::error_code error;  // it is there already, or another process was faster
    fs::rename(store, aside, error);
    if (!error)
      notice_(store.string() + ": entries of an earlier taut, set aside in " + aside.string());
  }
  make_folder(root_ / "store");
  make_folder(root_ / "tmp");
  const fs::path probe = root_ / "tmp" / ("probe." + unique_suffix());
  write_durably(probe, "can this folder be written?\n");
  fs::remove(probe);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(root_ / "tmp"))
    if (abandoned(entry.path().filename())) fs::remove_all(entry.path(), ignored);
}

fs::path Store::stage(const std::string& key) const {
  const fs::path place = packs().scratch ? packs().scratch->path() : root_ / "tmp";
  const fs::path staged = place / (key + "." + unique_suffix());
  std::error_code error;  // not its parents: should the results be moved away, nothing goes on
  if (!fs::create_directory(staged, error))
    throw InputError(staged.string() + ": cannot create: " + error.message());
  return staged;
}

Store::Commit Store::commit(EntryParts parts, const Record& record) const {
  parts["case.json"] = to_json(record, 1) + "\n";
  const std::string entry = entry_text(parts, record);
  // Another process may commit the same case at any moment: then this one looks again.
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::optional<Record> old = find(record.key);
    const bool adds_frames = parts.contains(kFramesFile) && !has_frames(record.key);
    const Commit done = beside(old, record, adds_frames);
    if (done == Commit::same) return done;
    if (done == Commit::stored && packs().writer) {
      PackIndex& index = packs().index;
      const auto pack = static_cast<std::uint32_t>(index.packs.size() - 1);
      const std::uint64_t offset = packs().writer->append(entry);
      index.places[record.key] = {pack, record.status.is_result(), offset};
      return done;
    }
    const fs::path place = done == Commit::conflict
                               ? root_ / "conflicts" / (record.key + "." + unique_suffix())
                               : file(record.key);
    make_folder(place.parent_path());
    if (done == Commit::conflict) make_folder(root_ / "tmp");        // all may be in pack files
    if (done == Commit::stored && old && old->status.is_result()) {  // the same one, with frames
      replace_durably(place, entry, root_ / "tmp");
      return done;
    }
    if (create_durably(place, entry, root_ / "tmp")) return done;
    if (old) take_failure_away(record.key);
  }
  throw InputError(file(record.key).string() + ": cannot create");
}

void Store::take_failure_away(const std::string& key) const {
  const fs::path taken = root_ / "tmp" / (key + "." + unique_suffix());
  if (std::rename(file(key).c_str(), taken.c_str()) != 0) {
    if (errno == ENOENT) return;
    throw InputError(file(key).string() + ": cannot replace: " + std::strerror(errno));
  }
  const StoredEntry entry(taken);
  if (const Record record = open_entry(entry, key); record.status.is_result())
    commit(parts_of(entry), record), flush();  // of a process that took the failure away before
  fs::remove(taken);
}

Store::Commit Store::commit(const fs::path& staged, const Record& record) const {
  const Commit done = commit(parts_in(staged), record);
  std::error_code ignored;
  fs::remove_all(staged, ignored);
  return done;
}

std::vector<std::string> Store::keys() const {
  std::vector<std::string> keys;
  std::error_code none;
  for (const auto& shelf : fs::directory_iterator(root_ / "store", none))
    for (const auto& entry : fs::directory_iterator(shelf.path(), none))
      keys.push_back(entry.path().filename());
  for (const auto& [key, place] : packs().index.places) keys.push_back(key);
  std::ranges::sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

std::string Store::digest() const {
  std::string all;
  for (const std::string& key : keys())
    if (const std::optional<Record> record = find(key); record && record->status.is_result())
      all += key + ' ' + result_digest(*record) + '\n';
  return sha256(all);
}

std::vector<std::string> Store::conflicts() const {
  std::vector<std::string> keys = packs().index.conflicts;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(root_ / "conflicts", none))
    keys.push_back(entry.path().filename().string().substr(0, 64));
  return keys;
}

}  // namespace taut
