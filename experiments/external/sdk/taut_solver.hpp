// The protocol taut-solver for C++17, without dependencies: copy this file beside your solver.
//
//     struct Mine {
//       using Json = taut_solver::Json;
//       // The answer to "hello", without its protocol.
//       static constexpr const char* kAbout =
//           R"("name": "mine", "version": "1.0", "params": {"iterations":
//              {"type": "integer", "min": 1, "max": 1000, "default": 8, "doc": "Sweeps"}})";
//       // Optional: the newest protocol that it knows; newer scenes are then not sent to it.
//       // "taut-solver/1" (the default): rigid links; planes, balls and boxes. /2: also elastic
//       // links, bending, capsules, seams, pins that let go. /3: also bodies of triangles. /4:
//       // also bodies that deform. /5: also a membrane. /6: also damping of
//       // links and of the membrane.
//       static constexpr const char* kProtocol = "taut-solver/2";
//       // Reasons why the scene would be misread; empty if it is read correctly.
//       static std::vector<std::string> cannot(const Json& scene, const Json& params);
//       Mine(const Json& scene, const Json& params);  // scene["dt"].number, ...
//       void load(const double* x, const double* v);  // start here: 3n [m] and 3n [m/s]
//       void step(double t, double dt);               // advance from t to t + dt [s]
//       void store(double* x, double* v) const;       // 3n each
//       // "", or further members of the answer to "scene" (plan, settings), after a comma.
//       std::string extras() const;
//     };
//     int main() { return taut_solver::serve<Mine>(); }
//
// Change the version with every change that alters results. Standard output belongs to the
// protocol: print to standard error. MIT licence, as taut.
#pragma once

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iostream>
#include <locale>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <type_traits>
#include <vector>

namespace taut_solver {

/// A JSON value, as in scene files and requests.
struct Json {
  enum class Kind { null, boolean, number, text, array, object } kind = Kind::null;
  double number = 0;  ///< 1 for true
  std::string text;
  std::vector<Json> items;
  std::map<std::string, Json> members;

  const Json& operator[](const std::string& key) const {
    const auto at = members.find(key);
    if (at == members.end()) throw std::runtime_error("no key '" + key + "'");
    return at->second;
  }
  const Json& operator[](std::size_t i) const { return items.at(i); }
  std::size_t size() const { return items.size(); }
  int integer() const { return static_cast<int>(number); }
  /// False for null, false, 0, "" and [].
  bool something() const {
    return number != 0 || !text.empty() || !items.empty() || !members.empty();
  }
  std::vector<double> numbers() const {
    std::vector<double> all;
    for (const Json& item : items) all.push_back(item.number);
    return all;
  }
};

/// Reads one value. Throws std::runtime_error if the text is not exactly one value.
class JsonParser {
 public:
  static Json parse(const std::string& text) {
    JsonParser parser(text);
    Json value = parser.value(0);
    if (parser.next() != '\0') parser.fail();
    return value;
  }

 private:
  explicit JsonParser(const std::string& text)
      : text_(text), at_(text_.c_str()), end_(at_ + text_.size()) {}
  [[noreturn]] static void fail() { throw std::runtime_error("no JSON"); }
  char next() {
    while (*at_ == ' ' || *at_ == '\n' || *at_ == '\t' || *at_ == '\r') ++at_;
    return *at_;
  }
  bool accept(char c) { return next() == c && ++at_; }
  void expect(const char* word) {
    for (; *word; ++word, ++at_)
      if (*at_ != *word) fail();
  }

  Json value(int depth) {
    if (depth > 100) fail();
    Json v;
    switch (next()) {
      case '{':
        ++at_;
        v.kind = Json::Kind::object;
        if (accept('}')) return v;
        do {
          next();
          const std::string key = string();
          if (!accept(':')) fail();
          v.members[key] = value(depth + 1);
        } while (accept(','));
        if (!accept('}')) fail();
        return v;
      case '[':
        ++at_;
        v.kind = Json::Kind::array;
        if (accept(']')) return v;
        do v.items.push_back(value(depth + 1));
        while (accept(','));
        if (!accept(']')) fail();
        return v;
      case '"':
        v.kind = Json::Kind::text;
        v.text = string();
        return v;
      case 't':
        expect("true");
        v.kind = Json::Kind::boolean;
        v.number = 1;
        return v;
      case 'f':
        expect("false");
        v.kind = Json::Kind::boolean;
        return v;
      case 'n':
        expect("null");
        return v;
      default: {
        // Not strtod(): a library may have set a locale with a decimal comma.
        const auto [end, error] = std::from_chars(at_, end_, v.number);
        v.kind = Json::Kind::number;
        if (error != std::errc()) fail();
        at_ = end;
        return v;
      }
    }
  }

