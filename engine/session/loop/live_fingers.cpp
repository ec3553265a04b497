#include "session/loop/live_fingers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <span>
#include <utility>

#include "array/drive.hpp"
#include "base/log.hpp"
#include "sensing/skin_twin.hpp"

namespace palpa::session {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t most_known = 16;

Box around(const Vec3& centre, double reach) {
  return {centre - Vec3(reach), centre + Vec3(reach)};
}

/// The pressure of a focus with the drive for its sound, over that with the drive for free air.
double gain_of(std::span<const Complex> sound, const array::Layout& layout, const Vec3& focus,
               const array::DriveOptions& drive) {
  const bool even = drive.weighting == array::Weighting::uniform;
  double heard = 0;
  Complex before = 0;
  for (std::size_t t = 0; t < sound.size(); ++t) {
    const double way = glm::distance(layout.transducers[t].position, focus);
    const double amplitude = even ? 1 : way;
    heard += amplitude * std::abs(sound[t]);
    before += std::polar(amplitude, -2 * std::numbers::pi * way * drive.medium.turns_per_metre()) * sound[t];
  }
  return std::abs(before) > 0 ? heard / std::abs(before) : 0;
}

}  // namespace

LiveFingers::LiveFingers(const SessionSetting& setting)
    : setting_(setting),
      surroundings_(surroundings_of(setting)),
      air_(acoustics::without_absorption(setting.finger->air)),
      newest_(std::make_shared<Answer>()),
      answers_([this](const Question& question, const std::atomic<bool>& give_up) { return work(question, give_up); }) {
  free_field_.set(setting.layout, setting.drive.medium, setting.drive.directivity);
}

// ---- the loop's thread ----------------------------------------------------------------------------------------------

void LiveFingers::begin() {
  stats_ = {};
  touching_ = false;
  next_sequence_.reset();
  asked_s_ = -1;
  if (!answers_.stale()) answers_.ask({});
}

void LiveFingers::saw(std::span<const sensing::DepthFrame> images, std::uint64_t sequence) {
  if (!touching_ || next_sequence_ || answers_.stale()) return;
  next_.images.assign(images.begin(), images.end());
  next_sequence_ = sequence;
}

void LiveFingers::planned(const FrameReport& report, const array::Schedule& schedule) {
  const touch::Touch& touch = *report.touch;
  touching_ = touch.finger_count > 0;
  if (touching_) ++stats_.touching;
  if (!next_sequence_ || *next_sequence_ > report.sequence) return;
  const bool this_frame = *next_sequence_ == report.sequence;
  next_sequence_.reset();
  if (!this_frame || !touching_) return;
  if (asked_s_ >= 0 && report.time_s >= asked_s_ && report.time_s < asked_s_ + least_step_s) return;
  asked_s_ = report.time_s;
  next_.time_s = report.time_s;
  next_.fingers.clear();
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    // The schedule lacks fingers that are expected to have left.
    const array::Voice& voice = schedule.voices[v];
    const auto fingers = std::span(touch.fingers).first(touch.finger_count);
    const auto finger = std::ranges::find(fingers, voice.id, &touch::Finger::id);
    if (finger != fingers.end()) next_.fingers.push_back({voice.id, Vec3(finger->section.centroid), voice.foci});
  }
  answers_.ask(std::move(next_));
  next_ = {};
}

/// Takes the thread's newest answer.
void LiveFingers::learn() {
  std::shared_ptr<const Answer> answer = answers_.newest();
  if (answer->number == learned_) return;
  learned_ = answer->number;
  if (!answer->fault.empty()) {
    if (!std::exchange(told_fault_, true))
      log::warning(fmt::format("--transfer finger: foci sound as in free air: {}", answer->fault));
    return;
  }
  newest_ = std::move(answer);
  if (newest_->took_s == 0) return;
  stats_.took_s.add(newest_->took_s);
  if (!newest_->placed) {
    ++stats_.not_found;
    return;
  }
  ++stats_.answers;
  for (const auto& known : newest_->fingers) {
    if (known->id != newest_->id) continue;
    for (const double gain : known->gains)
      stats_.gain.add(gain);
  }
}

bool LiveFingers::take(const array::Schedule& schedule) {
  learn();
  aims_.clear();
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = schedule.voices[v];
    const auto found = std::ranges::find_if(newest_->fingers, [&](const auto& known) { return known->id == voice.id; });
    if (found == newest_->fingers.end()) continue;
    const Known& known = **found;
    const double age_s = schedule.time_s - known.time_s;
    if (age_s < 0 || age_s > most_age_s || known.foci.size() != voice.foci.size()) continue;
    const Vec3 now = mean_of(voice.foci), then = mean_of(known.foci);
    for (std::size_t j = 0; j < voice.foci.size(); ++j) {
      if (known.factors[j].phase.empty()) continue;
      if (glm::distance(voice.foci[j] - now, known.foci[j] - then) > most_shift_m) continue;
      aims_.push_back({voice.foci[j], voice.foci[j] + known.places[j] - known.foci[j], &known.factors[j]});
    }
    stats_.age_s.add(age_s);
  }
  if (!aims_.empty()) ++stats_.frames;
  return !aims_.empty();
}

const LiveFingers::Aim* LiveFingers::find(const Vec3& focus) const {
  const auto found = std::ranges::find(aims_, focus, &Aim::focus);
  return found == aims_.end() ? nullptr : &*found;
}

void LiveFingers::fill(std::span<const array::FocusSource> foci, array::Weighting weighting,
                       array::Columns& columns) const {
  fill(foci, weighting, 0, setting_.layout.transducers.size(), columns);
}

