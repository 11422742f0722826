#include "experiments/external/connection.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/json.hpp"

namespace taut::external {

namespace fs = std::filesystem;

std::string Command::text() const { return join(words, " ", shell_word); }

namespace {

/// Splits a command into words as a POSIX shell would, with quotes, `~` and `$NAME`, but expands no
/// file name patterns and runs nothing. The value of a variable stays one word.
class Splitter {
 public:
  explicit Splitter(const std::string& text) : text_(text) {}

  std::vector<std::string> words() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (quote_ != '\'' && c == '\\' && at_ + 1 < text_.size())
        escaped();
      else if (quote_ != '\'' && (c == '$' || c == '`'))
        variable();
      else if (c == quote_)
        quote_ = 0;
      else if (quote_ != 0)
        add(c);
      else if (c == '\'' || c == '"') {
        quote_ = c;
        begun_ = true;
      } else if (c == ' ' || c == '\t')
        end_word();
      else if (std::string_view("\n|&;<>(){}").find(c) != std::string_view::npos)
        refuse();
      else if (c == '~' && !begun_ &&
               (at_ + 1 == text_.size() || std::strchr("/ \t", text_[at_ + 1])))
        add(value_of("HOME"));
      else
        add(c);
    }
    if (quote_ != 0) throw InputError("cmd='" + text_ + "': a quote is not closed");
    end_word();
    return std::move(words_);
  }

 private:
  void add(char c) {
    word_ += c;
    begun_ = true;
  }
  void add(const std::string& text) {
    word_ += text;
    begun_ = begun_ || !text.empty();
  }
  void end_word() {
    if (begun_) words_.push_back(std::exchange(word_, {}));
    begun_ = false;
  }
  void escaped() {
    const char next = text_[++at_];
    if (quote_ == '"' && !std::strchr("$`\"\\", next)) add('\\');
    add(next);
  }
  void variable() {
    const bool braces = text_.compare(at_, 2, "${") == 0;
    std::size_t end = at_ + (braces ? 2 : 1);
    const std::size_t begin = end;
    while (end < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[end])) || text_[end] == '_'))
      ++end;
    if (text_[at_] == '`' || end == begin || (braces && (end == text_.size() || text_[end] != '}')))
      refuse();
    add(value_of(text_.substr(begin, end - begin)));
    at_ = braces ? end : end - 1;
  }
  [[noreturn]] void refuse() const {
    throw InputError("cmd='" + text_ +
                     "': no shell runs it; put | & ; < > ( ) { } $( ) in a script");
  }
  static std::string value_of(const std::string& name) {
    const char* value = std::getenv(name.c_str());
    return value ? value : "";
  }

  const std::string& text_;
  std::size_t at_ = 0;
  char quote_ = 0;      ///< the open quote; 0: none
  bool begun_ = false;  ///< a word has begun, which may be empty in quotes
  std::string word_;
  std::vector<std::string> words_;
};

}  // namespace

Command split_command(const std::string& text, const fs::path& folder) {
  Command command;
  command.folder = folder;
  command.words = Splitter(text).words();
  if (command.words.empty()) throw InputError("cmd='" + text + "' names no program");
  const std::string& program = command.words.front();
  const bool there =
      program.find('/') != program.npos ? fs::exists(folder / program) : on_path(program);
  if (!there) throw InputError("cmd='" + text + "': no program '" + program + "'");
  return command;
}

namespace {

bool allowed(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; }

constexpr std::size_t kLongestLine = 1 << 20, kLog = 4000;
/// Limit on the program's standard error.
constexpr std::size_t kMostErrors = std::size_t{64} << 20;

/// The beginning of an output, for a message: one line of visible characters.
std::string excerpt(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 200))
    shown += c >= 0x20 && c < 0x7f ? c : c == '\n' ? ' ' : '?';
  return "'" + shown + (text.size() > 200 ? "..." : "") + "'";
}

ProcessOptions options(const Command& command, const fs::path& errors) {
  using Stream = ProcessOptions::Stream;
  return {.input = Stream::piped,
          .output = Stream::piped,
          .errors_file = errors,
          .folder = command.folder,
          .limits = {.file_bytes = kMostErrors}};
}

/// Whether a log reports that memory ran out. Each language words it differently.
bool names_memory(const std::string& log) {
  for (const char* word : {"MemoryError", "bad_alloc", "out of memory", "Cannot allocate memory"})
    if (log.find(word) != log.npos) return true;
  return false;
}

}  // namespace

bool is_solver_name(std::string_view text) {
  return !text.empty() && text.size() <= 40 && std::isalpha(static_cast<unsigned char>(text[0])) &&
         std::ranges::all_of(text, allowed);
}

std::string name_for(std::string_view called, std::string_view told_by) {
  std::string name(called.substr(0, 30));
  std::ranges::replace_if(
      name, [](char c) { return !allowed(c); }, '-');
  if (!is_solver_name(name)) name = ("external" + name).substr(0, 30);
  return name + "-" + sha256(std::string(told_by)).substr(0, 4);
}

Connection::Connection(Command command)
    : command_(std::move(command)),
      process_(command_.words, options(command_, scratch_.path() / "stderr.txt")) {}

