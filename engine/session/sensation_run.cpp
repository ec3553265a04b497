#include "session/sensation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numeric>
#include <span>
#include <thread>
#include <utility>

#include "array/plausible.hpp"
#include "base/log.hpp"
#include "session/links/safe_link.hpp"
#include "session/newest.hpp"
#include "session/plan/plan.hpp"
#include "session/predict/slot_clock.hpp"
#include "session/threads.hpp"

namespace palpa::session {
namespace {

/// How far plans reach ahead if they list no drives, and how often one is made.
constexpr double reach_s = 0.1, between_plans_s = 10e-3;
/// How many points Transport keeps.
constexpr std::size_t most_kept = 1024;

std::uint32_t slots_ahead(const SensationSetting& setting) {
  constexpr double least = 16, most = 1024;
  if (setting.listed) return listed_slots;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(reach_s / setting.output.slot_s), least, most));
}

/// The points of the slots to come. Kept from slot to slot, and evaluated again if something changes.
class PointsAhead {
 public:
  PointsAhead(sensation::Sensation& sensation, double slot_s, std::uint32_t count, std::uint64_t seed)
      : sensation_(sensation), slot_s_(slot_s), seed_(seed), points_(count) {}

  /// From this slot on, at the time `from_s`.
  void start(std::uint64_t slot, double from_s) {
    begin_ = until_ = slot;
    from_s_ = from_s;
    state_ = sensation::State::at(from_s, seed_);
    kept_ = {{slot, state_}};
    stop_.reset();
  }
  /// What plays from `slot` on changes. What was before stays.
  void take_changes(std::uint64_t slot) {
    rewind(std::max(slot, begin_));
    sensation_.take_changes();
  }
  /// Evaluates what lies before `slot`, as far as it is not known.
  void fill(std::uint64_t slot) {
    if (slot <= until_) return;
    kept_.emplace_back(until_, state_);
    while (kept_.size() > 1 && kept_[1].first + points_.size() <= slot)
      kept_.pop_front();
    times_.clear();
    out_.clear();
    for (std::uint64_t s = until_; s < slot; ++s)
      times_.push_back(time_of(s));
    sensation_.points(times_, state_, out_);
    for (std::uint64_t s = until_; s < slot; ++s) {
      const sensation::Point& point = out_[s - until_];
      points_[s % points_.size()] = point;
      if (point.stop && !stop_) stop_ = s;
    }
    until_ = slot;
  }

  double time_of(std::uint64_t slot) const { return from_s_ + static_cast<double>(slot - begin_) * slot_s_; }
  const sensation::Point& at(std::uint64_t slot) const { return points_[slot % points_.size()]; }
  std::uint64_t begin() const { return begin_; }
  /// The first slot in which the sensation has stopped, if it is among those evaluated.
  std::optional<std::uint64_t> stop() const { return stop_; }

 private:
  void rewind(std::uint64_t slot) {
    if (slot >= until_) return fill(slot);
    while (kept_.size() > 1 && kept_.back().first > slot)
      kept_.pop_back();
    std::tie(until_, state_) = kept_.back();
    if (stop_ && *stop_ >= until_) stop_.reset();
    fill(slot);
  }

  sensation::Sensation& sensation_;
  double slot_s_;
  std::uint64_t seed_;
  std::vector<sensation::Point> points_;
  std::uint64_t begin_ = 0, until_ = 0;
  double from_s_ = 0;
  sensation::State state_;
  std::deque<std::pair<std::uint64_t, sensation::State>> kept_;  ///< states at earlier slots
  std::optional<std::uint64_t> stop_;
  std::vector<double> times_;
  std::vector<sensation::Point> out_;
};

/// Warns once of places that cannot be driven or are of no use.
class PlaceWatch {
 public:
  explicit PlaceWatch(const array::Layout& layout) : layout_(layout) {}

