#include <fmt/format.h>
#include <gtest/gtest.h>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/locked_bytes.hpp"
#include "base/version.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "sweep/cases.hpp"
#include "sweep/commands.hpp"
#include "sweep/gather.hpp"
#include "sweep/results.hpp"
#include "sweep/run.hpp"
#include "sweep/workbench.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

/// Twelve drives of a small array, two of which are refused; a fraction of a millisecond each.
const std::string drives =
    "command = \"drive\"\n[options]\nfocus = [\"0,0,100mm\", \"10mm,0,100mm\"]\n"
    "[vary]\nlayout = [\"openmpd\", \"sonicsurface\"]\nsolver = [\"naive\", \"gs-pat\", \"adjoint\"]\n"
    "temperature = [20, 25]\n";

class SweepRuns : public testing::Test {
 protected:
  // Each test has its own: a file that was read in one test may not be written in another.
  fs::path folder_ =
      scratch_folder(std::string("sweep-") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path plan_ = folder_ / "plan.toml";
  void SetUp() override { write_text(plan_, drives); }
  std::string out(const std::string& name) const { return folder_ / name; }
  Result sweep(const std::vector<std::string>& more) const { return palpa_here(with({"sweep", plan_.string()}, more)); }
  Result compute(const std::string& name, const std::vector<std::string>& more = {}) const {
    return sweep(with({"--out", out(name), "--backend", "cpu"}, more));
  }
  /// The table of that folder, which must be complete.
  std::string table(const std::string& name) const {
    const std::string file = out(name) + "/table.csv";
    const Result result = sweep({"--out", out(name), "--gather", file, "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_text(file);
  }
};

TEST_F(SweepRuns, AnyNumberOfPartsGivesTheSameTable) {
  const Result whole = compute("one");
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_NE(whole.out.find("12 cases: 12 computed"), std::string::npos) << whole.out;
  EXPECT_NE(whole.err.find("4 cases were refused; the first: the case layout openmpd, solver adjoint, temperature 20"),
            std::string::npos)
      << whole.err;
  for (const int shards : {2, 7}) {
    for (int shard = shards; shard-- > 0;)
      EXPECT_EQ(compute(std::to_string(shards), {"--shard", fmt::format("{}/{}", shard, shards)}).exit_code, 0);
  }
  const std::string csv = table("one");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 13);
  EXPECT_EQ(csv, table("2"));
  EXPECT_EQ(csv, table("7"));
  EXPECT_TRUE(csv.starts_with("id,layout,solver,temperature,transducers,sound_speed_m_s,")) << csv;
  EXPECT_NE(csv.find(",openmpd,naive,20,256,343."), std::string::npos) << csv;
  EXPECT_NE(csv.find(",openmpd,adjoint,20,,,,,,,,,,refused\n"), std::string::npos) << csv;
}

TEST_F(SweepRuns, ACaseHasTheNumbersOfItsCommand) {
  compute("one");
  const Result alone =
      palpa_here({"drive", "--layout", "sonicsurface", "--focus", "0,0,100mm", "--focus", "10mm,0,100mm", "--solver",
                  "gs-pat", "--temperature", "25", "--backend", "cpu", "--json", "-"});
  const std::size_t at = alone.out.find("\"weakest_to_strongest\": ") + 24;
  const std::string evenness = alone.out.substr(at, alone.out.find(',', at) - at);
  const std::string csv = table("one");
  const std::size_t row = csv.find(",sonicsurface,gs-pat,25,");
  ASSERT_NE(row, std::string::npos);
  EXPECT_NE(csv.substr(row, csv.find('\n', row) - row).find("," + evenness + ","), std::string::npos)
      << evenness << "\n"
      << csv;
}

TEST_F(SweepRuns, RunningItAgainContinues) {
  sweep::Plan plan = sweep::load_plan(plan_);
  setup::ComputeOptions cpu;
  cpu.backend = setup::Backend::cpu;
  const auto stop_after = [](std::uint64_t count) {
    return [count](const sweep::CaseLine&, std::uint64_t number, std::uint64_t) { return number < count; };
  };
  EXPECT_EQ(run_sweep(plan, {.out = out("one"), .compute = cpu}, stop_after(5)).mine, 12u);
  const sweep::SweepReport rest = run_sweep(plan, {.out = out("one"), .compute = cpu});
  EXPECT_EQ(rest.before, 5u);
  EXPECT_EQ(rest.done + rest.refused, 7u);
  EXPECT_EQ(run_sweep(plan, {.out = out("one"), .compute = cpu}).before, 12u);
  // Values that are added later only add cases.
  std::string more = drives;
  more.replace(more.find("[20, 25]"), 8, "[10, 20, 25]");
  write_text(plan_, more);
  EXPECT_NE(compute("one").out.find("18 cases: 6 computed"), std::string::npos);
  // The results that are no longer in the plan stay where they are.
  write_text(plan_, drives);
  EXPECT_NE(sweep({"--out", out("one"), "--gather", out("one") + "/t.csv"})
                .out.find("12 rows; 4 refused; 6 results in the folder are not of this plan"),
            std::string::npos);
}

TEST_F(SweepRuns, AKillLosesOneCaseAtMost) {
  write_text(plan_,
             "command = \"field\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,100mm\"\nplane = \"xz\"\n"
             "size = \"20mm,20mm\"\npixels = \"20,20\"\n[vary]\ntemperature = { from = 15, to = 25, count = 300 }\n");
  std::size_t before = 0;
  for (int kills = 0; kills < 3; ++kills) {
    const pid_t child =
        start_program(palpa_binary(), {"sweep", plan_, "--out", out("one"), "--backend", "cpu", "--quiet"});
    // Until it has computed some more.
    for (int i = 0; i < 5000 && sweep::Store(out("one")).states().size() < before + 3; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::size_t now = sweep::Store(out("one")).states().size();
    EXPECT_GE(now, before + 3);
    EXPECT_LT(now, 300u) << "it ended before it was killed";
    before = now;
  }
  const Result rest = compute("one");
  EXPECT_NE(rest.out.find(fmt::format("300 cases: {} computed", 300 - before)), std::string::npos) << rest.out;
  EXPECT_EQ(compute("two").exit_code, 0);
  EXPECT_EQ(table("one"), table("two"));
}

TEST_F(SweepRuns, ProcessesWithClaimShareTheCases) {
  write_text(plan_,
             "command = \"field\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,100mm\"\nplane = \"xz\"\n"
             "size = \"20mm,20mm\"\npixels = \"20,20\"\n[vary]\ntemperature = { from = 15, to = 25, count = 100 }\n");
  std::vector<Result> results(2);
  {
    std::vector<std::jthread> threads;
    for (Result& result : results)
      threads.emplace_back([&] {
        result = palpa({"sweep", plan_, "--out", out("claim"), "--backend", "cpu", "--claim"});
      });
  }
  std::multiset<std::string> ids;
  const sweep::Store store(out("claim"));
  store.each([&](std::size_t, std::string_view id, sweep::State, std::string_view) { ids.emplace(id); });
  EXPECT_EQ(ids.size(), 100u) << "some case was computed twice, or by nobody";
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 100u);
  for (const Result& result : results)
    EXPECT_EQ(result.exit_code, 0) << result.err;
  // Nobody holds a lock any more, and a case whose line was lost is computed again in spite of its mark.
  for (const sweep::RunInfo& run : store.runs()) {
    const fs::path lines = fs::path(out("claim")) / "runs" / run.name / "cases.jsonl";
    std::string text = read_text(lines);
    if (text.empty()) continue;
    text.resize(text.size() - 5);
    write_text(lines, text);
    break;
  }
  EXPECT_NE(compute("claim", {"--claim"}).out.find("100 cases: 1 computed"), std::string::npos);
  EXPECT_EQ(compute("one").exit_code, 0);
  EXPECT_EQ(table("claim"), table("one"));
}

/// The file of the claims in a folder of results.
fs::path claims_in(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with("claims-")) return entry.path();
  }
  return {};
}

