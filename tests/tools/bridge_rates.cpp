// Prints how often a single fingertip splits and how often two neighbours merge, with and without bridging. It is not a
// test; run it by hand. Argument: trials per rig and object (default 12).
#include <array>
#include <cstdio>
#include <cstdlib>

#include "touch/fingertips.hpp"
#include "touch/stage.hpp"

namespace palpa::touch::test {
namespace {

struct Tally {
  int trials = 0, before = 0, after = 0;
  void add(bool wrong_before, bool wrong_after) {
    ++trials;
    before += wrong_before ? 1 : 0;
    after += wrong_after ? 1 : 0;
  }
};

/// One finger is split, or two are merged.
bool is_wrong(const Touch& touch, const Trial& trial) {
  if (trial.presses.size() == 1) return touch.finger_count > 1;
  for (const int presses : presses_in_fingers(touch, trial.presses)) {
    if (presses > 1) return true;
  }
  return false;
}

void run(int trials) {
  std::mt19937 random(7);
  std::printf("%-10s %-12s %6s %6s %6s   %6s %6s %6s\n", "cameras", "elevation", "single", "split", "after", "pairs",
              "merged", "after");
  for (const int cameras : {1, 2, 3}) {
    for (const double elevation : trial_elevations) {
      std::array<Tally, 2> tally;
      for (int t = 0; t < trials * 3; ++t) {
        for (const std::size_t fingers : {1, 2}) {
          const Trial trial = random_trial(random, cameras, elevation, trial_objects[t % 3], fingers);
          const auto solids = object(trial.object);
          Touch before, after;
          Stage(solids, trial.cameras, {.parameters = {.finger_width_m = 0}}).touch(trial.images, before);
          Stage(solids, trial.cameras).touch(trial.images, after);
          if (before.finger_count > 0) tally[fingers - 1].add(is_wrong(before, trial), is_wrong(after, trial));
        }
      }
      std::printf("%-10d %-12s %6d %6d %6d   %6d %6d %6d\n", cameras,
                  elevation == paper_rig ? "paper's rig" : std::to_string(static_cast<int>(elevation)).c_str(),
                  tally[0].trials, tally[0].before, tally[0].after, tally[1].trials, tally[1].before, tally[1].after);
    }
  }
}

}  // namespace
}  // namespace palpa::touch::test

int main(int argc, char** argv) {
  palpa::touch::test::run(argc > 1 ? std::atoi(argv[1]) : 12);
}