  /// Whether it can be driven; otherwise, it is silent.
  bool drivable(const Vec3& place_m) {
    if (array::drivable({.position = place_m})) return true;
    if (!std::exchange(far_, true))
      log::warning("the sensation goes farther than 100 m from the array: it is silent there");
    return false;
  }
  void look(const Box& box) {
    if (odd_ || box.empty()) return;
    const std::string odd = array::implausible_place(layout_, box);
    if (odd.empty()) return;
    odd_ = true;
    log::warning("the sensation " + odd);
  }

 private:
  const array::Layout& layout_;
  bool far_ = false, odd_ = false;
};

/// Makes the plans of a run.
class SensationPlans {
 public:
  SensationPlans(sensation::Sensation& sensation, Transport& transport, const SensationSetting& setting)
      : sensation_(sensation),
        transport_(transport),
        setting_(setting),
        count_(slots_ahead(setting)),
        points_(sensation, setting.output.slot_s, count_, setting.seed),
        watch_(setting.output.layout) {
    if (setting.listed) drives_.resize(count_ * setting.output.layout.transducers.size());
  }

  /// Fills the plan for the slots from `next` on. Slot 0 began at `begin_s`. False: there is nothing new to play.
  bool make(std::uint64_t next, double begin_s, Plan& plan);
  /// When the run has ended, on its clock; empty: not yet known.
  std::optional<double> end_s(double begin_s) const {
    if (!end_ || !setting_.ends) return std::nullopt;
    return begin_s + static_cast<double>(*end_) * setting_.output.slot_s;
  }

 private:
  void follow_changes(std::uint64_t next);
  void tell_sounded(std::uint64_t next);
  void fill(std::uint64_t from, std::uint64_t until, const std::optional<Transform>& hand, array::Voice& voice);
  void drive(std::uint64_t from, std::uint64_t until, const array::Voice& voice);
  bool silent(Plan& plan);

  sensation::Sensation& sensation_;
  Transport& transport_;
  const SensationSetting& setting_;
  std::uint32_t count_;
  PointsAhead points_;
  PlaceWatch watch_;
  std::optional<std::uint64_t> change_;  ///< of the transport, that is followed
  bool plays_ = false, sounds_ = false;
  std::optional<std::uint64_t> end_;  ///< the slot in which it has ended
  std::uint64_t told_ = 0;            ///< the slots before it have been told to the transport
  std::uint64_t hand_number_ = 0, redraw_ = 0;
  array::Drive drives_;  ///< of slot s at s % count
  array::DriveScratch scratch_;
};

void SensationPlans::follow_changes(std::uint64_t next) {
  const Transport::State now = transport_.now();
  if (change_ != now.number) {
    change_ = now.number;
    plays_ = now.plays;
    end_.reset();
    if (sensation_.has_changes()) sensation_.take_changes();
    if (plays_) {
      const double wait = std::ceil(now.in_s / setting_.output.slot_s);
      points_.start(next + static_cast<std::uint64_t>(std::clamp(wait, 0.0, 1e12)), now.from_s);
      told_ = redraw_ = points_.begin();
    }
  } else if (sensation_.has_changes()) {
    if (plays_) {
      points_.take_changes(next);
      redraw_ = next;
    } else {
      sensation_.take_changes();
    }
  }
}

/// Points whose slots have passed have sounded.
void SensationPlans::tell_sounded(std::uint64_t next) {
  const std::uint64_t least = next > count_ ? next - count_ : 0;  // older ones are not kept
  for (told_ = std::max(told_, least); told_ < next; ++told_) {
    const sensation::Point& point = points_.at(told_);
    const std::optional<Transform> hand =
        setting_.anchor && transport_.now().follows ? setting_.anchor->now().T_array_hand : std::optional<Transform>();
    transport_.sounded({placed(point, setting_, hand), point.stop ? 0 : point.gain, point.pattern_s, point.stop});
    if (!point.stop) continue;
    if (!setting_.ends) {
      transport_.ended(*change_);
      plays_ = false;
    }
    return;
  }
}

