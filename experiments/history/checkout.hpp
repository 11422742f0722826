#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "experiments/results/builds.hpp"
#include "experiments/system/files.hpp"

namespace taut {

/// A git repository that is only read. Nothing is written into it, and neither its hooks nor
/// programs that its configuration names are run. Objects that are missing, as in a partial clone,
/// are not fetched.
class Repository {
 public:
  /// Throws InputError if git is not installed or the folder is no repository.
  explicit Repository(const std::filesystem::path& folder);
  const std::filesystem::path& folder() const { return folder_; }

  /// The commits of the range "A..B" as builds, oldest first: A, and the line of first parents that
  /// leads from it to B. Throws InputError if a commit does not exist, A does not precede B, or the
  /// range is empty.
  std::vector<Build> line(const std::string& range) const;

 private:
  std::string commit(const std::string& name) const;
  bool is_ancestor(const std::string& a, const std::string& b) const;
  /// The line to b if a commit of it is missing, and so what lies between that one and a. Empty if
  /// none is.
  std::vector<Build> broken_line(const std::string& a, const std::string& b) const;
  std::filesystem::path folder_;
  std::shared_ptr<Scratch> own_;  ///< a checkout over its objects, without its configuration
};

/// Limits on the build of a commit.
struct BuildLimits {
  double seconds = 3600;
  double bytes = 20e9;  ///< size of its folder
};

/// A folder that contains the files of one commit after another, so that each build can reuse the
/// previous one. It borrows the repository's objects and writes nothing into the repository.
class Checkout {
 public:
  /// Reuses what an earlier process left there. Throws InputError if another process uses the
  /// folder.
  Checkout(const Repository&, const std::filesystem::path& folder);
  ~Checkout();
  Checkout(const Checkout&) = delete;
  Checkout& operator=(const Checkout&) = delete;
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& commit() const { return commit_; }  ///< "" until one is built

  /// Checks out a commit and runs `command`, unless it is "", in a shell there. Returns "" on
  /// success, otherwise a sentence that says why it failed, such as a missing object. Throws
  /// InputError if the disk is full.
  std::string build(const std::string& commit, const std::string& command, const BuildLimits&);
  /// A sentence that says what changed in the commit's files since build(); "" if nothing did.
  std::string changed() const;

 private:
  std::string state() const;  ///< the commit, and the files that differ from it
  std::filesystem::path folder_;
  std::string commit_, state_;
  int lock_ = -1;
};

}  // namespace taut