std::string Connection::log() const {
  std::ifstream in(scratch_.path() / "stderr.txt", std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::size_t>(std::max<std::streamoff>(0, in.tellg()));
  std::string text(std::min(size, kLog), '\0');
  in.seekg(static_cast<std::streamoff>(size - text.size()));
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

void Connection::fail(Status::Kind status, const std::string& reason) {
  process_.wait(0);  // also kills all processes that it started
  throw SolverFailure(status, reason, log());
}

void Connection::ended() {
  const auto end = process_.wait(1);
  const std::string during = " during '" + op_ + "'", said = last_line(std::istringstream(log()));
  const std::string why = said.empty() ? "" : ": " + said;
  if (!end) fail(Status::Kind::protocol, "closed its standard output" + during);
  if (end->signal == SIGXCPU) fail(Status::Kind::timeout, "CPU time");
  rlimit memory{};
  getrlimit(RLIMIT_DATA, &memory);
  const auto most = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
                    static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  if (end->from_outside(std::min<std::size_t>(most, memory.rlim_cur)))
    throw EndedFromOutside("the solver's program was ended (" + end->text() +
                           ") from outside; no result of its case is stored");
  if (end->signal == SIGKILL) fail(Status::Kind::oom, "killed by the system" + during);
  if (names_memory(log())) fail(Status::Kind::oom, "out of memory" + during + why);
  fail(Status::Kind::crash, end->text() + during + why);
}

void Connection::silent(SteadyClock::time_point deadline) {
  if (SteadyClock::now() < deadline) ended();
  const std::size_t some = process_.unread().size();
  fail(Status::Kind::timeout, "no answer to '" + op_ + "' within " + shortest(command_.seconds) +
                                  " s" +
                                  (some == 0 ? "" : ", only " + std::to_string(some) + " bytes"));
}

std::string Connection::take_line() {
  const auto deadline = in_seconds(command_.seconds);
  std::string line;
  if (process_.read_line(line, command_.seconds, kLongestLine)) return line;
  if (process_.unread().size() > kLongestLine)
    fail(Status::Kind::protocol, "answered '" + op_ + "' with more than " +
                                     std::to_string(kLongestLine) +
                                     " bytes without a line feed: " + excerpt(process_.unread()));
  silent(deadline);
}

std::string Connection::take(std::size_t bytes) {
  const auto deadline = in_seconds(command_.seconds);
  std::string taken;
  if (!process_.read_bytes(taken, bytes, command_.seconds)) silent(deadline);
  return taken;
}

void Connection::send(const std::string& line, std::string_view bytes) {
  if (!process_.unread().empty())
    fail(Status::Kind::protocol,
         "sent output that was not requested, after '" + op_ + "': " + excerpt(process_.unread()));
  for (const std::string_view part : {std::string_view(line), bytes})
    if (!process_.write(part, command_.seconds)) {
      if (process_.poll()) ended();
      fail(Status::Kind::timeout,
           "did not read its input within " + shortest(command_.seconds) + " s");
    }
}

Json parse_answer(const std::string& line) {
  try {
    Json answer = parse_json(line);
    if (answer.is_object()) return answer;
  } catch (const Json::exception&) {
  }
  throw InputError("not a JSON object: " + excerpt(line));
}

Json Connection::answer() {
  const std::string said = take_line();
  // Counted from the first answer, because a script may exec the program before it.
  if (ticks_at_start_ < 0) ticks_at_start_ = children_ticks();
  try {
    return parse_answer(said);
  } catch (const InputError& error) {
    fail(Status::Kind::protocol, "answer to '" + op_ + "': " + error.what());
  }
}

Json Connection::ask_line(const std::string& line) {
  op_ = line.substr(0, 60);
  send(line + "\n", {});
  return answer();
}

Json Connection::ask(const Json& request, std::string_view bytes) {
  op_ = request.at("op").get<std::string>();
  send(to_text(request) + "\n", bytes);
  Json answer = this->answer();
  const auto error = answer.find("error");
  if (error == answer.end()) return answer;
  const std::string why = error->is_string() ? error->get<std::string>() : to_text(*error);
  fail(names_memory(why) ? Status::Kind::oom : Status::Kind::error,
       "refused '" + op_ + "': " + why.substr(0, 500));
}

double Connection::cpu_seconds() const {
  clockid_t clock{};
  return clock_getcpuclockid(process_.pid(), &clock) == 0 ? seconds_of(clock) : std::nan("");
}

std::size_t Connection::peak_bytes() const {
  std::ifstream in("/proc/" + std::to_string(process_.pid()) + "/status");
  for (std::string word; in >> word;)
    if (word == "VmHWM:" && in >> word) return 1024 * whole<std::size_t>(word).value_or(0);
  return 0;
}

long Connection::children_ticks() const {
  std::ifstream in("/proc/" + std::to_string(process_.pid()) + "/stat");
  std::string text;
  std::getline(in, text);
  std::istringstream fields(text.substr(std::min(text.rfind(')') + 1, text.size())));
  std::string skipped;
  for (int i = 3; i < 16; ++i) fields >> skipped;  // proc(5): cutime is field 16, cstime 17
  std::string user, system;
  fields >> user >> system;
  return whole<long>(user).value_or(0) + whole<long>(system).value_or(0);
}

bool Connection::has_helpers() const {
  return children_ticks() > ticks_at_start_ || process_.has_descendants();
}

std::optional<ProcessEnd> Connection::close(double seconds) {
  process_.close_input();
  return process_.wait(seconds);
}

}  // namespace taut::external
