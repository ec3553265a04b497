#include "sensation/played.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/error.hpp"
#include "sensation/pattern_text.hpp"
#include "support/captured.hpp"
#include "support/occurrences.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using sensation::PatternSensation;
using sensation::Point;
using sensation::State;

std::vector<Point> points(sensation::Sensation& sensation, const std::vector<double>& times_s, State& state) {
  std::vector<Point> out;
  sensation.points(times_s, state, out);
  return out;
}

/// A point that moves 1 mm in each ms, and jumps back at 10 ms while a < 1.
PatternText moving() {
  return {.keyframes = key("standard", 0, coords(0, 0, 0) + intensity(param("i"))) + "," +
                       key("standard", 10, coords(10, 0, 0), jump("a", "lt", 1, 0)),
          .definitions = R"("a":{"default":0,"step":1},"i":{"default":1,"step":1})"};
}

TEST(Played, StepsDoNotDependOnTheTimesThatAreAskedFor) {
  PatternSensation all(sensation::parse_pattern(moving().text(), "t")),
      few(sensation::parse_pattern(moving().text(), "t"));
  State a = State::at(0), b = State::at(0);
  std::vector<double> fine, coarse;
  for (int n = 0; n <= 4000; ++n)
    fine.push_back(n * 12.5e-6);
  for (int n = 0; n <= 80; ++n)
    coarse.push_back(n * 625e-6);
  const std::vector<Point> of_all = points(all, fine, a), of_few = points(few, coarse, b);
  for (std::size_t n = 0; n < of_few.size(); ++n)
    EXPECT_EQ(of_few[n].place_m, of_all[n * 50].place_m) << n;
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.steps, 1001U);                    // 50 ms and its beginning
  EXPECT_NEAR(of_few[16].place_m.x, 0, 1e-12);  // 10 ms: back at the start
  EXPECT_NEAR(of_few[24].place_m.x, 5e-3, 1e-12);
}

TEST(Played, ACopyOfAStateGoesOnFromThere) {
  PatternSensation sensation(sensation::parse_pattern(moving().text(), "t"));
  State state = State::at(0);
  points(sensation, {0, 4e-3}, state);
  State copy = state;
  const Point first = points(sensation, {23e-3}, state)[0];
  EXPECT_EQ(points(sensation, {23e-3}, copy)[0].place_m, first.place_m);
  EXPECT_NEAR(first.pattern_s, 3e-3, 1e-9);
}

TEST(Played, ItMayStartAnywhere) {
  PatternSensation sensation(sensation::parse_pattern(moving().text(), "t"));
  State state = State::at(7e-3);
  EXPECT_NEAR(points(sensation, {7e-3}, state)[0].place_m.x, 7e-3, 1e-12);
  EXPECT_NEAR(points(sensation, {9e-3}, state)[0].place_m.x, 9e-3, 1e-12);
  EXPECT_NEAR(points(sensation, {12e-3}, state)[0].place_m.x, 2e-3, 1e-12);
}

TEST(Played, ParametersChangeWhenTheyAreTakenAndCanChangeBack) {
  PatternSensation sensation(sensation::parse_pattern(moving().text(), "t"));
  State state = State::at(0);
  EXPECT_FALSE(sensation.take_changes());
  sensation.set_parameter("i", 0.25);
  sensation.set_parameter("a", 1);
  EXPECT_EQ(points(sensation, {0}, state)[0].gain, 1);
  EXPECT_TRUE(sensation.take_changes());
  EXPECT_FALSE(sensation.take_changes());
  EXPECT_EQ(points(sensation, {1e-3}, state)[0].gain, 0.25);
  EXPECT_NEAR(points(sensation, {15e-3}, state)[0].place_m.x, 10e-3, 1e-12);  // a is 1: no jump
  sensation.set_parameters({{"a", 1}});                                       // the other one is at its default again
  EXPECT_TRUE(sensation.take_changes());
  EXPECT_EQ(points(sensation, {16e-3}, state)[0].gain, 1);
  EXPECT_ERROR(sensation.set_parameter("i", 0.0 / 0.0), Exit::usage, "is not a finite number");
  EXPECT_FALSE(sensation.take_changes());
}

TEST(Played, AnotherPatternGoesOnAtTheSameTime) {
  PatternSensation sensation(sensation::parse_pattern(moving().text(), "t"));
  State state = State::at(0);
  points(sensation, {4e-3}, state);
  PatternText other = moving();
  other.scale = fmt::format(R"({{"x":{},"y":{},"z":{}}})", f64(2), f64(1), f64(1));
  sensation.set_pattern(sensation::parse_pattern(other.text(), "u"));
  sensation.take_changes();
  EXPECT_NEAR(points(sensation, {5e-3}, state)[0].place_m.x, 10e-3, 1e-12);
}

TEST(Played, GainsStayWithinTheirLimitsAndWhatIsNoNumberIsSilent) {
  PatternSensation sensation(sensation::parse_pattern(moving().text(), "t"), {{"i", 1.5}});
  State state = State::at(0);
  EXPECT_EQ(points(sensation, {0}, state)[0].gain, 1);
  sensation.set_parameter("i", -1);
  sensation.take_changes();
  EXPECT_EQ(points(sensation, {1e-3}, state)[0].gain, 0);

  PatternText text = moving();
  const std::string one = R"({"type":"constant","value":1})", p = R"({"type":"parameter","value":"p"})";
  text.speed = R"({"type":"formula","value":{"type":"divide","value":[)" + one + "," + p + "]}}";
  PatternSensation divided(sensation::parse_pattern(text.text(), "d.adaptics"), {{"p", 1}});
  state = State::at(0);
  EXPECT_EQ(points(divided, {2e-3}, state)[0].gain, 1);
  divided.set_parameter("p", 0);
  divided.take_changes();
  const std::string told = stderr_of([&] {
    for (const Point& point : points(divided, {3e-3, 4e-3}, state)) {
      EXPECT_EQ(point.gain, 0);
      EXPECT_TRUE(is_finite(point.place_m));
    }
  });
  EXPECT_EQ(occurrences(told, "d.adaptics: at"), 1U) << told;
  divided.set_parameter("p", 1);
  divided.take_changes();
  EXPECT_EQ(points(divided, {5e-3}, state)[0].gain, 1);
}

TEST(Played, AFunctionIsAskedForAllTimesAtOnce) {
  int calls = 0;
  sensation::FunctionSensation sensation([&](std::span<const double> times, auto& places, auto& gains) {
    ++calls;
    for (const double time_s : times) {
      places.push_back(time_s > 2.5 ? Vec3(0.0 / 0.0) : Vec3(time_s, 0, 0.1));
      gains.push_back(2 * time_s);
    }
  });
  State state;
  std::vector<Point> got;
  const std::string told = stderr_of([&] { got = points(sensation, {0.25, 1, 3, 4}, state); });
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(got[0].place_m, Vec3(0.25, 0, 0.1));
  EXPECT_EQ(got[0].gain, 0.5);
  EXPECT_EQ(got[1].gain, 1);
  EXPECT_EQ(got[2].gain, 0);
  EXPECT_EQ(occurrences(told, "silence there"), 1U) << told;
  sensation::FunctionSensation short_one([](auto, auto& places, auto&) { places.resize(1); });
  EXPECT_ERROR(points(short_one, {0, 1}, state), Exit::usage, "gave 1 places and 0 gains for 2 times");
}

}  // namespace
}  // namespace palpa::test