TEST_F(SweepRuns, WhatFailedElsewhereIsNotTriedInTheSameSweep) {
  const sweep::Plan plan = sweep::load_plan(plan_);
  const sweep::Inputs inputs(plan);
  const sweep::Case last = sweep::deal(sweep::list_cases(plan, inputs, true), sweep::Shard()).back();
  setup::ComputeOptions cpu;
  cpu.backend = setup::Backend::cpu;
  const auto other_process = [&](const sweep::CaseLine&, std::uint64_t number, std::uint64_t) {
    if (number != 1) return true;
    sweep::RunInfo info{{}, version(), commit()};
    info.shard = "other";
    sweep::StoreWriter(out("one"), info).add({.id = last.id, .state = sweep::State::failed, .error = "no memory"});
    LockedBytes(claims_in(out("one"))).mark(last.index);
    return true;
  };
  const sweep::SweepTask task{.out = out("one"), .claim = true, .compute = cpu};
  const sweep::SweepReport first = run_sweep(plan, task, other_process);
  EXPECT_EQ(first.done + first.refused + first.failed, 11u);
  // The next sweep tries it.
  const sweep::SweepReport next = run_sweep(plan, task);
  EXPECT_EQ(next.before, 11u);
  EXPECT_EQ(next.done + next.refused, 1u);
}

