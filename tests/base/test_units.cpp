#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "base/units.hpp"

namespace palpa {
namespace {

using enum Quantity;

struct Typed {
  const char* text;
  Quantity quantity;
  std::optional<double> value;
};

// Exactly the double of the SI number: a value must not depend on the unit in which it is typed.
TEST(Units, AreExactAndOfTheirQuantity) {
  for (const auto& [text, quantity, value] : std::initializer_list<Typed>{{"1.5mm", length, 0.0015},
                                                                          {"5mm", length, 0.005},
                                                                          {"3mm", length, 0.003},
                                                                          {"0.1mm", length, 0.0001},
                                                                          {"15cm", length, 0.15},
                                                                          {"250um", length, 0.00025},
                                                                          {"2m", length, 2},
                                                                          {"-3mm", length, -0.003},
                                                                          {"15e-1mm", length, 0.0015},
                                                                          {"0.0015", length, 0.0015},
                                                                          {"0", length, 0},
                                                                          {"1.5e-3", time, 0.0015},
                                                                          {"1.5ms", time, 0.0015},
                                                                          {"11ms", time, 0.011},
                                                                          {"20us", time, 0.00002},
                                                                          {"1s", time, 1},
                                                                          {"40kHz", frequency, 40000},
                                                                          {"200Hz", frequency, 200},
                                                                          {"4e4", frequency, 40000},
                                                                          {"1.5MHz", frequency, 1500000},
                                                                          {"343.2m/s", speed, 343.2},
                                                                          {"343", speed, 343},
                                                                          {"8kPa", pressure, 8000},
                                                                          {"250Pa", pressure, 250},
                                                                          {"11ms", length, {}},
                                                                          {"1.5mm", time, {}},
                                                                          {"1.5mm", frequency, {}},
                                                                          {"40kHz", speed, {}},
                                                                          {"343m/s", length, {}},
                                                                          {"1e305MHz", frequency, {}}})
    EXPECT_EQ(parse_quantity(text, quantity), value) << text;
}

TEST(Units, EveryTenthOfAMillimetreIsExact) {
  for (int tenths = 1; tenths <= 10000; ++tenths) {
    const std::string whole = std::to_string(tenths / 10);
    const std::string text = whole + "." + std::to_string(tenths % 10) + "mm";
    EXPECT_EQ(parse_quantity(text, length), tenths / 10000.0) << text;
  }
}

TEST(Units, AnythingElseIsRefused) {
  for (const char* text :
       {"",       " ",       "mm",    "m",       "one",   "1.5 mm", " 1.5mm",   "1.5mm ",      "1.5mm\n", "1.5MM",
        "1.5mmm", "1.5inch", "1,5mm", "1.5.2mm", "--1mm", "+-1mm",  "0x10mm",   "1e999",       "-1e999",  "1e999mm",
        "nan",    "NaN",     "nanmm", "inf",     "-inf",  "infmm",  "infinity", "1.5\xc2\xb5m"}) {
    EXPECT_EQ(parse_quantity(text, length), std::nullopt) << '"' << text << '"';
  }
  EXPECT_EQ(parse_quantity(std::string_view("1\0mm", 4), length), std::nullopt);
}

TEST(Units, APlusBelongsToTheNumber) {
  EXPECT_EQ(parse_number("+20"), 20);
  EXPECT_EQ(parse_number("+.5e+1"), 5);
  EXPECT_EQ(parse_whole<int>("+20"), 20);
  EXPECT_EQ(parse_quantity("+1mm", length), 0.001);
  for (const char* text : {"+", "++1", "+-1", "-+1", "+ 1", "+inf", "+nan", "+mm"}) {
    EXPECT_EQ(parse_number(text), std::nullopt) << text;
    EXPECT_EQ(parse_whole<int>(text), std::nullopt) << text;
    EXPECT_EQ(parse_quantity(text, length), std::nullopt) << text;
  }
}

TEST(Units, HintsShowAUsableExample) {
  for (const Quantity quantity : {length, time, frequency, speed, pressure}) {
    const std::string hint(quantity_hint(quantity));
    const std::size_t begin = hint.find("as ") + 3;
    const std::string example = hint.substr(begin, hint.find(' ', begin) - begin);
    EXPECT_TRUE(parse_quantity(example, quantity)) << hint;
  }
}

}  // namespace
}  // namespace palpa
