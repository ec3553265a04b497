#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "sensation/pattern_text.hpp"
#include "sensation/played.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using sensation::Evaluation;
using sensation::Pattern;
using sensation::Progress;

using Given = std::map<std::string, double>;

/// One evaluation at a time that is also its start.
Evaluation once(const PatternText& text, double time_ms, const Given& given = {}, const Transform* matrix = nullptr) {
  const Pattern pattern = sensation::parse_pattern(text.text(), "test.adaptics");
  Progress progress{.last_ms = time_ms};
  Random random(1);
  return sensation::evaluate(pattern, sensation::values_of(pattern, given), time_ms, progress, random,
                             {.matrix = matrix});
}

void expect(const Evaluation& at, const Vec3& place, double intensity) {
  EXPECT_NEAR(at.place_mm.x, place.x, 1e-4);
  EXPECT_NEAR(at.place_mm.y, place.y, 1e-4);
  EXPECT_NEAR(at.place_mm.z, place.z, 1e-4);
  EXPECT_NEAR(at.intensity, intensity, 1e-6);
}

TEST(Evaluate, ThereIsNothingBeforeTheFirstKeyframe) {
  expect(once({.keyframes = ""}, 0), {0, 0, 200}, 0);
  const PatternText one{.keyframes = key("standard", 100, coords(30, 0, 10) + intensity(f64(0.8)) + circle(f64(5)))};
  expect(once(one, 99), {0, 0, 200}, 0);
  expect(once(one, 102.5), {30, 5, 210}, 0.8);
}

TEST(Evaluate, APauseHoldsCoordinatesAndNothingElse) {
  const PatternText text{.keyframes = key("standard", 0, coords(0, 0, 0) + intensity(f64(1))) + "," + key("pause", 50) +
                                      "," + key("standard", 100, coords(10, 20, 0) + intensity(f64(0)))};
  expect(once(text, 25), {0, 0, 200}, 0.75);
  expect(once(text, 75), {5, 10, 200}, 0.25);
}

TEST(Evaluate, AStopGivesAllTracksANewTime) {
  const PatternText text{.keyframes = key("standard", 0, coords(0, 0, 0) + intensity(f64(1))) + "," + key("stop", 50) +
                                      "," + key("standard", 100, coords(10, 0, 0) + intensity(f64(0)))};
  expect(once(text, 25), {0, 0, 200}, 0.5);
  expect(once(text, 75), {5, 0, 200}, 0.5);
  EXPECT_TRUE(once(text, 75).stop);
  EXPECT_FALSE(once(text, 100).stop);
}

TEST(Evaluate, LinesTurnAndCirclesDoNotBlendWithThem) {
  expect(once({.keyframes = key("standard", 0, coords(0, 0, 0) + line(30, 8, 60, 20) + intensity(f64(0.5)))}, 11),
         {12.1353, 21.0189, 200}, 0.296845);
  const PatternText mixed{.keyframes = key("standard", 0, coords(0, 0, 0) + intensity(f64(1)) + circle(f64(10))) + "," +
                                       key("pause", 10, line(30, 8, 60, 20))};
  expect(once(mixed, 5), {-10, 0, 200}, 1);
  const PatternText chirp{.keyframes = key("standard", 0, coords(0, 0, 0) + intensity(f64(1)) + circle(f64(0), 0)) +
                                       "," + key("pause", 100, circle(f64(0), 40))};
  EXPECT_NEAR(once(chirp, 50).intensity, 1, 1e-9);
}

std::string lissajous(double rotation, double x_scale, double stm_hz) {
  return brush("lissajous",
               fmt::format(R"("a":{},"b":{},"d":{},"rotation":{},"x_scale":{},"y_scale":{},)"
                           R"("am_freq":{},"stm_freq":{})",
                           f64(3), f64(2), f64(0.5), f64(rotation), f64(x_scale), f64(10), f64(0), f64(stm_hz)));
}

