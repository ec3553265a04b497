#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "base/files/toml.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

template <typename Act>
std::string fault_of(const Act& act) {
  const std::string line = test::error_of(act);
  return line.empty() ? "accepted" : line;
}

TomlTable table_of(const std::string& text, const TomlLimits& limits = {}) {
  return TomlTable::parse(text, "x", "a test", limits);
}

std::string load_fault_of(const std::string& text, const TomlLimits& limits = {}) {
  return fault_of([&] { table_of(text, limits); });
}

TEST(Toml, GivesWhatStandsThere) {
  TomlTable table = table_of(R"(
count = 3
size_m = 0.5
whole_m = 2
name = "a b"
flag = true
list = [1, 2.5]
names = ["", "b"]
[part]
x = 1
[[row]]
y = 1
[[row]]
y = 2
)");
  EXPECT_EQ(table.whole("count", 0, 10), 3u);
  EXPECT_EQ(table.number("size_m"), 0.5);
  EXPECT_EQ(table.number("whole_m", 0, 2), 2.0);
  EXPECT_EQ(table.number_or("absent", 7, 0, 1), 7.0);
  EXPECT_EQ(table.text("name"), "a b");
  EXPECT_EQ(table.text_or("title", "none"), "none");
  EXPECT_TRUE(table.flag_or("flag", false));
  EXPECT_TRUE(table.flag_or("other", true));
  EXPECT_EQ(table.numbers("list", 2), (std::vector<double>{1, 2.5}));
  EXPECT_EQ(table.texts("names"), (std::vector<std::string>{"", "b"}));
  EXPECT_FALSE(table.table("elsewhere"));
  EXPECT_EQ(table.fault("part", "hm").what(), std::string("x: line 9: hm"));
  auto part = table.table("part");
  ASSERT_TRUE(part);
  EXPECT_EQ(part->number("x"), 1.0);
  auto rows = table.tables("row");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].number("y"), 2.0);
  EXPECT_EQ(rows[1].fault("", "hm").what(), std::string("x: line 13: hm"));
  EXPECT_TRUE(table.tables("none").empty());
  EXPECT_NO_THROW(table.done());
}

TEST(Toml, AKeyThatIsGivenTwiceIsNamedWithBothLines) {
  const auto fault = [](const std::string& text, const char* asked) {
    return fault_of([&] {
      TomlTable table = table_of(text);
      table.has(asked);
      table.done();
    });
  };
  EXPECT_EQ(fault("[[c]]\na = 1\n[[c]]\na = 2\nb = 3\n\na = 4\n", "c"), "x: line 7: key a is already given in line 4");
  EXPECT_EQ(fault("a = 1\n[t]\nb = 1\n[t.u]\n\"b c\" = [\n1]\n \"b c\" = 2\n[v]\n", "v"),
            "x: line 7: key \"b c\" is already given in line 5");
  EXPECT_EQ(fault("[t]\nb = 1\n[u]\n[t]\nb = 1\n", "u"), "x: line 4: key t is already given in line 1");
  EXPECT_EQ(fault("t = 1\n[t]\n", "t"), "x: line 2: key t is already given in line 1");
  EXPECT_EQ(fault("p.q = 1\np.r = 1\np.q = 2\n", "p"), "x: line 3: key p.q is already given in line 1");
  EXPECT_EQ(fault("a = 1\na.b = 2\n", "a"), "x: line 2: key a.b is already given in line 1");
  EXPECT_EQ(fault("b = 1\na = {b = 1, b = 2}\n", "b"), "x: line 2: a key is given twice");
  // Without a key that is asked for, it may be any file, and nothing of it is shown.
  EXPECT_EQ(fault("a = 1\na = 2\n", "b"), "x: line 2: its key is already given in line 1");
  EXPECT_EQ(fault_of([] { table_of("a = 1\na = 2\n").number("b"); }), "x: line 2: its key is already given in line 1");
}

TEST(Toml, FaultsNameFileLineAndKey) {
  TomlTable table = table_of("a = 3\nb = \"x\\ny\"\nc = inf\nd = [1, nan]\ne = [[0]]\n\"\\u0001\\nf\" = 1\n");
  EXPECT_EQ(fault_of([&] { table.number("z"); }), "x: z is missing");
  EXPECT_EQ(fault_of([&] { table.number("a", 4, 5); }), "x: line 1: a is 3, expected 4 to 5");
  EXPECT_EQ(fault_of([&] { table.number("b"); }), "x: line 2: b must be a finite number");
  EXPECT_EQ(fault_of([&] { table.number("b", 0, 1); }), "x: line 2: b must be a number");
  EXPECT_EQ(fault_of([&] { table.text("b"); }),
            "x: line 2: b must be one line of at most 1024 characters, without tabs and the like");
  EXPECT_EQ(fault_of([&] { table.text("a"); }), "x: line 1: a must be a text in quotes, not empty");
  EXPECT_EQ(fault_of([&] { table.number("c"); }), "x: line 3: c must be a finite number");
  EXPECT_EQ(fault_of([&] { table.numbers("d", 0); }), "x: line 4: d must be a list of finite numbers");
  EXPECT_EQ(fault_of([&] { table.numbers("d", 3); }), "x: line 4: d must be 3 finite numbers in brackets");
  EXPECT_EQ(fault_of([&] { table.texts("d"); }), "x: line 4: d must be a list of texts");
  EXPECT_EQ(fault_of([&] { table.flag_or("a", true); }), "x: line 1: a must be true or false");
  EXPECT_EQ(fault_of([&] { table.pose("e"); }), "x: line 5: e must be four rows of four finite numbers");
  EXPECT_EQ(fault_of([&] { table.table("a"); }), "x: line 1: a must be a table: [a]");
  EXPECT_EQ(fault_of([&] { table.tables("d"); }), "x: line 4: d must be a list of tables: [[d]]");
  EXPECT_EQ(fault_of([&] { table.done(); }), "x: line 6: unknown key \\x01\\nf in a test; known: z, a, b, c, d, e");
}

