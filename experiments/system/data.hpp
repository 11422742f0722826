#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

/// Where shipped scenes and studies are: $TAUT_DATA if it is set, else what set_data_folder() said,
/// else share/taut beside an installed program, else the source tree. Throws InputError if
/// $TAUT_DATA is no folder.
std::filesystem::path data_folder();

/// For a library in a program that is not installed beside these data, as Python's is. Before the
/// first use of them.
void set_data_folder(std::filesystem::path);

/// Where converged references are: beside the shipped scenes if installed, else
/// results/references of the source tree.
std::filesystem::path references_folder();

/// Where results are kept: $TAUT_RESULTS if it is set (`./taut` names its own repository when it is
/// called from another folder), else results below the current folder.
std::filesystem::path results_folder();

/// Names of the shipped "scenes" or "studies", sorted.
std::vector<std::string> shipped(const std::string& kind);

/// The file of a scene or study: a text with a '/' or that ends in .toml is a path, any other the
/// name of a shipped one. Throws InputError, with a suggestion for a name that is not known.
std::filesystem::path find_scene(const std::string& name_or_path);
std::filesystem::path find_study(const std::string& name_or_path);

/// The running program's own file, and a program that is installed beside it ("" is itself).
std::filesystem::path this_program();
std::filesystem::path sibling_program(const std::string& name);

}  // namespace taut
