#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/results/builds.hpp"

namespace taut {

/// A repository of git, read alone: nothing is written into it, and neither its hooks nor what its
/// configuration names is started.
class Repository {
 public:
  /// Throws InputError: there is no git, or no repository.
  explicit Repository(const std::filesystem::path& folder);
  const std::filesystem::path& folder() const { return folder_; }

  /// A, and what follows it to B along first parents, of "A..B": its commits as builds, the oldest
  /// first. Throws InputError: no such commit, the wrong way round, none in between.
  std::vector<Build> line(const std::string& range) const;

 private:
  std::string commit(const std::string& name) const;
  bool is_ancestor(const std::string& a, const std::string& b) const;
  std::filesystem::path folder_;
};

/// How much a build of a commit may take.
struct BuildLimits {
  double seconds = 3600;
  double bytes = 20e9;  ///< of its folder
};

/// A folder that holds the files of one commit after another, so that the next commit finds what
/// was built of the last. It borrows the repository's objects and writes nothing there.
class Checkout {
 public:
  /// Takes up what an earlier process left. Throws InputError: another process uses the folder.
  Checkout(const Repository&, const std::filesystem::path& folder);
  ~Checkout();
  Checkout(const Checkout&) = delete;
  Checkout& operator=(const Checkout&) = delete;
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& commit() const { return commit_; }  ///< "": none yet

  /// Checks out a commit and, unless it is "", runs a command of the shell there. Returns why that
  /// failed, in one sentence; "" if it did not. Throws InputError: the disk is full, or git
  /// refuses.
  std::string build(const std::string& commit, const std::string& command, const BuildLimits&);
  /// What somebody changed in the files of the commit since build(), one sentence; "": nothing.
  std::string changed() const;

 private:
  std::string state() const;  ///< the commit, and files that are not as it has them
  std::filesystem::path folder_;
  std::string commit_, state_;
  int lock_ = -1;
};

}  // namespace taut
