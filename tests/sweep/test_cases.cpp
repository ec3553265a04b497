#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "sweep/cases.hpp"

namespace palpa::sweep {
namespace {

namespace fs = std::filesystem;

class SweepCases : public testing::Test {
 protected:
  fs::path folder_ = test::scratch_folder("sweep-cases");

  void SetUp() override {
    for (const std::string name : {"cube.glb", "hand.glb", "finger.ply"})
      fs::copy_file(test::source_file("assets/" + name), folder_ / name, fs::copy_options::overwrite_existing);
  }
  std::vector<std::string> ids(const std::string& text, const std::string& name = "plan.toml") const {
    const Plan plan = parse_plan(text, folder_ / name);
    const Inputs inputs(plan);
    std::vector<std::string> all;
    for (const Case& one : list_cases(plan, inputs, false))
      all.push_back(one.id);
    return all;
  }
};

const std::string touches =
    "command = \"touch\"\n[options]\nscene = \"cube.glb\"\npoints = \"finger.ply\"\n"
    "[vary]\npenetration = [\"1mm\", \"2mm\"]\n";

TEST_F(SweepCases, AnIdentifierIsThatOfWhatIsComputed) {
  const std::vector<std::string> before = ids(touches);
  ASSERT_EQ(before.size(), 2u);
  EXPECT_NE(before[0], before[1]);
  EXPECT_EQ(before[0].size(), 20u);
  // Names of files, the order of options and further values change nothing.
  fs::copy_file(folder_ / "cube.glb", folder_ / "other.glb", fs::copy_options::overwrite_existing);
  const std::string third =
      ids("command = \"touch\"\n[options]\nscene = \"cube.glb\"\npoints = \"finger.ply\"\npenetration = \"3mm\"\n")
          .front();
  EXPECT_EQ(ids("command = \"touch\"\n[options]\npoints = \"finger.ply\"\nscene = \"other.glb\"\n"
                "[vary]\npenetration = [\"2mm\", \"3mm\", \"1mm\"]\n",
                "other.toml"),
            (std::vector<std::string>{before[1], third, before[0]}));
  // Contents, options, kept results and the command do.
  const auto differs = [&](const std::string& text) {
    for (const std::string& id : ids(text))
      EXPECT_EQ(std::ranges::count(before, id), 0) << text;
  };
  differs(touches + "seed = [1]\n");
  differs("results = [\"points\"]\n" + touches);
  differs("keep = \"everything\"\n" + touches);
  test::write_text(folder_ / "other.ply", test::read_text(folder_ / "finger.ply") + "\n");
  std::string with_other = touches;
  with_other.replace(with_other.find("finger.ply"), 10, "other.ply");
  differs(with_other);
}

TEST_F(SweepCases, FilesThatFilesNameCountToo) {
  test::write_text(folder_ / "model.gltf",
                   R"({"buffers": [{"uri": "my%20data.bin", "byteLength": 4}, {"uri": "data:;base64,AAAA"}]})");
  test::write_text(folder_ / "my data.bin", "abcd");
  const std::string plan = "command = \"touch\"\n[options]\nscene = \"model.gltf\"\npoints = \"finger.ply\"\n";
  const std::vector<std::string> before = ids(plan);
  test::write_text(folder_ / "my data.bin", "abce");
  EXPECT_NE(ids(plan), before);
  const Plan with_rig = parse_plan("command = \"simulate\"\n[options]\nrig = \"rig.toml\"\n", folder_ / "plan.toml");
  test::write_text(folder_ / "layout.toml", "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n");
  test::write_text(folder_ / "rig.toml", "[array]\nlayout = \"layout.toml\"\n");
  std::set<std::string> names;
  const Inputs inputs(with_rig);
  for (const Input& input : inputs.all())
    names.insert(fs::path(input.path).filename());
  EXPECT_EQ(names, (std::set<std::string>{"rig.toml", "layout.toml"}));
}

TEST_F(SweepCases, ARigInASpreadIsAnInput) {
  const auto seen = [&](const char* residual) {
    test::write_text(folder_ / "seen.toml",
                     std::string("[[camera]]\nwidth = 4\nheight = 4\nfx = 4\nfy = 4\ncx = 2\ncy = 2\nresidual_m = ") +
                         residual + "\n");
  };
  seen("0.0003");
  const std::string text =
      "command = \"drive\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,10cm\"\n"
      "spread = \"phase=0.1,position=seen.toml\"\n";
  const std::vector<std::string> before = ids(text);
  const Plan plan = parse_plan(text, folder_ / "plan.toml");
  const Inputs inputs(plan);
  ASSERT_EQ(inputs.all().size(), 1u);
  EXPECT_EQ(inputs.all()[0].name, "seen.toml");
  bool found = false;
  for (const Setting& setting : inputs.resolved(plan.settings(0)))
    found =
        found || (setting.option == "--spread" &&
                  setting.values == std::vector<std::string>{"phase=0.1,position=" + (folder_ / "seen.toml").string()});
  EXPECT_TRUE(found);
  seen("0.0004");
  EXPECT_NE(ids(text), before);
}

TEST_F(SweepCases, PartsAreDisjointCompleteAndEqual) {
  Random random(5);
  for (const std::uint32_t count : {1U, 2U, 7U, 40U}) {
    std::vector<Case> all;
    for (std::uint64_t i = 0; i < 100; ++i)
      all.push_back(
          {i, std::to_string(i), {.seconds = i < 60 ? 1.0 + static_cast<double>(i / 20) : 3 * random.uniform()}});
    std::map<std::uint64_t, int> times;
    double least = 1e9, most = 0, whole = 0;
    for (std::uint32_t shard = 0; shard < count; ++shard) {
      const std::vector<Case> mine = deal(all, {shard, count});
      EXPECT_TRUE(std::ranges::is_sorted(mine, std::greater<>(), [](const Case& one) { return one.cost.seconds; }));
      double seconds = 0;
      for (const Case& one : mine) {
        ++times[one.index];
        seconds += one.cost.seconds;
      }
      least = std::min(least, seconds);
      most = std::max(most, seconds);
      whole += seconds;
    }
    EXPECT_EQ(times.size(), 100u);
    for (const auto& [index, how_often] : times)
      EXPECT_EQ(how_often, 1) << index;
    // No shard takes longer than its share by more than the longest case.
    EXPECT_LE(most, whole / count + 4) << count;
    EXPECT_LE(most - least, 4) << count;
  }
  // Equal cases stay in the plan's order, and neighbours stay together.
  std::vector<Case> equal;
  for (std::uint64_t i = 0; i < 8; ++i)
    equal.push_back({i, std::to_string(i), {.seconds = 1}});
  const std::vector<Case> first = deal(equal, {0, 2});
  ASSERT_EQ(first.size(), 4u);
  for (std::uint64_t i = 0; i < 4; ++i)
    EXPECT_EQ(first[i].index, i);
}

TEST_F(SweepCases, APlanWhoseOptionsAreRefusedInEveryCaseIsRefused) {
  const auto fault = [](const std::string& text) -> std::string {
    try {
      refuse_hopeless(parse_plan(text, "plan.toml"));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::bad_input);
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(fault("command = \"touch\"\n[options]\nscene = \"cube.glb\"\n[vary]\ndelta = [\"1mm\", \"2mm\"]\n"),
            "plan.toml: none of the 2 cases can be computed; the first: " +
                fault("command = \"touch\"\n[options]\nscene = \"cube.glb\"\n").substr(11));
  EXPECT_NE(fault("command = \"touch\"\n[options]\nscene = \"cube.glb\"\n").find("no skin"), std::string::npos);
  EXPECT_NE(fault("command = \"drive\"\n[options]\nlayout = \"openmpd\"\n").find("--focus is missing"),
            std::string::npos);
  EXPECT_NE(fault("command = \"field\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,1cm\"\n").find("no place"),
            std::string::npos);
  EXPECT_NE(fault("command = \"field\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,1cm\"\nplane = \"xz\"\n")
                .find("no extent"),
            std::string::npos);
  EXPECT_NE(fault("command = \"simulate\"\n[options]\nscene = \"cube.glb\"\n").find("--finger is missing"),
            std::string::npos);
  // One case that fits is enough.
  EXPECT_EQ(fault("command = \"drive\"\n[options]\nlayout = \"openmpd\"\nfocus = \"0,0,1cm\"\n"
                  "[vary]\nsolver = [\"adjoint\", \"naive\"]\n"),
            "");
}

TEST_F(SweepCases, TheFirstCaseWithAModelAndADeltaCostsMore) {
  const Plan plan = parse_plan(
      "command = \"touch\"\n[options]\npoints = \"finger.ply\"\n"
      "[vary]\nscene = [\"cube.glb\", \"hand.glb\"]\ndelta = [\"1mm\", \"2mm\"]\nspacing = [\"angle\", \"arc\"]\n",
      folder_ / "plan.toml");
  const Inputs inputs(plan);
  const std::vector<Case> cases = list_cases(plan, inputs, true);
  ASSERT_EQ(cases.size(), 8u);
  for (const Case& one : cases) {
    EXPECT_EQ(one.cost.first_s > 0, one.index % 2 == 0) << one.index;
    EXPECT_LT(one.cost.cpu_seconds, one.cost.seconds) << "the device takes longer for so few points";
    EXPECT_EQ(one.cost.seconds, cases[one.index / 4 * 4].cost.seconds) << "cases are dealt by what each of them takes";
  }
  EXPECT_GT(cases[4].cost.first_s, 0.05) << "a large concave solid is sorted into a grid that is kept";
  EXPECT_LT(cases[0].cost.first_s, 0.001);
}

TEST_F(SweepCases, LargerCasesCostMore) {
  const auto costs = [&](const std::string& text) {
    const Plan plan = parse_plan(text, folder_ / "plan.toml");
    std::vector<double> seconds;
    const Inputs inputs(plan);
    for (const Case& one : list_cases(plan, inputs, true))
      seconds.push_back(one.cost.seconds);
    return seconds;
  };
  const std::vector<double> fields = costs(
      "command = \"field\"\n[options]\nfocus = \"0,0,1cm\"\nplane = \"xz\"\nsize = \"1cm,1cm\"\nlayout = \"paper\"\n"
      "[vary]\npixels = [\"10,10\", \"100,100\", \"400,400\"]\n");
  EXPECT_LT(fields[0], fields[1]);
  EXPECT_LT(5 * fields[1], fields[2]);
  const std::vector<double> others = costs(
      "command = \"simulate\"\n[options]\nscene = \"cube.glb\"\nfinger = \"finger.ply\"\n"
      "[vary]\nmethod = [\"cross-section\", \"single-focus\"]\nlayout = [\"paper\", \"openmpd\"]\n");
  EXPECT_GT(others[0], others[1]);
  EXPECT_GT(others[0], others[2]);
  EXPECT_GT(others[0], 0.5);
  EXPECT_LT(others[0], 5);
}

}  // namespace
}  // namespace palpa::sweep