TEST(Evaluate, ALissajousFigureBlendsItsRotationAlone) {
  const std::string first = key("standard", 0, coords(0, 0, 0) + intensity(f64(1)) + lissajous(1, 20, 50));
  expect(once({.keyframes = first}, 3), {-9.9995, 2.0290, 200}, 1);
  expect(once({.keyframes = first + "," + key("pause", 10, lissajous(3, 40, 80))}, 3), {-9.3986, -3.9716, 200}, 1);
}

TEST(Evaluate, ThePlaceIsTransformedAndTheBrushIsNot) {
  const PatternText text{.keyframes = key("standard", 0, coords(10, 20, 5) + intensity(f64(1)) + circle(f64(4))),
                         .translate = fmt::format(R"({{"x":{},"y":{},"z":{}}})", f64(1), f64(2), f64(3)),
                         .scale = fmt::format(R"({{"x":{},"y":{},"z":{}}})", f64(2), f64(3), f64(4)),
                         .rotation = f64(90),
                         .factor = f64(0.5)};
  expect(once(text, 2.5), {-59, 26, 23}, 0.5);
  // Columns of rows (0,-1,0,5), (1,0,0,6), (0,0,1,7), (0,0,0,2).
  const Transform matrix{Vec4(0, 1, 0, 0), Vec4(-1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(5, 6, 7, 2)};
  expect(once(text, 2.5, {}, &matrix), {-8.5, -22.5, 15}, 0.5);
}

TEST(Evaluate, TheSpeedMayChangeWithoutAJump) {
  const Pattern pattern = sensation::parse_pattern(
      PatternText{.keyframes = "", .definitions = R"("s":{"default":0,"step":1})", .speed = param("s")}.text(), "t");
  Progress progress;
  Random random(1);
  const std::array<double, 5> speeds{1, 1, 3, -1, 0}, pattern_ms{0, 10, 40, 30, 30};
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const Given given = i < 4 ? Given{{"s", speeds[i]}} : Given{};
    const auto at = sensation::evaluate(pattern, sensation::values_of(pattern, given), 10.0 * static_cast<double>(i),
                                        progress, random);
    EXPECT_DOUBLE_EQ(at.pattern_ms, pattern_ms[i]);
  }
}

TEST(Evaluate, OneJumpIsTakenAndItsOvershootIsLost) {
  const std::string at0 = key("standard", 0, coords(0, 0, 0), jump("a", "lt", 1, 77)),
                    at10 = key("standard", 10, coords(0, 0, 0), jump("zz", "lt", 1, 90) + "," + jump("a", "lt", 1, 50));
  const Pattern pattern = sensation::parse_pattern(
      PatternText{.keyframes = at0 + "," + at10 + "," + key("standard", 50, coords(0, 0, 0), jump("a", "lt", 1, 0)) +
                               "," + key("standard", 60, coords(0, 0, 0), jump("a", "lt", 1, 5)),
                  .definitions = R"("a":{"default":0,"step":1})"}
          .text(),
      "t");
  Progress progress;
  Random random(1);
  const std::array<double, 6> times{0, 4, 12, 13, 23, 24}, pattern_ms{0, 4, 50, 51, 5, 6};
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto at = sensation::evaluate(pattern, sensation::values_of(pattern, {}), times[i], progress, random);
    EXPECT_DOUBLE_EQ(at.pattern_ms, pattern_ms[i]) << times[i];
  }
}

TEST(Evaluate, AJumpsOperatorsDifferAtItsValue) {
  const struct {
    const char* is;
    bool below, at, above;
  } operators[]{{"lt", true, false, false},
                {"lt_eq", true, true, false},
                {"gt", false, false, true},
                {"gt_eq", false, true, true}};
  for (const auto& [is, below, at, above] : operators) {
    const Pattern pattern =
        sensation::parse_pattern(PatternText{.keyframes = key("standard", 0, coords(0, 0, 0)) + "," +
                                                          key("standard", 10, coords(0, 0, 0), jump("a", is, 1, 50)) +
                                                          "," + key("standard", 60, coords(0, 0, 0)),
                                             .definitions = R"("a":{"default":0,"step":1})"}
                                     .text(),
                                 "t");
    for (const auto& [value, jumps] : {std::pair(0.9, below), {1.0, at}, {1.1, above}}) {
      Progress progress;
      Random random(1);
      const auto found =
          sensation::evaluate(pattern, sensation::values_of(pattern, {{"a", value}}), 12, progress, random);
      EXPECT_DOUBLE_EQ(found.pattern_ms, jumps ? 50 : 12) << value << " " << is;
    }
  }
}

