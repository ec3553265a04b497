// Prints how well pictures tell whether a faint digit of a hand of hand_rates touches. Not a test; run it by hand.
//
//   hand_doubts [--cameras N] CLASS SEED...
//   hand_doubts --picture FILE [--cameras N] CLASS SEED
//
// With --picture, draws what the cameras see of a digit (digit_picture.hpp), as in docs/notes/finger-rates.md. Else:
//
// A digit is faint if 1 to 9 of its pixels are contacts in a picture without noise, or if its skin is at most 0.3 mm
// above the surface. For each, the hand is filmed 300 times as it is in its last frame, and 300 times when it is higher
// (if the digit counts as a visible finger) or deeper (if not), by 0.2 mm. The columns:
//
//   deep           mm, of the digit's deepest skin
//   true           contacts of the digit without noise, as it is and moved
//   seen, moved    the same with noise: mean and standard deviation
//   count, 9       how often a picture of the hand that is deeper has more contacts of the digit than one of the hand
//                  that is higher, in % of all such pairs (the area under the ROC curve; 50: it tells nothing); 9: the
//                  same for means of nine pictures, which are 0.1 s at 90 Hz
//   palpa          in % of these pictures, the digit has at least min_points (5) contacts, as it is and moved
//   limit, 9       as count, for two hands of which one has the fewest contacts of a visible finger (5) without noise,
//                  and the other one less
//   mm             the difference in height of these two
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "digit_picture.hpp"
#include "hand_classes.hpp"
#include "hand_making.hpp"
#include "hand_truth.hpp"
#include "touch/stage.hpp"

