// Child processes: their limits, their results, and the ways in which they end.
#include "experiments/system/process.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <limits>
#include <sstream>
#include <thread>

#include "core/model/input_error.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/run_all.hpp"

namespace taut::process_test {
namespace {

using Stream = ProcessOptions::Stream;

std::vector<std::string> shell(const std::string& script) { return {"sh", "-c", script}; }

/// Output of a shell script.
std::string said(const std::string& script, ProcessOptions options = {}) {
  options.output = Stream::piped;
  Process process(shell(script), options);
  return process.read_all(20);
}

ProcessEnd end_of(const std::string& script) { return *Process(shell(script)).wait(20); }

bool lives(pid_t pid) { return kill(pid, 0) == 0; }

/// Whether the process is gone within ten seconds; reaps it if it has become a child of this one.
bool ends(pid_t pid) {
  for (const auto end = in_seconds(10); seconds_until(end) > 0; usleep(1000)) {
    if (!lives(pid)) return true;
    waitpid(pid, nullptr, WNOHANG);
  }
  return false;
}

/// Sends a signal to this thread every millisecond; interrupted system calls are not restarted.
class Interruptions {
 public:
  Interruptions() {
    struct sigaction action {};
    action.sa_handler = [](int) {};
    sigaction(SIGUSR1, &action, &before_);
    sender_ = std::thread([this, target = pthread_self()] {
      for (; !done_; usleep(1000)) pthread_kill(target, SIGUSR1);
    });
  }
  ~Interruptions() {
    done_ = true;
    sender_.join();
    sigaction(SIGUSR1, &before_, nullptr);
  }
  Interruptions(const Interruptions&) = delete;
  Interruptions& operator=(const Interruptions&) = delete;