TEST(Evaluate, ParametersStayWithinTheirLimitsAndSoDoDefaults) {
  const auto value = [](const std::string& definition, const Given& given) {
    const Pattern pattern = sensation::parse_pattern(
        PatternText{.keyframes = "", .definitions = "\"p\":" + definition, .rotation = param("q")}.text(), "t");
    return sensation::values_of(pattern, given).value[*pattern.parameter("p")];
  };
  EXPECT_EQ(value(R"({"default":0,"step":1,"min":0,"max":15})", {{"p", 10}}), 10);
  EXPECT_EQ(value(R"({"default":0,"step":1,"min":0,"max":10})", {{"p", 50}}), 10);
  EXPECT_EQ(value(R"({"default":0,"step":1,"min":0,"max":10})", {{"p", -50}}), 0);
  EXPECT_EQ(value(R"({"default":12.0001,"step":1,"min":null})", {}), 12.0001);
  EXPECT_EQ(value(R"({"default":12,"step":1,"max":10})", {}), 10);
}

std::string binary(const char* kind, const std::string& a, const std::string& b) {
  return fmt::format(R"({{"type":"{}","value":[{},{}]}})", kind, a, b);
}
std::string constant(double value) {
  return fmt::format(R"({{"type":"constant","value":{}}})", value);
}
std::string parameter(const char* name) {
  return fmt::format(R"({{"type":"parameter","value":"{}"}})", name);
}

TEST(Evaluate, FormulasAreTrees) {
  const auto value = [](const std::string& tree) {
    return once(
               {.keyframes = key("standard", 0,
                                 coords(0, 0, 0) + intensity(fmt::format(R"({{"type":"formula","value":{}}})", tree)))},
               0, {{"param", 11}, {"param2", 12}, {"param3", 13}, {"param4", 14}})
        .intensity;
  };
  const std::string products = binary("add",
                                      binary("subtract",
                                             binary("add", binary("multiply", constant(1), parameter("param")),
                                                    binary("divide", constant(2), parameter("param2"))),
                                             binary("multiply", constant(3), parameter("param3"))),
                                      binary("divide", constant(4), parameter("param4")));
  EXPECT_NEAR(value(products), -27.547619, 1e-6);
  EXPECT_NEAR(value(binary("add", fmt::format(R"({{"type":"negate","value":{}}})", parameter("param")), constant(2.0))),
              -9, 1e-12);
  EXPECT_EQ(value(binary("divide", constant(1), constant(0))), HUGE_VAL);
  EXPECT_EQ(value(parameter("nobody")), 0);
}

TEST(Evaluate, RandomIntensitiesAreWithinTheirLimitsAndTheSameForASeed) {
  const std::string random =
      fmt::format(R"(,"intensity":{{"intensity":{{"name":"random","params":{{"min":{},"max":{}}}}},{}}})", f64(0.25),
                  f64(0.5), transition_text("linear"));
  const auto drawn = [&](std::uint64_t seed) {
    sensation::PatternSensation sensation(
        sensation::parse_pattern(PatternText{.keyframes = key("standard", 0, coords(0, 0, 0) + random)}.text(), "t"));
    sensation::State state = sensation::State::at(0, seed);
    std::vector<double> all;
    for (int i = 0; i < 1000; ++i)
      all.push_back(sensation.step(1e-3 * i, state).intensity);
    return all;
  };
  const std::vector<double> first = drawn(1);
  EXPECT_EQ(first, drawn(1));
  EXPECT_NE(first, drawn(2));
  const auto [low, high] = std::ranges::minmax(first);
  EXPECT_GE(low, 0.25);
  EXPECT_LT(low, 0.251);
  EXPECT_LT(high, 0.5);
  EXPECT_GT(high, 0.499);
}

