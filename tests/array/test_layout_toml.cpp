// Layout TOMLs: their meaning, what is rejected and with which message, and the effect of hostile files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "array/layouts/board_types.hpp"
#include "array/layouts/layout_toml.hpp"
#include "base/error.hpp"
#include "support/damaged_text.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/time_limits.hpp"

namespace palpa::array {
namespace {

constexpr const char* one_unit = R"(
name = "mine"
source_level_pa_m = 5
transducer_radius_m = 0.005
[[unit]]
type = "autd3"
position_m = [0.1, 0, -0.2]
quaternion_wxyz = [0.7071, 0, 0, 0.7071]  # a quarter turn about z
)";

std::string fault_of(const std::string& text) {
  const std::string line = test::error_of([&] { parse_layout_toml(text, "my.toml"); });
  if (line.empty()) return "accepted";
  EXPECT_TRUE(line.starts_with("my.toml: ")) << line;
  for (const char c : line)
    EXPECT_TRUE(c >= ' ' && c != 127) << line;
  EXPECT_LT(line.size(), 400u);
  return line.substr(9);
}

TEST(LayoutToml, PlacesUnits) {
  const Layout layout = parse_layout_toml(one_unit, "x/y.toml");
  const Layout unit = load_layout("autd3");
  EXPECT_EQ(layout.name, "mine");
  EXPECT_EQ(layout.source_level_pa_m, 5);
  EXPECT_EQ(layout.transducer_radius_m, 0.005);
  ASSERT_EQ(layout.transducers.size(), 249u);
  for (std::size_t t = 0; t < 249; ++t) {
    const Vec3 p = unit.transducers[t].position;
    EXPECT_LE(glm::distance(layout.transducers[t].position, Vec3(-p.y + 0.1, p.x, -0.2)), 1e-12);
    EXPECT_LE(glm::distance(layout.transducers[t].axis, Vec3(0, 0, 1)), 1e-12);
  }
  ASSERT_EQ(layout.boards.size(), 1u);
  EXPECT_EQ(layout.boards[0].type, "autd3");
  EXPECT_EQ(layout.default_T_world_layout[3].y, -0.15);
}

TEST(LayoutToml, TurnsUnitsAboutAnyAxis) {
  const Layout flat = load_layout("autd3");
  std::string text(one_unit);
  const std::size_t at = text.find("[0.7071, 0, 0, 0.7071]");
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.48, -0.6, 0.64)}) {
    const double half = 0.25;
    const Vec3 v = std::sin(half) * axis;
    const auto turned = [&](double times) {
      return text.substr(0, at) +
             fmt::format("[{}, {}, {}, {}]", times * std::cos(half), times * v.x, times * v.y, times * v.z) +
             text.substr(at + 22);
    };
    const Layout layout = parse_layout_toml(turned(1), "x.toml");
    for (const std::size_t t : {0u, 17u, 248u}) {
      const Vec3 p = flat.transducers[t].position, way = glm::cross(axis, p);
      const Vec3 there =
          p * std::cos(2 * half) + way * std::sin(2 * half) + axis * (glm::dot(axis, p) * (1 - std::cos(2 * half)));
      EXPECT_LE(glm::distance(layout.transducers[t].position, there + Vec3(0.1, 0, -0.2)), 1e-12);
    }
    EXPECT_CONTAINS(fault_of(turned(1.01)), "quaternion_wxyz has length 1.0");
  }
}

TEST(LayoutToml, PlacesTransducersBehindUnits) {
  const Layout layout = parse_layout_toml(R"(
[[transducer]]
position_m = [0, 0, 0.3]
axis = [0, 0.6, -0.8]
[[unit]]
type = "openmpd"
position_m = [0, 0, 0]
quaternion_wxyz = [1, 0, 0, 0]
[[transducer]]
position_m = [0.01, 0.0, 0.3]
axis = [0, 0, -1]
)",
                                          "dome.toml");
  EXPECT_EQ(layout.name, "dome");
  EXPECT_EQ(layout.source_level_pa_m, 4.386);
  EXPECT_EQ(layout.transducer_radius_m, 0.0045);
  ASSERT_EQ(layout.transducers.size(), 258u);
  EXPECT_EQ(layout.transducers[256].position, Vec3(0, 0, 0.3));
  EXPECT_LE(glm::distance(layout.transducers[256].axis, Vec3(0, 0.6, -0.8)), 1e-12);
  EXPECT_EQ(layout.transducers[257].position, Vec3(0.01, 0, 0.3));
}

