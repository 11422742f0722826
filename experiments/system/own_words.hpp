#pragma once

/// Command-line words with which this program starts itself (some also start other builds of it).
/// Lower layers write them, and the verbs in experiments/cli read them.
namespace taut::own_words {

// `taut case SCENE SOLVER --into FOLDER`: a case in a process of its own
inline constexpr const char* kCase = "case";
inline constexpr const char* kInto = "--into";
inline constexpr const char* kFrames = "--frames";

// `taut bench --worker SCENE SOLVER`: samples of a case
inline constexpr const char* kBench = "bench";
inline constexpr const char* kWorker = "--worker";

// `taut verify TRUTH --here --json`: a truth in a process of its own
inline constexpr const char* kVerify = "verify";
inline constexpr const char* kHere = "--here";

// options of several verbs
inline constexpr const char* kSet = "--set";
inline constexpr const char* kSolver = "--solver";
inline constexpr const char* kJson = "--json";

/// Exit code of every verb for bad usage or input.
inline constexpr int kBadInputExit = 2;

}  // namespace taut::own_words
