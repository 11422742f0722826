// Called by g++ -fsanitize-coverage=trace-pc at the start of every block of code: marks, in a file that a process shares
// with those that it starts, which blocks have run. mutate.py reads it: $TAUT_EXECUTED.PROGRAM has a byte for each byte of
// the program.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

extern const char __executable_start[], etext[];
static unsigned char* executed;

void __sanitizer_cov_trace_pc(void) {
  if (executed) executed[(const char*)__builtin_return_address(0) - __executable_start] = 1;
}

// Linked last, so that what constructs global objects, in every run, does not count.
__attribute__((constructor)) static void open_file(void) {
  const char* prefix = getenv("TAUT_EXECUTED");
  char name[4096];
  if (!prefix) return;
  snprintf(name, sizeof name, "%s.%s", prefix, program_invocation_short_name);
  const int file = open(name, O_RDWR | O_CREAT, 0600);
  const off_t size = etext - __executable_start + 1;
  if (file < 0 || ftruncate(file, size) != 0) return;
  void* map = mmap(NULL, (size_t)size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (map != MAP_FAILED) executed = map;
}
