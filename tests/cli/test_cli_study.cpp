// `palpa study analyse`, `compare` and `power`, as an experimenter uses them.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "cli/support/here.hpp"
#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "cli/support/report.hpp"
#include "cli/support/tiny_files.hpp"
#include "cli/support/told.hpp"
#include "support/exhaustive.hpp"
#include "support/occurrences.hpp"
#include "support/own_cache.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

constexpr const char* single =
    "actual,cube,semi-sphere,pyramid,prism\ncube,50,30,9,11\nsemi-sphere,23,42,16,19\n"
    "pyramid,13,37,26,24\nprism,17,18,27,38\n";

/// The exit code of a program that does nothing, traced.
int succeeded_under(const std::filesystem::path& strace) {
  return run_program(strace, {"-qq", "-o", "/dev/null", "/bin/true"}).exit_code;
}

class CliStudy : public testing::Test {
 protected:
  const std::filesystem::path folder_ = scratch_folder("study");
  /// All tests share what palpa keeps of the fingers' sound.
  const OwnCache cache_{kept()};

  static const std::filesystem::path& kept() {
    static const std::filesystem::path folder = scratch_folder("study-cache");
    return folder;
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// A plan of two shapes and a method, plan.toml; `rest` is the end of the method and what follows.
  void write_plan(const std::string& ball, const std::string& rest) const {
    write_text(folder_ / "plan.toml",
               "[study]\ntrials_per_shape = 2\n[[shape]]\nname = \"cube\"\nmodel = \"palpa:cube.glb\"\n"
               "[[shape]]\nname = \"ball\"\nmodel = \"" +
                   ball + "\"\n[[method]]\nname = \"single-focus\"\n" + rest);
  }
};

TEST_F(CliStudy, AnalysesThePapersTables) {
  write_text(folder_ / "single.csv", single);
  EXPECT_CONTAINS(palpa_here({"study", "analyse", path("single.csv")}).out, "156 of 400 correct: 0.390, d' 0.489");
}

TEST_F(CliStudy, AnalysesTenParticipantsWithTheSameBytesForTheSameSeed) {
  write_ten(folder_ / "ten");
  const auto reports = [&] {
    const json numbers = report_of(
        {"study", "analyse", path("ten"), "--seed", "7", "--html", path("ten.html"), "--csv", path("ten.csv")});
    EXPECT_EQ(numbers["pairs"][0]["wilcoxon"]["p_two_sided"], 2.0 / 1024);
    EXPECT_EQ(numbers["methods"][0]["mean_accuracy"], 0.39);
    EXPECT_EQ(numbers["methods"][1]["mean_accuracy"], 0.6525);
    EXPECT_EQ(numbers["seed"], 7);
    return std::vector<std::string>{numbers.dump(), read_text(path("ten.html")), read_text(path("ten.csv"))};
  };
  const std::vector<std::string> one = reports();
  EXPECT_CONTAINS(one[1], "<svg");
  EXPECT_EQ(reports(), one);
}

/// The program is killed at the n-th call of one kind, for each n that there is: whatever the journal has as answered
/// is then in the log, or the analysis names it.
TEST_F(CliStudy, ProgramsThatAreKilledWhileTheyWriteLoseNoAnswerWithoutAWord) {
  const std::filesystem::path strace = "/usr/bin/strace";
  if (!std::filesystem::exists(strace)) GTEST_SKIP() << "skipped: no strace, with which programs are killed at a call";
  if (succeeded_under(strace) != 0) GTEST_SKIP() << "skipped: no program may be traced here";
  write_plan("palpa:pyramid.glb", "[[block]]\nkind = \"trial\"\n");
  std::size_t named = 0, kills = 0;
  for (const std::string call : {"fdatasync", "linkat", "rename"}) {
    for (int n = 1;; ++n) {
      const std::string out = path(fmt::format("{}-{}", call, n));
      const Result run = run_program(strace,
                                     {"-f", "-qq", "-o", "/dev/null", "-e", "trace=" + call, "-e",
                                      fmt::format("inject={}:signal=KILL:when={}", call, n), palpa_binary(), "study",
                                      "rehearse", path("plan.toml"), "--participant", "1", "--out", out, "--quiet"},
                                     {.environment = {where_assets_are()}});
      if (run.exit_code == 0) break;
      ASSERT_EQ(run.signal, SIGKILL) << run.err;
      ++kills;
      const std::filesystem::path sub = std::filesystem::path(out) / "sub-01";
      const auto journal = sub / "sub-01_journal.jsonl", log = sub / "beh/sub-01_task-shapes_run-01_events.tsv";
      const auto count = [](const std::filesystem::path& file, const char* what) {
        return std::filesystem::exists(file) ? occurrences(read_text(file), what) : 0;
      };
      const std::size_t answered = count(journal, "{\"what\":\"answer\""), logged = count(log, "\tanswered\t");
      ASSERT_GE(answered, logged);
      const Result analysis = palpa_here({"study", "analyse", out});
      const std::string told = analysis.out + analysis.err;
      if (answered > logged) {
        ++named;
        EXPECT_CONTAINS(told, "in no log, because the program was killed") << call << " " << n;
      } else if (answered > 0) {
        EXPECT_EQ(told.find("in no log"), std::string::npos) << call << " " << n << ": " << told;
        EXPECT_CONTAINS(told, count(journal, "\"finish\"") == 0 ? "the sitting is not finished" : "1 participant");
      }
    }
  }
  EXPECT_GT(named, 3u);
  EXPECT_GT(kills, 20u);
}

TEST_F(CliStudy, WarnsOfWhatIsLeftOut) {
  write_ten(folder_);
  std::string text = events_text("single-focus", 18);
  text.resize(text.size() - 5);
  write_events(events_place(folder_, 1), text);
  expect_warned({"study", "analyse", folder_},
                {{{"--quiet"}, ""},
                 {{}, "_events.tsv: line 44: the line has no end: the file is cut off here; the row is left out"}});
  EXPECT_EQ(report_of({"study", "analyse", folder_})["left_out"].size(), 1u);
}

TEST_F(CliStudy, WarningsInReportsNameFilesWithoutTheFoldersOfThisComputer) {
  for (const std::string study : {"one/mine", "two/mine"}) {
    write_ten(folder_ / study);
    std::filesystem::create_directory(folder_ / study / "sub-x");
  }
  write_text(folder_ / "counts.csv", "actual,a,b\na,1,2\nb,3,4");
  const std::string fault = ": is not a participant with a number, such as sub-7; it is left out";
  const auto lines = [&](std::vector<std::string> line) {
    line.insert(line.end(), {"--html", path("report.html"), "--csv", path("report.csv")});
    const json result = report_of(line);
    EXPECT_EQ(result.dump().find(folder_.string()), std::string::npos);
    for (const char* file : {"report.html", "report.csv"})
      EXPECT_EQ(read_text(path(file)).find(folder_.string()), std::string::npos) << file;
    return result["left_out"];
  };
  EXPECT_EQ(lines({"study", "analyse", path("one/mine") + "/"}), json({"mine/sub-x" + fault}));
  EXPECT_EQ(lines({"study", "compare", path("one/mine"), path("two/mine")}),
            json({"one/mine/sub-x" + fault, "two/mine/sub-x" + fault}));
  EXPECT_EQ(lines({"study", "analyse", path("counts.csv")}),
            json({"counts.csv: line 3 has no end: check that the file is complete"}));
}

TEST_F(CliStudy, ComparesAnythingWithAnything) {
  write_text(folder_ / "single.csv", single);
  write_ten(folder_ / "mine");
  succeeded(palpa_here({"study", "analyse", path("mine"), "--json", path("mine.json"), "--quiet"}));
  succeeded(palpa_here({"study", "analyse", path("single.csv"), "--json", path("single.json"), "--quiet"}));
  const json counts = report_of({"study", "compare", path("single.csv"), path("single.json")});
  EXPECT_EQ(counts["tables"][1]["counts"], counts["tables"][0]["counts"]);
  const json result = report_of({"study", "compare", "paper", path("single.csv"), path("mine"), path("mine.json")});
  ASSERT_EQ(result["tables"].size(), 7u);
  EXPECT_EQ(result["tables"][0]["accuracy"], 0.39);
  EXPECT_EQ(result["tables"][1]["accuracy"], 0.6525);
  EXPECT_EQ(result["tables"][2]["counts"], result["tables"][0]["counts"]);
  EXPECT_EQ(result["tables"][3]["counts"], result["tables"][5]["counts"]);
  EXPECT_EQ(result["pairs"].size(), 21u);
  EXPECT_EQ(result["pairs"][0]["tables"]["likelihood_ratio"], 92.13556425);
  EXPECT_EQ(result["pairs"][1]["tables"]["rms"], 0);
  // Reports name files without the folders of this computer, as far as they can be told apart.
  const auto names = [](const json& tables) {
    std::vector<std::string> all;
    for (const json& table : tables)
      all.push_back(table["name"]);
    return all;
  };
  EXPECT_EQ(names(result["tables"]),
            (std::vector<std::string>{"paper: single-focus", "paper: cross-section", "single.csv", "mine: single-focus",
                                      "mine: cross-section", "mine.json: single-focus", "mine.json: cross-section"}));
  write_text(folder_ / "mine" / "single.csv", single);
  const json alike = report_of({"study", "compare", path("single.csv"), path("mine/single.csv")});
  EXPECT_EQ(names(alike["tables"]),
            (std::vector<std::string>{folder_.filename().string() + "/single.csv", "mine/single.csv"}));
  EXPECT_EQ(names(report_of({"study", "analyse", path("single.csv")})["tables"]),
            (std::vector<std::string>{"single.csv"}));
}

TEST_F(CliStudy, ReportsReplaceNoFileOfAParticipant) {
  write_ten(folder_ / "mine");
  const auto participant = folder_ / "mine/sub-1";
  const std::string journal = participant / "sub-1_journal.jsonl", fresh = participant / "beh/new.html",
                    read = "is read by this command", told = "is in the folder of a participant";
  write_text(journal, "what was answered\n");
  for (const std::string option : {"--html", "--csv", "--json"}) {
    expect_refused({"study", "analyse", path("mine"), option}, {{{journal}, read}, {{fresh}, told}});
    expect_refused({"study", "compare", "paper", path("mine"), option}, {{{journal}, read}, {{fresh}, told}});
  }
  EXPECT_EQ(read_text(journal), "what was answered\n");
  EXPECT_FALSE(std::filesystem::exists(fresh));
}

TEST_F(CliStudy, ListsAParticipantsSteps) {
  const std::string paper = source_file("assets/studies/paper.toml");
  const json first = report_of({"study", "plan", paper, "--csv", path("order.csv")}),
             sixth = report_of({"study", "plan", paper, "--participant", "6"});
  EXPECT_EQ(first["steps"].size(), 92u);
  EXPECT_EQ(first["steps"][0]["method"], "single-focus");
  EXPECT_EQ(sixth["steps"][0]["method"], "cross-section");
  EXPECT_NEAR(first["crest_n"].get<double>(), 0.04 * 0.04 * 51.8e-3, 2e-6);
  EXPECT_EQ(read_text(path("order.csv")).substr(0, 26), "step,kind,method,shape\n1,f");
  const std::string text = palpa_here({"study", "plan", paper}).out;
  EXPECT_CONTAINS(text, "single-focus   trial           40 x 10 s");
  EXPECT_CONTAINS(text, "at the ceiling 0.04: ");
  EXPECT_CONTAINS(text, " dB predicted at the louder ear (limit 110 dB), a force of 0.083 mN");
  // Without steps, force follows the square of the ceiling.
  EXPECT_NEAR(first["paper_ceiling"].get<double>(), 0.04 * std::sqrt(16e-3 / first["crest_n"].get<double>()), 0.01);
  EXPECT_CONTAINS(text, "the paper's force, 16 mN, needs a ceiling of about 0.56, 132 dB");
}

/// What a microphone read replaces the prediction.
TEST_F(CliStudy, SaysHowLoudItIsAtAnEar) {
  const std::vector<std::string> line{"study", "level", path("plan.toml")};
  const std::string limit =
                        "layout = \"openmpd\"\namplitude = \"distance\"\nconstraint = \"normalise\"\n[level]\nceiling "
                        "= 0.05\nlimit_db = ",
                    at_120_db = limit + "120\n";
  write_plan("palpa:semi-sphere.glb", at_120_db);
  const json predicted = report_of(line);
  EXPECT_EQ(predicted["level_db"], std::max(predicted["left_db"], predicted["right_db"]));
  EXPECT_GT(predicted["bound_db"], predicted["level_db"]);
  EXPECT_FALSE(predicted.contains("measured_db"));
  write_plan("palpa:semi-sphere.glb",
             "layout = \"openmpd\"\namplitude = \"distance\"\nconstraint = \"normalise\"\n[level]\nceiling = "
             "0.025\nlimit_db = 120\n");
  const double quieter_db = predicted["level_db"].get<double>() - report_of(line)["level_db"].get<double>();
  EXPECT_NEAR(quieter_db, 20 * std::log10(2.0), 0.5) << "the first two steps of the board";
  // What the air makes of it follows the square of amplitudes. The whole of it is 40 dB above a tenth.
  const auto heard_at = [&](const std::string& ceiling) {
    write_plan("palpa:semi-sphere.glb", "layout = \"paper\"\n[level]\nceiling = " + ceiling + "\nlimit_db = 150\n");
    return report_of(line)["audible_dba"];
  };
  const json loud = heard_at("1"), quiet = heard_at("0.1");
  EXPECT_GT(loud[0], 30) << "the paper's array, at a participant's ears";
  for (const int end : {0, 1})
    EXPECT_NEAR(loud[end].get<double>() - quiet[end].get<double>(), 40, 1.5) << end;
  EXPECT_CONTAINS(palpa_here(line).out, "at the nearer ear: ");
  write_plan("palpa:semi-sphere.glb", at_120_db + "measured_db = 98\nmeasured_ceiling = 0.025\n");
  const json measured = report_of(line);
  EXPECT_NEAR(measured["level_db"].get<double>(), 98 + quieter_db, 1e-9);
  EXPECT_EQ(measured["left_db"], predicted["left_db"]);
  EXPECT_CONTAINS(palpa_here(line).out, "measured: 98.0 dB at the ceiling 0.025, so 103.9 dB at 0.05; this counts");
  const auto expect_told = [&](const std::string& level, const std::string& told) {
    write_plan("palpa:semi-sphere.glb", level);
    EXPECT_CONTAINS(palpa_here(line).err, told);
  };
  expect_told(at_120_db + "measured_db = 40\nmeasured_ceiling = 0.05\n", "it is not of this sound");
  expect_told(at_120_db + "measured_db = 87\nmeasured_ceiling = 0.05\n", "does not hear 40 kHz");
  expect_told(limit + "100\nmeasured_db = 98\nmeasured_ceiling = 0.025\n", "103.9 dB are measured at an ear");
  // Small models in the cube: the prediction is the cube's. One that asks for a pressure may get full amplitudes, so
  // several foci count. One elsewhere is felt there.
  write_tetrahedron(folder_ / "corners.bin");
  write_scene(folder_ / "plain.gltf", "corners.bin");
  const auto with_node = [&](const std::string& keys, const std::string& at) {
    std::string model = read_text(folder_ / "plain.gltf");
    const std::string node = "{\"mesh\":0}";
    model.replace(model.find(node), node.size(),
                  "{\"mesh\":0,\"scale\":[0.2,0.2,0.2],\"translation\":" + at + keys + "}");
    write_text(folder_ / "model.gltf", model);
    write_plan("model.gltf", at_120_db);
    return report_of(line)["level_db"].get<double>();
  };
  const std::string in_cube = "[0,-0.02,0]";
  EXPECT_NEAR(with_node("", in_cube), predicted["level_db"].get<double>(), 1e-9);
  for (const char* asks : {"palpa_pressure_pa", "\\u0070alpa_pressure_pa"}) {
    EXPECT_GT(with_node(std::string(",\"extras\":{\"") + asks + "\":20000}", in_cube),
              predicted["level_db"].get<double>() + 2);
    EXPECT_CONTAINS(palpa_here(line).out, "with equal amplitudes");
  }
  EXPECT_GT(std::abs(with_node("", "[0,0.04,0.06]") - predicted["level_db"].get<double>()), 0.3);
}

/// The least depths of a spring may be silent, but not all of them.
TEST_F(CliStudy, ASpringThatIsSilentAtEveryDepthOfThePlanIsRefused) {
  write_tetrahedron(folder_ / "corners.bin");
  write_scene(folder_ / "plain.gltf", "corners.bin");
  const auto write_spring = [&](const std::string& rows) {
    std::string model = read_text(folder_ / "plain.gltf");
    const std::string node = "{\"mesh\":0}";
    model.replace(model.find(node), node.size(),
                  "{\"mesh\":0,\"scale\":[0.2,0.2,0.2],\"extras\":{\"palpa_stiffness\":[" + rows + "]}}");
    write_text(folder_ / "spring.gltf", model);
  };
  write_plan("spring.gltf", "layout = \"openmpd\"\n[run]\ndeep_mm = 10\n[level]\nceiling = 0.05\n");
  const std::vector<std::string> line{"study", "plan", path("plan.toml")};
  for (const char* silent : {"0, 0.05, 0.01, 0.2", "0, 0.01, 0.02, 0.47"}) {
    write_spring(silent);
    expect_refused(line, {{{}, "times the intensity at its stiffest", 2}});
  }
  for (const char* sounds : {"0, 0.05, 0.01, 0.25", "0, 1, 0.01, 0", "0, 0, 0.02, 0.5"}) {
    write_spring(sounds);
    const Result result = palpa_here(line);
    EXPECT_EQ(result.exit_code, 0) << sounds << result.err;
  }
}

/// The level at which a force is reached does not depend on the ceiling of the plan, nor on steps of amplitudes there.
TEST_F(CliStudy, ThePapersForceHasTheSameLevelAtEveryCeiling) {
  std::vector<std::string> told;
  for (const char* ceiling : {"0.03", "0.04", "0.5"}) {
    write_plan("palpa:semi-sphere.glb", std::string("layout = \"openmpd\"\n[level]\nceiling = ") + ceiling + "\n");
    const std::string text = palpa_here({"study", "plan", path("plan.toml")}).out;
    const std::size_t at = text.find("the paper's force");
    ASSERT_NE(at, std::string::npos);
    told.push_back(text.substr(at, text.find('\n', at) - at));
  }
  EXPECT_EQ(told[0], told[1]);
  EXPECT_EQ(told[0], told[2]);
}

/// What a plan names is read before people come.
TEST_F(CliStudy, APlansFilesAreRead) {
  write_text(folder_ / "ball.glb", "x");
  write_text(folder_ / "noise.wav", "x");
  using namespace std::string_literals;
  const std::string format = "fmt \x10\0\0\0\1\0\1\0\x40\x1f\0\0\x80\x3e\0\0\2\0\x10\0"s;
  write_text(folder_ / "mute.wav", "RIFF\x24\0\0\0WAVE"s + format + "data\0\0\0\0"s);
  write_text(folder_ / "sound.wav", "RIFF\x28\0\0\0WAVE"s + format + "data\4\0\0\0\0\0\1\0"s);
  for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
           {"study", "plan", path("plan.toml")},
           {"study", "rehearse", path("plan.toml"), "--participant", "1", "--out", path("out")}}) {
    write_plan("ball.glb", "");
    expect_refused(line, {{{}, "ball.glb", 4}});
    for (const std::string masking : {"noise.wav", "mute.wav"}) {
      write_plan("palpa:semi-sphere.glb", "[run]\nmasking = \"" + masking + "\"\n");
      expect_refused(line, {{{}, masking + ": is no WAV file with a sound", 4}});
    }
    EXPECT_FALSE(std::filesystem::exists(path("out"))) << "nothing was begun";
    write_plan("palpa:semi-sphere.glb", "[run]\nmasking = \"sound.wav\"\n");
    succeeded(palpa_here(line));
  }
}

