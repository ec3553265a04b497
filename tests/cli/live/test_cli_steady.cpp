// Foci do not jump: fingers at rest, dipping, sliding and fast on all four objects, played by a session in this process
// and by the real program.
#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/steady_films.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

/// Plays a film on all of these objects; its path is the same on each. Returns their names and their sessions' lines.
std::vector<std::pair<std::string, std::vector<FociLine>>> on_each(const std::vector<std::string>& objects,
                                                                   const Film& film) {
  std::vector<Play> plays;
  for (const std::string& object : objects)
    plays.push_back({object});
  std::vector<std::vector<FociLine>> lines = played(film, plays);
  std::vector<std::pair<std::string, std::vector<FociLine>>> each;
  for (std::size_t i = 0; i < objects.size(); ++i)
    each.emplace_back(objects[i], std::move(lines[i]));
  return each;
}

std::vector<std::string> all_objects() {
  return the_first<std::string>(1, {"cube", "semi-sphere", "pyramid", "prism"});
}

/// The film that `palpa run --source synthetic --frames 95` sees, played on each object.
const std::vector<std::pair<std::string, std::vector<FociLine>>>& synthetic_on_each() {
  Film film = dipping("cube", 95);
  film.seed = 0;
  static const auto each = on_each(all_objects(), film);
  return each;
}

// With sanitizers, only the dipping finger is played: the others take the same path.
constexpr const char* same_path = "skipped: the dipping finger takes the same path";

TEST(SteadyFoci, OfAFingerAtRest) {
  if (instrumented()) GTEST_SKIP() << same_path;
  for (const auto& [object, lines] : on_each(all_objects(), resting("cube", 20))) {
    SCOPED_TRACE(object);
    const Movement m = movement_of(lines);
    EXPECT_GT(m.relative.size(), 45u);
    EXPECT_LE(m.share(0.95), 0.6e-3);
    EXPECT_LE(m.share(1), 1.2e-3);
  }
}

void expect_steady_while_dipping(const std::vector<FociLine>& lines) {
  const Movement m = movement_of(lines, 3);
  EXPECT_GT(m.relative.size(), 40u);
  EXPECT_LE(m.share(0.95), 0.8e-3);
  EXPECT_LE(m.share(1), 1.6e-3);
}

TEST(SteadyFoci, OfTheDippingFinger) {
  for (const auto& [object, lines] : synthetic_on_each()) {
    SCOPED_TRACE(object);
    expect_steady_while_dipping(lines);
  }
}

TEST(SteadyFoci, OfAFingerThatSlidesOverEdges) {
  if (instrumented()) GTEST_SKIP() << same_path;
  // Pyramid and prism have the same path.
  const std::vector<std::vector<std::string>> paths{{"cube"}, {"semi-sphere"}, {"pyramid", "prism"}};
  for (const std::vector<std::string>& objects : paths) {
    for (const auto& [object, lines] : on_each(objects, sliding(objects.front(), false, true))) {
      SCOPED_TRACE(object);
      const Movement m = movement_of(lines);
      EXPECT_GT(m.relative.size(), 20u);
      EXPECT_LE(m.share(1), 3 * 0.25e-3);
    }
  }
}

TEST(SteadyFoci, OfAFastFingerAreNotLate) {
  if (instrumented()) GTEST_SKIP() << same_path;
  const auto lines = played(fast("cube", 1), {{"cube"}, {.object = "cube", .smoothing = touch::Smoothing::none}});
  const auto &smooth = lines[0], &raw = lines[1];
  EXPECT_GT(movement_of(raw).relative.size(), 30u);
  EXPECT_LE(lag_of(raw, smooth), 5e-3);
}

/// Every sent line of foci equals the session's line of that frame, and at most a tenth is missing.
void expect_sent(const std::vector<FociLine>& sent, const std::vector<FociLine>& computed) {
  const auto sounds = [](const FociLine& line) { return !line.fingers.empty(); };
  for (const FociLine& line : sent) {
    if (!sounds(line)) continue;
    const auto same = std::find_if(computed.begin(), computed.end(),
                                   [&](const FociLine& other) { return other.time_s == line.time_s; });
    ASSERT_NE(same, computed.end()) << line.time_s;
    EXPECT_EQ(same->fingers, line.fingers) << line.time_s;
  }
  EXPECT_GE(static_cast<double>(std::count_if(sent.begin(), sent.end(), sounds)),
            0.9 * static_cast<double>(std::count_if(computed.begin(), computed.end(), sounds)));
}

TEST(SteadyFoci, OfTheRealProgramAreThoseOfASession) {
  auto dipping = std::async(std::launch::async, [] { return sent_by_palpa("synthetic", "cube", {"--frames", "95"}); });
  // Without steady axes and smoothing, foci jump: this shows that the other tests measure something.
  const Film film = resting("prism", 8);
  const auto take = scratch_folder("steady") / "take";
  record(film, take);
  const std::vector<FociLine> jumping =
      sent_by_palpa("recording:" + take.string(), "prism", {"--axes", "covariance", "--smoothing", "none"});
  const std::vector<FociLine> steady = dipping.get();
  expect_steady_while_dipping(steady);
  expect_sent(steady, synthetic_on_each().front().second);
  EXPECT_GT(movement_of(jumping).share(0.95), 2e-3);
  expect_sent(jumping, played(film, {{"prism", touch::Axes::covariance, touch::Smoothing::none}})[0]);
}

}  // namespace
}  // namespace palpa::test
