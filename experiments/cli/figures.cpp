#include <filesystem>
#include <memory>

#include "experiments/command_line/invoke.hpp"
#include "experiments/command_line/verb.hpp"

namespace taut::verb::figures {

namespace {

/// A picture of results/figures and what `taut render` is told to draw it.
struct Flagship {
  const char* file;
  std::vector<std::string> arguments;
};

/// Our side of a picture: as published, one substep, the links in the scene's own order.
const std::string kListing = "jakobsen:substeps=1,order=mesh,iterations=";

std::vector<Flagship> flagships() {
  return {
      {"ball.png",
       {"ball", "--solver", kListing + "16", "--solver", "bullet:iterations=16", "--at", "1",
        "--size", "1280x720"}},
      {"hang.png",
       {"hang", "--solver", kListing + "4", "--solver", "bullet:iterations=4", "--solver",
        kListing + "64", "--solver", "bullet:iterations=64", "--at", "2", "--size", "1080x1080"}},
      {"box-penetration.png",
       {"box", "--solver", kListing + "16", "--solver", "bullet:iterations=16", "--at", "1",
        "--colour", "penetration", "--size", "1280x720"}},
  };
}

std::function<int()> bind(Arguments& arguments) {
  const auto folder = std::make_shared<std::string>("results/figures");
  arguments.option("-o,--out", *folder, "Folder (default: results/figures)");
  return [folder]() -> int {
    std::filesystem::create_directories(*folder);
    for (Flagship flagship : flagships()) {
      flagship.arguments.insert(flagship.arguments.end(), {"-o", *folder + "/" + flagship.file});
      if (const int code = invoke("render", flagship.arguments); code != kPass) return code;
    }
    return kPass;
  };
}

}  // namespace
}  // namespace taut::verb::figures

TAUT_VERB(figures) = {.name = "figures",
                      .summary = "Draws the pictures of results/figures again",
                      .example = "taut figures\n  taut figures -o /tmp/figures",
                      .bind = taut::verb::figures::bind};
