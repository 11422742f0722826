#include "experiments/python/unlocked.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace taut::python {

namespace py = pybind11;

namespace {

std::atomic<bool> g_ending{false};
std::atomic<int> g_open{0};
/// The process that the count is of: one that was forked has none of the other threads.
std::atomic<pid_t> g_process{0};

void count(int change) {
  if (const pid_t now = getpid(); g_process.exchange(now) != now) g_open = 0;
  g_open += change;
}

void wait_for_all() {
  g_ending = true;
  for (count(0); g_open > 0;) {
    {
      const py::gil_scoped_release others_run;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

}  // namespace

Unlocked::Counted::Counted() {
  leave_if_python_ends();
  count(1);
}
Unlocked::Counted::~Counted() { count(-1); }

void leave_if_python_ends() {
  if (!g_ending) return;
  const py::gil_scoped_acquire own;
  PyErr_SetNone(PyExc_SystemExit);
  throw py::error_already_set();
}

void wait_for_unlocked_at_exit() {
  py::module_::import("atexit").attr("register")(py::cpp_function(wait_for_all));
}

}  // namespace taut::python
