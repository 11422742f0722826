#include "experiments/timing/beside.hpp"

#include <cmath>
#include <cstdlib>

#include "core/model/text.hpp"
#include "experiments/beside/beside.hpp"
#include "experiments/case/case.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

namespace {

constexpr double kLongestBuild = 600, kLongestAnswer = 120;  // s

/// Public code for a method that we have as well.
struct PublicCode {
  std::string_view name, adapter;
  std::string_view mark;  ///< a file that only its checkout has
  /// Include folders in the checkout, "a|b"; "." is the checkout itself.
  std::string_view includes;
  std::string_view sources;     ///< files of the checkout to compile with the adapter, "a|b"
  std::string_view ours;        ///< our solver of the method, with the same stiffness
  std::string_view differs;     ///< how it differs from ours
  std::string_view flags = "";  ///< additional compiler flags, "a|b"
};

constexpr PublicCode kKnown[] = {
    {"TinyVBD", "tiny_vbd.cpp", "Strand.h", ".", "", "vbd:substeps=1,precision=float",
     "float, a vertex after the other in their order; each 3 x 3 system by a QR factor with "
     "pivots; one corner is held, not two"},
    {"ShapeOp", "shapeop.cpp", "libShapeOp/src/Solver.h", "libShapeOp/src", "",
     "pd:substeps=1,precision=double",
     "double, a virtual call for each constraint; a simplicial factor, solved for x, y and z one "
     "after the other; pins are stiff constraints"},
    {"FastMassSpring", "fast_mass_spring.cpp", "ClothApp/MassSpringSolver.h", ".",
     "ClothApp/MassSpringSolver.cpp", "pd:substeps=1,precision=float",
     "float, one factor of x, y and z together, three times as large; its pins are put back after "
     "the step"},
    {"PositionBasedDynamics", "position_based_dynamics.cpp", "PositionBasedDynamics/XPBD.h", ".",
     "PositionBasedDynamics/XPBD.cpp|PositionBasedDynamics/PositionBasedDynamics.cpp|"
     "PositionBasedDynamics/MathFunctions.cpp",
     "xpbd:substeps=1,precision=float,structural=0.0001,shear=0.0001",
     "float, its projection called link after link in their order; without its own controller, "
     "which adds virtual calls"},
    {"avbd-demo3d", "avbd_demo3d.cpp", "source/manifold.cpp", "source",
     "source/collide.cpp|source/force.cpp|source/joint.cpp|source/manifold.cpp|source/rigid.cpp|"
     "source/sim_world.cpp|source/solver.cpp|source/spring.cpp",
     "avbd:substeps=1,precision=float",
     "float, rigid bodies that turn: six unknowns each; lists of pointers and virtual calls; its "
     "springs have no multiplier"},
    {"admm-elastic", "admm_elastic.cpp", "src/SpringEnergyTerm.hpp",
     "src|deps/mclscene/include|deps/mcloptlib/include", "src/Solver.cpp|src/ExplicitForce.cpp",
     "admm:substeps=1,precision=double",
     "double, a virtual call and allocations for each term; one factor of x, y and z "
     "together, "
     "three times as large; links and stiff pins are terms of ours",
     "-fopenmp"}};

const PublicCode& known(const std::filesystem::path& checkout) {
  for (const PublicCode& one : kKnown)
    if (std::filesystem::exists(checkout / one.mark)) return one;
  throw InputError(checkout.string() + ": no adapter knows this checkout: " +
                   join(kKnown, ", ", [](const PublicCode& one) {
                     return std::string(one.name) + " (which has " + std::string(one.mark) + ")";
                   }));
}

/// Output of a command. If it fails, throws InputError with the end of the output.
std::string output_of(std::vector<std::string> words, double seconds, const std::string& what) {
  Process process(std::move(words), {.output = ProcessOptions::Stream::piped,
                                     .errors = ProcessOptions::Stream::piped});
  const std::string said = process.read_all(seconds);
  const auto end = process.wait(seconds);
  if (end && end->good()) return said;
  throw InputError(what + " failed" + (end ? ": " + end->text() : "") + "\n" +
                   said.substr(said.size() > 2000 ? said.size() - 2000 : 0));
}

/// Commit and date of the checkout; "" if it is not a git repository.
std::string version(const std::filesystem::path& checkout) {
  try {
    const std::string said =
        output_of({"git", "-C", checkout.string(), "log", "-1", "--format=%h, %cs"}, 10, "git log");
    return said.substr(0, said.find('\n'));
  } catch (const InputError&) {
    return "";
  }
}

void build(const PublicCode& code, const std::filesystem::path& checkout,
           const std::filesystem::path& program) {
  const char* compiler = std::getenv("CXX");
  const std::filesystem::path data = data_folder();
  std::vector<std::string> words{compiler && *compiler ? compiler : "c++",
                                 "-std=c++17",
                                 "-O3",
                                 "-march=native",
                                 "-DNDEBUG",
                                 "-w",
                                 "-I" + (data / "beside").string(),
                                 "-I" + (data / "beside" / "linux").string(),
                                 "-isystem",
                                 "/usr/include/eigen3"};
  for (const std::string& flag : parts_of(code.flags)) words.push_back(flag);
  for (const std::string& folder : parts_of(code.includes))
    words.push_back("-I" + (checkout / folder).string());
  words.push_back((data / "beside" / code.adapter).string());
  for (const std::string& file : parts_of(code.sources))
    words.push_back((checkout / file).string());
  words.insert(words.end(), {"-o", program.string()});
  output_of(words, kLongestBuild, "the build of " + std::string(code.adapter));
}

/// Our solver on the same net, with few and with many iterations per step.
class OurSheet {
 public:
  explicit OurSheet(const std::string& solver)
      : few_(make(solver, beside::kFew)), many_(make(solver, beside::kMany)) {}
  double iteration() {
    return beside::iteration([this] { step(few_); }, [this] { step(many_); });
  }

