#include "hand_scores.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <optional>

#include "hand_chain.hpp"
#include "hand_truth.hpp"
#include "sensing/recording.hpp"

namespace palpa::test {
namespace {

/// The first frames of a film, and those after a touch begins or ends, have little before them.
constexpr double settled_s = 0.1;
constexpr double rearm = session::press_rearm;
constexpr int few = 5;

/// Where the frames of a hand come from.
class Film {
 public:
  explicit Film(const RatedHand& hand) : hand_(hand) {
    if (hand.recording.empty()) {
      rig_.emplace(hand.cameras, geometry::Mesh{}, sensing::Noise::d415, hand.seed);
    } else {
      recording_ = sensing::load_recording(hand.recording);
    }
  }
  const sensing::FrameSet& frame(std::size_t k) {
    if (!rig_) {
      sensing::read_entry(recording_, k, set_);
      return set_;
    }
    std::vector<sensing::Posed> skin;
    for (const HandBody& body : hand_.bodies)
      skin.push_back({&body.skin->mesh, body.pose(hand_.time_of(k))});
    rig_->render(skin, k, set_);
    for (sensing::DepthFrame& frame : set_.frames)
      frame.time_s = hand_.time_of(k);
    return set_;
  }

 private:
  const RatedHand& hand_;
  std::optional<sensing::SyntheticRig> rig_;
  sensing::Recording recording_;
  sensing::FrameSet set_;
};

/// A part of a hand in a frame.
struct PartThen {
  double depth_m = -1;
  int contacts = 0;
  bool of_palm = false, sounds = false;
  Vec3 centroid{0};
};

struct Interval {
  std::uint32_t part = 0;
  double begin_s = 0, end_s = 0;  ///< of the film, if the touch does not begin or end in it
  bool begins = false, ends = false;
};

/// A finger that sounds.
struct Sounding {
  std::vector<Vec3> foci;
  std::uint32_t part = 0;
};

class Scoring {
 public:
  Scoring(const RatedHand& hand, const touch::HysteresisRules& rules) : hand_(hand), chain_(hand, rules) {
    if (!hand.bodies.empty()) truth_.emplace(hand);
    const auto press = hand.solids[0].haptics.press_depth_m;
    if (press) press_m_ = *press;
  }

  HandScore score() {
    Film film(hand_);
    for (std::size_t k = 0; k < hand_.frames(); ++k)
      see(k, film.frame(k));
    find_touches();
    count_right();
    time_touches();
    count_presses();
    return std::move(score_);
  }

 private:
  void see(std::size_t k, const sensing::FrameSet& set) {
    const double t = hand_.time_of(k);
    chain_.see(set.frames, t);
    const touch::Touch& touch = chain_.seen();
    std::vector<PartThen>& then = parts_.emplace_back(hand_.parts());
    const TrueFrame* truth = truth_ ? &truth_->at(t) : nullptr;
    for (std::uint32_t p = 0; truth && p < then.size(); ++p)
      then[p] = {truth->depth_m[p], truth->contacts[p], truth->of_palm[p], false, truth->centroid[p]};
    counts_.push_back({touch.finger_count, truth ? truth->fingers : hand_.fingers, truth ? truth->least : hand_.fingers,
                       truth ? truth->most : hand_.fingers});
    const bool settled = t >= settled_s;
    const double ahead_s = chain_.ahead_s(), before_s = k > 0 ? hand_.time_of(k - 1) : 0;

    std::map<std::uint32_t, Sounding> now;
    std::vector<std::uint32_t> ids;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      const touch::Finger& finger = touch.fingers[f];
      ids.push_back(finger.id);
      const std::vector<std::uint32_t> held = parts_of(touch, finger, truth);
      const std::uint32_t part = held.empty() ? 0 : held[0];
      const array::Voice* const voice = voice_of(finger.id);
      for (const std::uint32_t p : held)
        then[p].sounds = then[p].sounds || voice;
      if (truth && settled) {
        double deepest = -1;
        for (const std::uint32_t p : held)
          deepest = std::max(deepest, truth->depth_m[p]);
        score_.deeper_m.push_back(finger.depth_m - std::max(deepest, 0.0));
      }
      if (truth && hand_.moves && touch.finger_count == truth->fingers && !held.empty()) {
        const auto [owner, fresh] = owners_.try_emplace(finger.id, part);
        score_.swaps += !fresh && owner->second != part ? 1 : 0;
        owner->second = part;
      }
      ++score_.finger_frames;
      if (!voice) {
        score_.silent += stays(held, t + ahead_s) ? 1 : 0;
        continue;
      }
      now[finger.id] = {voice->foci, part};
      if (settled && truth && ahead_s > 0 && finger.foci.size() == voice->foci.size()) {
        const Vec3 slow = k > 0 ? contacts_way(part) * (ahead_s * hand_.rate_hz) : Vec3(0);
        for (std::size_t n = 0; n < voice->foci.size(); ++n) {
          const Vec3 from(finger.foci[n].position);
          const Vec3 skin = level(truth_->way_of(part, from, t, t + ahead_s));
          score_.ahead_m.push_back(beside(voice->foci[n] - from, skin, slow));
        }
      }
    }
    // Jumps.
    for (const auto& [id, sounding] : now) {
      const auto before = before_.find(id);
      if (!settled || before == before_.end() || before->second.foci.size() != sounding.foci.size() || hand_.slides)
        continue;
      for (std::size_t n = 0; n < sounding.foci.size(); ++n) {
        const Vec3 from = before->second.foci[n], step = sounding.foci[n] - from;
        const Vec3 skin = truth ? level(truth_->way_of(sounding.part, from, before_s + ahead_s, t + ahead_s)) : Vec3(0);
        score_.jumps_m.push_back(beside(step, skin, truth ? contacts_way(sounding.part) : Vec3(0)));
      }
    }
    before_ = std::move(now);
    // Ids and events.
    std::ranges::sort(ids);
    if (settled) {
      std::vector<std::uint32_t> differ;
      std::ranges::set_symmetric_difference(ids, ids_, std::back_inserter(differ));
      score_.changes += static_cast<int>(differ.size());
    }
    ids_ = std::move(ids);
    for (const session::Event& event : chain_.events()) {
      if (event.kind == session::EventKind::press) ++score_.presses;
      if (event.time_s < settled_s) continue;
      if (event.kind == session::EventKind::touch) ++score_.touches;
      if (event.kind == session::EventKind::release) ++releases_;
    }
  }