/// Places and gains of the slots from `from` on.
void SensationPlans::fill(std::uint64_t from, std::uint64_t until, const std::optional<Transform>& hand,
                          array::Voice& voice) {
  voice.course.first_slot = from;
  voice.course.gains.clear();
  Box box;
  for (std::uint64_t slot = from; slot < until; ++slot) {
    const bool before = slot < points_.begin();
    const sensation::Point point = before ? sensation::Point{} : points_.at(slot);
    Vec3 place = transform_point(setting_.T_world_array, placed(point, setting_, hand));
    double gain = point.stop ? 0 : point.gain;
    if (gain > 0 && !watch_.drivable(place)) gain = 0;
    if (gain > 0) box.add(place);
    if (gain == 0 && !array::drivable({.position = place})) place = Vec3(0);
    voice.foci[slot % count_] = place;
    voice.course.gains.push_back(gain);
  }
  watch_.look(box);
}

/// The drives of these slots, for a plan that lists them. Others are silent.
void SensationPlans::drive(std::uint64_t from, std::uint64_t until, const array::Voice& voice) {
  const std::size_t transducers = setting_.output.layout.transducers.size();
  for (std::uint64_t slot = from; slot < until; ++slot) {
    const double gain = voice.course.gains[slot - voice.course.first_slot];
    const array::SlotFocus focus{.position = voice.foci[slot % count_], .gain = static_cast<float>(gain)};
    array::drive_for(setting_.output.layout, {&focus, 1}, setting_.output.drive,
                     std::span(drives_).subspan(slot % count_ * transducers, transducers), scratch_);
  }
}

bool SensationPlans::silent(Plan& plan) {
  plan.schedule.clear();
  list_nothing(plan);
  return std::exchange(sounds_, false);
}

bool SensationPlans::make(std::uint64_t next, double begin_s, Plan& plan) {
  const double slot_s = setting_.output.slot_s;
  follow_changes(next);
  // The output may be late and take the plan for the slot before, which is as it was.
  const std::uint64_t from = next > 0 ? next - 1 : 0;
  if (plays_) tell_sounded(from);
  if (!plays_) return silent(plan);
  points_.fill(std::max(points_.begin(), from) + count_);
  end_ = points_.stop();
  if (setting_.end_s) {
    const double left_s = *setting_.end_s - points_.time_of(points_.begin());
    const std::uint64_t last = points_.begin() + slots_until(std::max(left_s, 0.0), slot_s);
    end_ = std::min(end_.value_or(last), last);
  }
  const std::uint64_t until = std::min(from + count_, end_.value_or(from + count_));
  const bool on_hand = setting_.anchor && transport_.now().follows;
  const Anchor::Seen seen = on_hand ? setting_.anchor->now() : Anchor::Seen{};
  if (until <= next || (on_hand && !seen.T_array_hand)) return silent(plan);
  plan.schedule.clear();
  plan.schedule.slot_s = slot_s;
  plan.schedule.time_s = static_cast<double>(from) * slot_s;
  plan.schedule.once = true;
  array::Voice& voice = plan.schedule.add_voice();
  voice = {};
  voice.foci.resize(count_, Vec3(0));
  voice.order.resize(count_);
  std::iota(voice.order.begin(), voice.order.end(), 0U);
  voice.dwell_s = slot_s;
  fill(from, until, seen.T_array_hand, voice);
  list_nothing(plan);
  plan.cycle.plays = Plays::slot_by_slot;
  if (setting_.listed) {
    if (seen.number != std::exchange(hand_number_, seen.number)) redraw_ = next;
    drive(std::clamp(redraw_, from, until), until, voice);
    redraw_ = until;
    plan.drives = drives_;
    const std::size_t transducers = setting_.output.layout.transducers.size();
    for (std::uint64_t slot = until; slot < from + count_; ++slot) {  // it ends before
      std::fill_n(plan.drives.begin() + static_cast<std::ptrdiff_t>(slot % count_ * transducers), transducers,
                  array::TransducerDrive{0, 0});
      voice.foci[slot % count_] = voice.foci[(until - 1) % count_];
    }
    plan.foci = voice.foci;
    plan.cycle = {.plays = Plays::pattern, .length = count_};
    voice.course = {};  // the drives have the gains
  }
  plan.captured_s = begin_s + static_cast<double>(until) * slot_s - setting_.output.hold_s;
  if (on_hand) plan.captured_s = std::min(plan.captured_s, seen.captured_s);
  sounds_ = true;
  return true;
}

}  // namespace