TEST_F(CliStudy, FindsTheNumberOfParticipantsAndWarnsOfMeansThatCannotBe) {
  const json result = report_of({"study", "power", "--people", "12", "--studies", "200", "--seed", "3"});
  EXPECT_EQ(result["participants"], 6);
  EXPECT_EQ(result["seed"], 3);
  EXPECT_EQ(result["accuracies"], json({0.39, 0.6525}));
  expect_warned({"study", "power", "--people", "2", "--studies", "100"},
                {{{}, ""},
                 {{"--baseline", "0.05"},
                  "--baseline 0.05: with --spread 0.1, some participants would have an accuracy below 0; they get 0, "
                  "so the simulated mean is 0.070"},
                 {{"--accuracy", "1"},
                  "--accuracy 1: with --spread 0.1, some participants would have an accuracy above 1; they get 1, so "
                  "the simulated mean is 0.960"}});
}

TEST_F(CliStudy, RehearsesAndWithdraws) {
  const std::string plan = source_file("assets/studies/five-minutes.toml"), out = path("rehearsal");
  const std::vector<std::string> line{"study", "rehearse", plan, "--participant", "1", "--out", out, "--accuracy", "1"};
  const json result = report_of(line);
  EXPECT_EQ(result["ended"], true);
  EXPECT_EQ(result["complete"], 4 + 1 + 2 * (1 + 12));
  EXPECT_EQ(report_of(line)["starts"], 1) << "what has finished is only reported again";
  const Result analysis = succeeded(palpa_here({"study", "analyse", out, "--json", path("a.json")}));
  EXPECT_NE(analysis.err.find("is a rehearsal"), std::string::npos) << analysis.err;
  EXPECT_EQ(json::parse(read_text(path("a.json")))["methods"][0]["mean_accuracy"], 1.0);
  // No log has the name of the user or the host.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
    if (!entry.is_regular_file()) continue;
    const std::string text = read_text(entry.path());
    EXPECT_EQ(text.find(out), std::string::npos) << entry.path();
  }
  expect_refused({"study", "rehearse"}, {{{path("none.toml"), "--participant", "1", "--out", out}, "no such file", 4},
                                         {{plan, "--out", out}, "--participant is missing"},
                                         {{plan, "--participant", "Anna", "--out", out}, "--participant"}});

  EXPECT_EQ(open_to_others(out + "/sub-01"), std::vector<std::filesystem::path>());
  std::filesystem::create_hard_link(out + "/sub-01/sub-01_journal.jsonl", folder_ / "copy");
  std::vector<std::filesystem::path> before;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out))
    before.push_back(entry);
  const Result withdrawn = palpa_here({"study", "withdraw", "1", "--out", out});
  EXPECT_NE(
      withdrawn.err.find("sub-01_journal.jsonl remains under 1 other name elsewhere (hard links), which find -inum"),
      std::string::npos)
      << withdrawn.err;
  EXPECT_EQ(withdrawn.exit_code, 0) << withdrawn.err;
  const auto erased = std::ranges::count_if(before, [](const auto& place) { return !std::filesystem::exists(place); });
  EXPECT_CONTAINS(withdrawn.out, fmt::format("participant 1 has withdrawn: {} files and folders erased\n", erased));
  EXPECT_NE(palpa_here({"study", "withdraw", "1", "--out", out}).out.find("had withdrawn before"), std::string::npos);
  expect_refused(line, {{{}, "participant 1 withdrew"}});
  expect_refused({"study"}, {{{"analyse", out}, "the participant withdrew", 4},
                             {{"withdraw", "Anna", "--out", out}, "participants are numbers"},
                             {{"withdraw", "2", "--out", out}, "has no participant 2", 4}});
}

