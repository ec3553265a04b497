// Prints how far foci are from the skin when they sound, without and with prediction. It is not a test; run it by hand.
// It makes the tables of docs/notes/prediction-errors.md, from rendered fingers and from the shared recordings
// (hand-motion).
#include <cstdio>
#include <memory>

#include "session/hand_motion.hpp"
#include "session/predict/motion_filter.hpp"
#include "session/predict_chain.hpp"

namespace palpa::test {
namespace {

void print(const char* name, const ChainFilm& film) {
  for (const double late_s : {0.01, 0.02, 0.03, 0.05}) {
    const auto [seen, ahead] = chain_errors(film, late_s, false);
    std::printf("%-32s %2.0f ms   mean %5.2f -> %5.2f   p95 %5.2f -> %5.2f mm   silent %4.1f -> %4.1f ms late\n", name,
                late_s * 1e3, seen.mean_m * 1e3, ahead.mean_m * 1e3, seen.p95_m * 1e3, ahead.p95_m * 1e3,
                seen.late_s * 1e3, ahead.late_s * 1e3);
    std::fflush(stdout);
  }
}

void print(const char* name, const std::vector<TipPath>& tips, double noise_m, double assumed_m) {
  for (const double ahead_s : {0.02, 0.03, 0.05}) {
    const PredictionError error = error_of(
        tips,
        [&]() -> TipPredictor {
          const auto filter = std::make_shared<session::MotionFilter>(assumed_m);
          return {[filter](double t, const Vec3& place) { filter->see(t, place); },
                  [filter](double ahead) { return filter->at(ahead); }};
        },
        ahead_s, noise_m);
    std::printf("%-32s %2.0f ms   move %.2f (median %.2f)   rest %.2f   turn %.2f\n", name, ahead_s * 1e3, error.move,
                error.median, error.rest, error.turn);
    std::fflush(stdout);
  }
}

void run() {
  std::printf("foci of rendered fingers: distance from where the skin is, seen -> predicted\n");
  for (const double speed : {0.05, 0.1, 0.2, 0.4}) {
    char name[64];
    std::snprintf(name, sizeof(name), "slides at %.0f mm/s", speed * 1e3);
    print(name, sliding_film(speed, false, std::min(0.3, 0.12 / speed)));
  }
  print("a hand slides at 200 mm/s", hand_film(0.2, false, 0.3));
  print("the same, along z", hand_film(0.2, true, 0.3));
  print("over the semi-sphere, 200 mm/s", crossing_film(0.2));
  for (const double speed : {0.02, 0.1, 0.3}) {
    char name[64];
    std::snprintf(name, sizeof(name), "lifts at %.0f mm/s", speed * 1e3);
    print(name, lifting_film(speed));
  }
  print("rests", lifting_film(0));
  std::printf("fingertips of people: RMS error, relative to that of the place seen\n");
  print("markers, 75 Hz, 0.1 mm", marker_tips(), 0.1e-3, 0.1e-3);
  print("markers, 75 Hz, 0.3 mm", marker_tips(), 0.3e-3, 0.3e-3);
  std::vector<TipPath> thirty;
  for (const TipPath& tip : marker_tips())
    thirty.push_back(tip.thinned(2));
  print("markers, 38 Hz, 0.3 mm", thirty, 0.3e-3, 0.3e-3);
  print("Leap, about 110 Hz", leap_tips(), 0, 0.1e-3);
}

}  // namespace
}  // namespace palpa::test

int main() {
  palpa::test::run();
}
