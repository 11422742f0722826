#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/io/text_file.hpp"
#include "experiments/system/signals.hpp"

namespace taut {

/// Writes a file beside the old one and renames it: nobody ever sees half of it, and the old one
/// stays if this fails. A device or a pipe is written to as it is. Throws InputError with the
/// system's reason (read-only, full, no such folder).
void write_file(const std::filesystem::path&, std::string_view bytes);

/// The same; returns when it is on the disk, its name included.
void write_durably(const std::filesystem::path&, std::string_view bytes);

/// Whether a file can be written there: makes its folder and tries, before anything costs time.
/// Leaves nothing behind. Throws InputError with the reason.
void test_writable(const std::filesystem::path&);

/// Appends in one write. Throws as write_durably.
void append(const std::filesystem::path&, std::string_view bytes);

/// Creates the folder and its parents; throws InputError with the system's reason.
void make_folder(const std::filesystem::path&);

/// A folder below $TMPDIR with a name that nobody foresees; it goes with this object or, at a
/// signal, with the program. The first one of a process removes those of killed processes: what is
/// older than a minute and has no lock.
class Scratch {
 public:
  Scratch();  ///< throws InputError
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path& path() const { return with_program_.path(); }

 private:
  EndsWithProgram with_program_;
  int lock_;  ///< a descriptor of the folder, locked for as long as the process lives
};

/// Of this machine.
std::string host_name();

/// "<host>.<pid>.<8 hex digits>": a name that no other process makes.
std::string unique_suffix();

/// "20260102T030405Z", the time now.
std::string utc_stamp();

}  // namespace taut
