#include "session/watch/stats.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/files/json_rows.hpp"
#include "base/files/json_writer.hpp"

namespace palpa::session {
namespace {

constexpr int digits = 6;

void add_distribution(JsonWriter& json, std::string_view key, const Samples& samples, double scale) {
  json.key(key).begin_object().member("count", samples.count());
  json.key("median").rounded(samples.quantile(0.5) * scale, digits);
  json.key("p99").rounded(samples.quantile(0.99) * scale, digits);
  json.key("p999").rounded(samples.quantile(0.999) * scale, digits);
  json.key("max").rounded(samples.quantile(1.0) * scale, digits);
  json.end_object();
}

/// The numbers that passed each hand-over: `drives` and, for boards that play them, `plans`.
void add_hand_over(JsonWriter& json, const HandOver& counts) {
  json.key("hand_over").begin_object();
  const auto add = [&](std::string_view key, std::uint64_t Passed::*what, bool drives) {
    json.key(key).begin_object().member("loop", counts.loop.*what);
    if (counts.behind) {
      const Carried& behind = *counts.behind;
      if (behind.guard) {
        json.member("guard", (*behind.guard).*what).member("submitted", behind.submitted.*what);
        json.member("completed", behind.completed.*what);
        if (drives) json.member("starting", behind.starting);
        if (drives && behind.late) json.member("late", *behind.late);
      } else {
        json.member("played", behind.completed.*what);
      }
      if (drives) json.member("lost", counts.lost());
    }
    json.end_object();
  };
  add("drives", &Passed::drives, true);
  if (counts.behind && counts.behind->completed.plans > 0) add("plans", &Passed::plans, false);
  json.end_object();
}

/// How the system schedules what must not be late.
void add_scheduling(JsonWriter& json, const OutputStats& output) {
  json.key("scheduling").begin_object().member("output", to_text(output.scheduling));
  if (output.hand_over.behind && output.hand_over.behind->guard)
    json.member("guard", to_text(output.hand_over.behind->guard_scheduling));
  json.end_object();
}

}  // namespace

void Samples::add(double value) {
  least_ = count_ == 0 ? value : std::min(least_, value);
  most_ = count_ == 0 ? value : std::max(most_, value);
  ++count_;
  const double at = value > 0 ? per_doubling * (std::log2(value) - lowest) : 0;
  ++counts_[static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(buckets - 1)))];
}

double Samples::quantile(double p) const {
  if (count_ == 0) return 0;
  const auto wanted = static_cast<std::uint64_t>(std::llround(p * static_cast<double>(count_ - 1)));
  if (wanted == 0) return least_;
  if (wanted == count_ - 1) return most_;
  std::size_t bucket = 0;
  for (std::uint64_t below = counts_[0]; below <= wanted; below += counts_[bucket])
    ++bucket;
  const double middle = bucket == 0 ? least_ : std::exp2((static_cast<double>(bucket) + 0.5) / per_doubling + lowest);
  return std::clamp(middle, least_, most_);
}

void LoopStats::add_passes(std::span<const gpu::PassTime> times) {
  for (const gpu::PassTime& time : times) {
    auto known =
        std::find_if(passes.begin(), passes.end(), [&](const PassStats& pass) { return pass.name == time.name; });
    if (known == passes.end()) known = passes.insert(passes.end(), PassStats{time.name, {}});
    known->ms.add(time.ms);
  }
}

void write_dropped(const sensing::Dropped& dropped, JsonWriter& json) {
  using sensing::NoSkin;
  json.key("dropped").begin_object().member("room", dropped[NoSkin::room]).member("boards", dropped[NoSkin::board]);
  json.member("screen", dropped[NoSkin::screen]).member("background", dropped[NoSkin::background]).end_object();
}

std::string to_text(const std::optional<sensing::Dropped>& dropped, std::uint64_t frames) {
  if (!dropped || dropped->total() == 0 || frames == 0) return "";
  std::string what;
  const auto add = [&](sensing::NoSkin why, const char* where) {
    if ((*dropped)[why] == 0) return;
    what += fmt::format("{}{:.0f} {}", what.empty() ? "" : ", ",
                        std::ceil(static_cast<double>((*dropped)[why]) / static_cast<double>(frames)), where);
  };
  add(sensing::NoSkin::room, "outside the room");
  add(sensing::NoSkin::board, "on the array's boards");
  add(sensing::NoSkin::screen, "on the screen");
  add(sensing::NoSkin::background, "in the background");
  return fmt::format("points that are no skin, in a frame on average: {}\n", what);
}