TEST_F(CliStudy, KilledAtRandomInstantsNoTrialIsLostOrDoubled) {
  const std::string out = path("killed");
  const std::vector<std::string> line{
      "rehearse", source_file("assets/studies/paper.toml"), "--participant", "3", "--out", out, "--quiet"};
  Random random(5);
  const std::uint32_t kills = exhaustive() ? 100 : 4;
  std::uint32_t killed = 0;
  for (std::uint32_t i = 0; i < kills; ++i) {
    LiveRun run(line, {.command = "study"});
    const auto wait_us = static_cast<useconds_t>(random.below(60'000));
    if (i > 0) usleep(wait_us);  // the first is killed for certain, however slow this process is
    run.signal(SIGKILL);
    killed += run.wait(60).by_signal == SIGKILL ? 1 : 0;
  }
  EXPECT_GT(killed, 0u);
  const Result end = succeeded(palpa_here({"study", "rehearse", source_file("assets/studies/paper.toml"),
                                           "--participant", "3", "--out", out, "--json", "-"}));
  const json result = json::parse(end.out);
  EXPECT_EQ(result["complete"], 92);
  EXPECT_LE(result["void"].get<std::uint32_t>(), killed);
  const json people = report_of({"study", "analyse", out})["participants"];
  ASSERT_EQ(people.size(), 2u) << "one person with two methods";
  for (const json& person : people)
    EXPECT_EQ(person["trials"], 40);
}

}  // namespace
}  // namespace palpa::test