  std::string string() {
    if (*at_++ != '"') fail();
    std::string s;
    for (; *at_ != '"'; ++at_) {
      if (*at_ == '\0') fail();
      if (*at_ != '\\') {
        s += *at_;
        continue;
      }
      switch (*++at_) {
        case 'n':
          s += '\n';
          break;
        case 't':
          s += '\t';
          break;
        case 'r':
          s += '\r';
          break;
        case 'b':
          s += '\b';
          break;
        case 'f':
          s += '\f';
          break;
        case 'u':  // characters outside ASCII are not needed
          for (int k = 0; k < 4; ++k)
            if (*++at_ == '\0') fail();
          s += '?';
          break;
        case '\0':
          fail();
        default:
          s += *at_;
      }
    }
    ++at_;
    return s;
  }

  std::string text_;
  const char *at_, *end_;
};

inline std::string json_text(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') all += '\\';
    all += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return all + '"';
}

template <class Solver, class = void>
struct StatesProtocol : std::false_type {};
template <class Solver>
struct StatesProtocol<Solver, std::void_t<decltype(Solver::kProtocol)>> : std::true_type {};
template <class Solver>
std::string protocol_of() {
  if constexpr (StatesProtocol<Solver>::value)
    return Solver::kProtocol;
  else
    return "taut-solver/1";
}

/// Answers requests until the input ends.
template <class Solver>
int serve() {
  std::unique_ptr<Solver> live;
  std::size_t n = 0;
  std::vector<double> state;
  const auto cpu = [] {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
  };
  const auto answer_to = [&](const Json& request, bool& with_state) -> std::string {
    const std::string& op = request["op"].text;
    if (op == "hello")
      return R"({"protocol": ")" + std::string(protocol_of<Solver>()) + R"(", )" +
             std::string(Solver::kAbout) + "}";
    if (op == "scene") {
      std::ifstream file(request["file"].text, std::ios::binary);
      if (!file) throw std::runtime_error("cannot read " + request["file"].text);
      std::ostringstream content;
      content.imbue(std::locale::classic());
      content << file.rdbuf();
      const Json scene = JsonParser::parse(content.str());
      std::string reasons;
      for (const std::string& reason : Solver::cannot(scene, request["params"]))
        reasons += (reasons.empty() ? "" : ", ") + json_text(reason);
      if (!reasons.empty()) return R"({"cannot": [)" + reasons + "]}";
      live = std::make_unique<Solver>(scene, request["params"]);
      n = static_cast<std::size_t>(scene["vertices"].integer());
      state.assign(6 * n, 0);
      return R"({"vertices": )" + std::to_string(n) + live->extras() + "}";
    }
    if (op != "load" && op != "step" && op != "store") throw std::runtime_error("unknown op " + op);
    if (op == "load") {
      std::string bytes(static_cast<std::size_t>(request["bytes"].number), '\0');
      std::cin.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      if (bytes.size() != state.size() * sizeof(double))
        throw std::runtime_error("the state has another size");
      std::memcpy(state.data(), bytes.data(), bytes.size());
    }
    if (!live) throw std::runtime_error("no scene yet");
    if (op == "load") {
      live->load(state.data(), state.data() + 3 * n);
      return "{}";
    }
    if (op == "step") {
      const double before = cpu(), t = request["t"].number, dt = request["dt"].number;
      for (int k = 0; k < request["count"].integer(); ++k) live->step(t + k * dt, dt);
      return R"({"cpu_ns": )" + std::to_string(cpu() - before) + "}";
    }
    live->store(state.data(), state.data() + 3 * n);
    with_state = true;
    return R"({"bytes": )" + std::to_string(state.size() * sizeof(double)) + "}";
  };
  for (std::string line; std::getline(std::cin, line);) {
    bool with_state = false;
    std::string answer;
    try {
      answer = answer_to(JsonParser::parse(line), with_state);
    } catch (const std::exception& error) {
      answer = R"({"error": )" + json_text(error.what()) + "}";
    }
    for (char& c : answer)
      if (c == '\n') c = ' ';  // an answer is one line
    answer += '\n';
    std::fwrite(answer.data(), 1, answer.size(), stdout);
    if (with_state) std::fwrite(state.data(), sizeof(double), state.size(), stdout);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace taut_solver
