#pragma once

#include <string>
#include <vector>

#include "core/io/mesh_io.hpp"
#include "core/model/input_error.hpp"

namespace taut {

/// Collects what is wrong with a surface; a hopeless file does not flood the terminal.
class SurfaceErrors {
 public:
  explicit SurfaceErrors(std::string file) : file_(std::move(file)) {}
  void report(int line, const std::string& message, int column = 1);
  /// Throws InputError with the first hundred in the order of the file; returns if there are none.
  void throw_if_any();

 private:
  std::string file_;
  std::vector<Diagnostic> found_;
};

/// Reports faces without area, edges of more than two faces, vertices without a face and vertices
/// that coincide. Precondition: every face names vertices that exist.
void judge_surface(const Polygons&, SurfaceErrors&);

/// An edge with the faces that have it; a < b.
struct Edge {
  int a = 0, b = 0;
  std::vector<int> faces;
};
/// Sorted by a, then b; faces in their order.
std::vector<Edge> edges_of(const Polygons&);

}  // namespace taut
