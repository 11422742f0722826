// Contents of a case's record: name and address, text, values over time, end.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "core/io/positions/positions.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_columns.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/reference_store.hpp"
#include "experiments/case/task.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/cloths.hpp"
#include "tests/support/environment.hpp"

namespace taut::records_test {
namespace {

std::string problems(const CaseSpec& spec) {
  try {
    make_case(spec);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(CaseText, IsCalledByWhatWasAskedAndAddressedByWhatItIs) {
  const Case one = make_case(
      {"hang", {"cloth.grid=[4, 3]", "time.dt=\"1/32\"", "time.duration=2"}, "xpbd:iterations=4"});
  EXPECT_EQ(one.id, "hang cloth.grid=[4,3] dt=1/32 duration=2 xpbd:iterations=4");
  EXPECT_EQ(one.spec.solver,
            "xpbd:substeps=8,iterations=4,structural=0,shear=0,bend=0,precision=float"
            ",material=scene,multipliers=keep,method=sweeps,primal=off,order=coloured,seed=1,"
            "layout=auto,tethers=off,"
            "contact=continuous,faces=off,self=grid,simd=auto,threads=1");
  EXPECT_EQ(one.spec.settings.size(), 3u);
  EXPECT_EQ(one.scene->steps, 64);
  EXPECT_EQ(one.key, case_key(*one.scene, digest(*one.scene), one.choice));
  std::set<std::string> keys{one.key};
  for (const CaseSpec& other :
       {CaseSpec{"hang",
                 {"cloth.grid=[4, 3]", "time.dt=\"1/32\"", "time.duration=3"},
                 "xpbd:iterations=4"},
        {"hang", {"cloth.grid=[4, 3]", "time.dt=\"1/16\"", "time.duration=4"}, "xpbd:iterations=4"},
        {"hang", {"cloth.grid=[3, 4]", "time.dt=\"1/32\"", "time.duration=2"}, "xpbd:iterations=4"},
        {"hang", {"cloth.grid=[4, 3]", "time.dt=\"1/32\"", "time.duration=2"}, "xpbd:iterations=5"},
        {"hang",
         {"cloth.grid=[4, 3]", "time.dt=\"1/32\"", "time.duration=2"},
         "jakobsen:iterations=4"}})
    EXPECT_TRUE(keys.insert(make_case(other).key).second) << other.solver;
  EXPECT_EQ(make_case({"hang",
                       {"cloth.grid=[4, 3]", "summary='x'", "time.dt=0.03125", "time.duration=2.0"},
                       "xpbd:precision=float,iterations=4"})
                .key,
            one.key)
      << "the same simulation";
  const std::string both = problems({"hung", {}, "xpdb"});
  EXPECT_NE(both.find("hung"), std::string::npos) << both;
  EXPECT_NE(both.find("unknown solver 'xpdb'"), std::string::npos) << both;
}

TEST(CaseText, ThatDidNotRunHasAllButResults) {
  const Case one = make_case({"hang", {"cloth.grid=[4, 3]"}, "xpbd"});
  const Record r = unfinished(one, {Status::Kind::timeout, "60 s", 7, -1});
  EXPECT_EQ(r.key, one.key);
  EXPECT_EQ(r.id, one.id);
  EXPECT_EQ(r.scene + " " + r.setting, r.id);
  EXPECT_EQ(r.spec.settings, one.spec.settings);
  EXPECT_EQ(r.vertices, 12);
  EXPECT_EQ(r.links, 17 + 12);
  EXPECT_EQ(r.steps, 640);
  EXPECT_EQ(r.params.at("iterations"), "1");
  EXPECT_EQ(r.sweeps, 1);
  EXPECT_EQ(std::to_string(r.substeps), r.params.at("substeps"));
  EXPECT_EQ(r.work_parameters, (std::vector<std::string>{"substeps", "iterations"}));
  EXPECT_EQ(r.status.kind, Status::Kind::timeout);
  EXPECT_TRUE(r.values.empty());
  EXPECT_TRUE(std::isnan(r.value("stretch.rms")));
}

TEST(StateDigest, OfAStateKnowsEveryBit) {
  const State state{{Vec3(1, 2, 3), Vec3(4, 5, 6)}, {Vec3(0, 0, 0), Vec3(0, 0, 0)}};
  State other = state;
  std::set<std::string> digests{digest(state)};
  other.v[1].z() = -0.0;
  EXPECT_TRUE(digests.insert(digest(other)).second) << "-0 is not 0";
  other = state;
  other.x[1].z() = std::nextafter(6, 7);
  EXPECT_TRUE(digests.insert(digest(other)).second);
  other = state;
  std::swap(other.x, other.v);
  EXPECT_TRUE(digests.insert(digest(other)).second);
  EXPECT_EQ(digest(State{{Vec3::Zero()}, {}}) == digest(State{{}, {Vec3::Zero()}}), false);
  EXPECT_EQ(sha256("").substr(0, 16), "e3b0c44298fc1c14");
  EXPECT_EQ(program_digest().size(), 64u);
}

TEST(Status, SaysWhichReasonOfTheDetectorItHas) {
  for (const Reason one : {Reason::nonfinite, Reason::energy, Reason::box, Reason::stretch,
                           Reason::stretch_and_unsettled, Reason::unsettled})
    EXPECT_EQ(StatusReason::stored(std::string(to_string(one))), one);
  EXPECT_EQ(to_string(Reason::stretch_and_unsettled), "stretch, moves after five settling times")
      << "as it is stored";
  EXPECT_EQ(to_string(Reason::unsettled), "moves after five settling times");
  EXPECT_EQ(kSettlingTimes, 5);
  EXPECT_EQ(StatusReason::stored("SIGSEGV").text(), "SIGSEGV");
  EXPECT_FALSE(StatusReason("energy") == Reason::energy) << "a solver's words decide nothing";
  EXPECT_EQ(StatusReason(Reason::energy).text(), "energy");
}

TEST(Status, HasANameAndIsAResultOrAFailure) {
  using enum Status::Kind;
  const std::vector<std::pair<Status::Kind, std::string>> all{{ok, "ok"},
                                                              {exploded, "exploded"},
                                                              {unsettled, "unsettled"},
                                                              {extreme, "extreme"},
                                                              {unsupported, "unsupported"},
                                                              {timeout, "timeout"},
                                                              {oom, "oom"},
                                                              {crash, "crash"},
                                                              {protocol, "protocol"},
                                                              {error, "error"},
                                                              {interrupted, "interrupted"}};
  for (const auto& [kind, name] : all) {
    EXPECT_EQ(to_string(kind), name);
    EXPECT_EQ(status_kind(name), kind);
    EXPECT_TRUE(is_status(name));
    EXPECT_EQ(Status{kind}.is_result(), kind <= unsupported) << name;
    EXPECT_EQ(completed({kind}), kind == ok || kind == unsettled) << name;
  }
  EXPECT_FALSE(is_status("okay"));
  EXPECT_THROW(status_kind("okay"), InputError);
  EXPECT_EQ(describe(Status{}), "ok");
  EXPECT_FALSE(failed(Status{}) || failed(Status{unsettled}) || failed(Status{unsupported}));
  EXPECT_TRUE(failed(Status{extreme}) && failed(Status{crash}));
  EXPECT_EQ(describe(Status{exploded, "energy", 0, 0}), "exploded (energy) at step 0, vertex 0");
  EXPECT_EQ(describe(Status{crash, "SIG\x1b", -1, 12}), "crash (SIG?), vertex 12");
  EXPECT_EQ(describe(Status{extreme, "", 3, -1}), "extreme at step 3");
}

Record small_record() {
  Record r;
  r.key.assign(63, '0');
  r.key.push_back('f');
  r.id = "an id";
  r.setting = "a setting";
  r.spec = {"file", {"a=1", "b=2"}, "text"};
  r.scene = "hang";
  r.solver = "xpbd";
  r.params = {{"p", "q"}};
  r.dt = 0.25;
  r.steps = 6;
  r.vertices = 4;
  r.links = 5;
  r.status = {Status::Kind::exploded, Reason::energy, 17, 3};
  r.values = {{"a", 0.5}, {"b", std::nan("")}};
  r.projections = 60;
  r.step_cost = {{"links", 7, 8, 9, true}, {"wind", 1, 2, 3, false}};
  r.resolved_settings = {{"time step", "1/4 s"}, {"order", "of a mesh", "mesh", 0.25}};
  r.substeps = 2;
  r.sweeps = 8;
  r.work_parameters = {"p"};
  r.digest = "beef";
  return r;
}

TEST(RecordLine, HasEveryColumnOnce) {
  std::set<std::string_view> names, columns;
  for (const RecordColumn& column : record_columns()) {
    EXPECT_TRUE(names.insert(column.json).second) << column.json;
    EXPECT_TRUE(column.column.empty() || columns.insert(column.column).second) << column.column;
    EXPECT_FALSE(column.help.empty()) << column.json;
  }
  EXPECT_EQ(names.size(), columns.size() + 1) << "the values have a table of their own";
}

TEST(RecordLine, IsThisOneLine) {
  const std::string text =
      R"({"schema":)" + std::to_string(kRecordSchema) + R"(,"key":")" + std::string(63, '0') +
      R"(f","id":"an id","setting":"a setting","spec":{"scene":"file","settings":["a=1","b=2"],"solver":"text"},)"
      R"("scene":"hang","solver":"xpbd","params":{"p":"q"},"substeps":2,"sweeps":8,)"
      R"("work_parameters":["p"],"dt":0.25,"steps":6,"vertices":4,"links":5,)"
      R"("status":{"kind":"exploded","reason":"energy","step":17,"vertex":3},)"
      R"("values":{"a":0.5,"b":null},"projections":60,)"
      R"("step_cost":[{"pass":"links","items":7,"repeats":8,"bytes":9,"projections":true},)"
      R"({"pass":"wind","items":1,"repeats":2,"bytes":3,"projections":false}],)"
      R"("resolved_settings":[{"name":"time step","text":"1/4 s"},)"
      R"({"name":"order","text":"of a mesh","token":"mesh","number":0.25}],"digest":"beef"})";
  EXPECT_EQ(to_json(small_record()), text);
  const Record r = record_from_json(text, "file");
  EXPECT_EQ(to_json(r), text);
  EXPECT_EQ(r.status.reason, Reason::energy);
  EXPECT_EQ(r.status.vertex, 3);
  EXPECT_EQ(r.steps, 6);
  EXPECT_EQ(r.vertices, 4);
  EXPECT_EQ(r.links, 5);
  EXPECT_EQ(r.step_cost[0].repeats, 8u);
  EXPECT_EQ(r.log, "");
  Record with_log = r;
  with_log.log = "said";
  EXPECT_EQ(to_json(with_log), text.substr(0, text.size() - 1) + R"(,"log":"said"})");
  EXPECT_EQ(record_from_json(to_json(with_log), "file").log, "said");
  EXPECT_EQ(result_digest(with_log), result_digest(r)) << "no result";
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    try {
      record_from_json(other, "file");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(changed("\"dt\":0.25", "\"dt\":0").find("expected a time step greater than 0"),
            std::string::npos);
  EXPECT_NE(changed("0f\"", "0F\"").find("expected 64 hexadecimal digits"), std::string::npos);
  EXPECT_NE(changed("00f\"", "0f\"").find("expected 64 hexadecimal digits"), std::string::npos);
  EXPECT_NE(changed("\"exploded\"", "\"burst\"").find("unknown status 'burst'"), std::string::npos);
  for (const char* key : {"\"steps\":6", "\"vertices\":4", "\"links\":5"}) {
    const std::string all = key, name = all.substr(1, all.find('"', 1) - 1);
    EXPECT_NE(changed(all, "\"" + name + "\":-1").find(name), std::string::npos);
    EXPECT_EQ(changed(all, "\"" + name + "\":0"), "none");
  }
  EXPECT_NE(changed("\"step\":17", "\"step\":-2").find("step"), std::string::npos);
  EXPECT_NE(changed("\"step\":17,", "").find("has no 'step'"), std::string::npos);
  EXPECT_EQ(changed("\"step\":17", "\"step\":-1"), "none");
}

TEST(CsvText, OfSeriesAndStatesAreTheseLines) {
  const Series series{{"step", "t", "a"}, {{0, 0, std::nan("")}, {7, 0.1, -2}}};
  EXPECT_EQ(to_csv(series), "step,t,a\n0,0,\n7,0.1,-2\n");
  EXPECT_THROW(series_from_json(R"({"t":[1,2],"a":[1]})", "x"), InputError);
  EXPECT_THROW(series_from_json(R"({"t":[1,"2"]})", "x"), InputError);
  EXPECT_EQ(to_csv(State{{Vec3(1, 2, 3), Vec3(0.5, 0, -1)}, {Vec3(4, 5, 6), Vec3(0, 0, 7)}}),
            "vertex,x,y,z,vx,vy,vz\n0,1,2,3,4,5,6\n1,0.5,0,-1,0,0,7\n");
}

MotionReference motion_of(const Scene& scene, const std::string& derivation) {
  MotionReference motion{scene.name, reference_digest(scene, "motion"), derivation, 2, 0.001, 0.95};
  for (int k = 0; k <= 4; ++k) {
    State state = scene.start;
    for (Vec3& x : state.x) x.y() -= 0.25 * k;
    for (Vec3& v : state.v) v.y() = -0.125 * k;
    motion.states.push_back(state);
  }
  return motion;
}

TEST(ReferenceFiles, AreFoundByKindForExactlyTheirCloth) {
  const Scratch scratch;
  Scene scene = hanging_sheet(2, 2);
  scene.name = "small";
  scene.damping = 0.5;
  const auto write_rest = [&] {
    write_reference({"small", reference_digest(scene, "static"), "by hand", 1e-9, scene.start.x},
                    scratch.path() / "small");
  };
  write_rest();
  write_motion(motion_of(scene, "by hand"), scratch.path() / "small");
  write_file(scratch.path() / "small" / "notes.txt", "not read");
  for (const char* file : {"static.json", "motion.json", "motion.npy"})
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "small" / file)) << file;
  const auto found = [&] { return find_references(scene, scratch.path()); };
  ASSERT_TRUE(found().rest);
  const auto motion = found().motion;
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->derivation, "by hand");
  EXPECT_EQ(motion->horizon, 2);
  EXPECT_EQ(motion->floor, 0.001);
  EXPECT_EQ(motion->pushed_out, 0.95);
  ASSERT_EQ(motion->states.size(), 5u);
  EXPECT_EQ(motion->states[4].x[3].y(), static_cast<float>(scene.start.x[3].y() - 1));
  EXPECT_EQ(motion->states[3].v[3].y(), -0.375);
  scene.start.v[3].x() = 1;
  EXPECT_TRUE(found().rest && !found().motion) << "rest does not depend on where it came from";
  scene.start.v[3].x() = 0;
  scene.damping = 1;
  EXPECT_TRUE(found().rest && !found().motion);
  scene.damping = 0.5;
  scene.dt /= 2;
  scene.steps *= 3;
  EXPECT_TRUE(found().rest && found().motion);
  scene.gravity.x() = 1;
  EXPECT_FALSE(found().rest || found().motion);
  scene.gravity.x() = 0;
  scene.mesh.mass[1] *= 2;  // another scene with the same name
  write_rest();
  EXPECT_TRUE(found().rest);
  scene.mesh.mass[1] /= 2;
  EXPECT_TRUE(found().rest) << "its own was not replaced";
  scene.name = "";
  EXPECT_FALSE(found().rest || found().motion);
}

