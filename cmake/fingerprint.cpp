// Writes the file that identifies what produced a number: a digest for each solver, for each layer
// that has solvers, and for parts of the program such as the measurement. Keys of stored results
// contain these digests, so that a result is never taken for that of other code.
//
//   fingerprint OUT ROOT TOOLS FOLDER|... ... -- PART=FOLDER|... ...
//
// The folders before `--` are layers. A solver's digest is over its closure: its file, the files
// that it includes by `#include "`, and the sources of its layer that implement a header of these.
// A layer's digest is over all of its files. A part's digest is over the closure of its files, with
// the sources of ROOT/core that implement a header of these. TOOLS names compiler, flags and
// libraries. Comments and blank lines do not count; paths are relative to ROOT, so that clones
// agree. The build calls this program (cmake/fingerprint.cmake).
#include <openssl/evp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

std::string sha256(std::string_view bytes) {
  unsigned char hash[EVP_MAX_MD_SIZE];
  unsigned length = 0;
  if (!EVP_Digest(bytes.data(), bytes.size(), hash, &length, EVP_sha256(), nullptr))
    throw std::runtime_error("no SHA-256");
  std::string text;
  for (unsigned i = 0; i < length; ++i) {
    text += "0123456789abcdef"[hash[i] >> 4];
    text += "0123456789abcdef"[hash[i] & 15];
  }
  return text;
}

bool is_source(const fs::path& file) {
  return file.extension() == ".cpp" || file.extension() == ".hpp";
}

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// The code of a file: one blank for a comment or a run of blanks, none at the ends of a line or
/// inside of brackets, no empty line.
class Code {
 public:
  explicit Code(std::string_view text) : text_(text) {
    while (at_ < text_.size()) read();
    line_ends();
  }
  const std::string& text() const { return code_; }

 private:
  bool starts(std::string_view what) const { return text_.substr(at_).starts_with(what); }

  void read() {
    if (starts("//"))
      skip_line();
    else if (starts("/*"))
      skip_to("*/");
    else if (text_[at_] == '\n')
      line_ends();
    else if (text_[at_] == '"' && !code_.empty() && code_.back() == 'R')
      copy_raw();
    else if (text_[at_] == '"' || (text_[at_] == '\'' && !follows_word()))
      copy_literal(text_[at_]);
    else if (std::isspace(static_cast<unsigned char>(text_[at_]))) {
      blank_ = true;
      ++at_;
    } else
      put(text_[at_++]);
  }

  /// A quote behind a digit separates digits: 1'000.
  bool follows_word() const { return !code_.empty() && !blank_ && in_word(code_.back()); }

  void skip_line() {
    for (blank_ = true; at_ < text_.size() && text_[at_] != '\n'; ++at_)
      if (starts("\\\n")) ++at_;
  }
  void skip_to(std::string_view end) {
    const std::size_t found = text_.find(end, at_ + 2);
    at_ = found == text_.npos ? text_.size() : found + end.size();
    blank_ = true;
  }

  void put(char c) {
    constexpr std::string_view kOpens = "([{,;", kCloses = ")]},;";
    if (blank_ && !code_.empty() && code_.back() != '\n' &&
        kOpens.find(code_.back()) == kOpens.npos && kCloses.find(c) == kCloses.npos)
      code_ += ' ';
    blank_ = false;
    code_ += c;
  }
  void copy(std::size_t end) {
    put(text_[at_]);
    end = std::min(end, text_.size());
    code_ += text_.substr(at_ + 1, end - at_ - 1);
    at_ = end;
  }
  void copy_literal(char quote) {
    std::size_t end = at_ + 1;
    while (end < text_.size() && text_[end] != quote) end += text_[end] == '\\' ? 2 : 1;
    copy(end + 1);
  }
  void copy_raw() {
    const std::string_view mark = text_.substr(at_ + 1, text_.find('(', at_) - at_ - 1);
    const std::string end = ")" + std::string(mark) + "\"";
    copy(text_.find(end, at_) + end.size());
  }
  void line_ends() {
    if (!code_.empty() && code_.back() != '\n') code_ += '\n';
    blank_ = false;
    ++at_;
  }