TEST(LayoutToml, TheExampleLoads) {
  const Layout layout = load_layout(test::source_file("assets/layouts/example.toml").string());
  EXPECT_FALSE(layout.transducers.empty());
  EXPECT_FALSE(layout.boards.empty());
}

/// A transducer, and a board with the identity as its pose.
std::string transducer(const std::string& position, const std::string& axis = "[0, 0, 1]") {
  return "[[transducer]]\nposition_m = " + position + "\naxis = " + axis + "\n";
}
std::string unit(const std::string& type, const std::string& turn = "[1, 0, 0, 0]") {
  return "[[unit]]\n" + type + "\nposition_m = [0, 0, 0]\nquaternion_wxyz = " + turn + "\n";
}

TEST(LayoutToml, FaultsNameLineAndKey) {
  const std::string boards = "line 2: type is not a known board; known: " + known_board_types();
  const std::vector<std::pair<std::string, std::string>> faults{
      {"", "no transducers: write [[unit]] or [[transducer]] tables"},
      {"unit = 3", "line 1: unit must be a list of tables: [[unit]]"},
      {"\nunit = [3]", "line 2: unit must be a list of tables: [[unit]]"},
      {"[unit]\n", "line 1: unit must be a list of tables: [[unit]]"},
      {"name = \"x\"\ncolour = 1\n",
       "line 2: unknown key colour in a layout; known: name, source_level_pa_m, transducer_radius_m, amplitude_law, "
       "frequency_hz, unit, transducer"},
      {unit("type = \"autd4\""), boards},
      {unit("type = \"paper\""), boards},
      {unit("type = 3"), "line 2: type must be a text in quotes, not empty"},
      {unit(""), "line 1: [[unit]] type is missing"},
      {"[[unit]]\ntype = \"autd3\"\nposition_m = [0, 0, 0]\n", "line 1: [[unit]] quaternion_wxyz is missing"},
      {unit("type = \"autd3\"", "[1, 1, 0, 0]"), "line 4: quaternion_wxyz has length 1.4142135623730951, not 1"},
      {unit("type = \"autd3\"", "[nan, 1, 0, 0]"), "line 4: quaternion_wxyz must be 4 finite numbers in brackets"},
      {transducer("[0, 0]"), "line 2: position_m must be 3 finite numbers in brackets"},
      {transducer("[0, 0, 11]"), "line 2: position_m has a coordinate of 11 m; the limit is 10 m"},
      {transducer("[0, 0, 1]", "[0, 0, 0]"), "line 3: axis has length 0, not 1"},
      {transducer("[0, 0, 1]") + "x = 1\n", "line 4: unknown key x in [[transducer]]; known: position_m, axis"},
      {"source_level_pa_m = 0\n",
       "line 1: source_level_pa_m is 0; it must be above 0 and at most 10000 Pa m, such as 4.386"},
      {"amplitude_law = \"loud\"\n", "line 1: amplitude_law is loud; it must be distance or uniform"},
      {"transducer_radius_m = -1\n",
       "line 1: transducer_radius_m is -1; it must be above 0 and at most 0.1 m, such as 0.0045"},
      {"frequency_hz = 40\n", "line 1: frequency_hz is 40, expected 1000 to 10000000"},
      {"frequency_hz = 45e3\n" + unit("type = \"openmpd\""),
       "line 1: frequency_hz is 45000, but the boards of [[unit]] emit 40000 Hz only; transducers with another "
       "frequency "
       "are [[transducer]] tables"},
      {transducer("[0, 0, 1]") + transducer("[0, 0, 1]", "[0, 1, 0]"),
       "line 4: transducers 0 and 1 are at the same place"},
  };
  for (const auto& [text, fault] : faults)
    EXPECT_EQ(fault_of(text), fault) << text;
  EXPECT_TRUE(fault_of("name = \"x\"\nunit = [[\n").starts_with("line ")) << "whatever the parser calls it";
  EXPECT_TRUE(fault_of("\x01").starts_with("line 1: "));
  EXPECT_TRUE(fault_of("name = \"x\"\n\"\\u0001\\nb\" = 1").starts_with("line 2: unknown key \\x01\\nb in a layout"));
}

