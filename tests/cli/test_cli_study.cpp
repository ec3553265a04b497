// `palpa study analyse`, `compare` and `power`, as an experimenter uses them.
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
#include "cli/support/tiny_files.hpp"
#include "support/exhaustive.hpp"
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

class CliStudy : public testing::Test {
 protected:
  const std::filesystem::path folder_ = scratch_folder("study");

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static json result_of(const std::vector<std::string>& line) {
    const Result result = palpa_here(with(line, {"--json", "-"}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? json::parse(result.out) : json();
  }
};

TEST_F(CliStudy, AnalysesThePapersTables) {
  write_text(folder_ / "single.csv", single);
  const json tables = result_of({"study", "analyse", path("single.csv")})["tables"];
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0]["accuracy"], 0.39);
  EXPECT_EQ(tables[0]["dprime"], 0.4892759241);
  const Result summary = palpa_here({"study", "analyse", path("single.csv")});
  EXPECT_EQ(summary.err, "");
  EXPECT_NE(summary.out.find("156 of 400 correct: 0.390, d' 0.489"), std::string::npos) << summary.out;
}

TEST_F(CliStudy, AnalysesTenParticipants) {
  write_ten(folder_);
  const json result = result_of({"study", "analyse", folder_});
  EXPECT_EQ(result["pairs"][0]["wilcoxon"]["p_two_sided"], 2.0 / 1024);
  EXPECT_EQ(result["methods"][0]["mean_accuracy"], 0.39);
  EXPECT_EQ(result["methods"][1]["mean_accuracy"], 0.6525);
  // The program itself, and again: the same bytes.
  const std::vector<std::string> line{"study", "analyse", folder_, "--html", path("a.html"), "--csv", path("a.csv")};
  const Result program = palpa(line);
  EXPECT_EQ(program.exit_code, 0) << program.err;
  EXPECT_EQ(program.err, "");
  const std::string html = read_text(path("a.html")), csv = read_text(path("a.csv"));
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_EQ(palpa_here(line).out, program.out);
  EXPECT_EQ(read_text(path("a.html")), html);
  EXPECT_EQ(read_text(path("a.csv")), csv);
}

TEST_F(CliStudy, TheSeedChoosesTheResamples) {
  write_ten(folder_);
  const auto with_seed = [&](const char* seed) { return result_of({"study", "analyse", folder_, "--seed", seed}); };
  const json one = with_seed("1"), other = with_seed("2");
  EXPECT_EQ(one["seed"], 1);
  EXPECT_EQ(one["pairs"][0]["wilcoxon"], other["pairs"][0]["wilcoxon"]);
  EXPECT_EQ(one, with_seed("1"));
}