  std::string_view text_;
  std::string code_;
  std::size_t at_ = 0;
  bool blank_ = false;
};

struct Source {
  std::string digest;
  std::vector<std::string> includes;  ///< by `#include "`
  std::vector<std::string> solvers;   ///< by TAUT_SOLVER(, as names
};

/// All sources that were asked for, each read once.
class Sources {
 public:
  explicit Sources(fs::path root) : root_(std::move(root)) {}

  const Source& of(const std::string& file) {
    const auto [at, is_new] = read_.try_emplace(file);
    if (is_new) at->second = read(file);
    return at->second;
  }
  /// Files in FOLDER|..., a path without its extension means both of its files.
  Names in(std::string_view folders) const {
    Names files;
    while (!folders.empty()) {
      const std::string_view folder = folders.substr(0, folders.find('|'));
      folders.remove_prefix(std::min(folder.size() + 1, folders.size()));
      for (const char* extension : {".cpp", ".hpp"})
        if (const std::string file = std::string(folder) + extension; fs::exists(root_ / file))
          files.insert(file);
      if (!fs::is_directory(root_ / folder)) continue;
      for (const auto& entry : fs::recursive_directory_iterator(root_ / folder))
        if (entry.is_regular_file())
          files.insert(fs::relative(entry.path(), root_).generic_string());
    }
    return files;
  }

 private:
  Source read(const std::string& file) const {
    std::ifstream in(root_ / file, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + file);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    if (!is_source(file)) return {sha256(bytes), {}, {}};
    const Code code(bytes);
    return {sha256(code.text()), quoted(code.text(), "#include \"", "\""),
            quoted(code.text(), "TAUT_SOLVER(", ")")};
  }
  /// The texts between `before` and `after` on the lines that begin with `before`.
  static std::vector<std::string> quoted(std::string_view code, std::string_view before,
                                         std::string_view after) {
    std::vector<std::string> all;
    while (!code.empty()) {
      std::string_view line = code.substr(0, code.find('\n'));
      code.remove_prefix(std::min(line.size() + 1, code.size()));
      if (!line.starts_with(before)) continue;
      line.remove_prefix(before.size());
      all.emplace_back(line.substr(0, line.find(after)));
    }
    return all;
  }

  fs::path root_;
  std::map<std::string, Source> read_;
};

/// Adds a file and all files that it includes, directly or through others.
void add_with_includes(Sources& sources, const std::string& file, Names& files) {
  if (!files.insert(file).second) return;
  for (const std::string& header : sources.of(file).includes)
    add_with_includes(sources, header, files);
}

std::string folder_of(const std::string& file) { return fs::path(file).parent_path().string(); }

/// Whether a source of `layer` implements one of these files: the header of its own name or, if it
/// has none and is no solver itself, a header of its folder that it includes, be it through others.
bool implements_one(Sources& sources, const Names& layer, const std::string& source,
                    const Names& files) {
  const std::string own = source.substr(0, source.size() - 4) + ".hpp";
  if (layer.contains(own)) return files.contains(own);
  if (!sources.of(source).solvers.empty()) return false;
  Names included;
  add_with_includes(sources, source, included);
  return std::ranges::any_of(included, [&](const std::string& header) {
    return header.ends_with(".hpp") && folder_of(header) == folder_of(source) &&
           files.contains(header);
  });
}

/// These files, what they include, and the sources of `layer` that implement a header of these.
Names closure_of(Sources& sources, const Names& layer, const Names& roots) {
  Names files;
  for (const std::string& file : roots) add_with_includes(sources, file, files);
  for (std::size_t before = 0; before < files.size();) {
    before = files.size();
    for (const std::string& source : layer)
      if (source.ends_with(".cpp") && implements_one(sources, layer, source, files))
        add_with_includes(sources, source, files);
  }
  return files;
}

