#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include "base/files/json_rows.hpp"
#include "base/files/json_writer.hpp"

namespace palpa {
namespace {

using Style = JsonWriter::Style;

/// The same members in any style.
std::string in_style(Style style) {
  JsonWriter json;
  json.begin_object(style).member("a", 1);
  json.key("b").begin_object(style).member("c", std::vector<std::uint32_t>{2, 3}).member("d", true).end_object();
  json.end_object();
  return json.take();
}

TEST(JsonWriter, LaysOutContainers) {
  EXPECT_EQ(in_style(Style::block), "{\n  \"a\": 1,\n  \"b\": {\n    \"c\": [2, 3],\n    \"d\": true\n  }\n}\n");
  EXPECT_EQ(in_style(Style::line), "{\"a\": 1, \"b\": {\"c\": [2, 3], \"d\": true}}\n");
  EXPECT_EQ(in_style(Style::compact), "{\"a\":1,\"b\":{\"c\":[2,3],\"d\":true}}\n");
  EXPECT_EQ(in_style(Style::rows), "{\"a\":1,\n \"b\":{\"c\":[2,3],\"d\":true}}\n");
}

TEST(JsonWriter, NumbersAreTheShortestOfTheirType) {
  JsonWriter json;
  json.begin_array(Style::compact)
      .value(0.1F)
      .value(0.1)
      .value(1.0 / 3)
      .value(-7)
      .value(1e300)
      .value(18446744073709551615U);
  json.value(std::nan("")).value(INFINITY).rounded(1.0 / 3, 6).rounded(1234567.0, 6).rounded(-INFINITY, 6).end_array();
  EXPECT_EQ(json.take(),
            "[0.1,0.1,0.3333333333333333,-7,1e+300,18446744073709551615,null,null,0.333333,1.23457e+06,null]\n");
}

TEST(JsonWriter, AnyBytesMakeAString) {
  JsonWriter json;
  json.value(std::string_view("\"\\\n\x7f\xc3\xa9\xc3(\xed\xa0\x80", 11));
  EXPECT_EQ(json.take(), "\"\\\"\\\\\\u000a\\u007f\xc3\xa9\\ufffd(\\ufffd\\ufffd\\ufffd\"\n");
}

TEST(JsonWriter, KeepsItsStorageFromDocumentToDocument) {
  JsonWriter json;
  const void* storage = nullptr;
  for (int round = 0; round < 3; ++round) {
    json.clear();
    json.begin_object(Style::compact).member("numbers", std::vector<double>(100, 0.125)).end_object();
    const std::string_view text = json.finish();
    EXPECT_TRUE(text.starts_with("{\"numbers\":[0.125,0.125,") && text.ends_with("]}\n")) << text;
    EXPECT_TRUE(round == 0 || text.data() == storage);
    storage = text.data();
  }
}

struct Ball {
  glm::vec3 centre{0};
  double radius = 0;
};
struct Things {
  std::string name;
  std::vector<Ball> balls;
  std::vector<double> sums;
  std::optional<Ball> best{};
};

JsonRows<Things> rows_of_things() {
  const auto ball =
      JsonRows<Ball>().value("centre", [](const Ball& b) { return b.centre; }).value("radius", [](const Ball& b) {
        return b.radius;
      });
  return JsonRows<Things>()
      .value("name", [](const Things& t) { return std::string_view(t.name); })
      .objects("balls", ball, [](const Things& t) { return &t.balls; })
      .value("radii", [](const Things& t) { return std::views::transform(t.balls, &Ball::radius); })
      .value("sums", [](const Things& t) { return t.sums.empty() ? nullptr : &t.sums; })
      .value("pairs",
             [](const Things& t) {
               return t.sums.empty() ? std::nullopt : std::optional(std::vector<std::vector<double>>{t.sums});
             })
      .object("best", ball, [](const Things& t) { return t.best ? &*t.best : nullptr; });
}

TEST(JsonRows, TheTextAndThePathsComeFromOneList) {
  const JsonRows<Things> rows = rows_of_things();
  EXPECT_EQ(rows.paths(), (std::vector<std::string>{"name", "balls.#.centre.#", "balls.#.radius", "radii.#", "sums.#",
                                                    "pairs.#.#", "best.centre.#", "best.radius"}));
  EXPECT_EQ(rows.text({"a", {{{1, 2, 3}, 0.5}}, {}, {}}),
            "{\n  \"name\": \"a\",\n  \"balls\": [{\"centre\": [1, 2, 3], \"radius\": 0.5}],\n  \"radii\": [0.5]\n}\n");
  EXPECT_EQ(
      rows.text({"b", {}, {0.25, 1}, Ball{{0, 0, 1}, 2}}),
      "{\n  \"name\": \"b\",\n  \"balls\": [],\n  \"radii\": [],\n  \"sums\": [0.25, 1],\n  \"pairs\": [[0.25, 1]],\n"
      "  \"best\": {\n    \"centre\": [0, 0, 1],\n    \"radius\": 2\n  }\n}\n");
}

TEST(JsonRows, MembersOfOtherRowsAndThoseThatAFunctionWritesStandWhereTheyWereAdded) {
  struct Touch {
    Ball ball;
    std::vector<std::optional<glm::vec3>> foci;
    double ms;
  };
  const auto ball = JsonRows<Ball>().value("radius", [](const Ball& b) { return b.radius; });
  const auto rows = JsonRows<Touch>()
                        .written({"order.#"},
                                 [](JsonWriter& json, const Touch&) {
                                   json.key("order").value(std::vector{2, 1});
                                 })
                        .members(ball, [](const Touch& t) { return &t.ball; })
                        .value("foci_m", [](const Touch& t) { return &t.foci; })
                        .written({}, [](JsonWriter& json, const Touch& t) { json.member("timing_ms", t.ms); });
  EXPECT_EQ(rows.paths(), (std::vector<std::string>{"order.#", "radius", "foci_m.#.#"}));
  EXPECT_EQ(rows.text({{{0, 0, 0}, 3}, {glm::vec3(1, 2, 3), std::nullopt}, 5}),
            "{\n  \"order\": [2, 1],\n  \"radius\": 3,\n  \"foci_m\": [[1, 2, 3], null],\n  \"timing_ms\": 5\n}\n");
}

}  // namespace
}  // namespace palpa