// ---- the patterns of Adaptics' authors, where they are
// ---------------------------------------------------------------

struct Row {
  const char* pattern;
  double time_ms, pattern_ms, x, y, intensity;
  bool stop;
};
/// What Adaptics' own evaluator gives, from 0 on in steps of 0.0625 ms; z is 200.
constexpr Row rows[] = {
    {"Checkmark", 0, 0, -15.0000, -5.0000, 1.0, false},
    {"Checkmark", 51.25, 51.25, -17.9289, 2.0711, 1.0, false},
    {"Checkmark", 152.5, 152.5, -24.7143, 4.7857, 1.0, false},
    {"Checkmark", 237.5, 237.5, -15.0000, -22.5000, 1.0, false},
    {"Checkmark", 401.875, 401.875, -1.1732, -10.7612, 1.0, false},
    {"Checkmark", 587.5, 587.5, 7.5000, -20.0000, 1.0, false},
    {"Checkmark", 703.125, 703.125, 26.7982, 17.7388, 0.575, false},
    {"Checkmark", 851.25, 851.25, 52.0711, 27.0711, 0.0, true},
    {"Button", 101.25, 101.25, 3.5355, 3.5355, 0.6, false},
    {"Button", 249.9375, 249.9375, 4.9961, -0.1963, 0.6, false},
    {"Button", 250, 0, 5.0000, 0.0000, 0.6, false},
    {"Button", 551.25, 301.25, 7.7634, 7.7634, 0.851814, false},
    {"Button", 805.0625, 555.0625, -22.4827, -0.8833, 0.136188, false},
    {"Button", 1051.25, 551.25, 15.9099, 15.9099, 0.777785, false},
    {"Button", 1500.625, 750.625, 53.7467, 22.2626, 0.972161, false},
    {"Button", 1601.25, 851.25, 33.2179, 33.2179, 1.0, false},
    {"Wind", 0, 0, -116.6025, 1.9615, 0.0, false},
    {"Wind", 62.5, 93.75, -86.6025, -50.0000, 0.375, false},
    {"Wind", 201.25, 301.875, -66.1344, 8.8815, 0.993844, false},
    {"Wind", 501.875, 752.8125, 48.5057, 50.8189, 0.986185, false},
    {"Wind", 601.25, 901.875, 68.9249, 80.6186, 0.780168, false},
    {"Wind", 666.625, 999.9375, 99.6650, 27.3751, 0.000126, false},
    {"Wind", 666.6875, 0, -71.9439, -75.3895, 0.0, false},
    {"Wind", 1101.25, 651.84375, 16.3372, 52.6865, 0.993844, false},
    {"SpaceshipHeartbeat", 101.25, 101.25, 8.8609, 8.8609, 1.0, false},
    {"SpaceshipHeartbeat", 301.25, 301.90625, 5.9228, 5.9228, 0.009607, false},
    {"SpaceshipHeartbeat", 601.25, 751.90625, 9.3977, 9.3977, 0.990393, false},
    {"SpaceshipHeartbeat", 766.625, 999.96875, -5.2248, -8.5261, 0.752829, false},
    {"SpaceshipHeartbeat", 766.6875, 0, -4.8862, -8.7250, 0.748582, false},
    {"SpaceshipHeartbeat", 1103.125, 556.25, -9.1366, 22.0576, 1.0, false},
    {"SpaceshipHeartbeat", 1401.25, 1152.5, 26.4811, 26.4811, 0.159879, false},
    {"SpaceshipHeartbeat", 1751.25, 1852.5, 70.7107, 70.7107, 0.038060, false},
};