TEST(Toml, AMisspeltKeyIsNamedBeforeTheOneThatIsMissing) {
  TomlTable table = table_of("[t]\nfxx = 1\nfy = 2\nlayot = 3\nspeed = 4\nheigth = 5\n").table("t").value();
  EXPECT_EQ(fault_of([&] { table.number("fx"); }), "x: line 2: unknown key fxx in [t]; did you mean fx?");
  EXPECT_EQ(fault_of([&] { table.text("layout"); }), "x: line 4: unknown key layot in [t]; did you mean layout?");
  EXPECT_EQ(fault_of([&] { table.number("height"); }), "x: line 6: unknown key heigth in [t]; did you mean height?");
  // Another key, not a misspelt one.
  TomlTable other = table_of("[t]\nfy = 2\nwidth = 3\n").table("t").value();
  EXPECT_EQ(fault_of([&] { other.number("fx"); }), "x: line 1: [t] fx is missing");
  EXPECT_EQ(fault_of([&] { other.number("height"); }), "x: line 1: [t] height is missing");
  other.number("width");
  EXPECT_EQ(fault_of([&] { other.number("width_"); }), "x: line 1: [t] width_ is missing");
}

TEST(Toml, TextMustBeUtf8) {
  EXPECT_EQ(fault_of([] { table_of("a = 1\nb = \"\xc3\xa4\"\nc = \"\xe4\"\n"); }),
            "x: line 3: not TOML: it has bytes that are not UTF-8; save the file as UTF-8");
  EXPECT_EQ(table_of("b = \"\xc3\xa4\"\n").text("b"), "\xc3\xa4");
}

TEST(Toml, LookingForAKeyIsNotReadingIt) {
  TomlTable table = table_of("a = 1\n");
  EXPECT_TRUE(table.has("a"));
  EXPECT_FALSE(table.has("b"));
  EXPECT_EQ(fault_of([&] { table.done(); }), "x: line 1: unknown key a in a test; known: a, b");
  table.number("a");
  EXPECT_NO_THROW(table.done());
}

TEST(Toml, ReadsFilesWithinTheirBounds) {
  const auto file = test::scratch_folder("toml") / "a.toml";
  std::ofstream(file) << "a = 1\n";
  EXPECT_EQ(TomlTable::load(file, "a test").number("a"), 1.0);
  EXPECT_EQ(fault_of([&] { TomlTable::load(file, "a test", {.bytes = 5}); }),
            file.string() + ": has 6 bytes, at most 5 are expected");
  EXPECT_EQ(load_fault_of("a = 1\n", {.bytes = 5}), "x: has 6 bytes, at most 5 are expected");
  EXPECT_EQ(load_fault_of("a = [1, 2]\n", {.items = 4}), "accepted");
  EXPECT_EQ(load_fault_of("a = [1, 2]\nb = 1", {.items = 4}), "x: line 2: more than 4 values and lines");
  EXPECT_EQ(load_fault_of("a.b.c = 1", {.key_parts = 2}), "x: line 1: a key of more than 2 parts");
  EXPECT_TRUE(load_fault_of("a = 1\nb = \n").starts_with("x: line 2: not TOML: "));
}

TEST(Toml, WrittenValuesReadBack) {
  Transform pose(1);
  pose[3] = Vec4(0.1, -2, 1e-17, 1);
  TomlTable table = table_of("a = " + toml_number(3) + "\nb = " + toml_number(-0.0) +
                             "\nc = " + toml_string("\"\\\xc3\xa9") + "\nd = " + toml_pose(pose) + "\n");
  EXPECT_EQ(table.number("a"), 3.0);
  EXPECT_TRUE(std::signbit(table.number("b")));
  EXPECT_EQ(table.text("c"), "\"\\\xc3\xa9");
  EXPECT_EQ(table.pose("d"), pose);
}

TEST(TomlGuard, CountsKeyPartsOutsideOfStringsOnly) {
  EXPECT_NO_THROW(
      guard_toml("a = \"1.2.3.4.5.6.7.8.9.10\"\nb = '''\n1.1.1.1.1.1.1.1.1.1\n'''\n# 1.1.1.1.1.1.1.1.1.1.1", "x"));
  EXPECT_NO_THROW(guard_toml("a = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]", "x"));
  EXPECT_NO_THROW(guard_toml("a = \"\"\"x\"\"\"\"\"\nb.c = 1", "x"));
  EXPECT_REFUSED(guard_toml("a.b.c.d.e.f.g.h.i = 1", "x"), "x: line 1: a key of more than 8 parts");
  EXPECT_REFUSED(guard_toml("a = \"\\\"\"\na . b . c.d.e.f.g.h.i = 1", "x"), "x: line 2: a key of more than 8 parts");
  EXPECT_REFUSED(guard_toml("\"a\".'b'.\"c\".d.e.f.g.h.i = 1", "x"), "x: line 1: a key of more than 8 parts");
  EXPECT_REFUSED(guard_toml("\n\"\\\n\"\n''' \n'''\na.b.c.d.e.f.g.h.i = 1", "x"),
                 "x: line 6: a key of more than 8 parts");
}

TEST(TomlTable, KeysAreInTheOrderOfTheFile) {
  EXPECT_EQ(table_of("zebra = 1\napple = 2\n[middle]\n").keys(),
            (std::vector<std::string>{"zebra", "apple", "middle"}));
}

}  // namespace
}  // namespace palpa
