#pragma once

#include <filesystem>
#include <string>

#include "core/model/solver.hpp"
#include "experiments/system/files.hpp"

namespace taut {

/// For its lifetime registers a solver "scripted" with jakobsen's parameters, and makes a shell
/// script the program that runs and times its cases. In the script $folder is a folder that the
/// test reads, $3 is the text of a case's solver, and $5 is the folder for its files.
class Scripted {
 public:
  explicit Scripted(const std::string& body) {
    write(body);
    set_solver_source(
        {.names = [] { return std::vector<std::string>{"scripted"}; },
         .find = [](std::string_view name,
                    std::string_view) { return name == "scripted" ? &entry() : nullptr; }});
  }
  ~Scripted() { set_solver_source({}); }
  Scripted(const Scripted&) = delete;
  Scripted& operator=(const Scripted&) = delete;

  /// Replaces the script.
  void write(const std::string& body) {
    file() = (scratch_.path() / "script").string();
    write_file(file(), "#!/bin/sh\nfolder='" + folder().string() + "'\n" + body);
    std::filesystem::permissions(file(), std::filesystem::perms::owner_all);
    make_folder(folder());
  }
  std::filesystem::path folder() const { return scratch_.path() / "told"; }
  /// Text that the script left in this file; "" if there is no file.
  std::string told(const std::string& name) const {
    return std::filesystem::exists(folder() / name) ? read_text(folder() / name) : "";
  }

 private:
  static std::string& file() {
    static std::string path;
    return path;
  }
  static const SolverEntry& entry() {
    static const SolverEntry scripted = [] {
      SolverEntry one = find_solver("jakobsen");
      one.name = "scripted";
      one.program = [](const Params&) { return std::string_view(file()); };
      return one;
    }();
    return scripted;
  }
  Scratch scratch_;
};

}  // namespace taut