void Anchor::see(const Transform& T_array_hand, double captured_s) {
  const std::lock_guard lock(mutex_);
  seen_ = {T_array_hand, captured_s, seen_.number + 1};
}

void Anchor::lose() {
  const std::lock_guard lock(mutex_);
  if (seen_.T_array_hand) seen_ = {std::nullopt, 0, seen_.number + 1};
}

Anchor::Seen Anchor::now() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

void Transport::play(double from_s, double in_s) {
  const std::lock_guard lock(mutex_);
  now_ = {true, now_.follows, from_s, in_s, now_.number + 1};
  newest_.clear();
}

void Transport::pause() {
  const std::lock_guard lock(mutex_);
  now_.plays = false;
  ++now_.number;
}

void Transport::follow(bool follows) {
  const std::lock_guard lock(mutex_);
  now_.follows = follows;
}

bool Transport::plays() const {
  const std::lock_guard lock(mutex_);
  return now_.plays;
}

std::vector<SoundedPoint> Transport::newest(std::size_t most) const {
  const std::lock_guard lock(mutex_);
  const std::size_t count = std::min(most, newest_.size());
  return {newest_.end() - static_cast<std::ptrdiff_t>(count), newest_.end()};
}

Transport::State Transport::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void Transport::ended(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  if (now_.number == number) now_.plays = false;
}

void Transport::sounded(const SoundedPoint& point) {
  const std::lock_guard lock(mutex_);
  newest_.push_back(point);
  if (newest_.size() > most_kept) newest_.pop_front();
}

Vec3 placed(const sensation::Point& point, const SensationSetting& setting, const std::optional<Transform>& hand) {
  const Vec3 local = point.place_m - Vec3(0, 0, point.height_m);
  if (hand) return setting.upright ? Vec3((*hand)[3]) + local : transform_point(*hand, local);
  return setting.at_m ? *setting.at_m + local : point.place_m;
}

std::uint64_t slots_until(double end_s, double slot_s) {
  constexpr double rounding = 1e-9, most = 1e15;
  return static_cast<std::uint64_t>(std::min(std::ceil(end_s / slot_s * (1 - rounding)), most));
}

std::vector<sensation::Point> points_of_slots(sensation::Sensation& sensation, double slot_s,
                                              std::optional<double> end_s, std::uint64_t most, std::uint64_t seed) {
  constexpr std::uint64_t at_once = 256;
  const std::uint64_t count = end_s ? std::min(slots_until(*end_s, slot_s), most) : most;
  sensation::State state = sensation::State::at(0, seed);
  std::vector<sensation::Point> points;
  std::vector<double> times;
  while (points.size() < count) {
    times.clear();
    for (std::uint64_t slot = points.size(); slot < std::min(points.size() + at_once, count); ++slot)
      times.push_back(static_cast<double>(slot) * slot_s);
    sensation.points(times, state, points);
    const auto stopped = std::ranges::find(points.end() - static_cast<std::ptrdiff_t>(times.size()), points.end(), true,
                                           &sensation::Point::stop);
    if (stopped == points.end()) continue;
    points.erase(stopped, points.end());
    break;
  }
  return points;
}

