// Prints how much the results of split_rates depend on each constant of splitting and joining: the errors with 0.8 and
// 1.25 times its value. It is not a test; run it by hand. Argument: scenes per row of split_rates (default 10).
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <vector>

#include "touch/fingers/finger_scenes.hpp"
#include "touch/stage.hpp"
#include "tuned.hpp"

namespace palpa::touch::test {
namespace {

struct Constant {
  const char* name;
  const char* value;
  std::function<void(Parameters&, float factor)> scale;
  bool is_parameter = false;  ///< of a stage; else a variable of tuned.hpp
};

Constant tuned(tuning::Name which, const char* name, const char* value) {
  return {name, value, [which](Parameters&, float factor) { tuning::factors[which] = factor; }};
}

const std::vector<Constant>& constants() {
  using namespace tuning;
  static const std::vector<Constant> all{
      tuned(valley, "depth of a valley", "1 mm"),
      tuned(noise, "its addition by distance", "5 mm/m^2"),
      tuned(hole, "width of a hole", "2 mm"),
      tuned(inside, "depth of inner points", "0.36 widths"),
      tuned(same, "inner points of one finger", "0.3 widths"),
      tuned(apart, "inner points of two fingers", "0.45 widths"),
      tuned(facing, "skin that faces other skin", "cosine 0.4"),
      tuned(grow, "groups grow below", "3/8"),
      tuned(votes, "pairs with a valley", "1/2"),
      tuned(firm, "firm contacts", "1/2"),
      tuned(company, "pixels of a firm contact", "5 of 25"),
      tuned(rim, "step at a rim", "4 mm"),
      tuned(clear, "empty beyond", "4 mm"),
      tuned(nearest, "pairs that face", "2 mm"),
      tuned(away, "path into the skin", "cosine -0.1"),
      tuned(towards, "path out of the skin", "cosine 0.3"),
      tuned(empty, "empty places", "3/32"),
      {"--finger-width", "25 mm", [](Parameters& p, float factor) { p.finger_width_m *= double{factor}; }, true},
      {"--finger-gap", "5 mm", [](Parameters& p, float factor) { p.finger_gap_m *= double{factor}; }, true},
      {"--min-points", "5",
       [](Parameters& p, float factor) {
         p.min_points = static_cast<std::uint32_t>(static_cast<float>(p.min_points) * factor + 0.5F);
       },
       true},
  };
  return all;
}

/// Scenes in which the found fingers are not the real ones, and why.
struct Errors {
  int wrong = 0, merged = 0, cut = 0, missing = 0, spurious = 0;

  void add(const Score& score) {
    wrong += score.right() ? 0 : 1;
    merged += score.merged;
    cut += score.split;
    missing += score.found < score.fingers ? score.fingers - score.found : 0;
    spurious += score.found > score.fingers ? score.found - score.fingers : 0;
  }
};

void run(int scenes) {
  constexpr std::array<float, 3> factors{1, 0.8F, 1.25F};
  std::vector<std::array<Errors, 3>> errors(constants().size());
  int seen = 0;
  for (const SceneKind kind : all_scenes) {
    for (const int cameras : {1, 3}) {
      std::mt19937 random(11);
      for (int t = 0; t < scenes; ++t) {
        const FingerScene scene = random_scene(random, kind, cameras);
        ++seen;
        Stage usual({scene.solid}, scene.cameras, {.parameters = scene.parameters});
        for (std::size_t c = 0; c < constants().size(); ++c) {
          const Constant& constant = constants()[c];
          for (std::size_t f = c == 0 ? 0 : 1; f < factors.size(); ++f) {
            Parameters parameters = scene.parameters;
            constant.scale(parameters, factors[f]);
            Touch touch;
            if (constant.is_parameter) {
              Stage({scene.solid}, scene.cameras, {.parameters = parameters}).touch(scene.images, touch);
            } else {
              usual.touch(scene.images, touch);
            }
            errors[c][f].add(score_of(scene, touch));
          }
          Parameters unused;
          constant.scale(unused, 1);
        }
      }
    }
    std::fprintf(stderr, "%s\n", name_of(kind));
  }
  const auto print = [](const Errors& e) {
    std::printf(" | %3d (%d merged, %d cut, %d missing, %d spurious)", e.wrong, e.merged, e.cut, e.missing, e.spurious);
  };
  std::printf("%d scenes; wrong with the constants as they are", seen);
  print(errors[0][0]);
  std::printf("\n| constant | value | wrong with 0.8 times | wrong with 1.25 times |\n|---|---|---|---|\n");
  for (std::size_t c = 0; c < constants().size(); ++c) {
    std::printf("| %s | %s", constants()[c].name, constants()[c].value);
    print(errors[c][1]);
    print(errors[c][2]);
    std::printf(" |\n");
  }
}

}  // namespace
}  // namespace palpa::touch::test

int main(int argc, char** argv) {
  palpa::touch::test::run(argc > 1 ? std::atoi(argv[1]) : 10);
}
