#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

/// Folder of the shipped scenes and studies: $TAUT_DATA if it is set, else the folder of
/// set_data_folder(), else share/taut beside an installed program, else the source tree. Throws
/// InputError if $TAUT_DATA is not a folder.
std::filesystem::path data_folder();

/// Sets the data folder for a library, such as Python's, in a program that is not installed beside
/// the data. Call it before the data are first used.
void set_data_folder(std::filesystem::path);

/// Folder of the converged references: beside the shipped scenes if installed, otherwise
/// results/references in the source tree.
std::filesystem::path references_folder();

/// Folder of the results: $TAUT_RESULTS if it is set (`./taut` sets it to its own repository's when
/// called from another folder), otherwise results below the current folder.
std::filesystem::path results_folder();

/// Names of the shipped "scenes" or "studies", sorted.
std::vector<std::string> shipped(const std::string& kind);

/// File of a scene or study. A text that contains '/' or ends in .toml is a path; any other is the
/// name of a shipped one. Throws InputError, with a suggestion if the name is unknown.
std::filesystem::path find_scene(const std::string& name_or_path);
std::filesystem::path find_study(const std::string& name_or_path);
/// A scene that `file` names, as find_scene() takes it: a relative path is seen from the file's
/// folder.
std::string scene_seen_from(const std::filesystem::path& file, const std::string& name_or_path);

/// Folder of the committed baselines: that of the results, or this repository's if $TAUT_RESULTS
/// names a folder without.
std::filesystem::path baselines_folder();

/// File of the running program.
std::filesystem::path this_program();
std::filesystem::path sibling_program(const std::string& name);

}  // namespace taut
