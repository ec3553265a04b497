// Computes the array's sound at the fingers' foci in a separate thread beside the loop. It takes milliseconds per
// finger, and no frame waits for it.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "acoustics/felt/harmonics.hpp"
#include "acoustics/felt/tune.hpp"
#include "acoustics/field/array_field.hpp"
#include "session/newest.hpp"

namespace palpa::session {

/// One question at a time goes to the thread. It covers all fingers whose harmonics are needed. The next question is
/// sent when the answer has arrived. All calls come from the compute thread, and no call waits. The thread sleeps
/// while there is no question, and it yields to all other threads: it is not real-time (SCHED_BATCH) even if the thread
/// that starts it is, and its nice value is higher by ten. It takes no signals.
class TuningThread {
 public:
  /// `field` must outlive it.
  explicit TuningThread(const acoustics::ArrayField& field);
  /// Ends the thread, within a few milliseconds even in the middle of a question.
  ~TuningThread();
  TuningThread(const TuningThread&) = delete;
  TuningThread& operator=(const TuningThread&) = delete;

  /// Begins a new frame: gives new results to `strides`.
  void begin(acoustics::StrideTuner& strides);
  /// The number of fingers' fields computed so far.
  std::uint64_t known() const { return known_; }
  /// Adds a finger of that frame, with foci in the order of their sectors, to the question if `strides` needs it and no
  /// other question is open. `asks`: the finger requests a pressure, which each focus then has.
  void look_at(std::uint32_t id, std::span<const Vec3> foci, bool asks, double time_s,
               const acoustics::StrideTuner& strides);
  /// Ends the frame, after its last finger.
  void end();

 private:
  struct Ring {
    std::uint32_t id = 0;
    double time_s = 0;
    bool asks = false;
    std::vector<Vec3> foci;
  };
  /// Only the first `count` are valid; the others keep their storage.
  struct Question {
    std::vector<Ring> rings;
    std::size_t count = 0;
  };
  struct Answer {
    std::uint32_t id = 0;
    double time_s = 0;
    acoustics::Harmonics harmonics;
  };
  using Answers = std::vector<Answer>;

  void work();

  const acoustics::ArrayField& field_;
  Newest<Question> questions_;
  Newest<Answers> answers_;
  bool asked_ = false;  ///< a question is open
  std::uint64_t known_ = 0;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace palpa::session