void LiveFingers::fill(std::span<const array::FocusSource> foci, array::Weighting weighting, std::size_t first,
                       std::size_t count, array::Columns& columns) const {
  shifted_.assign(foci.begin(), foci.end());
  for (array::FocusSource& source : shifted_) {
    if (const Aim* const aim = find(source.position)) source.position = aim->place;
  }
  free_field_.fill(shifted_, weighting, first, count, columns);
  for (std::size_t j = 0; j < foci.size(); ++j) {
    const Aim* const aim = find(foci[j].position);
    if (!aim) continue;
    const Factors& h = *aim->factors;
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t entry = n * foci.size() + j;
      const auto x = static_cast<double>(h.cosine[first + n]), y = static_cast<double>(h.sine[first + n]);
      const double cosine = columns.cosine[entry], sine = columns.sine[entry];
      columns.cosine[entry] = cosine * x - sine * y;
      columns.sine[entry] = cosine * y + sine * x;
      columns.loud[entry] *= static_cast<double>(h.size[first + n]);
      columns.asked[entry] = std::min(columns.asked[entry], 1.0);
    }
  }
}

std::optional<FingerSounds::Aimed> LiveFingers::aimed(const Vec3& focus) const {
  const Aim* const aim = find(focus);
  return aim ? std::optional(Aimed{aim->place, aim->factors->phase}) : std::nullopt;
}

// ---- the thread beside it -------------------------------------------------------------------------------------------

const LiveFingers::Tracked& LiveFingers::longest_waiting(const std::vector<Tracked>& fingers) const {
  const auto asked_s = [&](const Tracked& tracked) {
    const auto found = std::ranges::find_if(known_, [&](const auto& known) { return known->id == tracked.id; });
    return found == known_.end() ? -1e300 : (*found)->asked_s;
  };
  return *std::ranges::min_element(fingers, {}, asked_s);
}

void LiveFingers::hear(const Tracked& tracked, Known& known, const std::atomic<bool>& give_up) const {
  const Transform T_finger_world = glm::inverse(*known.T_world_finger);
  const array::Layout layout = array::transformed(setting_.layout, T_finger_world);
  std::vector<Vec3> foci;
  for (const Vec3& focus : tracked.foci)
    foci.push_back(transform_point(T_finger_world, focus));
  const auto heard = finger_->hear(foci, layout, &give_up);
  array::FreeField free_field;
  free_field.set(layout, setting_.drive.medium, setting_.drive.directivity);
  array::Columns columns;
  known.foci = tracked.foci;
  known.places.clear();
  known.gains.clear();
  known.factors.assign(foci.size(), Factors());
  for (std::size_t j = 0; j < foci.size(); ++j) {
    known.places.push_back(transform_point(*known.T_world_finger, heard[j].place));
    if (heard[j].moved_m > most_off_skin_m) continue;
    const array::FocusSource source{heard[j].place, 0, 1};
    free_field.fill(std::span(&source, 1), array::Weighting::uniform, columns);
    Factors& h = known.factors[j];
    for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
      const Complex free = layout.source_level_pa_m * columns.transfer(t);
      // Behind a transducer there is no sound to compare with, and none to use.
      const Complex factor = std::norm(free) > 0 ? heard[j].sound[t] / free : 1;
      const double size = std::abs(factor);
      h.cosine.push_back(static_cast<float>(size > 0 ? factor.real() / size : 1));
      h.sine.push_back(static_cast<float>(size > 0 ? factor.imag() / size : 0));
      h.phase.push_back(static_cast<float>(std::arg(factor)));
      h.size.push_back(static_cast<float>(size));
    }
    known.gains.push_back(gain_of(heard[j].sound, layout, foci[j], setting_.drive));
  }
}

LiveFingers::Answer LiveFingers::work(const Question& question, const std::atomic<bool>& give_up) {
  const auto begin = std::chrono::steady_clock::now();
  if (!finger_) {
    auto body = std::make_shared<const acoustics::RigidBody>(setting_.finger->body, air_.wave_number(), &give_up);
    finger_.emplace(std::move(body), air_, setting_.drive.directivity, &give_up);
    fit_.emplace(finger_->body().mesh());
    rays_.emplace(sensing::make_rays(setting_.cameras));
  }
  Answer answer;
  if (!question.fingers.empty()) {
    const Tracked& tracked = longest_waiting(question.fingers);
    answer.id = tracked.id;
    const auto found = std::ranges::find_if(known_, [&](const auto& known) { return known->id == tracked.id; });
    Known known = found == known_.end() ? Known() : **found;
    if (found != known_.end()) known_.erase(found);
    known.id = tracked.id;
    known.asked_s = question.time_s;

    std::vector<sensing::Crop> crops;
    std::vector<shader::SkinVolume> volumes;
    sensing::SkinOfFrame skin;
    const Box box = around(tracked.contacts, FingerFit::reach_m);
    sensing::plan_crops(setting_.cameras, *rays_, box, crops);
    sensing::plan_drops(surroundings_, box, volumes);
    sensing::find_skin(*rays_, question.images, box, crops, volumes, skin);
    std::vector<Vec3> points;
    points.reserve(skin.points.size());
    for (const sensing::SkinPoint& point : skin.points)
      points.emplace_back(point.position);
    const std::optional<FittedPose> pose = fit_->find(points, tracked.contacts, known.T_world_finger);
    answer.placed = pose.has_value();
    known.T_world_finger = pose ? std::optional(pose->T_world_finger) : std::nullopt;
    if (pose) {
      hear(tracked, known, give_up);
      known.time_s = question.time_s;
    } else {
      known.foci.clear();
    }
    known_.push_back(std::make_shared<const Known>(std::move(known)));
    if (known_.size() > most_known) known_.erase(known_.begin());
    answer.took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  answer.fingers = known_;
  return answer;
}

}  // namespace palpa::session
