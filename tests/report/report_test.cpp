// The report: one file, everything in it, nothing that the data do not say.
#include "experiments/report/report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/model/input_error.hpp"
#include "experiments/report/axis.hpp"
#include "experiments/report/comparison.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report {
namespace {

namespace fs = std::filesystem;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

/// What a bare run gives: two studies on two scenes, with strain over time.
ReportInput example() {
  ReportInput input;
  input.command = "./taut run iterations time-steps";
  input.provenance = {{"version", "taut 0.1.0"}, {"compiler", "g++ 12.2.0"}};
  input.solvers = {{"jakobsen", "Verlet with relaxed sticks", "Jakobsen 2001"},
                   {"bullet", "btSoftBody", "Bullet 3.24"}};
  input.scenes = {{"hang", "A sheet held by two corners"}, {"ball", "A sheet on a ball"}};
  StudyResult sweeps{"iterations", "How fast does stretch fall?", {}, 40, {{"hang", -1}}};
  StudyResult steps{"time-steps", "Which steps survive?", {}, 0, {}};
  for (const std::string scene : {"hang", "ball"}) {
    for (const Record& r : synthetic::iterations(scene)) sweeps.records.push_back(r);
    for (const Record& r : synthetic::time_steps(scene)) steps.records.push_back(r);
  }
  for (StudyResult* study : {&sweeps, &steps})
    for (Record& r : study->records)
      if (r.scene == "hang") r.values.erase("penetration.max");
  input.studies = {sweeps, steps};
  for (const std::string solver : {"jakobsen", "bullet"}) {
    TimeSeries series{"ball", solver, solver_title(solver), "stretch.rms", {}, {}};
    for (int i = 0; i <= 160; ++i) {
      const double t = i / 64.0;
      series.t.push_back(t);
      series.y.push_back((solver == "bullet" ? 0.06 : 0.02) * std::exp(-t) * (1 - std::cos(6 * t)));
    }
    input.series.push_back(series);
  }
  return input;
}

TEST(Report, OneFileThatAsksForNothing) {
  const fs::path path =
      fs::temp_directory_path() / ("taut_report_" + std::to_string(getpid()) + ".html");
  EXPECT_EQ(write_report(example(), path), path);
  const std::string html = read_text(path);
  fs::remove(path);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  for (const char* request : {"src=\"http", "href=\"http", "url(", "@import", "<link", "fetch("})
    EXPECT_EQ(html.find(request), std::string::npos) << request;
  EXPECT_LT(html.size(), 1'000'000U * 2) << "1 MB a scene";
}

TEST(Report, EverySectionIsThereAndEveryChartHasItsNumbers) {
  const std::string html = make_report(example());
  for (const char* id : {"verdict", "hero", "tiles", "fairness", "scenes", "scene-hang",
                         "scene-ball", "truths", "regressions", "method", "raw", "limits"})
    EXPECT_EQ(count(html, "id=\"" + std::string(id) + "\""), 1U) << id;
  EXPECT_GT(count(html, "<svg class=\"chart\""), 8U);
  // Each chart has its numbers once and is drawn for phones too; films' also for half a page.
  const std::size_t films = count(html, "class=\"plot phone\""),
                    half = count(html, "class=\"plot half\"");
  const std::size_t charts = films + count(html, "class=\"narrow\"");
  EXPECT_EQ(charts, count(html, "<details class=\"data\""));
  EXPECT_EQ(half, films);
  EXPECT_EQ(2 * charts + half, count(html, "<svg class=\"chart\""));
  EXPECT_EQ(count(html, "<svg class=\"chart\""), count(html, "</desc>"));
  EXPECT_EQ(html.find("rgb("), std::string::npos) << "every colour follows the theme";
}

TEST(Report, MapsShowEverySolver) {
  ReportInput input = example();
  EXPECT_NE(make_report(input).find("No map was run"), std::string::npos);
  input.maps = {
      {"map", "Where does it <break>?", "dt", "iterations", synthetic::time_steps("hang")}};
  const std::string html = make_report(input);
  EXPECT_NE(html.find("Where does it &lt;break&gt;?"), std::string::npos);
  for (const char* solver : {"Jakobsen", "Bullet"})
    EXPECT_NE(html.find("<h4>" + std::string(solver) + ", hang</h4>"), std::string::npos) << solver;
}

TEST(Report, AbsentDataNameTheCommandThatMakesThem) {
  const std::string html = make_report(example());
  for (const char* command : {"taut verify", "taut check", "taut bench", "taut render ball"})
    EXPECT_NE(html.find(command), std::string::npos) << command;
}

TEST(Report, ATruthThatDeviatesForManyIsSaidOnce) {
  ReportInput input = example();
  Truths truths;
  for (const char* solver : {"jakobsen", "bullet"})
    for (const char* value : {"0.10", "0.55", "1.35"})
      truths.rows.push_back(
          {"chains", "modes obey theory", "a book", solver, value, "2", "deviates", "links turn"});
  truths.rows.push_back(
      {"chains", "another", "a book", "bullet", "1", "2", "deviates", "links turn"});
  truths.truths = 2, truths.findings = 7;
  input.truths = truths;
  const std::string html = make_report(input);
  const std::size_t begins = html.find("<section id=\"truths\"");
  const std::string shown = html.substr(begins, html.find("<details", begins) - begins);
  EXPECT_EQ(count(shown, "modes obey theory"), 1U);
  EXPECT_EQ(count(shown, "rowspan=\"6\""), 2U) << "statement and verdict";
  EXPECT_EQ(count(shown, "links turn"), 2U) << "not shared with the next truth";
  EXPECT_EQ(count(shown, "<tr>"), 8U);
}

TEST(Report, NamesFromOutsideStayText) {
  ReportInput input = example();
  const std::string evil = "<script>alert(1)</script>\"'&";
  input.title = evil;
  input.command = evil;
  input.scenes[0].summary = evil;
  input.studies[0].question = evil;
  for (Record& r : input.studies[0].records) {
    r.id += evil;
    r.status.reason = evil;
    r.params["mode"] = evil;
    r.resolved_settings.emplace_back(evil, evil);
    if (r.scene == "ball") r.scene = evil;
  }
  const std::string html = make_report(input);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;alert"), std::string::npos);
}

TEST(Report, SurvivesNanFailuresOnlyAndASingleSolver) {
  ReportInput input = example();
  for (StudyResult& study : input.studies)
    for (Record& r : study.records) {
      r.values["stretch.rms"] = std::numeric_limits<double>::quiet_NaN();
      r.projections = 0;
    }
  for (double& y : input.series[0].y) y = std::numeric_limits<double>::quiet_NaN();
  std::string html = make_report(input);
  EXPECT_EQ(html.find("nan"), html.find("nance")) << "NaN is shown as a dash";
  for (StudyResult& study : input.studies)
    for (Record& r : study.records) synthetic::fail(r, Status::Kind::crash, "SIGSEGV");
  html = make_report(input);
  EXPECT_NE(html.find("stretch cannot be compared"), std::string::npos);
  for (StudyResult& study : input.studies)
    std::erase_if(study.records, [](const Record& r) { return r.solver == "bullet"; });
  EXPECT_NE(make_report(input).find("nothing to compare it with"), std::string::npos);
}

TEST(Report, WithoutAnyRecordIsAnInputError) {
  EXPECT_THROW(make_report({}), InputError);
  ReportInput input = example();
  for (StudyResult& study : input.studies) study.records.clear();
  EXPECT_THROW(make_report(input), InputError);
}

TEST(Report, MediaThatWouldBurstTheLimitAreLeftOutAndSaidSo) {
  ReportInput input = example();
  Clip clip{.type = "video/mp4", .bytes = std::string(4'000'000, 'x')};
  input.media = {{"ball", {clip}, 2.5, 1, {}}};
  const std::string html = make_report(input);
  EXPECT_LT(html.size(), report_limit(2));
  EXPECT_NE(html.find("left out"), std::string::npos);
  input.media[0].clips[0].bytes.resize(1000);
  EXPECT_NE(make_report(input).find("data-src=\"data:video/mp4;base64,eHh4"), std::string::npos);
}

TEST(Report, ScenesThatNoStudyRanAreShownBesideWhoRefusesThem) {
  ReportInput input = example();
  EXPECT_EQ(make_report(input).find("id=\"others\""), std::string::npos);
  SceneMedia media{.scene = "twist", .clips = {{.type = "video/mp4", .bytes = "xxx"}}};
  media.summary = "A strip is <wound> up", media.duration = 3, media.speed = 0.25;
  media.refused = {{"bullet", "self-collision & more"}};
  input.media = {media};
  input.series.push_back({"twist", "jakobsen", "Jakobsen", "stretch.rms", {0, 1, 2}, {0, 0.1, 0}});
  const std::string html = make_report(input);
  const std::size_t begins = html.find("id=\"film-twist\"");
  ASSERT_NE(begins, std::string::npos);
  const std::string card = html.substr(begins, html.find("</article>", begins) - begins);
  for (const char* text :
       {"A strip is &lt;wound&gt; up", "data-src=\"data:video", "class=\"refused\"",
        "self-collision &amp; more", "1/4 of real time", "<svg"})
    EXPECT_NE(card.find(text), std::string::npos) << text;
  EXPECT_EQ(html.find("id=\"scene-twist\""), std::string::npos);
}

/// A test picture as video, if ffmpeg is here; tests/browser uses it to try the slider.
std::string test_video(const fs::path& path) {
  const std::string command =
      "ffmpeg -v error -y -f lavfi -i testsrc=size=320x180:rate=30:duration=2 "
      "-pix_fmt yuv420p -g 15 '" +
      path.string() + "' </dev/null";
  if (std::system(command.c_str()) != 0) return "";
  const std::string bytes = read_text(path);
  fs::remove(path);
  return bytes;
}

// Not a test by itself: writes the page that tests/browser/report.py opens.
TEST(Report, SampleForTheBrowser) {
  const char* path = getenv("TAUT_SAMPLE_REPORT");
  if (path == nullptr) GTEST_SKIP() << "TAUT_SAMPLE_REPORT names no file";
  fs::create_directories(fs::path(path).parent_path());
  ReportInput input = example();
  if (const std::string video = test_video(std::string(path) + ".mp4"); !video.empty()) {
    const Clip clip{.type = "video/mp4",
                    .bytes = video,
                    .alt = "A sheet on a ball, two solvers",
                    .panels = {{"jakobsen", "16 sweeps"}}};
    Clip other = clip;
    other.panels = {{"bullet", "16 sweeps"}};
    input.media = {{"ball", {clip, other}, 2.5, 1.25, {}}};
    input.media.front().poster = 1, input.media.front().frame = 1.25 / 30;
    SceneMedia more{
        .scene = "twist", .clips = {clip}, .duration = 2, .summary = "A strip, wound up"};
    more.poster = 0.5, more.refused = {{"bullet", "self-collision is not what it does"}};
    input.media.push_back(more);
    input.series.push_back(
        {"twist", "jakobsen", "Jakobsen", "stretch.rms", {0, 1, 2}, {0, 0.1, 0}});
  }
  write_report(input, path);
  EXPECT_TRUE(fs::exists(path));
}

TEST(Verdict, NamesTheWinnerWhicheverItIs) {
  ReportInput input = example();
  std::string text = verdict(compare(input), {"hang", "ball"});
  EXPECT_NE(text.find(">Jakobsen</b> leaves <b>"), std::string::npos) << text;
  EXPECT_NE(text.find("less on hang and ball"), std::string::npos) << text;
  for (StudyResult& study : input.studies)
    for (Record& r : study.records) {
      auto& stretch = r.values["stretch.rms"];
      if (r.solver == "bullet") stretch /= 100;
    }
  text = verdict(compare(input), {"hang", "ball"});
  EXPECT_NE(text.find(">Bullet</b> leaves <b>"), std::string::npos) << text;
}

TEST(Verdict, EqualSolversAreAlike) {
  ReportInput input = example();
  for (StudyResult& study : input.studies)
    for (Record& r : study.records)
      r.values["stretch.rms"] = 0.1 / value_of(r, "iterations"), r.status = {};
  const std::string text = verdict(compare(input), {"hang", "ball"});
  EXPECT_NE(text.find("<b>the same stretch</b> on all 2 scenes"), std::string::npos) << text;
  EXPECT_NE(text.find("both stay sound at every time step tried, up to 100"), std::string::npos)
      << text;
  EXPECT_NE(text.find("No case failed."), std::string::npos) << text;
}

TEST(Verdict, SubstepsThatDifferAreSaid) {
  ReportInput input = example();
  const auto text = [&](const char* theirs) {
    for (StudyResult& study : input.studies)
      for (Record& r : study.records) r.params["substeps"] = r.solver == "bullet" ? theirs : "5";
    return verdict(compare(input), {"hang", "ball"});
  };
  EXPECT_EQ(text("5").find("substeps"), std::string::npos);
  EXPECT_NE(text("1").find("cannot be compared (their substeps differ"), std::string::npos);
  EXPECT_FALSE(equal_substeps(compare(input)));
}

TEST(Comparison, RatiosPairOnlyCasesThatBothEndedWell) {
  const Comparison facts = compare(example());
  ASSERT_EQ(facts.contenders.size(), 2U);
  EXPECT_EQ(facts.contenders[0].solver, "jakobsen");
  EXPECT_EQ(facts.sweeps, 16);
  ASSERT_TRUE(facts.stretch[1]);
  // time-steps pairs have ratio 1; of 2 x 9 sweeps pairs with ratio 3 Bullet's k = 128 failed.
  EXPECT_GT(facts.stretch[1]->mean, 1);
  EXPECT_LT(facts.stretch[1]->mean, 3);
  const auto dt = largest_sound_step(facts.contenders[1], "hang", 4);
  ASSERT_TRUE(dt);
  EXPECT_LT(dt->dt, 0.1);
  EXPECT_FALSE(dt->no_limit);
}

TEST(Comparison, AStepThatWentWellIsNoLimit) {
  ReportInput input = example();
  for (Record& r : input.studies[1].records) r.status = {};
  SoundSteps steps = sound_steps(compare(input), {"hang", "ball"});
  EXPECT_TRUE(steps.no_limit);
  EXPECT_DOUBLE_EQ(steps.dt.at(0), 0.1);
  // Three steps within a factor of four say nothing about limits.
  std::erase_if(input.studies[1].records, [](const Record& r) {
    return r.scene == "ball" && (r.dt < 0.0039 || r.dt > 0.016);
  });
  EXPECT_EQ(sound_steps(compare(input), {"hang", "ball"}).scenes, std::vector<std::string>{"hang"});
}

TEST(Comparison, ASolverWithoutSweepsHasNoSayInWhichAreQuoted) {
  ReportInput input = example();
  Record springs = input.studies.front().records.front();
  springs.solver = "mass-spring", springs.status = {}, springs.values["stretch.rms"] = 0.25;
  springs.params.erase("iterations"), springs.key += ", springs";
  input.studies.front().records.push_back(springs);
  const Comparison facts = compare(input);
  ASSERT_EQ(facts.contenders.size(), 3U);
  EXPECT_EQ(facts.sweeps, 16);
  EXPECT_EQ(value_at(facts.contenders.back(), springs.scene, 16, "stretch.rms"), 0.25);
}

TEST(Comparison, RoundingInFreeFallDecidesNothing) {
  ReportInput input = example();
  for (StudyResult& study : input.studies)
    for (Record& r : study.records) r.values["stretch.rms"] = r.solver == "bullet" ? 1e-13 : 1e-17;
  const Comparison facts = compare(input);
  ASSERT_TRUE(facts.stretch[1]);
  EXPECT_DOUBLE_EQ(facts.stretch[1]->mean, 1);
}

TEST(InlineSvg, KeepsContentDropsIdsAndTakesTheThemesColours) {
  const std::string svg = inline_svg(
      "<svg width=\"9\" viewBox=\"0 0 9 9\">\n<defs><a id='x'/></defs><g "
      "id=\"gnuplot_canvas\">\n<g "
      "stroke=\"none\">\n</g><path stroke=\"rgb(11, 107, 203)\"/></g></svg>",
      "f1", "A <b>", "d");
  EXPECT_EQ(svg.find("gnuplot_canvas"), std::string::npos);
  EXPECT_EQ(svg.find("<defs>"), std::string::npos);
  EXPECT_EQ(count(svg, "<g"), 1U);
  EXPECT_NE(svg.find("var(--s-blue)"), std::string::npos);
  EXPECT_NE(svg.find("A &lt;b&gt;"), std::string::npos);
}

}  // namespace
}  // namespace taut::report
