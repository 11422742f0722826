#include <csignal>
#include <system_error>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/parser.hpp"
#include "experiments/command_line/streams.hpp"
#include "experiments/command_line/verb.hpp"

namespace taut {

namespace {

const VerbEntry* find_verb(const std::string& name) {
  const auto found = std::ranges::find(verbs(), name, &VerbEntry::name);
  return found == verbs().end() ? nullptr : *found;
}

}  // namespace

int command_line(int argc, char** argv) {
  open_standard_descriptors();
  const PrintableErrors printable_errors;
  std::signal(SIGXFSZ, SIG_IGN);  // writes beyond a file size limit then fail and are reported
  if (argc > 1 && argv[1][0] != '-' && !find_verb(argv[1])) {
    std::vector<std::string> names;
    for (const VerbEntry* verb : verbs()) names.emplace_back(verb->name);
    std::cerr << "unknown verb '" << argv[1] << "'" << suggestion(argv[1], names)
              << " (`taut --help` names all)\n";
    return kUsage;
  }
  try {
    return parse_and_run(argc, argv);
  } catch (const Interrupted&) {
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    std::cerr << "out of memory\n";
  } catch (const InputError& error) {
    std::cerr << error.what() << '\n';
  } catch (const SolverFailure& failure) {
    std::cerr << to_string(failure.status) << ": " << failure.what() << '\n' << failure.log;
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << error.path1().string() << ": " << error.code().message() << '\n';
  } catch (const std::system_error& error) {  // for example, if a thread cannot be started
    std::cerr << error.what() << '\n';
  } catch (const std::exception& error) {
    std::cerr << "taut" << (argc > 1 ? std::string(" ") + argv[1] : "")
              << ": what was not foreseen: " << error.what() << '\n';
  }
  return kUsage;
}

}  // namespace taut
