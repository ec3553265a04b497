// The measurements of a loop.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/audible.hpp"
#include "array/drive_options.hpp"
#include "base/files/json_writer.hpp"
#include "gpu/pass_time.hpp"
#include "sensing/no_skin.hpp"
#include "session/links/hand_over.hpp"
#include "session/watch/effort.hpp"
#include "session/watch/pressure_log.hpp"
#include "session/watch/untouched.hpp"

namespace palpa::session {

/// The distribution of one quantity over a whole run, however long, in a fixed amount of memory: adding never
/// allocates.
class Samples {
 public:
  Samples() : counts_(buckets) {}

  void add(double value);
  std::uint64_t count() const { return count_; }
  /// The value below which a share `p` (0..1) of the samples lie, within 0.3 %; the least and the greatest are exact. 0
  /// without samples. Samples below 1e-12 count as the least one.
  double quantile(double p) const;

 private:
  // Buckets of equal ratio: 128 for each doubling, from 2^lowest.
  static constexpr int per_doubling = 128, lowest = -40, doublings = 64;
  static constexpr std::size_t buckets = std::size_t{per_doubling} * doublings;

  std::vector<std::uint32_t> counts_;
  std::uint64_t count_ = 0;
  double least_ = 0, most_ = 0;
};

/// Kept by the output thread.
struct OutputStats {
  std::uint64_t drives = 0, silent_drives = 0, skipped_slots = 0;
  HandOver hand_over;                           ///< the counts of drives at each hand-over to the device
  Scheduling scheduling = Scheduling::unknown;  ///< of the output thread at its end; unknown: it did not ask
  Samples jitter_s;                             ///< how late each drive left
  Samples capture_to_drive_s;                   ///< from a frame's capture to its first drive

  void sent(double late_s, bool silent) {
    ++drives;
    silent_drives += silent ? 1 : 0;
    jitter_s.add(late_s);
  }
  void skipped(std::uint64_t slots) { skipped_slots += slots; }
  void first_drive(double latency_s) { capture_to_drive_s.add(latency_s); }
};

/// For a run that reports events.
struct EventStats {
  std::uint64_t written = 0, dropped = 0;
};

/// For a run that other programs may change by messages.
struct MessageStats {
  std::uint64_t taken = 0, refused = 0;
};

/// For a run whose scene is read again.
struct ReloadStats {
  std::uint64_t taken = 0;    ///< scenes that replaced the one before
  std::uint64_t refused = 0;  ///< times that the scene could not be used
};

/// For a run that tunes strides.
struct TuneStats {
  bool of_array = false;     ///< true: by the array's field, once it is known; false: by spots
  std::uint64_t fields = 0;  ///< how many fingers' fields were computed
};

/// For a run that predicts where fingers will be.
struct PredictStats {
  Samples latency_s;          ///< from a frame's capture to the middle of the first slot that could play it
  Samples distance_m;         ///< the way of the finger that was moved farthest
  std::uint64_t clamped = 0;  ///< frames whose first cycle lasts beyond the longest prediction

  void add(double latency, double distance, bool beyond) {
    latency_s.add(latency);
    distance_m.add(distance);
    clamped += beyond ? 1 : 0;
  }
};

/// For a run whose foci are computed on the fingers.
struct FingerSoundStats {
  std::uint64_t touching = 0;   ///< planned frames with a finger
  std::uint64_t frames = 0;     ///< of these, those in which the sound was known at a focus
  std::uint64_t answers = 0;    ///< fingers whose sound was computed
  std::uint64_t not_found = 0;  ///< fingers whose mesh did not fit the skin
  Samples took_s;               ///< the time of each answer
  Samples age_s;                ///< of the answer that a finger's foci used
  Samples gain;                 ///< of each focus' pressure, over that with the drive for free air
};

/// For a run that has shed work.
struct ShedStats {
  Effort least;              ///< the least effort of any frame
  double hold_s = 0;         ///< the longest that a frame was allowed to sound
  std::uint64_t frames = 0;  ///< that were processed only in part
};

/// The time of one pass over all frames.
struct PassStats {
  std::string name;
  Samples ms;
};

struct LoopStats {
  std::string backend, backend_why;         ///< what computed, "gpu" or "cpu", and why; set by the caller, who chose it
  std::uint64_t captured = 0;               ///< frames that came from the source
  std::uint64_t replaced = 0;               ///< of these, skipped because a newer one had come
  std::uint64_t missing = 0;                ///< how often the source had no frame within the hold
  std::uint64_t unrecorded = 0;             ///< frames that are not recorded, usually because they came too fast
  std::uint64_t planned = 0;                ///< frames whose drives were made
  std::uint64_t unplayed = 0;               ///< of these, not played because the drives of a newer one had come
  std::uint64_t touching = 0;               ///< of the planned frames, those with at least one finger
  std::optional<UntouchedStats> untouched;  ///< if frames were planned and none had a finger; set by the caller
  std::optional<sensing::Dropped> dropped;  ///< of the planned frames, if something could be dropped
  double seconds = 0;                       ///< from the first frame to the end
  Samples frame_to_plan_s;                  ///< a frame in memory to its drives in memory
  std::vector<PassStats> passes;
  OutputStats output;
  std::optional<EventStats> events;
  std::optional<MessageStats> messages;
  std::optional<ReloadStats> reload;
  std::optional<TuneStats> tune;
  std::optional<ShedStats> shed;
  std::optional<PredictStats> prediction;
  std::optional<FingerSoundStats> finger_sounds;
  std::optional<acoustics::EarLevel> ear;  ///< how loud the loudest touch was to the ear, as predicted; none: no touch
  std::vector<FingerPressure> fingers;     ///< filled if pressures were requested
  std::vector<std::string> solids;         ///< the names of their solids
  std::optional<array::DrivenBy> driven;   ///< how drives were computed

  void add_passes(std::span<const gpu::PassTime> times);
};

/// One JSON object, keys as in docs/run.md.
std::string to_json(const LoopStats& stats);

/// Adds "dropped": the points that were no skin, by reason.
void write_dropped(const sensing::Dropped& dropped, JsonWriter& json);
/// The same as a line of a summary, per frame; empty if there were none.
std::string to_text(const std::optional<sensing::Dropped>& dropped, std::uint64_t frames);

}  // namespace palpa::session
