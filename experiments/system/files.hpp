#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/io/text_file.hpp"
#include "experiments/system/signals.hpp"

namespace taut {

/// Writes a new file beside the old one and renames it, so that no reader sees half of it and the
/// old one survives a failure. Writes directly to a device or a pipe. Throws InputError with the
/// system's reason (read-only, full, no such folder).
void write_file(const std::filesystem::path&, std::string_view bytes);

/// As write_file(), but returns only when the file and its name are on the disk.
void write_durably(const std::filesystem::path&, std::string_view bytes);

/// Tests whether a file can be written there, before time is spent on computing it: creates the
/// folder and tries. Leaves no file behind. Throws InputError with the reason.
void test_writable(const std::filesystem::path&);

/// Appends in a single write. Throws as write_durably() does.
void append(const std::filesystem::path&, std::string_view bytes);

/// Creates the folder and its parents; throws InputError with the system's reason.
void make_folder(const std::filesystem::path&);

/// A folder below $TMPDIR with an unpredictable name. It is removed with this object, or when a
/// signal ends the program. The first Scratch of a process also removes folders of killed
/// processes, which are older than a minute and not locked.
class Scratch {
 public:
  Scratch();  ///< throws InputError
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path& path() const { return with_program_.path(); }

 private:
  EndsWithProgram with_program_;
  int lock_;  ///< descriptor of the folder, which it keeps locked
};

/// Name of this machine.
std::string host_name();

/// "<host>.<pid>.<8 hex digits>": unique among processes.
std::string unique_suffix();

/// The current time as "20260102T030405Z".
std::string utc_stamp();

}  // namespace taut
