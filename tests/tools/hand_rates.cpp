// Prints what palpa makes of hundreds of rendered hands (hand_classes.cpp), class by class. Not a test; run it by hand.
//
//   hand_rates [--cameras N] [--csv FILE] [--without RULE]... [CLASS | SEED]...
//
// Without classes or seeds, all of them. A seed replays one hand; with its class, any number is a seed.
// --cameras: every hand is filmed by that many cameras, 1 to 3, instead of one to three by its seed; sparse fingers
// (one camera) and recordings keep theirs. --csv: also a line for each hand, in a file. --without: leaves out a rule of
// hysteresis (few, islands, apart, together, edges, falling, whole, again, members, or all).
//
// Hands and fingers are rendered as one to three D415 see them, with that sensor's noise, and go through palpa's chain
// frame by frame: contacts, fingers, foci, prediction, events. The same arguments give the same bytes, with any number
// of threads. A quantile of few values is the largest of them.
//
// The truth comes from the model of the hand, and from a picture of the same moment, by the same cameras, without
// noise. A digit is a visible finger if at least min_points (5) of its pixels are in the shell. Digits that touch each
// other are still several. A digit's contacts that continue those of the palm, the back of the hand or the forearm
// (steps of at most the finger gap, within that digit and the palm) are the palm's. Each patch of a palm is a finger of
// its own, unless the means of two are within a finger width. The columns:
//
//   frames, right  frames that count: after the first 0.1 s, and not in the 0.1 s after a true touch begins or ends; in
//                  % of them, there are as many fingers as are visible
//   fair           the same, if digits with 1 to 9 contacts, and skin up to 0.3 mm above the surface, may be counted or
//                  not, patches of a palm may be one finger or several, and so may digits that continue it
//   events         touch and release events after the first 0.1 s, beyond those of true touches and releases
//   ids            the same for the ids that begin and end from frame to frame
//   swaps          ids that have another digit than before, in frames with the right number of fingers
//   jump, most     99 % and most, mm: from frame to frame, the way of each focus that sounds, relative to its skin. It
//                  is the distance from the way of the skin along the surface, or from that of the centroid of the
//                  finger's contacts without noise, whichever is less: skin that rolls leaves its contacts behind.
//                  Predicted foci are compared at the time for which they are predicted. After the first 0.1 s
//   first, second  ms, 99 %: from the time when a digit's skin enters the solid to the capture of the first frame with
//                  which it sounds; second: another digit touches already. Only of digits with 10 visible contacts
//   leaves, last   ms, median and 99 %: from the time when the skin has left to the capture of the last frame with
//                  which the digit sounds
//   touches        reported, of true ones, after the first 0.1 s
//   presses        reported, of true ones: the deepest skin of a digit with at least 10 visible contacts passes the
//                  press depth
//   silent         % of the fingers of all frames that are found, but do not sound, although their skin will be less
//                  than 0.5 mm off the surface at the time that is predicted
//   deeper, most   mm, 99 % and most: by how much the reported depth exceeds that of the digit's deepest skin
//   ahead          mm, 95 %: of predicted foci, the distance from where their skin takes them (as for jump)
//   worst          the seed of the worst hand: HandScore::badness() weighs the columns
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "hand_classes.hpp"
#include "hand_scores.hpp"
#include "touch/stage_setting.hpp"

namespace palpa::test {
namespace {

struct Job {
  const HandClass* kind = nullptr;
  std::uint64_t seed = 0;
  HandScore score;
  std::string what;
};

struct Asked {
  std::filesystem::path csv;
  std::optional<int> cameras;
  touch::HysteresisRules rules;
  std::vector<std::string_view> names;
  std::vector<std::uint64_t> seeds;
};

void leave_out(std::string_view name, touch::HysteresisRules& rules) {
  using Rules = touch::HysteresisRules;
  constexpr std::pair<std::string_view, bool Rules::*> members[] = {
      {"few", &Rules::few},           {"islands", &Rules::islands}, {"apart", &Rules::apart},
      {"together", &Rules::together}, {"edges", &Rules::edges},     {"falling", &Rules::falling},
      {"whole", &Rules::whole},       {"again", &Rules::again},     {"members", &Rules::members},
  };
  if (name == "all") {
    rules = touch::no_rules;
    return;
  }
  for (const auto& [known, member] : members) {
    if (known != name) continue;
    rules.*member = false;
    return;
  }
  throw bad_usage(fmt::format("no rule {}", name));
}

int number_of_cameras(std::string_view word) {
  if (word != "1" && word != "2" && word != "3") throw bad_usage(fmt::format("1 to 3 cameras, not {}", word));
  return word[0] - '0';
}

Asked asked_by(int argc, char** argv) {
  Asked asked;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), seed);
    if (word == "--csv" && i + 1 < argc) {
      asked.csv = argv[++i];
    } else if (word == "--cameras" && i + 1 < argc) {
      asked.cameras = number_of_cameras(argv[++i]);
    } else if (word == "--without" && i + 1 < argc) {
      leave_out(argv[++i], asked.rules);
    } else if (error == std::errc() && end == word.data() + word.size()) {
      asked.seeds.push_back(seed);
    } else if (std::ranges::any_of(hand_classes(), [&](const HandClass& kind) { return word == kind.name; })) {
      asked.names.push_back(word);
    } else {
      throw bad_usage(fmt::format("no class {}", word));
    }
  }
  return asked;
}

