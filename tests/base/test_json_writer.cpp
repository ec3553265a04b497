#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

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

}  // namespace
}  // namespace palpa