  /// The parts that have at least a tenth of a finger's contacts, the one with most first.
  std::vector<std::uint32_t> parts_of(const touch::Touch& touch, const touch::Finger& finger,
                                      const TrueFrame* truth) const {
    if (!truth) return {};
    std::map<std::uint32_t, std::size_t> votes;
    const std::size_t step = 1 + finger.contacts.size() / 64;
    std::size_t asked = 0;
    for (std::size_t i = 0; i < finger.contacts.size(); i += step, ++asked)
      ++votes[truth_->part_at(*truth, Vec3(touch.contacts[finger.contacts[i]].position))];
    std::vector<std::uint32_t> parts;
    for (const auto& [part, count] : votes) {
      if (count * 10 >= asked) parts.push_back(part);
    }
    std::ranges::stable_sort(parts, [&](std::uint32_t a, std::uint32_t b) { return votes[a] > votes[b]; });
    return parts;
  }

  const array::Voice* voice_of(std::uint32_t id) const {
    const array::Schedule& schedule = chain_.schedule();
    for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
      if (schedule.voices[v].id == id) return &schedule.voices[v];
    }
    return nullptr;
  }

  /// Whether a finger of these parts is still at the surface then.
  bool stays(const std::vector<std::uint32_t>& parts, double time_s) const {
    constexpr double off_m = 0.5e-3;
    if (!truth_) return true;
    const TrueFrame frame = truth_->depths_at(time_s);
    return std::ranges::any_of(parts, [&](std::uint32_t p) { return frame.depth_m[p] > -off_m; });
  }

  /// Contacts stay at the surface, which is level, when the skin comes or leaves.
  static Vec3 level(Vec3 way) {
    way.y = 0;
    return way;
  }
  static double beside(const Vec3& step, const Vec3& skin, const Vec3& contacts) {
    return std::min(glm::length(step - skin), glm::length(step - contacts));
  }
  /// The way of the centroid of a part's true contacts since the frame before.
  Vec3 contacts_way(std::uint32_t part) const {
    if (parts_.size() < 2 || parts_.back().empty()) return Vec3(0);
    const PartThen &now = parts_.back()[part], &before = parts_[parts_.size() - 2][part];
    return now.contacts > 0 && before.contacts > 0 ? now.centroid - before.centroid : Vec3(0);
  }

  /// When a part's depth passes zero between two frames.
  double crossing(std::uint32_t part, std::size_t k) const {
    double before = hand_.time_of(k - 1), after = hand_.time_of(k);
    const bool touches_after = parts_[k][part].depth_m > 0;
    for (int n = 0; n < 6; ++n) {
      const double middle = (before + after) / 2;
      ((truth_->depths_at(middle).depth_m[part] > 0) == touches_after ? after : before) = middle;
    }
    return (before + after) / 2;
  }

  /// The touches of parts that cameras see.
  void find_touches() {
    for (std::uint32_t p = 0; p < hand_.parts(); ++p) {
      std::optional<Interval> open;
      int most = 0;
      const auto close = [&](double end_s, bool ends) {
        open->end_s = end_s;
        open->ends = ends;
        if (most >= 2 * few) touches_.push_back(*open);
        open.reset();
        most = 0;
      };
      for (std::size_t k = 0; k < parts_.size(); ++k) {
        const PartThen& part = parts_[k][p];
        const bool touches = part.depth_m > 0 && !part.of_palm;
        if (touches && !open) {
          open = Interval{.part = p, .begin_s = k > 0 ? crossing(p, k) : 0, .begins = k > 0};
        } else if (!touches && open) {
          close(part.of_palm ? hand_.time_of(k) : crossing(p, k), true);
        }
        most = std::max(most, part.contacts);
      }
      if (open) close(hand_.length_s, false);
    }
    for (const Interval& touch : touches_) {
      score_.true_touches += touch.begins ? 1 : 0;
      true_releases_ += touch.ends ? 1 : 0;
    }
    score_.events = std::max(0, score_.touches - score_.true_touches) + std::max(0, releases_ - true_releases_);
    score_.changes = std::max(0, score_.changes - score_.true_touches - true_releases_);
  }