 private:
  struct sigaction before_ {};
  std::atomic<bool> done_ = false;
  std::thread sender_;
};

/// Limit as printed by a shell's ulimit, in multiples of `unit` bytes.
std::string printed(int limit, rlim_t unit) {
  rlimit both{};
  getrlimit(static_cast<__rlimit_resource>(limit), &both);
  return both.rlim_cur == RLIM_INFINITY ? "unlimited" : std::to_string(both.rlim_cur / unit);
}

TEST(Processes, MayUseWhatTheyAreAllowed) {
  ProcessOptions options;
  options.limits = {.cpu_seconds = 6.2, .memory = 300 << 20, .file_bytes = 40 << 10};
  EXPECT_EQ(said("ulimit -St; ulimit -Ht; ulimit -c; ulimit -f", options), "7\n8\n0\n80\n")
      << "whole seconds, one more until it is killed; blocks of 512 bytes";
#ifndef TAUT_SANITIZED  // the sanitizer's shadow memory alone takes terabytes
  EXPECT_EQ(said("ulimit -Sd; ulimit -Hd", options), "307200\n307200\n") << "kB";
#endif
  EXPECT_EQ(said("ulimit -t; ulimit -d; ulimit -f"), printed(RLIMIT_CPU, 1) + "\n" +
                                                         printed(RLIMIT_DATA, 1024) + "\n" +
                                                         printed(RLIMIT_FSIZE, 512) + "\n");
  options.folder = "/";
  EXPECT_EQ(said("pwd", options), "/\n");
  EXPECT_EQ(said("test $(cut -d' ' -f6 /proc/$$/stat) = $$ && echo yes"), "yes\n")
      << "a session of its own";
  EXPECT_EQ(said("cat; echo end"), "end\n") << "its input is empty";
}

TEST(Processes, SayHowTheyEnded) {
  EXPECT_TRUE(end_of("exit 0").good());
  EXPECT_EQ(end_of("exit 0").text(), "exit code 0");
  EXPECT_EQ(end_of("exit 3").text(), "exit code 3");
  EXPECT_FALSE(end_of("exit 3").good());
  const ProcessEnd killed = end_of("kill -SEGV $$");
  EXPECT_EQ(killed.signal, SIGSEGV);
  EXPECT_EQ(killed.exit_code, -1);
  EXPECT_EQ(killed.text(), "SIGSEGV");
  EXPECT_FALSE(killed.good());
  EXPECT_EQ((ProcessEnd{-1, SIGRTMIN + 1}).text(), "signal " + std::to_string(SIGRTMIN + 1));
  // ignored in this process, not in the child
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXFSZ}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    std::signal(signal, SIG_IGN);
    EXPECT_EQ(end_of("kill -" + std::to_string(signal) + " $$; exit 4").signal, signal);
    sigaction(signal, &before, nullptr);
  }
  try {
    Process({"/no/such/program", "x"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/no/such/program: cannot be executed: No such file or directory");
  }
  ProcessOptions nowhere;
  nowhere.folder = "/no/such/folder";
  EXPECT_THROW(Process(shell("true"), nowhere), InputError);
}

TEST(Processes, OutputIsReadByLinesByBytesAndToTheEnd) {
  Process process(shell("printf 'one\\n\\nthree\\nabcdef'; echo err >&2; sleep 0.1; echo end"),
                  {.output = Stream::piped});
  std::string got;
  for (const char* line : {"one", "", "three"}) {
    ASSERT_TRUE(process.read_line(got, 20));
    EXPECT_EQ(got, line);
  }
  ASSERT_TRUE(process.read_bytes(got, 4, 20));
  EXPECT_EQ(got, "abcd");
  EXPECT_EQ(process.unread().substr(0, 2), "ef");
  ASSERT_TRUE(process.read_line(got, 20));
  EXPECT_EQ(got, "efend") << "not what it says on standard error";
  EXPECT_FALSE(process.read_line(got, 20)) << "it has ended";
  EXPECT_FALSE(process.read_bytes(got, 1, 20));
  EXPECT_TRUE(process.wait()->good());

  ProcessOptions both{.output = Stream::piped, .errors = Stream::piped};
  EXPECT_EQ(Process(shell("echo out; echo err >&2"), both).read_all(20), "out\nerr\n");
  Process endless(shell("printf abcd; exec sleep 1000"), {.output = Stream::piped});
  EXPECT_FALSE(endless.read_line(got, 20, 3)) << "longer than that";
  Process slow(shell("printf abcd; sleep 0.1; echo"), {.output = Stream::piped});
  EXPECT_TRUE(slow.read_line(got, 20, 4));
  EXPECT_EQ(got, "abcd");
  const std::string many = said("head -c 200000 /dev/zero | tr '\\0' x");
  EXPECT_EQ(many, std::string(200000, 'x'));
}

TEST(Processes, WhoeverTakesTooLongIsNotWaitedFor) {
  // shortest of three, as other processes use this machine too
  const auto seconds = [](const auto& what) {
    double least = 1e9;
    for (int i = 0; i < 3; ++i) {
      const auto start = SteadyClock::now();
      what();
      least = std::min(least, seconds_since(start));
    }
    return least;
  };
  std::string got;
  Process silent(shell("exec sleep 1000"), {.input = Stream::piped, .output = Stream::piped});
  EXPECT_FALSE(silent.poll());
  for (const double limit : {0.0, 0.0009, 0.06})  // fractions of a millisecond count as well
    for (const auto& wait : std::vector<std::function<void()>>{
             [&] { EXPECT_FALSE(silent.read_line(got, limit)); },
             [&] { EXPECT_FALSE(silent.read_bytes(got, 1, limit)); },
             [&] { EXPECT_EQ(silent.read_all(limit), ""); },
             [&] { EXPECT_FALSE(silent.write(std::string(1 << 22, 'x'), limit)); }}) {
      const double took = seconds(wait);
      EXPECT_GE(took, limit);
      EXPECT_LT(took, limit + 0.34);
    }
  const pid_t pid = silent.pid();
  EXPECT_FALSE(silent.wait(0.1));
  EXPECT_FALSE(lives(pid)) << "killed";
  EXPECT_EQ(silent.poll()->signal, SIGKILL);
  EXPECT_FALSE(silent.write("x")) << "nobody reads it";
}

TEST(Processes, AreAnsweredAndTalkedTo) {
  Process process(shell("while read word; do echo \"<$word>\"; done; echo bye"),
                  {.input = Stream::piped, .output = Stream::piped});
  std::string got;
  for (const std::string word : {"one", "two"}) {
    ASSERT_TRUE(process.write(word + "\n"));
    ASSERT_TRUE(process.read_line(got, 20));
    EXPECT_EQ(got, "<" + word + ">");
  }
  process.close_input();
  EXPECT_EQ(process.read_all(20), "bye\n");
  EXPECT_TRUE(process.wait(20)->good());
  Process pipe({"cat"}, {.input = Stream::piped, .output = Stream::piped});
  std::thread writer([&] {
    EXPECT_TRUE(pipe.write(std::string(3 << 20, 'y'), 20));
    pipe.close_input();
  });
  EXPECT_EQ(pipe.read_all(20).size(), std::size_t{3} << 20);
  writer.join();
}

TEST(Processes, TakeWithThemWhatTheyStarted) {
  std::string line;
  Process process(shell("setsid sleep 1000 & echo $!; read wait"),
                  {.input = Stream::piped, .output = Stream::piped});
  ASSERT_TRUE(process.read_line(line, 20));
  const pid_t left = std::stoi(line);
  EXPECT_TRUE(lives(left));
  EXPECT_TRUE(process.has_descendants());
  process.close_input();
  EXPECT_TRUE(process.wait(20));
  EXPECT_TRUE(ends(left));
  EXPECT_FALSE(process.has_descendants());
  pid_t pid = 0;
  {
    const Process killed({"sleep", "1000"});
    pid = killed.pid();
    EXPECT_FALSE(killed.has_descendants());
  }
  EXPECT_FALSE(lives(pid)) << "it ends with the object";
  Process bystander({"sleep", "1000"});
  EXPECT_TRUE(end_of("exit 0").good());
  EXPECT_FALSE(bystander.poll()) << "another one goes on";
}

TEST(Processes, OfTheirGroupNobodyStays) {
  std::string line;
  Process process(shell("env -i sleep 1000 & echo $!"), {.output = Stream::piped});
  ASSERT_TRUE(process.read_line(line, 20));
  EXPECT_TRUE(process.wait(20)->good());
  EXPECT_TRUE(ends(std::stoi(line)));
  kill(std::stoi(line), SIGKILL);
}

TEST(Processes, ASignalMeanwhileCutsNothingShort) {
  const Interruptions every_millisecond;
  Process process(shell("sleep 0.05; echo one; sleep 0.05; printf abc; sleep 0.05"),
                  {.output = Stream::piped});
  std::string got;
  ASSERT_TRUE(process.read_line(got, 20));
  EXPECT_EQ(got, "one");
  ASSERT_TRUE(process.read_bytes(got, 3, 20));
  EXPECT_EQ(got, "abc");
  const auto end = process.wait(20);
  EXPECT_TRUE(end && end->good());
  Process late(shell("sleep 0.05; exec cat >/dev/null"), {.input = Stream::piped});
  EXPECT_TRUE(late.write(std::string(1 << 20, 'x'), 20));
}

TEST(Processes, AnInterruptionOfBeforeIsNone) {
  Process process(shell("exit 3"));
  process.wait(0.001);  // errno is still that of an earlier call
  for (const char* script : {"exit 3", "sleep 0.02; exit 3"}) {
    Process other(shell(script));
    errno = EINTR;
    const auto end = other.wait(20);
    EXPECT_TRUE(end && end->exit_code == 3);
  }
  Process polled(shell("exit 4"));
  std::optional<ProcessEnd> end;
  for (const auto late = in_seconds(20); !end && seconds_until(late) > 0; usleep(1000)) {
    errno = EINTR;
    end = polled.poll();
  }
  EXPECT_TRUE(end && end->exit_code == 4);
}

TEST(Processes, HaveThisEnvironmentAndNoBlockedSignal) {
  const std::string marks = "env | grep ^" + descent() + "; grep SigBlk /proc/self/status";
  const std::string one = said(marks), other = said(marks);
  const auto number = [](const std::string& text) {
    EXPECT_TRUE(text.starts_with(descent())) << text;
    EXPECT_TRUE(text.ends_with("=\nSigBlk:\t0000000000000000\n")) << text;
    return std::stoi(text.substr(descent().size()));
  };
  EXPECT_EQ(number(other), number(one) + 1) << "each its own";
  EXPECT_EQ(descent(), "TAUT_PROCESS_" + std::to_string(getpid()) + "_");
  EXPECT_EQ(said("echo $PATH"), std::string(std::getenv("PATH")) + "\n");
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  EXPECT_FALSE(sigismember(&blocked, SIGTERM)) << "of this one neither";
}

TEST(Processes, HaveTheirMarkEvenInTheMiddleOfAnExec) {
  const std::string again = R"(exec sh -c "$0" "$0")";
  const Process process({"sh", "-c", again, again});
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(has_mark(process.pid(), descent())) << i;
}

TEST(Processes, AMarkIsHowAVariableBegins) {
  Process process({"env", "-i", "AB=1", "CD=2", "sleep", "1000"});
  const auto has = [&](const char* mark) { return has_mark(process.pid(), mark); };
  for (const auto late = in_seconds(20); !has("AB=1") && seconds_until(late) > 0;) usleep(1000);
  for (const char* mark : {"AB=1", "A", "CD=", "C"}) EXPECT_TRUE(has(mark)) << mark;
  for (const char* mark : {"B=1", "D", "AB=2", "1", "sleep"}) EXPECT_FALSE(has(mark)) << mark;
  EXPECT_FALSE(has_mark(std::numeric_limits<pid_t>::max(), "A")) << "there is no such process";
}

TEST(Processes, WhatTheySayOnStandardErrorIsAppendedToAFile) {
  const Scratch scratch;
  const auto file = scratch.path() / "errors";
  for (const char* script : {"echo one >&2", "echo two >&2; echo out"})
    EXPECT_TRUE(Process(shell(script), {.errors_file = file}).wait(20)->good());
  EXPECT_EQ(read_text(file), "one\ntwo\n");
  EXPECT_THROW(Process(shell("true"), {.errors_file = file / "none"}), InputError);
}

TEST(Processes, TheLastLineThatIsNotBlankIsWhatWasSaid) {
  const auto last = [](const std::string& text) { return last_line(std::istringstream(text)); };
  EXPECT_EQ(last("one\ntwo\n \t\r\n\n"), "two");
  EXPECT_EQ(last("one\ntwo"), "two");
  EXPECT_EQ(last(" \n"), "");
  EXPECT_EQ(last("x" + std::string(400, 'a')), "x" + std::string(299, 'a'));
}

TEST(ShellWords, AreQuotedWhereAShellWouldNotTakeThemAsTheyAre) {
  for (const char* plain : {"abc", "a-b_c=1:2,3./+@%", "Z9"}) EXPECT_EQ(shell_word(plain), plain);
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("a b"), "'a b'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  for (const std::string odd : {"$HOME `id` \"x\" \\ *", "a\nb", "'", "~", "a&b;c", "#x"})
    EXPECT_EQ(said("printf %s " + shell_word(odd)), odd);
}

