#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "sweep/plan.hpp"

namespace palpa::sweep {
namespace {

Plan plan_of(const std::string& rest) {
  return parse_plan("command = \"drive\"\n" + rest, "folder/plan.toml");
}

/// The message with which a plan is refused.
std::string fault_of(const std::string& text) {
  try {
    parse_plan(text, "plan.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::bad_input);
    return error.what();
  }
  ADD_FAILURE() << "was read: " << text;
  return {};
}

std::string shown(const Plan& plan, std::uint64_t index) {
  std::string text;
  for (const Setting& setting : plan.settings(index))
    text += setting.option + "=" + setting.shown() + " ";
  return text;
}

TEST(SweepPlan, ItsCasesAreAllCombinationsAndTheLastAxisVariesFastest) {
  const Plan plan = plan_of(
      "[options]\nfocus = \"0,0,150mm\"\n"
      "[vary]\nlayout = [\"openmpd\", \"autd3\"]\nconstraint = [\"normalise\", \"uniform\", \"clamp\"]\n");
  ASSERT_EQ(plan.count(), 6u);
  EXPECT_EQ(plan.folder, "folder");
  EXPECT_EQ(shown(plan, 0), "--focus=0,0,150mm --layout=openmpd --constraint=normalise ");
  EXPECT_EQ(shown(plan, 1), "--focus=0,0,150mm --layout=openmpd --constraint=uniform ");
  EXPECT_EQ(shown(plan, 5), "--focus=0,0,150mm --layout=autd3 --constraint=clamp ");
  std::set<std::string> all;
  for (std::uint64_t i = 0; i < plan.count(); ++i)
    all.insert(shown(plan, i));
  EXPECT_EQ(all.size(), 6u);
  EXPECT_EQ(plan.varied(), (std::vector<std::string>{"--layout", "--constraint"}));
  EXPECT_EQ(plan_of("").count(), 1u);
}

TEST(SweepPlan, ValuesAreWhatACommandLineTakes) {
  const Plan plan = plan_of(
      "[options]\nlayout = \"openmpd\"\nfocus = [\"0,0,0.1\", \"0,0,0.2\"]\nfrequency = 39500\ntemperature = 21.5\n"
      "[vary]\nforce = [true, false]\n");
  setup::Given given = given_by(plan.settings(0));
  EXPECT_EQ(given.at("--focus"), (std::vector<std::string>{"0,0,0.1", "0,0,0.2"}));
  EXPECT_EQ(given.at("--frequency"), std::vector<std::string>{"39500"});
  EXPECT_EQ(given.at("--temperature"), std::vector<std::string>{"21.5"});
  EXPECT_TRUE(given.contains("--force"));
  given = given_by(plan.settings(1));
  EXPECT_FALSE(given.contains("--force"));
  EXPECT_EQ(plan.settings(1).back().shown(), "false");
}

TEST(SweepPlan, StepsAndValuesThatBelongTogether) {
  const Plan plan = plan_of(
      "[vary]\nfrequency = { from = \"39kHz\", to = \"41kHz\", count = 5 }\n"
      "place = [{ layout = \"openmpd\", focus = \"0,0,1cm\" }, { layout = \"autd3\", temperature = 25 }]\n");
  ASSERT_EQ(plan.count(), 10u);
  EXPECT_EQ(shown(plan, 0), "--frequency=39kHz --layout=openmpd --focus=0,0,1cm ");
  EXPECT_EQ(shown(plan, 3), "--frequency=39.5kHz --layout=autd3 --temperature=25 ");
  EXPECT_EQ(shown(plan, 8), "--frequency=41kHz --layout=openmpd --focus=0,0,1cm ");
  EXPECT_EQ(plan.varied(), (std::vector<std::string>{"--frequency", "--layout", "--focus", "--temperature"}));
  // Steps read as people write them: 0.1, 0.2, 0.3 and not 0.30000000000000004.
  const Plan tenths = plan_of("[vary]\ntemperature = { from = 0.1, to = 1.0, count = 10 }\n");
  EXPECT_EQ(shown(tenths, 2), "--temperature=0.3 ");
  EXPECT_EQ(shown(tenths, 9), "--temperature=1 ");
}

TEST(SweepPlan, FaultsAreToldWithTheirLine) {
  const struct {
    const char *text, *told;
  } cases[] = {
      {"command = \"drive\"\nvarry = 1\n", "plan.toml: line 2: unknown key varry"},
      {"command = \"run\"\n",
       "plan.toml: line 1: command is \"run\", but must be one of touch, drive, field, simulate"},
      {"[vary]\n", "plan.toml: command is missing"},
      {"command = \"drive\"\n[vary]\nlayuot = [\"openmpd\"]\n",
       "line 3: layuot is not an option that a case can have; "
       "did you mean layout?"},
      {"command = \"drive\"\n[options]\njson = \"x\"\n", "line 3: json is not an option that a case can have"},
      {"command = \"drive\"\n[options]\nbackend = \"cpu\"\n", "line 3: backend is not an option that a case can have"},
      {"command = \"drive\"\n[options]\ncsv = \"x\"\n", "line 3: csv is not an option that a case can have"},
      {"command = \"drive\"\n[options]\nfrequency = \"fast\"\n", "line 3: --frequency: 'fast' is not a frequency"},
      {"command = \"drive\"\n[options]\nfrequency = true\n", "line 3: frequency must be a text or a number"},
      {"command = \"drive\"\n[options]\nforce = 1\n", "line 3: force must be true or false"},
      {"command = \"drive\"\n[options]\nfrequency = 1979-05-27\n", "line 3: frequency must be a text of one line"},
      {"command = \"drive\"\n[vary]\nsolver = [\"naive\", \"best\"]\n",
       "line 3: --solver: 'best' is not one of naive|"},
      {"command = \"drive\"\n[vary]\nsolver = \"naive\"\n", "line 3: solver must be a list of values"},
      {"command = \"drive\"\n[vary]\nsolver = []\n", "line 3: solver must be a list of values"},
      {"command = \"drive\"\n[vary]\nslot = [1, 2, 1]\n", "line 3: slot has a value twice: 1"},
      {"command = \"drive\"\n[vary]\nfrequency = {from = \"1kHz\", to = 2, count = 3}\n", "with the same unit"},
      {"command = \"drive\"\n[vary]\nfrequency = {from = 1, to = 2, count = 2.5}\n", "count must be a whole number"},
      {"command = \"drive\"\n[vary]\nfrequency = {from = 1, to = 2, step = 2}\n", "line 3: unknown key step"},
      {"command = \"drive\"\n[options]\nslot = 1\n[vary]\nslot = [1, 2]\n",
       "slot is set in [options] and in slot of [vary]: set it in one place"},
      {"command = \"drive\"\nresults = []\n", "line 2: results is empty"},
      {"command = \"drive\"\nresults = [\"a..b\"]\n", "line 2: results: a..b has an empty part"},
      {"command = \"field\"\nresults = [\"timing_ms.total\"]\n", "is a time or a backend, which depends"},
      {"command = \"touch\"\nresults = [\"backend\"]\n", "backend is a time or a backend"},
      {"command = \"touch\"\nresults = [\"fingers\"]\n",
       "line 2: results: fingers is a list; name one of its entries, such as fingers.0, or fingers.count"},
      {"command = \"touch\"\nresults = [\"points\", \"fingers.12.schedule\"]\n",
       "line 2: results: fingers.12.schedule is an object; name one of its entries, such as "
       "fingers.12.schedule.dwell_s"},
      {"command = \"drive\"\n[options]\nfocus = \"0,0\"\n", "line 3: --focus: '0,0' is not a point x,y,z"},
      {"command = \"drive\"\n[vary]\nfocus = [\"0,0,1cm\", \"0,0,1cm,2\"]\n",
       "line 3: --focus: '0,0,1cm,2' is not x,y,z,a"},
      {"command = \"field\"\n[options]\nline = [\"0,0,0\", \"0,0\"]\n", "line 3: --line: '0,0' is not a point x,y,z"},
      {"command = \"drive\"\nkeep = \"all\"\n", "line 2: keep must be \"results\" or \"everything\""},
  };
  for (const auto& [text, told] : cases)
    EXPECT_NE(fault_of(text).find(told), std::string::npos) << text << "\n" << fault_of(text);
}

TEST(SweepPlan, TooManyCasesAreCountedAndNotListed) {
  std::string text = "command = \"touch\"\n[vary]\n";
  for (const char* option : {"delta", "finger-gap", "penetration"})
    text += std::string(option) + " = { from = \"1mm\", to = \"2mm\", count = 1000 }\n";
  EXPECT_EQ(fault_of(text),
            "plan.toml: has 1,000,000,000 cases (1,000 delta x 1,000 finger-gap x 1,000 penetration); a plan has at "
            "most 1,000,000: vary less, or divide it");
  // They are counted before the values are made: a key that is no option is found later.
  text += "very = { from = 1, to = 2, count = 1000000 }\n";
  EXPECT_NE(fault_of(text).find("has 1,000,000,000,000,000 cases"), std::string::npos) << fault_of(text);
  for (const char* option : {"dwell", "spot", "finger-width", "modulation-frequency"})
    text += std::string(option) + " = { from = 0.001, to = 0.01, count = 1000 }\n";
  EXPECT_NE(fault_of(text).find("more than 18,446,744,073,709,551,615 cases"), std::string::npos) << fault_of(text);
}

}  // namespace
}  // namespace palpa::sweep