namespace palpa::test {
namespace {

constexpr std::size_t pictures = 300, together = 9;
constexpr double moved_m = 0.2e-3, above_m = 0.3e-3;
constexpr int few = 5;

/// The hand of its last frame, higher by so much.
RatedHand raised(const RatedHand& hand, double by_m) {
  RatedHand out = hand;
  out.moves = false;
  const double last_s = hand.time_of(hand.frames() - 1);
  for (HandBody& body : out.bodies)
    body.pose = [T = hands::at({0, by_m, 0}, body.pose(last_s))](double) { return T; };
  return out;
}

/// The digit's contacts in each of many pictures.
std::vector<double> counts_of(const RatedHand& hand, std::uint32_t digit, std::uint64_t seed) {
  HandTruth truth(hand);
  const TrueFrame frame = truth.at(0);
  sensing::SyntheticRig rig(hand.cameras, geometry::Mesh{}, sensing::Noise::d415, seed);
  touch::Stage stage(hand.solids, hand.cameras, {.parameters = {.finger_width_m = 0}});
  std::vector<sensing::Posed> skin;
  for (const HandBody& body : hand.bodies)
    skin.push_back({&body.skin->mesh, body.pose(0)});
  sensing::FrameSet set;
  touch::Touch touch;
  std::vector<double> counts;
  for (std::size_t k = 0; k < pictures; ++k) {
    rig.render(skin, k, set);
    stage.touch(set.frames, touch);
    counts.push_back(static_cast<double>(std::ranges::count_if(
        touch.contacts, [&](const touch::Contact& c) { return truth.part_at(frame, Vec3(c.position)) == digit; })));
  }
  return counts;
}

std::vector<double> means_of(const std::vector<double>& values) {
  std::vector<double> means;
  for (std::size_t k = 0; k + together <= values.size(); k += together) {
    double sum = 0;
    for (std::size_t i = 0; i < together; ++i)
      sum += values[k + i];
    means.push_back(sum / together);
  }
  return means;
}

/// In %: how often a value of `more` is the greater one.
double greater(const std::vector<double>& more, const std::vector<double>& less) {
  double wins = 0;
  for (const double a : more) {
    for (const double b : less)
      wins += a > b ? 1 : a == b ? 0.5 : 0;
  }
  return 100 * wins / static_cast<double>(more.size() * less.size());
}

double enough(const std::vector<double>& counts) {
  const auto found = std::ranges::count_if(counts, [](double count) { return count >= few; });
  return 100.0 * static_cast<double>(found) / static_cast<double>(counts.size());
}

std::string spread(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double v : values)
    sum += v, squares += v * v;
  const auto n = static_cast<double>(values.size());
  return fmt::format("{:.1f} +- {:.1f}", sum / n, std::sqrt(std::max(0.0, squares / n - sum / n * sum / n)));
}

int contacts_without_noise(const RatedHand& hand, std::uint32_t digit) {
  HandTruth truth(hand);
  return truth.at(0).contacts[digit];
}

/// How far the hand must be raised until the digit has at most so many contacts without noise.
double height_of(const RatedHand& hand, std::uint32_t digit, int contacts) {
  double low = -1e-3, high = 1e-3;
  for (int n = 0; n < 12; ++n) {
    const double middle = (low + high) / 2;
    (contacts_without_noise(raised(hand, middle), digit) > contacts ? low : high) = middle;
  }
  return high;
}

std::string row_of(const HandClass& kind, const RatedHand& hand, std::uint32_t digit, double deep_m, int contacts) {
  const bool visible = contacts >= few;
  const RatedHand other = raised(hand, visible ? moved_m : -moved_m);
  const std::vector<double> here = counts_of(hand, digit, 2 * hand.seed),
                            there = counts_of(other, digit, 2 * hand.seed + 1);
  const auto& deeper = visible ? here : there;
  const auto& higher = visible ? there : here;
  const double five_m = height_of(hand, digit, few), four_m = height_of(hand, digit, few - 1);
  const std::vector<double> five = counts_of(raised(hand, five_m), digit, 2 * hand.seed + 2),
                            four = counts_of(raised(hand, four_m), digit, 2 * hand.seed + 3);
  return fmt::format(
      "{:<11}{:>6}{:>8}{:>6}{:>7.2f}{:>9}{:>16}{:>16}{:>8.1f}{:>7.1f}{:>8.0f}{:>5.0f}{:>9.1f}{:>7.1f}{:>8.3f}\n",
      kind.name, hand.seed, hand.cameras.size(), digit, 1e3 * deep_m,
      fmt::format("{}, {}", contacts, contacts_without_noise(other, digit)), spread(here), spread(there),
      greater(deeper, higher), greater(means_of(deeper), means_of(higher)), enough(here), enough(there),
      greater(five, four), greater(means_of(five), means_of(four)), 1e3 * (four_m - five_m));
}

void run(int argc, char** argv) {
  std::optional<int> cameras;
  std::filesystem::path picture;
  const HandClass* kind = nullptr;
  std::vector<std::uint64_t> seeds;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    std::uint64_t number = 0;
    const bool is_number = std::from_chars(word.data(), word.data() + word.size(), number).ec == std::errc();
    const auto named = std::ranges::find_if(hand_classes(), [&](const HandClass& c) { return word == c.name; });
    if (word == "--cameras" && i + 1 < argc) {
      cameras = argv[++i][0] - '0';
    } else if (word == "--picture" && i + 1 < argc) {
      picture = argv[++i];
    } else if (is_number) {
      seeds.push_back(number);
    } else if (named != hand_classes().end()) {
      kind = &*named;
    } else {
      throw bad_usage(fmt::format("no class {}", word));
    }
  }
  if (!kind || seeds.empty()) throw bad_usage("hand_doubts [--picture FILE] [--cameras N] CLASS SEED...");
  if (!picture.empty()) return draw_digit(make_hand_of(*kind, seeds.front(), cameras), kind->name, picture);
  std::vector<std::string> rows(seeds.size());
  parallel_chunks(seeds.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const RatedHand hand = raised(make_hand_of(*kind, seeds[i], cameras), 0);
    const TrueFrame frame = HandTruth(hand).at(0);
    for (std::uint32_t digit = 0; digit < hand.parts(); ++digit) {
      const int contacts = frame.contacts[digit];
      if (contacts < 2 * few && (contacts > 0 || frame.depth_m[digit] > -above_m) && !frame.of_palm[digit])
        rows[i] += row_of(*kind, hand, digit, frame.depth_m[digit], contacts);
    }
  });
  std::printf("%-11s%6s%8s%6s%7s%9s%16s%16s%8s%7s%8s%5s%9s%7s%8s\n", "class", "seed", "cameras", "digit", "deep",
              "true", "seen", "moved", "count", "9", "palpa", "", "limit", "9", "mm");
  for (const std::string& row : rows)
    std::printf("%s", row.c_str());
}

}  // namespace
}  // namespace palpa::test

int main(int argc, char** argv) {
  try {
    palpa::test::run(argc, argv);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
