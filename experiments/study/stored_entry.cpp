#include <algorithm>
#include <fstream>
#include <optional>

#include "core/model/input_error.hpp"
#include "experiments/case/record.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/study/store.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;  ///< of a part

struct Header {
  std::string key, result;
  bool is_result = false;
  std::vector<std::pair<std::string, std::size_t>> sizes;  ///< in the order of the parts
  std::uint64_t bytes = 0;                                 ///< of all parts
};

Header header_of(const std::string& line, const fs::path& pack) {
  return read_json(line, pack.string(), [](const JsonReader& j) {
    Header header{j.at("key").text(), j.at("result").text(), false, {}, 0};
    if (!is_key(header.key)) j.at("key").fail("expected 64 hexadecimal digits");
    header.is_result = Status{status_of(j.at("status")), {}, -1, -1}.is_result();
    for (const auto& [part, size] : j.at("sizes").members()) {
      header.sizes.emplace_back(part, size.count());
      if (header.sizes.back().second > kMostBytes) size.fail("expected at most 1 GiB");
      header.bytes += header.sizes.back().second;
    }
    return header;
  });
}

}  // namespace

std::uint64_t PackWriter::append(const std::string& entry) {
  const std::uint64_t offset = size_;
  waiting_ += entry;
  size_ += entry.size();
  if (waiting_.size() >= std::max<std::size_t>(batch_, 1)) flush();
  return offset;
}

void PackWriter::flush() {
  if (waiting_.empty()) return;
  const bool first = !fs::exists(file_);
  if (first) make_folder(file_.parent_path());
  const std::uint64_t before = size_ - waiting_.size();
  try {
    append_durably(file_, waiting_);
    if (first) sync_folder(file_.parent_path());
  } catch (const InputError&) {  // half an entry must not stand before a whole one
    std::error_code ignored;
    fs::resize_file(file_, before, ignored);
    throw;
  }
  waiting_.clear();
}

PackIndex PackIndex::of(const fs::path& root) {
  PackIndex index;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(root / "packs", none))
    if (file.path().extension() == ".pack" && file.is_regular_file(none))
      index.packs.push_back(file.path());
  std::ranges::sort(index.packs);
  std::unordered_map<std::string, std::string> results;  // of those that are results
  for (std::size_t i = 0; i < index.packs.size(); ++i) {
    std::ifstream in(index.packs[i], std::ios::binary);
    const std::uint64_t size = fs::file_size(index.packs[i]);
    std::uint64_t offset = 0;
    for (std::string line; std::getline(in, line) && !in.eof();) {
      std::optional<Header> header;
      try {
        header = header_of(line, index.packs[i]);
      } catch (const InputError& error) {
        index.damaged.push_back(std::string(error.what()) + ": ignored from byte " +
                                std::to_string(offset) + " on");
        break;
      }
      const std::uint64_t next = offset + line.size() + 1 + header->bytes;
      if (next > size) break;  // cut off
      const Place place{static_cast<std::uint32_t>(i), header->is_result, offset};
      const auto [at, added] = index.places.try_emplace(header->key, place);
      if (!added && header->is_result && !at->second.result) at->second = place;
      if (header->is_result)
        if (const auto [known, fresh] = results.try_emplace(header->key, header->result);
            !fresh && known->second != header->result)
          index.conflicts.push_back(header->key);
      in.seekg(static_cast<std::streamoff>(next));
      offset = next;
    }
  }
  return index;
}

StoredEntry::StoredEntry(fs::path file, std::uint64_t offset)
    : StoredEntry(file, std::ifstream(file, std::ios::binary), offset) {}

std::optional<StoredEntry> StoredEntry::in(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in.is_open()) {
    if (!fs::exists(file)) return {};
    in.clear(), in.open(file, std::ios::binary);  // it has come meanwhile, or cannot be read
  }
  return StoredEntry(file, std::move(in), 0);
}

StoredEntry::StoredEntry(fs::path file, std::ifstream in, std::uint64_t offset)
    : place_(std::move(file)), in_(std::move(in)) {
  in_.seekg(static_cast<std::streamoff>(offset));
  if (!std::getline(in_, seal_)) throw InputError(place_.string() + ": cannot read");
  std::uint64_t at = offset + seal_.size() + 1;
  for (const auto& [part, size] : header_of(seal_, place_).sizes) {
    parts_[part] = {at, size};
    at += size;
  }
}

std::string StoredEntry::part(const std::string& name) const {
  const auto at = parts_.find(name);
  if (at == parts_.end()) return {};
  std::string text(at->second.second, '\0');
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(at->second.first));
  if (!in_.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw InputError(place_.string() + ": " + name + " is cut off");
  return text;
}

}  // namespace taut
