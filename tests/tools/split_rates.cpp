// Prints in how many scenes exactly the real fingers are found, without looking at the depth frames again
// (--finger-width 0) and with it. It is not a test; run it by hand. Argument: scenes per row (default 60).
#include <array>
#include <cstdio>
#include <cstdlib>

#include "touch/fingers/finger_scenes.hpp"
#include "touch/stage.hpp"

namespace palpa::touch::test {
namespace {

struct Tally {
  int right = 0, there = 0, found = 0, split = 0;
};

void run(int scenes) {
  std::printf("%-26s %-8s %7s   %-24s %-24s\n", "", "cameras", "scenes", "before: right, found", "after");
  for (const SceneKind kind : all_scenes) {
    for (const int cameras : {1, 3}) {
      std::mt19937 random(11);
      std::array<Tally, 2> tallies;
      int seen = 0;
      for (int t = 0; t < scenes; ++t) {
        const FingerScene scene = random_scene(random, kind, cameras);
        bool touched = false;
        for (const bool after : {false, true}) {
          Parameters parameters = scene.parameters;
          if (!after) parameters.finger_width_m = 0;
          Touch touch;
          Stage({scene.solid}, scene.cameras, {.parameters = parameters}).touch(scene.images, touch);
          const Score score = score_of(scene, touch);
          touched = score.fingers > 0 || scene.fingers.empty();
          if (!touched) break;
          Tally& tally = tallies[after ? 1 : 0];
          tally.right += score.right() ? 1 : 0;
          tally.there += score.fingers;
          tally.found += score.found;
          tally.split += score.split;
        }
        seen += touched ? 1 : 0;
      }
      std::printf("%-26s %-8d %7d", name_of(kind), cameras, seen);
      for (const Tally& tally : tallies)
        std::printf("   %3d, %4d of %4d (%2d cut)", tally.right, tally.found, tally.there, tally.split);
      std::printf("\n");
    }
  }
}

}  // namespace
}  // namespace palpa::touch::test

int main(int argc, char** argv) {
  palpa::touch::test::run(argc > 1 ? std::atoi(argv[1]) : 60);
}