TEST_F(CliStudy, WarnsOfWhatIsLeftOut) {
  write_ten(folder_);
  std::string text = events_text("single-focus", 18);
  text.resize(text.size() - 5);
  write_events(events_place(folder_, 1), text);
  const Result result = palpa_here({"study", "analyse", folder_, "--quiet", "--json", path("a.json")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "") << "--quiet";
  const Result loud = palpa_here({"study", "analyse", folder_, "--json", path("a.json")});
  ASSERT_EQ(loud.err_lines().size(), 1u) << loud.err;
  EXPECT_NE(loud.err.find("_events.tsv: line 44: the line has no end: the file is cut off here; the row is left out"),
            std::string::npos)
      << loud.err;
  EXPECT_EQ(json::parse(read_text(path("a.json")))["left_out"].size(), 1u);
}

TEST_F(CliStudy, ComparesAnythingWithAnything) {
  write_text(folder_ / "single.csv", single);
  write_ten(folder_ / "mine");
  ASSERT_EQ(palpa_here({"study", "analyse", path("mine"), "--json", path("mine.json"), "--quiet"}).exit_code, 0);
  const json result = result_of({"study", "compare", "paper", path("single.csv"), path("mine"), path("mine.json")});
  ASSERT_EQ(result["tables"].size(), 7u);
  EXPECT_EQ(result["tables"][0]["accuracy"], 0.39);
  EXPECT_EQ(result["tables"][1]["accuracy"], 0.6525);
  EXPECT_EQ(result["tables"][2]["counts"], result["tables"][0]["counts"]);
  EXPECT_EQ(result["tables"][3]["counts"], result["tables"][5]["counts"]);
  EXPECT_EQ(result["pairs"].size(), 21u);
  EXPECT_EQ(result["pairs"][0]["tables"]["likelihood_ratio"], 92.13556425);
  EXPECT_EQ(result["pairs"][1]["tables"]["rms"], 0);
}

TEST_F(CliStudy, ReportsReplaceNoFileOfAParticipant) {
  write_ten(folder_ / "mine");
  const auto participant = folder_ / "mine/sub-1";
  ASSERT_TRUE(std::filesystem::exists(participant));
  const std::string journal = (participant / "sub-1_journal.jsonl").string();
  write_text(journal, "what was answered\n");
  for (const std::string option : {"--html", "--csv", "--json"}) {
    for (const std::string& file : {journal, (participant / "beh/new.html").string()}) {
      for (const std::vector<std::string>& command :
           {std::vector<std::string>{"study", "analyse"}, std::vector<std::string>{"study", "compare", "paper"}}) {
        const Result result = palpa_here(with(command, {path("mine"), option, file}));
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_NE(result.err.find("is in the folder of a participant"), std::string::npos) << result.err;
      }
    }
  }
  EXPECT_EQ(read_text(journal), "what was answered\n");
  EXPECT_FALSE(std::filesystem::exists(participant / "beh/new.html"));
}

TEST_F(CliStudy, FindsTheNumberOfParticipants) {
  const json result = result_of({"study", "power", "--people", "12", "--studies", "200", "--seed", "3"});
  EXPECT_EQ(result["participants"], 6);
  EXPECT_EQ(result["seed"], 3);
  EXPECT_EQ(result["accuracies"], json({0.39, 0.6525}));
}

TEST_F(CliStudy, ListsAParticipantsSteps) {
  const std::string paper = source_file("assets/studies/paper.toml");
  const OwnCache cache(folder_ / "cache");
  const json first = result_of({"study", "plan", paper}),
             sixth = result_of({"study", "plan", paper, "--participant", "6"});
  EXPECT_EQ(first["steps"].size(), 92u);
  EXPECT_EQ(first["steps"][0]["method"], "single-focus");
  EXPECT_EQ(sixth["steps"][0]["method"], "cross-section");
  const Result text = palpa_here({"study", "plan", paper, "--csv", path("order.csv")});
  EXPECT_NE(text.out.find("single-focus   trial           40 x 10 s"), std::string::npos) << text.out;
  EXPECT_EQ(read_text(path("order.csv")).substr(0, 26), "step,kind,method,shape\n1,f");
  EXPECT_NEAR(first["crest_n"].get<double>(), 0.04 * 0.04 * 51.8e-3, 2e-6);
  EXPECT_CONTAINS(text.out, "at the ceiling 0.04: ");
  EXPECT_CONTAINS(text.out, " dB predicted at the louder ear (limit 110 dB), a force of 0.083 mN");
  // A copy of the plan has the same models.
  std::filesystem::copy_file(paper, folder_ / "copy.toml");
  EXPECT_EQ(result_of({"study", "plan", path("copy.toml")})["steps"], first["steps"]);
  // A model of the plan is an input.
  write_text(folder_ / "cube.glb", "x");
  write_text(folder_ / "ball.glb", "x");
  write_text(folder_ / "plan.toml",
             "[[shape]]\nname = \"cube\"\nmodel = \"cube.glb\"\n[[shape]]\nname = \"ball\"\nmodel = \"ball.glb\"\n"
             "[[method]]\nname = \"single-focus\"\n[study]\ntrials_per_shape = 2\n");
  expect_failure(palpa_here({"study", "plan", path("plan.toml"), "--csv", path("cube.glb")}), 2, "--csv");
  EXPECT_EQ(read_text(path("cube.glb")), "x");
  std::filesystem::remove(path("ball.glb"));
  expect_failure(palpa_here({"study", "plan", path("plan.toml")}), 4, "the model of 'ball' is missing");
}

/// What a microphone read replaces the prediction.
TEST_F(CliStudy, SaysHowLoudItIsAtAnEar) {
  const auto write_plan = [&](const std::string& level, const std::string& ball = "palpa:semi-sphere.glb") {
    write_text(folder_ / "plan.toml",
               "[[shape]]\nname = \"cube\"\nmodel = \"palpa:cube.glb\"\n[[shape]]\nname = \"ball\"\nmodel = \"" + ball +
                   "\"\n[[method]]\nname = \"single-focus\"\nlayout = \"openmpd\"\n"
                   "[study]\ntrials_per_shape = 2\n[level]\n" +
                   level);
  };
  write_plan("ceiling = 0.05\nlimit_db = 120\n");
  const json predicted = result_of({"study", "level", path("plan.toml")});
  EXPECT_EQ(predicted["level_db"], std::max(predicted["left_db"], predicted["right_db"]));
  EXPECT_GT(predicted["bound_db"], predicted["level_db"]);
  EXPECT_FALSE(predicted.contains("measured_db"));
  write_plan("ceiling = 0.05\nlimit_db = 120\nmeasured_db = 98\nmeasured_ceiling = 0.025\n");
  const json measured = result_of({"study", "level", path("plan.toml")});
  EXPECT_NEAR(measured["level_db"].get<double>(), 98 + 20 * std::log10(2.0), 1e-9);
  EXPECT_EQ(measured["left_db"], predicted["left_db"]);
  const Result text = palpa_here({"study", "level", path("plan.toml")});
  EXPECT_CONTAINS(text.out, "measured: 98.0 dB at the ceiling 0.025, so 104.0 dB at 0.05; this counts");
  EXPECT_EQ(text.err, "");
  write_plan("ceiling = 0.05\nlimit_db = 100\nmeasured_db = 98\nmeasured_ceiling = 0.025\n");
  const Result loud = palpa_here({"study", "level", path("plan.toml")});
  EXPECT_EQ(loud.exit_code, 2);
  EXPECT_CONTAINS(loud.err, "104.0 dB are measured at an ear");
  write_plan("ceiling = 0.05\nlimit_db = 120\nmeasured_db = 40\nmeasured_ceiling = 0.05\n");
  const Result deaf = palpa_here({"study", "level", path("plan.toml")});
  EXPECT_EQ(deaf.exit_code, 2);
  EXPECT_CONTAINS(deaf.err, "does not hear 40 kHz");
  EXPECT_CONTAINS(deaf.err, "it is not of this sound");
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
    write_plan("ceiling = 0.05\nlimit_db = 120\n", "model.gltf");
    return result_of({"study", "level", path("plan.toml")})["level_db"].get<double>();
  };
  const std::string in_cube = "[0,-0.02,0]";
  EXPECT_NEAR(with_node("", in_cube), predicted["level_db"].get<double>(), 1e-9);
  for (const char* asks : {"palpa_pressure_pa", "\\u0070alpa_pressure_pa"}) {
    EXPECT_GT(with_node(std::string(",\"extras\":{\"") + asks + "\":2000}", in_cube),
              predicted["level_db"].get<double>() + 2);
    EXPECT_CONTAINS(palpa_here({"study", "level", path("plan.toml")}).out, "with equal amplitudes");
  }
  EXPECT_GT(with_node("", "[0,0.04,0.06]"), predicted["level_db"].get<double>() + 1);
}

