#pragma once

#include <filesystem>
#include <functional>

#include "experiments/render/picture/recorded_run.hpp"

namespace taut {

/// Writes every `stride`-th frame of a run as Wavefront OBJ, FOLDER/PREFIX_00000.obj and on: the
/// particles as they are (no refinement), material coordinates of sheets as vt, triangles, or lines
/// where there are none. Makes the folder. Gives the number of files; throws InputError.
int export_obj(const Scene&, const RecordedRun&, const std::filesystem::path& folder,
               const std::string& prefix, int stride,
               const std::function<void(int, int)>& progress = {});

}  // namespace taut