TEST(LayoutToml, ALayoutHasALawOfAmplitudes) {
  const std::string rest = unit("type = \"openmpd\"");
  EXPECT_EQ(parse_layout_toml(rest, "a.toml").amplitude_law, Weighting::uniform);
  EXPECT_EQ(parse_layout_toml("amplitude_law = \"distance\"\n" + rest, "a.toml").amplitude_law, Weighting::distance);
  for (const std::string& name : layout_names())
    EXPECT_EQ(load_layout(name).amplitude_law, name == "paper" ? Weighting::distance : Weighting::uniform) << name;
}

std::string transducers(std::size_t count) {
  std::ostringstream text;
  for (std::size_t i = 0; i < count; ++i) {
    text << "[[transducer]]\nposition_m = [" << 0.01 * static_cast<double>(i % 256) << ", "
         << 0.01 * static_cast<double>(i / 256) << ", 0]\naxis = [0, 0, 1]\n";
  }
  return text.str();
}

TEST(LayoutToml, HoldsAsManyTransducersAsAllowedAndNoMore) {
  EXPECT_EQ(parse_layout_toml(transducers(max_transducers), "most.toml").transducers.size(), max_transducers);
  const std::string fault = fault_of(transducers(max_transducers + 1));
  EXPECT_TRUE(fault.ends_with("more than 65000 transducers")) << fault;
}

TEST(LayoutToml, HostileShapesAreRefusedAtOnce) {
  const std::size_t big = max_layout_bytes;
  /// `head`, then as many `part`s as fit into `bytes`, then `tail`.
  const auto repeat = [](std::string_view part, std::size_t bytes, std::string_view head = "",
                         std::string_view tail = "") {
    std::string text(head);
    while (text.size() + part.size() <= bytes)
      text += part;
    text += tail;
    return text;
  };
  std::string dotted_inside = "a = [";
  for (int depth = 0; depth < 100; ++depth)
    dotted_inside += repeat("b.", 10000, "{", "b = [");
  const std::vector<std::pair<const char*, std::string>> shapes{
      {"zeros", std::string(big, '\0')},
      {"too many bytes", std::string(big + 1, ' ')},
      {"brackets", repeat("[", big)},
      {"open lists", repeat("[", big - 10, "a = ")},
      {"inline tables", repeat("{a=", big - 10, "a = ")},
      {"dotted key", repeat("a.", big - 10, "", "a = 1")},
      {"quoted dotted key", repeat("\",\".", big - 10, "", "a = 1")},
      {"literal dotted key", repeat("'\n'.", big - 10, "", "a = 1")},
      {"dotted header", repeat("a.", big - 10, "[", "a]")},
      {"dotted keys within tables within lists", dotted_inside},
      {"values", repeat("1,", big - 10, "a = [", "]")},
      {"keys", repeat("\n\n\n", big)},
      {"endless string", repeat("x", big - 10, "a = \"")},
      {"escapes to the end", repeat("\\", big - 10, "a = \"")},
      {"quotes", repeat("\"", big)},
      {"bad utf-8", repeat("\xc3", big)},
      {"long number", repeat("1", big - 10, "a = ")},
      {"one comment", repeat("x", big - 10, "#")},
  };
  for (const auto& [name, text] : shapes) {
    const double begin_s = test::processor_s();
    const std::string fault = fault_of(text);
    EXPECT_NE(fault, "accepted") << name;
    // A second at full speed; sanitizers make it longer.
    EXPECT_LT(test::processor_s() - begin_s, 5 * test::slowest) << name;
    if (testing::Test::HasFailure()) FAIL() << name << ": " << fault;
  }
}

TEST(LayoutToml, FuzzedTextsNeverGetThroughBroken) {
  const std::string seeds[] = {
      one_unit, transducers(3),
      "unit = [{type = \"openmpd\", position_m = [0, 0, 0], quaternion_wxyz = [1, 0, 0, 0]}]\n"};
  std::mt19937_64 random(20240601);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::string text = test::damaged(seeds[random() % 3], random);
    test::error_of([&] {
      const Layout layout = parse_layout_toml(text, "fuzz.toml");
      ++accepted;
      ASSERT_FALSE(layout.transducers.empty());
      for (const Transducer& t : layout.transducers) {
        ASSERT_LT(glm::length(t.position), 20) << text;
        ASSERT_NEAR(glm::length(t.axis), 1, 1e-9) << text;
      }
    });
  }
  // The fuzz reaches both outcomes.
  EXPECT_GT(accepted, 200);
  EXPECT_LT(accepted, 15000);
}

}  // namespace
}  // namespace palpa::array