TEST_F(SweepRuns, AStoppedCaseIsNotMarkedAsWritten) {
  write_text(plan_,
             "command = \"field\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,100mm\"\nplane = \"xz\"\n"
             "size = \"20mm,20mm\"\npixels = \"20,20\"\n[vary]\ntemperature = [20, 25]\n");
  std::atomic<bool> stop = false;
  std::string first;
  setup::ComputeOptions cpu;
  cpu.backend = setup::Backend::cpu;
  const sweep::SweepTask task{.out = out("one"), .claim = true, .compute = cpu, .stop = &stop};
  run_sweep(sweep::load_plan(plan_), task, [&](const sweep::CaseLine& line, std::uint64_t, std::uint64_t) {
    first = line.settings.back().second;
    stop = true;  // so the second case has begun, and ends without a result
    return true;
  });
  const LockedBytes claims(claims_in(out("one")));
  EXPECT_EQ(sweep::Store(out("one")).states().size(), 1u);
  EXPECT_EQ(claims.is_marked(0), first == "20");
  EXPECT_EQ(claims.is_marked(1), first == "25");
}

TEST_F(SweepRuns, TheDeviceIsKeptAndResultsDoNotDependOnWhatCameBefore) {
  const std::string scene = source_file("assets/cube.glb"), finger = source_file("assets/finger.ply");
  const auto plan_with = [&](const std::string& penetrations) {
    write_text(plan_,
               fmt::format("command = \"touch\"\nkeep = \"everything\"\n[options]\nscene = \"{}\"\npoints = \"{}\"\n"
                           "[vary]\nmethod = [\"cross-section\", \"multi-focus\"]\npenetration = {}\n",
                           scene, finger, penetrations));
  };
  const auto line_of_3mm = [&](const std::string& name) {
    const sweep::Plan plan = sweep::load_plan(plan_);
    std::string found;
    sweep::Store(out(name)).each([&](std::size_t, std::string_view, sweep::State state, std::string_view line) {
      EXPECT_EQ(state, sweep::State::done) << line;
      if (line.find("\"penetration\":\"3mm\"") != line.npos && line.find("cross-section") != line.npos)
        found = line.substr(0, line.find("\"took_s\""));
    });
    return found;
  };
  plan_with("[\"1mm\", \"2mm\", \"3mm\"]");
  const Result result = sweep({"--out", out("many")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  plan_with("[\"3mm\"]");
  sweep({"--out", out("few")});
  EXPECT_FALSE(line_of_3mm("many").empty());
  EXPECT_EQ(line_of_3mm("many"), line_of_3mm("few"));
}

TEST_F(SweepRuns, AFullDiskLosesOneCase) {
  // A limit of 2 KiB for each file, which is a few lines.
  const std::string line = fmt::format("ulimit -f 2; exec '{}' sweep '{}' --out '{}' --backend cpu", palpa_binary(),
                                       plan_.string(), out("full"));
  const Result result = run_program("/bin/bash", {"-c", line});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.err.find("cases.jsonl: cannot be written: File too large"), std::string::npos) << result.err;
  const std::size_t kept = sweep::Store(out("full")).states().size();
  EXPECT_GT(kept, 1u);
  EXPECT_LT(kept, 12u);
  EXPECT_NE(compute("full").out.find(fmt::format("{} computed", 12 - kept)), std::string::npos);
  EXPECT_EQ(compute("one").exit_code, 0);
  EXPECT_EQ(table("full"), table("one"));
}

TEST_F(SweepRuns, FaultsAreToldBeforeAnythingIsComputed) {
  write_text(plan_, "command = \"touch\"\n[options]\npoints = \"none.ply\"\n[vary]\nscene = [\"none.glb\"]\n");
  expect_failure(compute("out"), 4, "plan.toml: points: ");
  expect_failure(compute("out"), 4, "none.ply: ");
  EXPECT_FALSE(fs::exists(out("out")));
  write_text(plan_, drives + "results = 3\n");
  expect_failure(compute("out"), 4, "line 8: results must be a list of values");
  write_text(plan_, "results = [\"foci_m\"]\n" + drives);
  expect_failure(compute("out"), 4, "plan.toml: line 1: results: foci_m is a list; name one of its entries");
  write_text(plan_, drives);
  expect_failure(sweep({}), 2, "--out is missing");
  expect_failure(palpa_here({"sweep"}), 2, "give palpa sweep a plan");
  expect_failure(palpa_here({"sweep", plan_, plan_}), 2, "one plan");
  expect_failure(compute("out", {"--shard", "3/3"}), 2, "--shard: '3/3' is not a shard");
  write_text(folder_ / "file", "x");
  expect_failure(compute("file"), 2, "is not a folder");
  expect_failure(compute("none/out"), 1, "none/out: cannot be created");
}

TEST_F(SweepRuns, AMisspeltResultIsToldOnce) {
  write_text(plan_, "results = [\"pressures_p.0\", \"pressures_pa.7\"]\n" + drives);
  const Result result = compute("out");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string warning = "plan.toml: results: a case has no pressures_p; did you mean pressures_pa?";
  EXPECT_NE(result.err.find(warning), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("results: "), result.err.rfind("results: ")) << result.err;
}

TEST_F(SweepRuns, ListsAndEstimates) {
  const Result list = sweep({"--list"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  EXPECT_EQ(std::ranges::count(list.out, '\n'), 13);
  EXPECT_TRUE(list.out.starts_with("id,layout,solver,temperature\n"));
  std::multiset<char> lines;
  for (const char* shard : {"0/2", "1/2"})
    EXPECT_EQ(std::ranges::count(sweep({"--list", "--shard", shard}).out, '\n'), 7);
  EXPECT_TRUE(sweep({"--list", "--estimate"}).out.starts_with("id,layout,solver,temperature,seconds,megabytes\n"));
  EXPECT_NE(sweep({"--estimate"}).out.find("12 cases: "), std::string::npos);
  compute("one");
  const Result with_results = sweep({"--estimate", "--out", out("one"), "--backend", "cpu"});
  EXPECT_NE(with_results.out.find("as 8 results there took"), std::string::npos) << with_results.err;
  // Those of the other backend say nothing.
  EXPECT_EQ(sweep({"--estimate", "--out", out("one")}).out.find("results there"), std::string::npos);
}

TEST_F(SweepRuns, OneThingIsNotPlural) {
  write_text(plan_, "command = \"drive\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,100mm\"\n");
  EXPECT_TRUE(compute("out").out.starts_with("1 case: 1 computed in "));
  EXPECT_TRUE(sweep({"--estimate"}).out.starts_with("1 case: "));
  EXPECT_NE(sweep({"--estimate", "--out", out("out"), "--backend", "cpu"}).out.find("as 1 result there"),
            std::string::npos);
  EXPECT_EQ(sweep({"--out", out("out"), "--gather", out("out") + "/t.csv"}).out, "1 row\n");
}

TEST_F(SweepRuns, ExitsWithAFailureIfNothingCouldBeComputed) {
  // Each case's options fit together, but a focus is on a transducer.
  write_text(plan_,
             "command = \"drive\"\n[options]\nlayout = \"openmpd\"\nfocus = \"-78.75mm,-78.75mm,0\"\n"
             "[vary]\ntemperature = [20, 25]\n");
  expect_failure(compute("out", {"--quiet"}), 1,
                 "no case could be computed: all were refused; the case temperature 20: --focus:");
  expect_failure(compute("out", {"--quiet"}), 1, "no case could be computed: all were refused; --gather writes why");
  // One that can be is enough, and so is one of another shard.
  write_text(plan_,
             "command = \"drive\"\n[options]\nlayout = \"openmpd\"\n"
             "[vary]\nfocus = [\"-78.75mm,-78.75mm,0\", \"0,0,10cm\"]\n");
  EXPECT_EQ(compute("two").exit_code, 0);
  // Options that fit in no case are refused before anything is computed.
  write_text(plan_, "command = \"touch\"\n[options]\nscene = \"" + source_file("assets/cube.glb").string() + "\"\n");
  for (const std::vector<std::string>& how : {std::vector<std::string>{"--list"}, {"--estimate"}, {"--out", out("no")}})
    expect_failure(sweep(how), 4, "plan.toml: no skin");
  EXPECT_FALSE(fs::exists(out("no")));
}

/// Every list and object in a JSON text, as commands.cpp knows them.
void collect_structures(const nlohmann::ordered_json& json, const std::string& path, std::set<std::string>& found) {
  if (!json.is_structured()) return;
  if (!path.empty() && path != "timing_ms") found.insert(path);
  for (const auto& [key, value] : json.items())
    collect_structures(value, path + (path.empty() ? "" : ".") + (json.is_array() ? "#" : key), found);
}

TEST_F(SweepRuns, PathsToListsAndObjectsAreKnownBeforeACaseIsComputed) {
  const std::string cube = source_file("assets/cube.glb"), skin = source_file("assets/finger.ply");
  const std::string tip = folder_ / "tip.ply";
  geometry::Mesh ball = geometry::icosphere(4e-3, 3);
  for (Vec3& p : ball.positions)
    p.y += 4e-3;
  geometry::write_ply(tip, ball.positions, ball.triangles);
  const std::string touched = "scene = \"" + cube + "\"\npoints = \"" + skin + "\"\npenetration = \"3mm\"\n";
  const std::pair<const char*, std::string> plans[] = {
      {"touch", touched + "layout = \"openmpd\"\nspectrum = true\ntune = true\n"},
      {"touch", touched + "method = \"multi-focus\"\n"},
      {"drive", "layout = \"openmpd\"\nfocus = [\"0,0,100mm\", \"1mm,0,100mm\"]\nspread = \"phase=0.1\"\ndraws = 20\n"},
      {"field",
       "layout = \"openmpd\"\nfocus = \"0,0,100mm\"\nplane = \"xz\"\nsize = \"2cm,2cm\"\npixels = \"3,3\"\n"
       "spread = \"phase=0.1\"\ndraws = 20\n"},
      {"simulate", "scene = \"" + cube + "\"\nfinger = \"" + tip +
                       "\"\npenetration = \"1mm\"\nlayout = \"openmpd\"\nspread = \"phase=0.1\"\ndraws = 20\n"}};
  setup::ComputeOptions cpu;
  cpu.backend = setup::Backend::cpu;
  for (const auto& [command, options] : plans) {
    std::unique_ptr<sweep::Line> line;
    const sweep::Plan plan =
        sweep::parse_plan(fmt::format("command = \"{}\"\n[options]\n{}", command, options), plan_.string());
    line = sweep::read_line(sweep::command_of(command), sweep::given_by(plan.settings(0)));
    std::set<std::string> found;
    collect_structures(nlohmann::ordered_json::parse(sweep::Workbench(cpu).compute(*line)), "", found);
    EXPECT_GT(found.size(), 3u) << command;
    for (const std::string& path : found)
      EXPECT_NE(sweep::structure_fault(path, sweep::command_of(command).structures), "") << command << " " << path;
  }
}

/// A model's touches, with a time for each of them that is far from this machine's noise. It is processor time, which
/// other programs change little.
TEST_F(SweepRuns, EstimatesAreOfTheRightSize) {
  write_text(plan_,
             fmt::format("command = \"touch\"\n[options]\npoints = \"{}\"\npenetration = \"3mm\"\nscene = "
                         "\"{}\"\n[vary]\ndelta = {{ from = \"2mm\", to = \"3mm\", count = 10 }}\n",
                         source_file("assets/finger.ply").string(), source_file("assets/semi-sphere.glb").string()));
  const sweep::Plan plan = sweep::load_plan(plan_);
  const sweep::Inputs inputs(plan);
  double model_s = 0, took_s = 1e9;
  for (const sweep::Case& one : sweep::list_cases(plan, inputs, true))
    model_s += one.cost.cpu_seconds;
  setup::ComputeOptions cpu;
  cpu.backend = setup::Backend::cpu;
  for (const char* name : {"one", "two", "three"}) {
    const std::clock_t begin = std::clock();
    run_sweep(plan, {.out = out(name), .compute = cpu});
    took_s = std::min(took_s, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  // A build without optimisation takes longer; a machine of tomorrow less.
  EXPECT_GT(took_s, model_s / 4);
  EXPECT_LT(took_s, model_s * (instrumented() ? 1000 : 8));
}

TEST_F(SweepRuns, ClaimersThatAreKilledAtAnyTimeLoseNothing) {
  write_text(plan_,
             "command = \"field\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,100mm\"\nplane = \"xz\"\n"
             "size = \"20mm,20mm\"\npixels = \"30,30\"\n[vary]\ntemperature = { from = 15, to = 25, count = 120 }\n");
  std::minstd_rand random(7);
  const auto start = [&] {
    return start_program(palpa_binary(),
                         {"sweep", plan_, "--out", out("claim"), "--backend", "cpu", "--claim", "--quiet"});
  };
  std::array<pid_t, 2> claimers{start(), start()};
  std::uint64_t kills = 0;
  for (; kills < 12 && sweep::Store(out("claim")).states().size() < 100; ++kills) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + random() % 60));
    pid_t& victim = claimers[random() % 2];
    kill(victim, SIGKILL);
    waitpid(victim, nullptr, 0);
    victim = start();
  }
  for (const pid_t claimer : claimers)
    waitpid(claimer, nullptr, 0);
  // What the last of them left to a claimer that was killed afterwards.
  EXPECT_EQ(compute("claim", {"--claim"}).exit_code, 0);
  std::multiset<std::string> ids;
  sweep::Store(out("claim")).each([&](std::size_t, std::string_view id, sweep::State state, std::string_view) {
    EXPECT_EQ(state, sweep::State::done);
    ids.emplace(id);
  });
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 120u);
  EXPECT_LE(ids.size(), 120u + kills) << "a kill between line and mark lets one case be computed again";
  EXPECT_EQ(compute("one").exit_code, 0);
  EXPECT_EQ(table("claim"), table("one"));
}

}  // namespace
}  // namespace palpa::test
