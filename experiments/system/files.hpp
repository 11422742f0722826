#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace taut {

/// Everything in a file; throws InputError if it cannot be read.
std::string read_text(const std::filesystem::path&);

/// Writes a whole file and waits until it is on the disk. Throws InputError with the system's
/// reason (read-only, full, no such folder).
void write_durably(const std::filesystem::path&, std::string_view text);

/// Writes a text beside the place and renames it: nobody ever sees half a file. Throws as
/// write_durably.
void write_whole(const std::filesystem::path&, std::string_view text);

/// Whether a file can be written there: makes its folder and tries, before anything costs time.
/// Leaves nothing behind. Throws InputError with the reason.
void test_writable(const std::filesystem::path&);

/// Appends a line in one write. Throws as write_durably.
void append_line(const std::filesystem::path&, std::string_view line);

/// Makes the folder's entries (new names, renames) durable. Throws as write_durably.
void sync_folder(const std::filesystem::path&);

/// Creates the folder and its parents; throws InputError with the system's reason.
void make_folder(const std::filesystem::path&);

/// "<host>.<pid>.<8 hex digits>": a name that no other process gives.
std::string unique_suffix();

/// "20260102T030405Z", the time now.
std::string utc_stamp();

}  // namespace taut
