#pragma once

#include <filesystem>
#include <string>

#include "experiments/metrics/reference.hpp"

namespace taut {

/// Writes pretty JSON with shortest round-trip numbers; throws InputError if that fails.
void write_reference(const Reference&, const std::filesystem::path& folder);

/// Where write_reference() puts it: a file of its kind that belongs to another digest stays, and
/// the name has the digest's beginning. Throws InputError if what is there is no reference.
std::filesystem::path reference_file(const Reference&, const std::filesystem::path& folder);

/// SHA-256 of the scene without what a reference of this kind does not depend on: the time step
/// and the duration; for "static" damping and velocities too.
std::string reference_digest(const Scene&, const std::string& kind);

/// The references of the scene of this name below `root` that belong to exactly this cloth: another
/// grid or mass has none. Throws InputError on a file that is not a reference.
References find_references(const Scene&, const std::filesystem::path& root);

/// Throws InputError that names the file.
Reference read_reference(const std::filesystem::path&);

}  // namespace taut
