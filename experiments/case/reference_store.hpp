#pragma once

#include <filesystem>
#include <string>

#include "experiments/metrics/reference.hpp"

namespace taut {

/// Writes pretty JSON with shortest round-trip numbers; throws InputError if that fails.
void write_reference(const Reference&, const std::filesystem::path& folder);
/// Writes a description in JSON and, beside it, an array of NumPy in float32: the places [m] at all
/// moments, then the velocities [m/s]. Throws InputError.
void write_motion(const MotionReference&, const std::filesystem::path& folder);

void write_ensemble(const Ensemble&, const std::filesystem::path& folder);

/// The file for a reference of this kind: "static", "motion" or "ensemble". If the file of this
/// kind belongs to another digest, it stays, and the new name contains the beginning of the digest.
/// Throws InputError if the existing file is no reference.
std::filesystem::path reference_file(const std::string& kind, const std::string& digest,
                                     const std::filesystem::path& folder);

/// SHA-256 of the parts of the scene on which a reference of this kind depends: all but the time
/// step and the duration, and for "static" all but damping and velocities, too.
std::string reference_digest(const Scene&, const std::string& kind);

/// The references of the scene of this name below `root` that belong to exactly this cloth: another
/// grid or mass has none. Throws InputError on a file that is not a reference.
References find_references(const Scene&, const std::filesystem::path& root);

/// Throw InputError that names the file.
Reference read_reference(const std::filesystem::path&);
/// `start` is the scene's, with which the motion begins.
MotionReference read_motion(const std::filesystem::path&, const State& start);
Ensemble read_ensemble(const std::filesystem::path&);

}  // namespace taut
