#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <unordered_map>

#include "base/error.hpp"
#include "base/version.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "sweep/store.hpp"

namespace palpa::sweep {
namespace {

namespace fs = std::filesystem;

RunInfo this_run() {
  return {{}, version(), commit(), "touch", "0123", "0/1", "host", "device", "cpu", 12};
}

CaseLine line_of(const std::string& id, State state = State::done) {
  CaseLine line{.id = id, .state = state};
  line.settings = {{"scene", "a \"b\".glb"}};
  if (state == State::done) {
    line.results = {{"points", "3"}};
  } else {
    line.error = "too\nbad";
    line.exit_code = 1;
  }
  return line;
}

class SweepStore : public testing::Test {
 protected:
  // Each test has its own: a file that was read in one test may not be written in another.
  fs::path folder_ =
      test::scratch_folder(std::string("store-") + testing::UnitTest::GetInstance()->current_test_info()->name()) /
      "out";
  /// The only file of lines.
  fs::path lines() const {
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (entry.path().filename() == "cases.jsonl") return entry.path();
    }
    return {};
  }
};

TEST_F(SweepStore, ALaterLookReadsOnlyWhatIsNew) {
  const auto add = [&](const std::string& id, State state = State::done) {
    StoreWriter writer(folder_, this_run());
    writer.add(line_of(id, state));
    return fs::path(folder_) / "runs" / writer.name() / "cases.jsonl";
  };
  Places places;
  const auto look = [&] {
    std::multiset<std::string> ids;
    const auto take = [&](std::size_t, std::string_view id, State, std::string_view) { ids.emplace(id); };
    Store(folder_).each(take, &places);
    return ids;
  };
  EXPECT_TRUE(look().empty());
  const fs::path file = add("00000000000000000001");
  EXPECT_EQ(look(), (std::multiset<std::string>{"00000000000000000001"}));
  EXPECT_TRUE(look().empty());
  add("00000000000000000002", State::failed);
  // The first process writes on, and is seen in the middle of a line.
  const std::string before = test::read_text(file), line = to_json_line(line_of("00000000000000000003"));
  test::write_text(file, before + line.substr(0, 20));
  EXPECT_EQ(look(), (std::multiset<std::string>{"00000000000000000002"}));
  test::write_text(file, before + line);
  EXPECT_EQ(look(), (std::multiset<std::string>{"00000000000000000003"}));
  EXPECT_TRUE(look().empty());
  EXPECT_EQ(Store(folder_).states().size(), 3u);
}

TEST_F(SweepStore, LinesAreThereOrNot) {
  EXPECT_TRUE(Store(folder_).states().empty()) << "a folder that does not exist yet";
  {
    StoreWriter writer(folder_, this_run());
    writer.add(line_of("00000000000000000001"));
    writer.add(line_of("00000000000000000002", State::failed));
    writer.add(line_of("00000000000000000003", State::refused));
  }
  auto states = Store(folder_).states();
  ASSERT_EQ(states.size(), 3u);
  EXPECT_EQ(states.at("00000000000000000001"), State::done);
  EXPECT_EQ(states.at("00000000000000000002"), State::failed);
  // A line that was cut anywhere is absent, and its file still counts.
  const std::string whole = test::read_text(lines());
  const std::size_t third =
      whole.rfind('{', whole.size() - 1) == std::string::npos ? 0 : whole.find("{\"id\":\"00000000000000000003");
  for (std::size_t end = third; end < whole.size(); end += 5) {
    test::write_text(lines(), whole.substr(0, end));
    EXPECT_EQ(Store(folder_).states().size(), 2u) << end;
  }
  // A line that is something else is absent, too, but not those after it.
  test::write_text(lines(), whole.substr(0, third) + std::string(40, '\0') + "\n" + whole.substr(third));
  EXPECT_EQ(Store(folder_).states().size(), 3u);
  // A line of which a power failure has left only the ends is absent, too.
  std::string zeros = whole;
  zeros.replace(third + 60, 10, 10, '\0');
  test::write_text(lines(), zeros);
  EXPECT_EQ(Store(folder_).states().size(), 2u);
  test::write_text(lines(), whole);
  // Another process adds a file of its own; of two results, the better one counts.
  {
    StoreWriter writer(folder_, this_run());
    writer.add(line_of("00000000000000000002"));
  }
  const Store store(folder_);
  EXPECT_EQ(store.runs().size(), 2u);
  EXPECT_EQ(store.states().at("00000000000000000002"), State::done);
}

TEST_F(SweepStore, AnotherVersionsResultsAreRefused) {
  RunInfo old = this_run();
  old.version = "0.1.0";
  old.commit = "abc";
  { StoreWriter(folder_, old).add(line_of("00000000000000000001")); }
  try {
    Store(folder_).check_version();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::usage);
    EXPECT_NE(std::string(error.what()).find("has results of palpa 0.1.0 (abc), and this is"), std::string::npos);
  }
}

TEST_F(SweepStore, AFolderOfSomethingElseIsRefused) {
  fs::create_directory(folder_);
  EXPECT_NO_THROW(Store{folder_}) << "an empty one";
  test::write_text(folder_ / "thesis.tex", "x");
  EXPECT_ERROR(Store{folder_}, Exit::usage, "has files, but is no folder of a sweep");
  EXPECT_ERROR(Store(folder_ / "thesis.tex"), Exit::usage, "thesis.tex is not a folder");
}

}  // namespace
}  // namespace palpa::sweep
