// Foci do not jump: fingers at rest, dipping, sliding and fast on all four objects, through the real program.
#include <gtest/gtest.h>

#include <cstdlib>

#include "steady_films.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

class SteadyFociOn : public ::testing::Test {
 protected:
  /// As a source. Rendering takes longer than playing: each path is rendered once.
  static std::string recorded(const Film& film) {
    static const std::filesystem::path folder = scratch_folder("steady");
    const auto at = folder / (film.path + " " + std::to_string(film.frames));
    if (!exists(at)) record(film, at);
    return "recording:" + at.string();
  }
};
class SteadyFoci : public SteadyFociOn, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(, SteadyFoci,
                         ::testing::ValuesIn(the_first<const char*>(1, {"cube", "semi-sphere", "pyramid", "prism"})),
                         [](const auto& object) { return std::string(object.param).substr(0, 4); });

TEST_P(SteadyFoci, OfAFingerAtRest) {
  const Movement m = movement_of(play(recorded(resting(GetParam(), 20)), GetParam()));
  EXPECT_GT(m.relative.size(), 45u);
  EXPECT_LE(m.share(0.95), 0.6e-3);
  EXPECT_LE(m.share(1), 1.2e-3);
}

TEST_P(SteadyFoci, OfTheDippingFinger) {
  const Movement m = movement_of(play("synthetic", GetParam(), {"--frames", "95"}), 3);
  EXPECT_GT(m.relative.size(), 40u);
  EXPECT_LE(m.share(0.95), 0.8e-3);
  EXPECT_LE(m.share(1), 1.6e-3);
}

TEST_P(SteadyFoci, OfAFingerThatSlidesOverEdges) {
  const Film film = sliding(GetParam(), false, true);
  const Movement m = movement_of(play(recorded(film), GetParam()));
  EXPECT_GT(m.relative.size(), 20u);
  EXPECT_LE(m.share(1), 3 * 0.25e-3);
}

TEST_F(SteadyFociOn, OfAFastFingerAreNotLate) {
  const std::string source = recorded(fast("cube", 1));
  const auto smooth = play(source, "cube"), raw = play(source, "cube", {"--smoothing", "none"});
  EXPECT_GT(movement_of(raw).relative.size(), 30u);
  EXPECT_LE(lag_of(raw, smooth), 5e-3);
}

TEST_F(SteadyFociOn, AreNotSoWithoutSteadyAxesAndSmoothing) {
  // What the other tests would say if they measured nothing.
  const Movement m =
      movement_of(play(recorded(resting("prism", 8)), "prism", {"--axes", "covariance", "--smoothing", "none"}));
  EXPECT_GT(m.share(0.95), 2e-3);
}

}  // namespace
}  // namespace palpa::test