 private:
  struct Running {
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Solver> solver;
    int steps = 0;
  };
  static Running make(const std::string& solver, int iterations) {
    const std::string side = std::to_string(beside::Net::kSide);
    const Case one = make_case({"hang",
                                {"cloth.grid=[" + side + ", " + side + "]"},
                                with(solver, "iterations=" + std::to_string(iterations))});
    Running running{one.scene, one.choice.entry->make(*one.scene, one.choice.params)};
    running.solver->load(one.scene->start);
    return running;
  }
  static void step(Running& one) { one.solver->step(one.steps++ * one.scene->dt, one.scene->dt); }

  Running few_, many_;
};

/// A running adapter.
class Adapter {
 public:
  explicit Adapter(const std::filesystem::path& program)
      : process_({program.string()}, {.input = ProcessOptions::Stream::piped,
                                      .output = ProcessOptions::Stream::piped}) {}
  /// ns per iteration and vertex. Throws InputError if it does not answer or its net does not fall.
  double iteration() {
    std::string line;
    if (!process_.write("\n", kLongestAnswer) || !process_.read_line(line, kLongestAnswer))
      throw InputError("the adapter ended without an answer");
    const std::vector<std::string> words = parts_of(line, ' ');
    const auto number = [&](std::size_t k) {
      return k < words.size() ? whole<double>(words[k]).value_or(std::nan("")) : std::nan("");
    };
    const double each = number(0), lowest = number(1);
    if (!std::isfinite(each) || !std::isfinite(lowest) || lowest > -0.5)
      throw InputError("the adapter's net does not hang: '" + line + "'");
    return each;
  }

 private:
  Process process_;
};

}  // namespace

Answer bench_beside(const std::filesystem::path& checkout, int rounds) {
  const PublicCode& code = known(checkout);
  const Scratch scratch;
  const std::filesystem::path program = scratch.path() / "adapter";
  build(code, std::filesystem::absolute(checkout), program);
  Adapter theirs(program);
  OurSheet ours{std::string(code.ours)}, jakobsen("jakobsen:substeps=1,order=coloured");
  std::vector<double> of_theirs, of_ours, of_jakobsen;
  for (int i = 0; i < rounds; ++i) {
    of_theirs.push_back(theirs.iteration());
    of_ours.push_back(ours.iteration());
    of_jakobsen.push_back(jakobsen.iteration());
  }
  const std::string checked_out = version(checkout);
  const double their = median(of_theirs), our = median(of_ours), sweep = median(of_jakobsen);
  Answer answer{"bench beside", std::string(code.name) + (checked_out.empty() ? "" : ", ") +
                                    checked_out + ": an iteration on a net of " +
                                    std::to_string(beside::Net::kSide) + " x " +
                                    std::to_string(beside::Net::kSide)};
  const Unit nanoseconds{Unit::Kind::time, "s", "ns", 1e9};
  Table table{"iterations",
              "an iteration for each vertex",
              {{"code"},
               {"each", "an iteration and vertex", nanoseconds, 2},
               {"sweeps", "over a sweep of Jakobsen's", kNumber, 2},
               {"differs", ""}}};
  const std::string named =
      std::string(code.name) + (checked_out.empty() ? "" : ", ") + checked_out;
  table.rows.push_back({named, 1e-9 * their, their / sweep, std::string(code.differs)});
  table.rows.push_back({"taut " + std::string(code.ours), 1e-9 * our, our / sweep, ""});
  table.rows.push_back({"taut jakobsen:substeps=1,order=coloured", 1e-9 * sweep, 1, ""});
  answer.add(std::move(table));
  answer.add({"times", "public code over ours"}, their / our);
  return answer;
}

}  // namespace taut
