#include "experiments/command_line/page.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::reporting {

namespace {

struct Options : PageRequest {
  bool no_media = false;
};

int run(Options options) {
  options.media = !options.no_media;
  if (options.output.empty() && !options.model) options.output = "report.html";
  const std::string text = make_page(options).text;
  if (options.output.empty()) {
    std::cout << text;
    return kPass;
  }
  write_file(options.output, text);
  std::cout << options.output << '\n';
  return kPass;
}

void add_options(Arguments& args, Options& options) {
  args.add_option("STUDY", options.studies,
                  "Names or paths of studies; none: the main job, preset quick. After two results "
                  "folders A and B: what differs");
  add_stored(args, options.preset, options.results);
  args.add_option(
          "--film", options.films,
          "Also film this scene (name or path), which no study ran; without --film and STUDY: "
          "pictures of all shipped scenes without bodies that deform")
      .one_each();
  args.add_flag("--no-media", options.no_media, "Leave out pictures and videos");
  add_json(args, options.model,
           "the model of the page (experiments/report/model/MODEL.md), without pictures,");
  add_output(args, options.output,
             "The page (default: report.html), or the model (default: standard output)");
}

}  // namespace

}  // namespace taut::verb::reporting

TAUT_VERB(report) = {
    .name = "report",
    .group = VerbGroup::studies,
    .summary = "Writes the comparison of stored results as one HTML page",
    .example =
        "taut report\n  taut report iterations --preset quick -o hang.html\n  taut "
        "report iterations --json | jq .answer\n  taut report results/before results/after",
    .bind = taut::bind_verb<taut::verb::reporting::add_options, taut::verb::reporting::run>};
