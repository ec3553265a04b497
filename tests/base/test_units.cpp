#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "base/units.hpp"

namespace palpa {
namespace {

using enum Quantity;

// Exactly the double of the SI number: a value must not depend on the unit in which it is typed.
TEST(Units, AreExact) {
  EXPECT_EQ(parse_quantity("1.5mm", length), 0.0015);
  EXPECT_EQ(parse_quantity("5mm", length), 0.005);
  EXPECT_EQ(parse_quantity("3mm", length), 0.003);
  EXPECT_EQ(parse_quantity("0.1mm", length), 0.0001);
  EXPECT_EQ(parse_quantity("15cm", length), 0.15);
  EXPECT_EQ(parse_quantity("250um", length), 0.00025);
  EXPECT_EQ(parse_quantity("2m", length), 2.0);
  EXPECT_EQ(parse_quantity("-3mm", length), -0.003);
  EXPECT_EQ(parse_quantity("1.5ms", time), 0.0015);
  EXPECT_EQ(parse_quantity("11ms", time), 0.011);
  EXPECT_EQ(parse_quantity("20us", time), 0.00002);
  EXPECT_EQ(parse_quantity("1s", time), 1.0);
  EXPECT_EQ(parse_quantity("40kHz", frequency), 40000.0);
  EXPECT_EQ(parse_quantity("200Hz", frequency), 200.0);
  EXPECT_EQ(parse_quantity("1.5MHz", frequency), 1500000.0);
  EXPECT_EQ(parse_quantity("343.2m/s", speed), 343.2);
  EXPECT_EQ(parse_quantity("8kPa", pressure), 8000.0);
  EXPECT_EQ(parse_quantity("250Pa", pressure), 250.0);
}

TEST(Units, EveryTenthOfAMillimetreIsExact) {
  for (int tenths = 1; tenths <= 10000; ++tenths) {
    const std::string whole = std::to_string(tenths / 10);
    const std::string text = whole + "." + std::to_string(tenths % 10) + "mm";
    EXPECT_EQ(parse_quantity(text, length), tenths / 10000.0) << text;
  }
}

TEST(Units, ABareNumberIsSi) {
  EXPECT_EQ(parse_quantity("0.0015", length), 0.0015);
  EXPECT_EQ(parse_quantity("1.5e-3", time), 0.0015);
  EXPECT_EQ(parse_quantity("0", length), 0.0);
  EXPECT_EQ(parse_quantity("4e4", frequency), 40000.0);
  EXPECT_EQ(parse_quantity("343", speed), 343.0);
}

TEST(Units, ExponentsTakeUnitsToo) {
  EXPECT_EQ(parse_quantity("15e-1mm", length), 0.0015);
}

TEST(Units, AnythingElseIsRefused) {
  for (const char* text :
       {"",       " ",       "mm",    "m",       "one",   "1.5 mm", " 1.5mm",   "1.5mm ",      "1.5mm\n", "1.5MM",
        "1.5mmm", "1.5inch", "1,5mm", "1.5.2mm", "--1mm", "+1mm",   "0x10mm",   "1e999",       "-1e999",  "1e999mm",
        "nan",    "NaN",     "nanmm", "inf",     "-inf",  "infmm",  "infinity", "1.5\xc2\xb5m"}) {
    EXPECT_EQ(parse_quantity(text, length), std::nullopt) << '"' << text << '"';
  }
  EXPECT_EQ(parse_quantity(std::string_view("1\0mm", 4), length), std::nullopt);
}

TEST(Units, AUnitOfAnotherQuantityIsRefused) {
  EXPECT_EQ(parse_quantity("11ms", length), std::nullopt);
  EXPECT_EQ(parse_quantity("1.5mm", time), std::nullopt);
  EXPECT_EQ(parse_quantity("1.5mm", frequency), std::nullopt);
  EXPECT_EQ(parse_quantity("40kHz", speed), std::nullopt);
  EXPECT_EQ(parse_quantity("343m/s", length), std::nullopt);
}

TEST(Units, AUnitCannotMakeAnInfinity) {
  EXPECT_EQ(parse_quantity("1e305MHz", frequency), std::nullopt);
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