  void count_right() {
    for (std::size_t k = 0; k < counts_.size(); ++k) {
      const double t = hand_.time_of(k);
      const bool settled = t >= settled_s && std::ranges::none_of(touches_, [&](const Interval& touch) {
                             return (touch.begins && t > touch.begin_s && t < touch.begin_s + settled_s) ||
                                    (touch.ends && t > touch.end_s && t < touch.end_s + settled_s);
                           });
      if (!settled) continue;
      const Count& count = counts_[k];
      ++score_.frames;
      score_.right += count.found == count.right ? 1 : 0;
      score_.fair += count.found >= count.least && count.found <= count.most ? 1 : 0;
    }
  }

  void time_touches() {
    for (const Interval& touch : touches_) {
      const bool later = std::ranges::any_of(touches_, [&](const Interval& other) {
        return other.part != touch.part && other.begin_s < touch.begin_s && other.end_s > touch.begin_s;
      });
      double next_s = touch.end_s + 0.3, begins_s = touch.end_s, last_s = -1;
      for (const Interval& other : touches_) {
        if (other.part == touch.part && other.begin_s > touch.end_s) next_s = std::min(next_s, other.begin_s);
      }
      for (std::size_t k = 0; k < parts_.size(); ++k) {
        const double t = hand_.time_of(k);
        if (t < touch.begin_s || t > next_s) continue;
        if (parts_[k][touch.part].sounds) {
          if (last_s < 0) begins_s = std::min(t, touch.end_s);
          last_s = t;
        } else if (t > touch.end_s) {
          break;
        }
      }
      if (touch.begins) (later ? score_.second_s : score_.first_s).push_back(begins_s - touch.begin_s);
      if (touch.ends && last_s >= 0) score_.leaves_s.push_back(last_s - touch.end_s);
    }
  }

  void count_presses() {
    if (press_m_ <= 0) return;
    for (std::uint32_t p = 0; p < hand_.parts(); ++p) {
      const bool visible = std::ranges::any_of(parts_, [&](const auto& then) { return then[p].contacts >= 2 * few; });
      bool armed = visible;
      for (const auto& then : parts_) {
        if (armed && then[p].depth_m >= press_m_) {
          armed = false;
          ++score_.true_presses;
        } else if (then[p].depth_m < rearm * press_m_) {
          armed = visible;
        }
      }
    }
  }

  struct Count {
    std::uint32_t found = 0, right = 0, least = 0, most = 0;
  };

  const RatedHand& hand_;
  HandChain chain_;
  std::optional<HandTruth> truth_;
  double press_m_ = 0;
  HandScore score_;
  int releases_ = 0, true_releases_ = 0;
  std::vector<std::vector<PartThen>> parts_;  ///< per frame
  std::vector<Count> counts_;                 ///< per frame
  std::vector<Interval> touches_;
  // What the frame before has left.
  std::map<std::uint32_t, Sounding> before_;
  std::vector<std::uint32_t> ids_;
  std::map<std::uint32_t, std::uint32_t> owners_;  ///< the part that an id had last
};

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

void HandScore::add(const HandScore& other) {
  frames += other.frames, right += other.right, fair += other.fair;
  events += other.events, changes += other.changes;
  touches += other.touches, true_touches += other.true_touches;
  presses += other.presses, true_presses += other.true_presses;
  finger_frames += other.finger_frames, silent += other.silent;
  swaps += other.swaps;
  append(jumps_m, other.jumps_m), append(deeper_m, other.deeper_m), append(ahead_m, other.ahead_m);
  append(first_s, other.first_s), append(second_s, other.second_s), append(leaves_s, other.leaves_s);
}

double HandScore::badness() const {
  const auto share = [](std::size_t part, std::size_t all, double of_none) {
    return all == 0 ? of_none : static_cast<double>(part) / static_cast<double>(all);
  };
  const auto over = [](const std::vector<double>& values, double limit) {
    return std::max(0.0, quantile(values, 0.99) - limit);
  };
  return 100 * (1 - share(right, frames, 1)) + 5 * events + 2 * changes + 20 * std::abs(touches - true_touches) +
         20 * std::abs(presses - true_presses) + 20 * swaps + 100 * share(silent, finger_frames, 0) +
         10e3 * over(jumps_m, 1e-3) + 1e3 * over(deeper_m, 1e-3) + 100 * over(first_s, 25e-3) +
         100 * over(second_s, 70e-3) + over(leaves_s, 0);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const double rank = std::ceil(share * static_cast<double>(values.size())) - 1;
  return values[static_cast<std::size_t>(std::max(rank, 0.0))];
}

HandScore score_of(const RatedHand& hand, const touch::HysteresisRules& rules) {
  return Scoring(hand, rules).score();
}

}  // namespace palpa::test