std::string to_json(const LoopStats& stats) {
  JsonWriter json;
  json.begin_object(JsonWriter::Style::rows);
  if (!stats.backend.empty()) json.member("backend", stats.backend).member("backend_why", stats.backend_why);
  json.key("frames").begin_object();
  json.member("captured", stats.captured).member("replaced", stats.replaced).member("missing", stats.missing);
  json.member("unrecorded", stats.unrecorded).member("planned", stats.planned).member("unplayed", stats.unplayed);
  json.member("touching", stats.touching);
  json.end_object();
  if (stats.untouched) write_untouched(*stats.untouched, json);
  if (stats.dropped) write_dropped(*stats.dropped, json);
  json.key("seconds").rounded(stats.seconds, digits);
  json.key("timing_ms").begin_object();
  add_distribution(json, "frame_to_plan", stats.frame_to_plan_s, 1e3);
  add_distribution(json, "capture_to_drive", stats.output.capture_to_drive_s, 1e3);
  add_distribution(json, "drive_jitter", stats.output.jitter_s, 1e3);
  json.end_object();
  json.key("passes_ms").begin_object();
  for (const PassStats& pass : stats.passes)
    add_distribution(json, pass.name, pass.ms, 1.0);
  json.end_object();
  json.key("drives").begin_object();
  json.member("sent", stats.output.drives).member("silent", stats.output.silent_drives);
  json.member("skipped_slots", stats.output.skipped_slots);
  if (stats.driven) array::driven_rows().write_members(json, *stats.driven);
  json.end_object();
  if (stats.output.scheduling != Scheduling::unknown) add_scheduling(json, stats.output);
  add_hand_over(json, stats.output.hand_over);
  if (stats.events) {
    json.key("events").begin_object();
    json.member("written", stats.events->written).member("dropped", stats.events->dropped).end_object();
  }
  if (stats.messages) {
    json.key("osc").begin_object().member("taken", stats.messages->taken);
    json.member("refused", stats.messages->refused).end_object();
  }
  if (stats.reload) {
    json.key("reload").begin_object().member("taken", stats.reload->taken);
    json.member("refused", stats.reload->refused).end_object();
  }
  if (stats.shed) {
    json.key("shed").begin_object().member("pixel_stride", stats.shed->least.pixel_stride);
    json.member("foci_part", stats.shed->least.foci_part).member("hold_s", stats.shed->hold_s);
    json.member("frames", stats.shed->frames).end_object();
  }
  if (stats.prediction) {
    json.key("prediction").begin_object();
    add_distribution(json, "latency_ms", stats.prediction->latency_s, 1e3);
    add_distribution(json, "distance_mm", stats.prediction->distance_m, 1e3);
    json.member("clamped", stats.prediction->clamped).end_object();
  }
  if (stats.tune) {
    json.key("tune").begin_object().member("field", stats.tune->of_array ? "array" : "spot");
    json.member("fields", stats.tune->fields).end_object();
  }
  if (stats.finger_sounds) {
    const FingerSoundStats& own = *stats.finger_sounds;
    json.key("transfer").begin_object().member("touching", own.touching).member("frames", own.frames);
    json.member("answers", own.answers).member("not_found", own.not_found);
    add_distribution(json, "took_ms", own.took_s, 1e3);
    add_distribution(json, "age_ms", own.age_s, 1e3);
    json.key("gain").begin_object().member("count", own.gain.count());
    json.key("least").rounded(own.gain.quantile(0), digits).key("median").rounded(own.gain.quantile(0.5), digits);
    json.key("most").rounded(own.gain.quantile(1), digits).end_object();
    json.end_object();
  }
  if (stats.ear) acoustics::write_level(*stats.ear, json);
  write_pressures(stats.fingers, stats.solids, json);
  json.end_object();
  return json.take();
}

}  // namespace palpa::session