TEST(ShellWords, AProgramIsOnThePathIfItMayRun) {
  const Scratch scratch;
  write_file(scratch.path() / "there", "#!/bin/sh\n");
  const std::string before = std::getenv("PATH");
  setenv("PATH", ("/no/such:" + scratch.path().string() + ":/also/none").c_str(), 1);
  EXPECT_FALSE(on_path("there")) << "it may not be run";
  std::filesystem::permissions(scratch.path() / "there", std::filesystem::perms::owner_all);
  EXPECT_TRUE(on_path("there"));
  EXPECT_FALSE(on_path("sh"));
  unsetenv("PATH");
  EXPECT_FALSE(on_path("there"));
  setenv("PATH", before.c_str(), 1);
}

TEST(Clocks, AFutureIsNeverBeforeItsStart) {
  const auto start = SteadyClock::now();
  EXPECT_NEAR(seconds_between(start, after(start, 2.5)), 2.5, 1e-9);
  EXPECT_EQ(after(start, -3), start);
  EXPECT_NEAR(seconds_until(in_seconds(3)), 3, 0.5);
  EXPECT_LT(seconds_since(in_seconds(3)), 0);
  const auto shown = [] {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  };
  for (int i = 0; i < 20; ++i, usleep(10000)) {  // lasts a fifth of a second
    const double before = shown(), between = seconds_of(CLOCK_MONOTONIC), now = shown();
    EXPECT_LE(before, between);
    EXPECT_LE(between, now);
  }
}

TEST(RunAll, CallsEachOnceAndNoneAfterAnException) {
  for (int jobs : {1, 3, 50}) {
    std::array<std::atomic<int>, 20> calls{};
    run_all(calls.size(), jobs, [&](std::size_t i) { ++calls[i]; });
    for (const std::atomic<int>& count : calls) EXPECT_EQ(count, 1);
  }
  int calls = 0;
  EXPECT_THROW(run_all(9, 1,
                       [&](std::size_t i) {
                         ++calls;
                         if (i == 2) throw InputError("no");
                       }),
               InputError);
  EXPECT_EQ(calls, 3);
  run_all(0, 4, [](std::size_t) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace taut::process_test