Given parameters_at(const std::string& pattern, double time_ms) {
  if (pattern == "Button") {
    if (time_ms < 400) return {{"proximity", 0.6}};
    return {{"proximity", 1}, {"activation", time_ms < 1200 ? 0.5 : 1}};
  }
  if (pattern == "Wind") return {{"speed", 1.5}, {"direction", 30}, {"turbulence", 1}};
  if (pattern != "SpaceshipHeartbeat") return {};
  if (time_ms < 300) return {{"health", 1}, {"taking_damage", 0}};
  return time_ms < 1000 ? Given{{"health", 0.5}, {"taking_damage", 1}} : Given{{"health", 0}, {"deadpulse", 1}};
}

TEST(Evaluate, GivesWhatAdapticsOwnEvaluatorGives) {
  PALPA_SHARED_OR_SKIP(folder, "adaptics");
  for (std::size_t r = 0; r < std::size(rows);) {
    const std::string name = rows[r].pattern;
    const Pattern pattern = sensation::load_pattern((folder / (name + ".adaptics")).string());
    Progress progress;
    Random random(1);
    for (int n = 0; r < std::size(rows) && name == rows[r].pattern; ++n) {
      const double time_ms = 0.0625 * n;
      const Evaluation at = sensation::evaluate(pattern, sensation::values_of(pattern, parameters_at(name, time_ms)),
                                                time_ms, progress, random);
      if (time_ms != rows[r].time_ms) continue;
      SCOPED_TRACE(fmt::format("{} at {}", name, time_ms));
      expect(at, {rows[r].x, rows[r].y, 200}, rows[r].intensity);
      EXPECT_NEAR(at.pattern_ms, rows[r].pattern_ms, 1e-9);
      EXPECT_EQ(at.stop, rows[r].stop);
      ++r;
    }
  }
}

/// Runs the evaluator beside the data, which was written from the same facts by somebody else.
TEST(Evaluate, AgreesWithAnEvaluatorInPythonOnEveryPattern) {
  PALPA_SHARED_OR_SKIP(folder, "adaptics");
  const auto scratch = scratch_folder("adaptics");
  const std::string script =
      "import sys, glob, os\n"
      "sys.dont_write_bytecode = True\n"
      "sys.path.insert(0, sys.argv[1])\n"
      "import adaptics_eval as e\n"
      "out = open(sys.argv[2], 'w')\n"
      "for f in sorted(glob.glob(sys.argv[1] + '/*.adaptics')):\n"
      "    for T, r in e.play(e.Pattern.load(f), 0.05, 1300):\n"
      "        print(os.path.basename(f), *(r[k].hex() if k != 'stop' else int(r[k]) for k in\n"
      "              ('x', 'y', 'z', 'intensity', 'pattern_time', 'stop')), file=out)\n";
  write_text(scratch / "all.py", script);
  const std::string command =
      fmt::format("python3 {} {} {}", (scratch / "all.py").string(), folder.string(), (scratch / "all.txt").string());
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::ifstream all(scratch / "all.txt");
  std::string file, last, numbers[5];
  int stop = 0, patterns = 0, n = 0;
  Pattern pattern;
  sensation::Values values;
  Progress progress;
  Random random(1);
  while (all >> file >> numbers[0] >> numbers[1] >> numbers[2] >> numbers[3] >> numbers[4] >> stop) {
    if (file != last) {
      pattern = sensation::load_pattern((folder / file).string());
      values = sensation::values_of(pattern, {});
      progress = {};
      n = 0;
      ++patterns;
      last = file;
    }
    const Evaluation at = sensation::evaluate(pattern, values, n++ * 0.05, progress, random);
    const double got[] = {at.place_mm.x, at.place_mm.y, at.place_mm.z, at.intensity, at.pattern_ms};
    for (int i = 0; i < 5; ++i)
      ASSERT_NEAR(got[i], std::strtod(numbers[i].c_str(), nullptr), 1e-6) << file << " " << n << " value " << i;
    ASSERT_EQ(at.stop, stop != 0) << file << " " << n;
  }
  EXPECT_GE(patterns, 7);
}

}  // namespace
}  // namespace palpa::test
