#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <string>

#include "base/error.hpp"
#include "sensation/pattern.hpp"
#include "sensation/pattern_text.hpp"
#include "support/captured.hpp"
#include "support/occurrences.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

std::string refusal(const std::string& text) {
  return error_of([&] { sensation::parse_pattern(text, "p.adaptics"); });
}

std::string with(const std::string& keyframes) {
  return PatternText{.keyframes = keyframes}.text();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(ReadPattern, TakesThreeRevisionsAndNoOther) {
  for (const char* revision : {"0.1.0-alpha.3", "0.1.0-alpha.2", "0.0.10-alpha.1"})
    EXPECT_EQ(refusal(PatternText{.revision = revision}.text()), "");
  for (const char* revision : {"0.1.0-alpha.1", "0.0.9-alpha.2", "0.1.0-alpha.4", ""}) {
    EXPECT_EQ(refusal(PatternText{.revision = revision}.text()),
              fmt::format("p.adaptics: the pattern: \"$REVISION\" is '{}'; palpa reads 0.1.0-alpha.3, 0.1.0-alpha.2 "
                          "and 0.0.10-alpha.1",
                          revision));
  }
}

TEST(ReadPattern, SaysWhatIsWrongAndWhere) {
  const std::string good =
      with(key("standard", 0, coords(1, 2, 3) + circle(f64(5)) + intensity(f64(1)), jump("a", "lt", 1, 0)));
  ASSERT_EQ(refusal(good), "");
  const auto says = [&](const std::string& what, const std::string& by, const std::string& told) {
    const std::string line = refusal(replaced(good, what, by));
    EXPECT_NE(line.find(told), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  };
  says("MidAir", "MidSea", "no pattern of Adaptics");
  says("\"name\":\"test\"", "\"title\":\"test\"", "the pattern: \"name\" is missing");
  says("\"cjumps\"", "\"jumps\"", "keyframe 0: \"cjumps\" is missing");
  says("\"type\":\"standard\"", "\"type\":\"loop\"", "keyframe 0: \"type\" must be standard, pause or stop");
  says("\"time\":0", "\"time\":\"0\"", "keyframe 0: \"time\" is not a finite number");
  says("\"x\":1", "\"x\":1e999", "number that is out of range");
  says("\"linear\"", "\"smooth\"", "must be linear or step");
  says("\"circle\"", "\"square\"", "must be circle, line or lissajous");
  says("\"radius\"", "\"diameter\"", "\"radius\" is missing");
  says(f64(5), "5", "\"radius\"");
  says(f64(5), R"({"type":"text","value":5})", "must be f64, param or formula");
  says(f64(5), R"({"type":"formula","value":{"type":"add","value":[1]}})", "array of two");
  says("\"lt\"", "\"eq\"", "must be lt, lt_eq, gt or gt_eq");
  says("\"jump_to\":0", "\"jump_to\":null", "\"jump_to\" is not a finite number");
  EXPECT_NE(refusal("{"), "");
  EXPECT_NE(refusal("[]"), "");
  EXPECT_NE(refusal("null"), "");
}

TEST(ReadPattern, RefusesALeastValueAboveTheGreatest) {
  const auto defined = [](const std::string& limits) {
    return refusal(PatternText{.definitions = "\"p\":{\"default\":0,\"step\":1" + limits + "}"}.text());
  };
  EXPECT_EQ(defined(R"(,"min":2,"max":2)"), "");
  EXPECT_EQ(defined(R"(,"min":3,"max":2)"), "p.adaptics: parameter \"p\": \"min\" is 3, above \"max\", 2");
  EXPECT_EQ(defined(R"(,"min":null,"max":null)"), "");
}

TEST(ReadPattern, TakesOldNamesAndAMissingFrequency) {
  const auto pattern = sensation::parse_pattern(
      PatternText{.keyframes = key("standard", 0, coords(0, 0, 0) + circle(R"({"type":"dynamic","value":"r"})")),
                  .revision = "0.0.10-alpha.1"}
          .text(),
      "p.adaptics");
  EXPECT_EQ(pattern.parameter("r"), 0U);
  EXPECT_EQ(sensation::fastest_hz(pattern, sensation::values_of(pattern, {})), 100);
}

TEST(ReadPattern, TheFastestOfBrushesAndModulations) {
  const auto fastest = [](double stm_hz, double am_hz) {
    const std::string brushes = test::brush(
        "circle", fmt::format(R"("radius":{},"am_freq":{},"stm_freq":{})", f64(5), f64(am_hz), f64(stm_hz)));
    const auto pattern = sensation::parse_pattern(
        PatternText{.keyframes = key("standard", 0, coords(0, 0, 0) + brushes)}.text(), "p.adaptics");
    return sensation::fastest_hz(pattern, sensation::values_of(pattern, {}));
  };
  EXPECT_EQ(fastest(50, 300), 300);
  EXPECT_EQ(fastest(120, 30), 120);
}

TEST(ReadPattern, WarnsOnceOfKeysThatItIgnores) {
  const std::string told = stderr_of([] {
    sensation::parse_pattern(PatternText{.keyframes = key("stop", 5, ",\"odd\":1") + "," +
                                                      key("standard", 0, coords(0, 0, 0) + ",\"even\":2"),
                                         .more = ",\"colour\":3,\"size\":4"}
                                 .text(),
                             "p.adaptics");
  });
  EXPECT_EQ(occurrences(told, "\n"), 1U) << told;
  EXPECT_NE(told.find("p.adaptics: ignores keys that the format does not know"), std::string::npos);
  EXPECT_NE(told.find("\"colour\" of the pattern"), std::string::npos) << told;
}

std::string formula_of(const std::string& tree) {
  return R"({"type":"formula","value":)" + tree + "}";
}

TEST(ReadPattern, BigFilesHaveLimits) {
  std::string sum = R"({"type":"constant","value":1})";
  for (int i = 0; i < 7; ++i)
    sum = R"({"type":"add","value":[)" + sum + "," + sum + "]}";
  const auto negated = [](const std::string& of) { return R"({"type":"negate","value":)" + of + "}"; };
  const auto refused = [](const std::string& formula, int keys) {
    std::string all;
    for (int k = 0; k < keys; ++k)
      all += (k > 0 ? "," : "") + key("standard", k, coords(0, 0, 0) + intensity(formula_of(formula)));
    return refusal(with(all));
  };
  EXPECT_EQ(refused(negated(sum), 1), "");  // 256 parts
  EXPECT_CONTAINS(refused(negated(negated(sum)), 1), "a formula has more than 256 parts");
  EXPECT_EQ(refused(sum, 392), "");
  EXPECT_CONTAINS(refused(sum, 393), "formulas have more than 100000 parts");
  std::string deep = R"({"type":"constant","value":1})";
  for (int i = 0; i < 200; ++i)
    deep = R"({"type":"negate","value":)" + deep + "}";
  EXPECT_NE(refusal(with(key("standard", 0, coords(0, 0, 0) + intensity(formula_of(deep))))).find("nested more than"),
            std::string::npos);
}

TEST(ReadPattern, AParameterMustBeFinite) {
  const auto pattern = sensation::parse_pattern(PatternText{.rotation = param("p")}.text(), "p.adaptics");
  const std::map<std::string, double> nan{{"p", std::numeric_limits<double>::quiet_NaN()}},
      infinite{{"p", std::numeric_limits<double>::infinity()}};
  EXPECT_ERROR(sensation::values_of(pattern, nan), Exit::usage, "is not a finite number");
  EXPECT_ERROR(sensation::values_of(pattern, infinite), Exit::usage, "is not a finite number");
}

}  // namespace
}  // namespace palpa::test