std::vector<Job> jobs_for(const Asked& asked) {
  std::vector<Job> jobs;
  for (const HandClass& kind : hand_classes()) {
    if (!asked.names.empty() && std::ranges::find(asked.names, kind.name) == asked.names.end()) continue;
    const std::uint64_t end = kind.first_seed + kind.hands;
    for (const std::uint64_t seed : asked.seeds) {
      if (!asked.names.empty() || (seed >= kind.first_seed && seed < end)) jobs.push_back({&kind, seed, {}, {}});
    }
    for (std::uint64_t seed = kind.first_seed; asked.seeds.empty() && seed < end; ++seed)
      jobs.push_back({&kind, seed, {}, {}});
  }
  return jobs;
}

/// The cells of a row; "-" where there is nothing to measure.
std::vector<std::string> cells_of(const HandScore& s) {
  const auto percent = [](std::size_t part, std::size_t all) {
    return all == 0 ? "-" : fmt::format("{:.1f}", 100.0 * static_cast<double>(part) / static_cast<double>(all));
  };
  const auto at = [](const std::vector<double>& values, double share, int digits) {
    return values.empty() ? "-" : fmt::format("{:.{}f}", 1e3 * quantile(values, share), digits);
  };
  const auto of = [](int reported, int real) {
    return reported == 0 && real == 0 ? "-" : fmt::format("{}/{}", reported, real);
  };
  return {std::to_string(s.frames),
          percent(s.right, s.frames),
          percent(s.fair, s.frames),
          std::to_string(s.events),
          std::to_string(s.changes),
          std::to_string(s.swaps),
          at(s.jumps_m, 0.99, 2),
          at(s.jumps_m, 1, 2),
          at(s.first_s, 0.99, 0),
          at(s.second_s, 0.99, 0),
          at(s.leaves_s, 0.5, 0),
          at(s.leaves_s, 0.99, 0),
          of(s.touches, s.true_touches),
          of(s.presses, s.true_presses),
          s.silent == 0 && s.ahead_m.empty() ? "-" : percent(s.silent, s.finger_frames),
          at(s.deeper_m, 0.99, 2),
          at(s.deeper_m, 1, 2),
          at(s.ahead_m, 0.95, 2)};
}
constexpr const char* headings[] = {"frames",  "right",   "fair",   "events", "ids",    "swaps",
                                    "jump",    "most",    "first",  "second", "leaves", "last",
                                    "touches", "presses", "silent", "deeper", "most",   "ahead"};

void print_table(const std::vector<Job>& jobs) {
  const auto print = [](std::string_view name, std::string_view hands, const std::vector<std::string>& cells,
                        const std::string& worst) {
    std::string line = fmt::format("{:<12}{:>6}", name, hands);
    for (const std::string& cell : cells)
      line += fmt::format("{:>8}", cell);
    std::printf("%s%8s\n", line.c_str(), worst.c_str());
  };
  print("class", "hands", {std::begin(headings), std::end(headings)}, "worst");
  for (std::size_t begin = 0; begin < jobs.size();) {
    HandScore sum;
    const Job* worst = nullptr;
    std::size_t end = begin;
    for (; end < jobs.size() && jobs[end].kind == jobs[begin].kind; ++end) {
      sum.add(jobs[end].score);
      if (!worst || jobs[end].score.badness() > worst->score.badness()) worst = &jobs[end];
    }
    print(jobs[begin].kind->name, std::to_string(end - begin), cells_of(sum), std::to_string(worst->seed));
    begin = end;
  }
}

void write_csv(const std::vector<Job>& jobs, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "class,seed";
  for (const char* heading : headings)
    out << ',' << heading;
  out << ",badness,what\n";
  for (const Job& job : jobs) {
    out << job.kind->name << ',' << job.seed;
    for (const std::string& cell : cells_of(job.score))
      out << ',' << cell;
    out << fmt::format(",{:.1f},\"{}\"\n", job.score.badness(), job.what);
  }
  if (!out.flush()) throw failure(fmt::format("cannot write {}", file.string()));
}

void run(const Asked& asked) {
  std::vector<Job> jobs = jobs_for(asked);
  if (jobs.empty()) throw bad_usage("no such hand");
  parallel_chunks(jobs.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    Job& job = jobs[i];
    const RatedHand hand = make_hand_of(*job.kind, job.seed, asked.cameras);
    job.what = hand.what;
    job.score = score_of(hand, asked.rules);
  });
  if (!asked.csv.empty()) write_csv(jobs, asked.csv);
  print_table(jobs);
}

}  // namespace
}  // namespace palpa::test

int main(int argc, char** argv) {
  try {
    palpa::test::run(palpa::test::asked_by(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