TEST(ReferenceFiles, OfAMotionThatLacksFramesSaySo) {
  const Scratch scratch;
  Scene scene = hanging_sheet(2, 2);
  scene.name = "small";
  write_motion(motion_of(scene, "by hand"), scratch.path());
  create_rounded_npy(scratch.path() / "motion.npy")->append(0, scene.start.x);
  try {
    read_motion(scratch.path() / "motion.json", scene.start);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what())
                    .ends_with("motion.npy: expected 8 frames of 4 vertices: places, then "
                               "velocities"))
        << error.what();
  }
}

// A task depends neither on the order of settings nor on a setting of time.dt: the record's step
// counts.
TEST(Tasks, AreTheSameInAnyOrderOfTheirSettings) {
  const auto asked = [](SceneSettings settings, double dt = 0.01) {
    Record record;
    record.scene = "hang";
    record.spec.settings = std::move(settings);
    record.dt = dt;
    return task_of(record);
  };
  const Task one = asked({"wind.strength=2", "time.dt=0.01", "cloth.grid=[4, 4]"});
  EXPECT_EQ(one, asked({"cloth.grid=[4, 4]", "wind.strength=2"}));
  EXPECT_NE(one, asked({"cloth.grid=[4, 4]", "wind.strength=3"}));
  EXPECT_NE(one, asked({"cloth.grid=[4, 4]", "wind.strength=2"}, 0.02));
  EXPECT_EQ(title_among(one, {one, asked({"wind.strength=2"})}), "hang (cloth.grid=[4, 4])");
}

