#pragma once

#include <pybind11/pybind11.h>

/// What the library computes without the interpreter's lock, and the end of Python meanwhile.
namespace taut::python {

/// A scope without the interpreter's lock, in which other threads of Python run. While one is open,
/// Python does not end: it would end a thread that takes the lock again, in the middle of C++.
class Unlocked {
 public:
  /// Throws SystemExit if Python is ending.
  Unlocked() = default;

 private:
  /// Counts the scope from before the lock is released until it is taken again.
  struct Counted {
    Counted();
    ~Counted();
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
  };
  Counted counted_;
  pybind11::gil_scoped_release released_;
};

/// Throws SystemExit, which a thread of Python ends with silently, if Python is ending. Takes the
/// lock for that alone.
void leave_if_python_ends();

/// Has Python, before it ends, tell the open scopes to leave and wait for them. Ctrl-C ends the
/// wait.
void wait_for_unlocked_at_exit();

}  // namespace taut::python
