// Prints how far foci are from the skin when they sound, without and with prediction: the tables of
// docs/notes/prediction-errors.md. Not a test; run it by hand.
//
//   predict_rates
//
// Rendered fingers, and the shared recordings of fingertips (hand-motion) if they are there.
#include <fmt/format.h>

#include <cstdio>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "base/system/parallel.hpp"
#include "session/hand_motion.hpp"
#include "session/predict/motion_filter.hpp"
#include "session/predict_chain.hpp"

namespace palpa::test {
namespace {

struct Filmed {
  const char* name;
  ChainFilm film;
};

/// Mean and 95th percentile, mm.
std::string row_of(const Filmed& filmed) {
  std::string row = fmt::format("{:<32}", filmed.name);
  for (const double late_s : {0.02, 0.05}) {
    const auto [seen, ahead] = chain_errors(filmed.film, late_s, false);
    row += fmt::format("{:8.2f},{:5.2f}{:8.2f},{:5.2f}{:6.0f}{:6.0f}", seen.mean_m * 1e3, seen.p95_m * 1e3,
                       ahead.mean_m * 1e3, ahead.p95_m * 1e3, seen.late_s * 1e3, ahead.late_s * 1e3);
  }
  return row + "\n";
}

/// RMS errors of the filter alone, relative to those of the newest place.
std::string row_of(const char* name, const std::vector<TipPath>& tips, double noise_m, double assumed_m) {
  std::string row = fmt::format("{:<32}", name);
  for (const double ahead_s : {0.02, 0.05}) {
    const auto make = [&]() -> TipPredictor {
      const auto filter = std::make_shared<session::MotionFilter>(assumed_m);
      return {[filter](double t, const Vec3& place) { filter->see(t, place); },
              [filter](double ahead) { return filter->at(ahead); }};
    };
    const PredictionError error = error_of(tips, make, ahead_s, noise_m);
    row += fmt::format("{:9.2f}{:7.2f}{:7.2f}", error.move, error.rest, error.turn);
  }
  return row + "\n";
}

void run() {
  const Filmed films[] = {
      {"slides at 50 mm/s", sliding_film(0.05, false, 0.3)},
      {"slides at 200 mm/s", sliding_film(0.2, false, 0.3)},
      {"over the semi-sphere, 200 mm/s", crossing_film(0.2)},
      {"lifts at 100 mm/s", lifting_film(0.1)},
      {"rests", lifting_film(0)},
  };
  std::string rows[std::size(films)];
  parallel_chunks(std::size(films), 1, [&](std::size_t i, std::size_t, std::size_t) { rows[i] = row_of(films[i]); });
  std::printf("%-32s%14s%14s%12s%14s%14s%12s\n", "mm: mean, 95 %; ms after the end", "20 ms late", "predicted",
              "last slot", "50 ms late", "predicted", "last slot");
  for (const std::string& row : rows)
    std::printf("%s", row.c_str());

  const std::vector<TipPath> markers = marker_tips();
  if (markers.empty()) return;
  std::vector<TipPath> thinned;
  for (const TipPath& tip : markers)
    thinned.push_back(tip.thinned(2));
  std::printf("\n%-32s%9s%7s%7s%9s%7s%7s\n", "RMS, of the place seen", "20: move", "rest", "turn", "50: move", "rest",
              "turn");
  std::printf("%s", row_of("markers, 75 Hz, 0.1 mm", markers, 0.1e-3, 0.1e-3).c_str());
  std::printf("%s", row_of("markers, 75 Hz, 0.3 mm", markers, 0.3e-3, 0.3e-3).c_str());
  std::printf("%s", row_of("markers, 38 Hz, 0.3 mm", thinned, 0.3e-3, 0.3e-3).c_str());
  std::printf("%s", row_of("Leap, about 110 Hz", leap_tips(), 0, 0.1e-3).c_str());
}

}  // namespace
}  // namespace palpa::test

int main() {
  palpa::test::run();
}