OutputStats run_sensation(sensation::Sensation& sensation, Transport& transport, Link& link,
                          const SensationSetting& setting, std::atomic<bool>& stop, RunObserver& observer,
                          const Clock& clock) {
  const log::Relay relay;  // log messages of any thread do not block any thread
  OutputStats stats;
  const double slot_s = setting.output.slot_s;
  Newest<Plan> plans(clock);
  plans.each([&](Plan& plan) {
    if (setting.listed) plan.drives.reserve(listed_slots * setting.output.layout.transducers.size());
  });
  Ending ending{stop};
  SlotClock slots(clock, slot_s);
  OutputSetting output = setting.output;
  output.slots = &slots;
  std::exception_ptr link_fault, fault;
  std::atomic<bool> output_over{false};
  std::thread player = clock.start("the link", [&] {
    go_first();  // drives leave on time
    try {
      play(link, plans, output, clock, ending, stats, observer);
    } catch (...) {
      link_fault = std::current_exception();
      stop = true;
    }
    output_over = true;
  });
  try {
    SensationPlans made(sensation, transport, setting);
    const double wait_s = std::min(between_plans_s, slots_ahead(setting) * slot_s / 4);
    std::optional<double> end_s;
    while (!stop && !output_over && !(end_s && clock.now() >= *end_s)) {
      const double now_s = clock.now();
      const std::optional<FirstSlot> first = slots.first(0);
      if (first) {
        const double begin_s = *first->ahead_s - (static_cast<double>(first->slot) + 0.5) * slot_s;
        if (made.make(first->slot, begin_s, plans.back())) plans.publish();
        end_s = made.end_s(begin_s);
      }
      clock.sleep_until(std::min(now_s + (first ? wait_s : 1e-3), end_s.value_or(now_s + wait_s)));
    }
  } catch (...) {
    fault = std::current_exception();
    ending.failed = true;
  }
  ending.over = true;
  clock.join(player);
  const std::exception_ptr first = link_fault ? link_fault : fault;
  if (first) {
    stop = true;
    std::rethrow_exception(first);
  }
  return stats;
}

OutputStats record_sensation(sensation::Sensation& sensation, Link& link, const SensationSetting& setting,
                             std::uint64_t slots, const std::atomic<bool>& stop) {
  const array::Layout& layout = setting.output.layout;
  OutputStats stats;
  SafeLink safe(link, layout.transducers.size(), setting.output.safety, setting.output.slot_s);
  PlaceWatch watch(layout);
  sensation::State state = sensation::State::at(0, setting.seed);
  std::vector<sensation::Point> points;
  array::Drive drive(layout.transducers.size());
  array::DriveScratch scratch;
  std::uint64_t slot = 0;
  for (; slot < slots && !stop; ++slot) {
    points.clear();
    const double time_s = static_cast<double>(slot) * setting.output.slot_s;
    sensation.points({&time_s, 1}, state, points);
    if (points[0].stop) break;
    const Vec3 place = transform_point(setting.T_world_array, placed(points[0], setting, {}));
    const bool drivable = points[0].gain > 0 && watch.drivable(place);
    if (drivable) watch.look({place, place});
    const array::SlotFocus focus{.position = drivable ? place : Vec3(0),
                                 .gain = drivable ? static_cast<float>(points[0].gain) : 0};
    array::drive_for(layout, {&focus, 1}, setting.output.drive, drive, scratch);
    safe.send(slot, drive);
    stats.sent(0, !safe.sounded());
  }
  if (safe.must_fade() && !stop) {
    safe.silence();
    std::ranges::fill(drive, array::TransducerDrive{0, 0});
    for (++slot; safe.must_fade(); ++slot)
      safe.send(slot, drive);
  }
  safe.finish();
  stats.hand_over = safe.handed_over();
  return stats;
}

}  // namespace palpa::session
