#include "session/sensation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

#include "array/plausible.hpp"
#include "base/log.hpp"
#include "sensing/depth_source.hpp"
#include "session/links/safe_link.hpp"
#include "session/loop/loop.hpp"
#include "session/plan/planner.hpp"

namespace palpa::session {
namespace {

/// How far plans reach ahead if they list no drives, and how often one is made.
constexpr double reach_s = 0.1, between_plans_s = 10e-3;

std::uint32_t slots_ahead(const SensationSetting& setting) {
  constexpr double least = 16, most = 1024;
  if (setting.listed) return listed_slots;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(reach_s / setting.output.slot_s), least, most));
}

/// The number of slots until a time.
std::uint64_t slots_until(double end_s, double slot_s) {
  constexpr double rounding = 1e-9, most = 1e15;
  return static_cast<std::uint64_t>(std::min(std::ceil(end_s / slot_s * (1 - rounding)), most));
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
  /// What plays from `slot` on is evaluated again. What was before stays.
  void rewind(std::uint64_t slot) {
    slot = std::max(slot, begin_);
    if (slot < until_) {
      while (kept_.size() > 1 && kept_.back().first > slot)
        kept_.pop_back();
      std::tie(until_, state_) = kept_.back();
      if (stop_ && *stop_ >= until_) stop_.reset();
    }
    fill(slot);
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

/// Makes the plans of a run: a frame is nothing but a moment.
class SensationPlanner final : public Planner {
 public:
  SensationPlanner(sensation::Sensation& sensation, SensationControl& control, const SensationSetting& setting)
      : sensation_(sensation),
        control_(control),
        setting_(setting),
        count_(slots_ahead(setting)),
        points_(sensation, setting.output.slot_s, count_, setting.seed),
        watch_(setting.output.layout) {
    if (setting.listed) drives_.resize(count_ * setting.output.layout.transducers.size());
  }

  bool can_start() const override { return !busy(); }
  bool busy() const override { return frame_.has_value(); }
  void start(const SkinFrame& frame) override { frame_ = frame; }
  bool step(Plan& plan, FrameReport& report) override;
  void set_pose(std::uint32_t, const Transform&) override {}
  std::string_view too_slow() const override {
    return "the sensation takes longer to compute than it lasts: give it a faster function, or a longer --dwell";
  }

  /// When the run has ended, on its clock; infinite: not yet known. For any thread.
  double end_s() const { return end_s_; }

 private:
  void follow_changes(std::uint64_t next);
  void take_changes();
  void tell_sounded(std::uint64_t next, double at_s);
  void find_end();
  double gain_of(const sensation::Point& point) const { return point.stop || too_fast_ ? 0 : point.gain; }
  bool on_hand() const { return setting_.hand != nullptr && control_.now().follows; }
  HandPlace::Seen hand(double at_s) const;
  void make(std::uint64_t next, double begin_s, Plan& plan);
  void fill(std::uint64_t from, std::uint64_t until, const std::optional<Transform>& hand, array::Voice& voice);
  void list(std::uint64_t from, std::uint64_t until, Plan& plan);

  sensation::Sensation& sensation_;
  SensationControl& control_;
  const SensationSetting& setting_;
  std::uint32_t count_;
  PointsAhead points_;
  PlaceWatch watch_;
  std::optional<SkinFrame> frame_;
  const touch::Touch nothing_;
  std::optional<std::uint64_t> change_;  ///< of the control, that is followed
  bool plays_ = false, too_fast_ = false, warned_ = false, looked_ = false, coarse_ = false;
  std::optional<std::uint64_t> end_;  ///< the slot in which it has ended
  std::atomic<double> end_s_{std::numeric_limits<double>::infinity()};
  std::uint64_t told_ = 0;  ///< the slots before it have been told to the control
  std::uint64_t hand_number_ = 0, redraw_ = 0;
  array::Drive drives_;  ///< of slot s at s % count
  array::DriveScratch scratch_;
};

void SensationPlanner::take_changes() {
  sensation_.take_changes();
  const double hz = sensation_.fastest_hz();
  const double most_hz = std::min(sensation::most_hz, 1 / (least_places * setting_.output.slot_s));
  too_fast_ = !(hz <= most_hz);
  if (too_fast_ && !std::exchange(warned_, true)) {
    log::warning(
        fmt::format("the sensation now has a brush or a modulation of {:g} Hz; palpa plays at most {:g} Hz: it "
                    "is silent until it is slower",
                    hz, most_hz));
  }
  // The sensation that a run begins with has been looked at before.
  const bool first = !std::exchange(looked_, true);
  if (first || too_fast_ || places_in_a_turn(hz, setting_.output.slot_s) >= few_places || std::exchange(coarse_, true))
    return;
  log::warning(fmt::format("the sensation now turns at {:g} Hz, so one turn has {:.3g} places: give a shorter --dwell",
                           hz, places_in_a_turn(hz, setting_.output.slot_s)));
}

void SensationPlanner::follow_changes(std::uint64_t next) {
  const SensationControl::State now = control_.now();
  if (change_ != now.number) {
    change_ = now.number;
    plays_ = now.plays;
    end_.reset();
    take_changes();
    if (!plays_) return;
    const double wait = std::ceil(now.in_s / setting_.output.slot_s);
    points_.start(next + static_cast<std::uint64_t>(std::clamp(wait, 0.0, 1e12)), now.from_s);
    told_ = redraw_ = points_.begin();
  } else if (sensation_.has_changes()) {
    if (plays_) points_.rewind(next);
    take_changes();
    redraw_ = std::min(redraw_, next);
  }
}

/// The hand on which it plays at that time, if there is one that is not out of date.
HandPlace::Seen SensationPlanner::hand(double at_s) const {
  HandPlace::Seen seen = on_hand() ? setting_.hand->now() : HandPlace::Seen{};
  if (!(at_s < seen.captured_s + setting_.output.hold_s)) seen.T_array_hand.reset();
  return seen;
}

/// Points whose slots have passed have sounded.
void SensationPlanner::tell_sounded(std::uint64_t next, double at_s) {
  const std::uint64_t least = next > count_ ? next - count_ : 0;  // older ones are not kept
  const HandPlace::Seen seen = hand(at_s);
  for (told_ = std::max(told_, least); told_ < next; ++told_) {
    sensation::Point point = points_.at(told_);
    point.place_m = placed(point, setting_, seen.T_array_hand);
    const bool drivable = array::drivable({.position = transform_point(setting_.T_world_array, point.place_m)});
    point.gain = drivable && (seen.T_array_hand || !on_hand()) ? gain_of(point) : 0;
    control_.sounded(point);
    if (!point.stop) continue;
    if (!setting_.ends) {
      control_.ended(*change_);
      plays_ = false;
    }
    return;
  }
}

void SensationPlanner::find_end() {
  end_ = points_.stop();
  if (!setting_.end_s) return;
  const double left_s = *setting_.end_s - points_.time_of(points_.begin());
  const std::uint64_t last = points_.begin() + slots_until(std::max(left_s, 0.0), setting_.output.slot_s);
  end_ = std::min(end_.value_or(last), last);
}

/// Places and gains of the slots from `from` on.
void SensationPlanner::fill(std::uint64_t from, std::uint64_t until, const std::optional<Transform>& hand,
                            array::Voice& voice) {
  voice = {};
  voice.foci.resize(count_, Vec3(0));
  voice.order.resize(count_);
  std::iota(voice.order.begin(), voice.order.end(), 0U);
  voice.dwell_s = setting_.output.slot_s;
  voice.course.first_slot = from;
  for (std::uint64_t slot = from; slot < until; ++slot) {
    const sensation::Point point = slot < points_.begin() ? sensation::Point{} : points_.at(slot);
    const Vec3 place = transform_point(setting_.T_world_array, placed(point, setting_, hand));
    const double gain = gain_of(point);
    const bool sounds = gain > 0 && watch_.sounds(place);
    voice.foci[slot % count_] = array::drivable({.position = place}) ? place : Vec3(0);
    voice.course.gains.push_back(sounds ? gain : 0);
  }
  watch_.look();
}

/// Lists the drives of these slots, with their gains. Others are silent.
void SensationPlanner::list(std::uint64_t from, std::uint64_t until, Plan& plan) {
  const array::Layout& layout = setting_.output.layout;
  array::Voice& voice = plan.schedule.voices[0];
  const auto part = [&](array::Drive& drives, std::uint64_t slot) {
    return std::span(drives).subspan(slot % count_ * layout.transducers.size(), layout.transducers.size());
  };
  for (std::uint64_t slot = std::clamp(std::exchange(redraw_, until), from, until); slot < until; ++slot) {
    const array::SlotFocus focus{.position = voice.foci[slot % count_],
                                 .gain = static_cast<float>(voice.course.gains[slot - from])};
    array::drive_for(layout, {&focus, 1}, setting_.output.drive, part(drives_, slot), scratch_);
  }
  plan.drives = drives_;
  for (std::uint64_t slot = until; slot < from + count_; ++slot) {  // it ends before
    std::ranges::fill(part(plan.drives, slot), array::TransducerDrive{0, 0});
    voice.foci[slot % count_] = voice.foci[(until - 1) % count_];
  }
  plan.foci = voice.foci;
  plan.cycle = {.plays = Plays::pattern, .length = count_};
  voice.course = {};
}

/// Fills the plan, which is silent, for the slots from `next` on. Slot 0 began at `begin_s`.
void SensationPlanner::make(std::uint64_t next, double begin_s, Plan& plan) {
  const OutputSetting& output = setting_.output;
  const auto time_of = [&](std::uint64_t slot) { return begin_s + static_cast<double>(slot) * output.slot_s; };
  follow_changes(next);
  // The output may be late and take the plan for the slot before, which is as it was.
  const std::uint64_t from = next > 0 ? next - 1 : 0;
  if (plays_) tell_sounded(from, time_of(from));
  if (!plays_) return;
  points_.fill(std::max(points_.begin(), from) + count_);
  find_end();
  end_s_ = end_ && setting_.ends ? time_of(*end_) : std::numeric_limits<double>::infinity();
  const std::uint64_t until = std::min(from + count_, end_.value_or(from + count_));
  const HandPlace::Seen seen = hand(time_of(next));
  if (until <= next || (on_hand() && !seen.T_array_hand)) return;
  plan.schedule.slot_s = output.slot_s;
  plan.schedule.time_s = time_of(from) - begin_s;
  plan.schedule.once = true;
  fill(from, until, seen.T_array_hand, plan.schedule.add_voice());
  plan.cycle.plays = Plays::slot_by_slot;
  if (setting_.listed) {
    if (seen.number != std::exchange(hand_number_, seen.number)) redraw_ = next;
    list(from, until, plan);
  }
  plan.captured_s = time_of(until) - output.hold_s;
  if (on_hand()) plan.captured_s = std::min(plan.captured_s, seen.captured_s);
}

bool SensationPlanner::step(Plan& plan, FrameReport& report) {
  const SkinFrame frame = *std::exchange(frame_, std::nullopt);
  report = {.sequence = frame.sequence, .time_s = frame.time_s, .touch = &nothing_, .arrived_s = frame.arrived_s};
  plan.schedule.clear();
  list_nothing(plan);
  plan.captured_s = frame.arrived_s;
  if (const std::optional<FirstSlot> first = frame.first()) {
    const double middle_s = frame.captured_s + *first->ahead_s;
    make(first->slot, middle_s - (static_cast<double>(first->slot) + 0.5) * setting_.output.slot_s, plan);
  }
  return true;
}

/// The moments at which plans are made.
class Moments final : public sensing::DepthSource {
 public:
  Moments(const Clock& clock, double apart_s, const SensationPlanner& planner)
      : clock_(clock), apart_s_(apart_s), planner_(planner) {}

  const std::vector<sensing::Camera>& cameras() const override { return no_cameras_; }
  bool next(sensing::FrameSet& out, double) override {
    const double now_s = clock_.now();
    clock_.sleep_until(std::min(now_s + apart_s_, planner_.end_s()));
    out.pushed = true;
    out.time_s = clock_.now();
    out.sequence = number_++;
    return out.time_s < planner_.end_s();
  }

 private:
  const Clock& clock_;
  double apart_s_;
  const SensationPlanner& planner_;
  std::uint64_t number_ = 0;
  std::vector<sensing::Camera> no_cameras_;
};

}  // namespace

bool PlaceWatch::sounds(const Vec3& place_m) {
  if (!array::drivable({.position = place_m})) {
    if (!std::exchange(far_, true))
      log::warning("the sensation goes farther than 100 m from the array: it is silent there");
    return false;
  }
  box_.add(place_m);
  return true;
}

void PlaceWatch::look() {
  const Box box = std::exchange(box_, {});
  if (odd_ || box.empty()) return;
  const std::string odd = array::implausible_place(layout_, box);
  if (odd.empty()) return;
  odd_ = true;
  log::warning("the sensation " + odd);
}

Vec3 placed(const sensation::Point& point, const SensationSetting& setting, const std::optional<Transform>& hand) {
  const Vec3 local = point.place_m - Vec3(0, 0, point.height_m);
  if (hand) return setting.upright ? Vec3((*hand)[3]) + local : transform_point(*hand, local);
  return setting.at_m ? *setting.at_m + local : point.place_m;
}

std::vector<sensation::Point> points_of_slots(sensation::Sensation& sensation, const SensationSetting& setting,
                                              std::uint64_t most) {
  constexpr std::uint64_t at_once = 256;
  const double slot_s = setting.output.slot_s;
  const std::uint64_t count = setting.end_s ? std::min(slots_until(*setting.end_s, slot_s), most) : most;
  sensation::State state = sensation::State::at(0, setting.seed);
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
  PlaceWatch watch(setting.output.layout);
  for (sensation::Point& point : points) {
    if (point.gain > 0 && !watch.sounds(transform_point(setting.T_world_array, placed(point, setting, {}))))
      point.gain = 0;
  }
  watch.look();
  return points;
}

OutputStats run_sensation(sensation::Sensation& sensation, SensationControl& control, Link& link,
                          const SensationSetting& setting, std::atomic<bool>& stop, RunObserver& observer,
                          const Clock& clock) {
  SensationPlanner planner(sensation, control, setting);
  Moments moments(clock, std::min(between_plans_s, slots_ahead(setting) * setting.output.slot_s / 4), planner);
  LoopStats stats;
  struct Runs {
    explicit Runs(SensationControl& told) : control(told) { control.set_runs(true); }
    ~Runs() { control.set_runs(false); }
    SensationControl& control;
  } const runs(control);
  run_loop(moments, planner, link, {.output = setting.output}, stop, {.observer = &observer}, stats, clock);
  return stats.output;
}

OutputStats record_sensation(std::span<const sensation::Point> points, Link& link, const SensationSetting& setting,
                             const std::atomic<bool>& stop) {
  const array::Layout& layout = setting.output.layout;
  OutputStats stats;
  SafeLink safe(link, layout.transducers.size(), setting.output.safety, setting.output.slot_s);
  array::Drive drive(layout.transducers.size());
  array::DriveScratch scratch;
  std::uint64_t slot = 0;
  for (; slot < points.size() && !stop; ++slot) {
    const sensation::Point& point = points[slot];
    const Vec3 place = transform_point(setting.T_world_array, placed(point, setting, {}));
    const array::SlotFocus focus{.position = point.gain > 0 ? place : Vec3(0), .gain = static_cast<float>(point.gain)};
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