/// What a plan names is read before people come.
TEST_F(CliStudy, APlansFilesAreRead) {
  const auto write_plan = [&](const std::string& model, const std::string& masking) {
    write_text(folder_ / "plan.toml",
               "[[shape]]\nname = \"cube\"\nmodel = \"palpa:cube.glb\"\n[[shape]]\nname = \"ball\"\n"
               "model = \"" +
                   model +
                   "\"\n[[method]]\nname = \"single-focus\"\n[study]\n"
                   "trials_per_shape = 2\n[run]\nmasking = \"" +
                   masking + "\"\n");
  };
  const std::vector<std::vector<std::string>> lines{
      {"study", "plan", path("plan.toml")},
      {"study", "rehearse", path("plan.toml"), "--participant", "1", "--out", path("out")}};
  write_text(folder_ / "ball.glb", "x");
  write_text(folder_ / "noise.wav", "x");
  using namespace std::string_literals;
  const std::string format = "fmt \x10\0\0\0\1\0\1\0\x40\x1f\0\0\x80\x3e\0\0\2\0\x10\0"s;
  write_text(folder_ / "mute.wav", "RIFF\x24\0\0\0WAVE"s + format + "data\0\0\0\0"s);
  write_text(folder_ / "sound.wav", "RIFF\x28\0\0\0WAVE"s + format + "data\4\0\0\0\0\0\1\0"s);
  for (const std::vector<std::string>& line : lines) {
    write_plan("ball.glb", "off");
    expect_failure(palpa_here(line), 4, "ball.glb");
    for (const char* masking : {"noise.wav", "mute.wav"}) {
      write_plan("palpa:semi-sphere.glb", masking);
      expect_failure(palpa_here(line), 4, std::string(masking) + ": is no WAV file with a sound");
    }
    EXPECT_FALSE(std::filesystem::exists(path("out"))) << "nothing was begun";
    write_plan("palpa:semi-sphere.glb", "sound.wav");
    const Result result = palpa_here(line);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
}

TEST_F(CliStudy, PowerWarnsOfMeansThatCannotBe) {
  const std::vector<std::string> few{"--people", "2", "--studies", "100"};
  EXPECT_EQ(palpa_here(with({"study", "power"}, few)).err, "");
  const Result result = palpa_here(with({"study", "power", "--baseline", "0.05", "--accuracy", "1"}, few));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_CONTAINS(result.err,
                  "--baseline 0.05: with --spread 0.1, some participants would have an accuracy below 0; they "
                  "get 0, so the simulated mean is 0.070");
  EXPECT_CONTAINS(result.err,
                  "--accuracy 1: with --spread 0.1, some participants would have an accuracy above 1; they get "
                  "1, so the simulated mean is 0.960");
}

TEST_F(CliStudy, RehearsesAndWithdraws) {
  const std::string plan = source_file("assets/studies/five-minutes.toml"), out = path("rehearsal");
  const std::vector<std::string> line{"study", "rehearse", plan, "--participant", "1", "--out", out, "--accuracy", "1"};
  const json result = result_of(line);
  EXPECT_EQ(result["ended"], true);
  EXPECT_EQ(result["complete"], 4 + 1 + 2 * (1 + 12));
  EXPECT_EQ(result_of(line)["starts"], 1) << "what has finished is only reported again";
  const Result analysis = palpa_here({"study", "analyse", out, "--json", path("a.json")});
  EXPECT_EQ(analysis.exit_code, 0) << analysis.err;
  EXPECT_NE(analysis.err.find("is a rehearsal"), std::string::npos) << analysis.err;
  EXPECT_EQ(json::parse(read_text(path("a.json")))["methods"][0]["mean_accuracy"], 1.0);
  // No log has the name of the user or the host.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
    if (!entry.is_regular_file()) continue;
    const std::string text = read_text(entry.path());
    EXPECT_EQ(text.find(out), std::string::npos) << entry.path();
  }
  expect_failure(palpa_here({"study", "rehearse", path("none.toml"), "--participant", "1", "--out", out}), 4,
                 "no such file");
  expect_failure(palpa_here({"study", "rehearse", plan, "--out", out}), 2, "--participant is missing");
  expect_failure(palpa_here({"study", "rehearse", plan, "--participant", "Anna", "--out", out}), 2, "--participant");

  const Result withdrawn = palpa_here({"study", "withdraw", "1", "--out", out});
  EXPECT_EQ(withdrawn.exit_code, 0) << withdrawn.err;
  EXPECT_NE(withdrawn.out.find("participant 1 has withdrawn"), std::string::npos);
  EXPECT_NE(palpa_here({"study", "withdraw", "1", "--out", out}).out.find("had withdrawn before"), std::string::npos);
  expect_failure(palpa_here(line), 2, "participant 1 withdrew");
  expect_failure(palpa_here({"study", "analyse", out}), 4, "the participant withdrew");
  expect_failure(palpa_here({"study", "withdraw", "Anna", "--out", out}), 2, "participants are numbers");
  expect_failure(palpa_here({"study", "withdraw", "2", "--out", out}), 4, "has no participant 2");
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
    usleep(wait_us);
    run.signal(SIGKILL);
    killed += run.wait(60).by_signal == SIGKILL ? 1 : 0;
  }
  EXPECT_GT(killed, 0u);
  const Result end = palpa_here({"study", "rehearse", source_file("assets/studies/paper.toml"), "--participant", "3",
                                 "--out", out, "--json", "-"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json result = json::parse(end.out);
  EXPECT_EQ(result["complete"], 92);
  EXPECT_LE(result["void"].get<std::uint32_t>(), killed);
  const json people = result_of({"study", "analyse", out})["participants"];
  ASSERT_EQ(people.size(), 2u) << "one person with two methods";
  for (const json& person : people)
    EXPECT_EQ(person["trials"], 40);
}

TEST_F(CliStudy, SaysWhatIsWrong) {
  const auto refused = [](const std::vector<std::string>& line, int code, const std::string& told) {
    expect_failure(palpa_here(line), code, told);
  };
  refused({"study", "analyse"}, 2, "give palpa study analyse the folder of a study, or a CSV file of counts");
  refused({"study", "analyse", ""}, 2, "is empty");
  refused({"study", "analyse", path("none")}, 4, "no such file");
  refused({"study", "analyse", folder_}, 4, "has no participants");
  refused({"study", "compare"}, 2, "at least two tables");
  write_text(folder_ / "single.csv", single);
  refused({"study", "compare", path("single.csv")}, 2, "one table alone cannot be compared");
  refused({"study", "compare", "paper", path("none.json")}, 4, "none.json: no such file");
  refused({"study", "analyse", path("single.csv"), folder_}, 4, "single.csv: is not a folder");
  refused({"study", "power", "--studies", "20000", "--trials", "1000"}, 2, "is more than 400 million");
  refused({"study", "power", "--alpha", "0"}, 2, "--alpha");
  refused({"study", "power", "--people", "1"}, 2, "from 2 to 200");
  write_text(folder_ / "bad.csv", "actual,a,b\na,1,-1\nb,0,1\n");
  refused({"study", "analyse", path("bad.csv")}, 4, "bad.csv: line 2: '-1' is not a count");
}

}  // namespace
}  // namespace palpa::test
