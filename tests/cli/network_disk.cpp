// Preloaded library that makes every file system look like NFS and gives the host $HOST_NAME's
// name.
#include <sys/vfs.h>

#include <cstdlib>
#include <cstring>

extern "C" [[gnu::visibility("default")]] int statfs(const char*, struct statfs* about) {
  std::memset(about, 0, sizeof *about);
  about->f_type = 0x6969;
  return 0;
}

extern "C" [[gnu::visibility("default")]] int gethostname(char* name, std::size_t size) {
  std::strncpy(name, std::getenv("HOST_NAME"), size);
  return 0;
}
