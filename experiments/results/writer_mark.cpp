#include "experiments/results/writer_mark.hpp"

#include <signal.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/results/store_error.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

/// Name of the file system if other hosts may write to it too; "" for a local one. Numbers:
/// statfs(2) and <linux/magic.h>.
std::string network_file_system(const fs::path& folder) {
  constexpr std::pair<unsigned, const char*> kKnown[] = {
      {0x6969, "NFS"},      {0x517B, "SMB"},        {0xFF534D42, "SMB"},   {0xFE534D42, "SMB"},
      {0x00C36400, "Ceph"}, {0x0BD00BD0, "Lustre"}, {0x47504653, "GPFS"},  {0x19830326, "BeeGFS"},
      {0x5346414F, "AFS"},  {0x73757245, "Coda"},   {0xAAD7AAEA, "PanFS"}, {0x7461636F, "OCFS2"},
      {0x01161970, "GFS2"}, {0x65735546, "FUSE"},   {0x01021997, "9P"}};
  struct statfs about {};
  if (statfs(folder.c_str(), &about) != 0) return {};
  for (const auto& [type, name] : kKnown)
    if (static_cast<unsigned>(about.f_type) == type) return name;
  return {};
}

}  // namespace

WriterMark::WriterMark(const fs::path& file) {
  const std::string file_system = network_file_system(file.parent_path());
  if (file_system.empty()) return;
  const fs::path mark = file.string() + ".writer";
  if (fs::exists(mark)) {
    const std::string theirs = read_text(mark), host = theirs.substr(0, theirs.find(' '));
    if (host != host_name())
      throw StoreError(
          file, "host " + printable(host) + " writes it too, and between hosts the locks of " +
                    file_system +
                    " are not reliable: name another folder with --out and unite them with "
                    "`taut cluster merge`; if that process is gone, remove " +
                    mark.string());
    const int process = std::atoi(theirs.c_str() + std::min(theirs.size(), host.size()));
    if (process > 0 && (kill(process, 0) == 0 || errno != ESRCH))
      return;  // within a host, locks are reliable
  }
  write_file(mark, host_name() + " " + std::to_string(getpid()) + "\n");
  mark_ = mark;
}

WriterMark::~WriterMark() {
  std::error_code ignored;
  if (!mark_.empty()) fs::remove(mark_, ignored);
}

}  // namespace taut