std::string digest_of(Sources& sources, const Names& files, const std::string& tools) {
  std::string text = tools + "\n";
  for (const std::string& file : files) text += file + " " + sources.of(file).digest + "\n";
  return sha256(text);
}

/// The name for an identifier: underscores become hyphens.
std::string name_of(std::string identifier) {
  std::ranges::replace(identifier, '_', '-');
  return identifier;
}

/// A line of a generated function that looks a solver up by its name.
std::string line_of(const std::string& solver, const std::string& digest) {
  return "  if (solver == \"" + solver + "\") return \"" + digest + "\";\n";
}

/// Lines of the two functions about solvers.
struct OfSolvers {
  std::string solvers, layers;
};

OfSolvers print_solvers(Sources& sources, const std::string& tools,
                        const std::vector<std::string>& layers) {
  OfSolvers made;
  for (const std::string& folders : layers) {
    const Names files = sources.in(folders);
    const std::string digest = digest_of(sources, files, tools);
    for (const std::string& file : files)
      for (const std::string& identifier : sources.of(file).solvers) {
        if (!file.ends_with(".cpp")) continue;  // the definition of TAUT_SOLVER
        const std::string name = name_of(identifier);
        const Names closure = closure_of(sources, files, {file});
        made.solvers += line_of(name, digest_of(sources, closure, tools));
        made.layers += line_of(name, digest);
      }
  }
  return made;
}

/// A function for each part, named like the part.
std::string print_parts(Sources& sources, const std::string& tools,
                        const std::vector<std::string>& parts) {
  std::string made;
  for (const std::string& part : parts) {
    const std::size_t equals = part.find('=');
    if (equals == part.npos) throw std::runtime_error("no PART=FOLDERS: " + part);
    const Names files = sources.in(std::string_view(part).substr(equals + 1));
    if (files.empty()) throw std::runtime_error("no files: " + part);
    Names candidates = sources.in("core");
    candidates.insert(files.begin(), files.end());
    made += "std::string_view " + part.substr(0, equals) + "() { return \"" +
            digest_of(sources, closure_of(sources, candidates, files), tools) + "\"; }\n\n";
  }
  return made;
}

std::string generated(const OfSolvers& made, const std::string& parts, const std::string& tools) {
  return "// Generated by cmake/fingerprint.cpp.\n#include \"experiments/case/fingerprint.hpp\"\n\n"
         "namespace taut {\n\n"
         "std::string_view implementation(std::string_view solver) {\n" +
         made.solvers +
         "  return {};\n}\n\n"
         "std::string_view layer_digest(std::string_view solver) {\n" +
         made.layers + "  return {};\n}\n\n" + parts +
         "std::string_view toolchain() { return R\"(" + tools + ")\"; }\n\n}  // namespace taut\n";
}

bool has_text(const std::string& file, const std::string& text) {
  std::ifstream in(file, std::ios::binary);
  return in && std::string(std::istreambuf_iterator<char>(in), {}) == text;
}

}  // namespace

int main(int count, char** words) try {
  const std::vector<std::string> given(words, words + count);
  const auto end_of_layers = std::ranges::find(given, "--");
  if (end_of_layers - given.begin() < 5 || end_of_layers == given.end())
    throw std::runtime_error("usage: fingerprint OUT ROOT TOOLS FOLDERS... -- PART=FOLDERS...");
  const std::string &out = given[1], &tools = given[3];
  Sources sources(given[2]);
  const OfSolvers made = print_solvers(sources, tools, {given.begin() + 4, end_of_layers});
  const std::string parts = print_parts(sources, tools, {end_of_layers + 1, given.end()});
  const std::string text = generated(made, parts, tools);
  if (has_text(out, text)) return 0;  // what is made of it stays up to date
  std::ofstream file(out, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error("cannot write " + out);
  return 0;
} catch (const std::exception& error) {
  std::cerr << "fingerprint: " << error.what() << '\n';
  return 1;
}
