// `palpa study analyse`, `compare` and `power`, as an experimenter uses them.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"

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

TEST_F(CliStudy, FindsTheNumberOfParticipants) {
  const json result = result_of({"study", "power", "--people", "12", "--studies", "200", "--seed", "3"});
  EXPECT_EQ(result["participants"], 6);
  EXPECT_EQ(result["seed"], 3);
  EXPECT_EQ(result["accuracies"], json({0.39, 0.6525}));
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
  refused({"study", "compare", path("single.csv")}, 2, "one table has nothing beside it");
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