// Committed references come first. Kinds that are missing there are taken from the user's own, each
// kind separately.
TEST(ReferenceFiles, OnesOwnStandInForEachKindThatIsNotCommitted) {
  Scene scene = hanging_sheet(2, 2);
  scene.name = "small";
  for (int has = 0; has < 16; ++has) {
    const Scratch scratch;
    const Environment data("TAUT_DATA", scratch.path().c_str()),
        own("TAUT_RESULTS", (scratch.path() / "own").c_str());
    int bit = 1;
    for (const std::string whose : {"committed", "own"})
      for (const std::string kind : {"static", "motion"}) {
        const auto folder = scratch.path() / (whose == "own" ? "own/references" : "references");
        make_folder(folder);
        if (has & bit && kind == "motion")
          write_motion(motion_of(scene, whose), folder / "small");
        else if (has & bit)
          write_reference({"small", reference_digest(scene, kind), whose, 1e-9, scene.start.x},
                          folder / "small");
        bit *= 2;
      }
    const auto whose = [&](int committed, int mine) {
      return has & committed ? "committed" : has & mine ? "own" : "";
    };
    const References known = known_references(scene);
    EXPECT_EQ(known.rest ? known.rest->derivation : "", whose(1, 4)) << has;
    EXPECT_EQ(known.motion ? known.motion->derivation : "", whose(2, 8)) << has;
  }
}

}  // namespace
}  // namespace taut::records_test
