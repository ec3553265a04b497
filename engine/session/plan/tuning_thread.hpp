// What an array makes of the fingers' foci, computed beside the loop: it takes milliseconds per finger, and no frame
// waits for it.
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

/// One question at a time goes over to the thread, of all fingers whose harmonics are wanted; the next when the answer
/// is here. All calls are the compute thread's; none of them waits. The thread sleeps while nothing is asked, and gives
/// way to every other: it is not real-time even where who starts it is (SCHED_BATCH), and nicer than that by ten. It
/// takes no signals.
class TuningThread {
 public:
  /// `field` outlives it.
  explicit TuningThread(const acoustics::ArrayField& field);
  /// Ends the thread, in the middle of a question within a few milliseconds.
  ~TuningThread();
  TuningThread(const TuningThread&) = delete;
  TuningThread& operator=(const TuningThread&) = delete;

  /// A new frame: hands what has become known to `strides`.
  void begin(acoustics::StrideTuner& strides);
  /// How many fingers' fields have become known so far.
  std::uint64_t known() const { return known_; }
  /// A finger of that frame, its foci in the order of their sectors: asks for it where `strides` wants it and no other
  /// question is under way. `asks`: for a pressure, which each focus has then.
  void look_at(std::uint32_t id, std::span<const Vec3> foci, bool asks, double time_s,
               const acoustics::StrideTuner& strides);
  /// The frame's last finger was looked at.
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
  bool asked_ = false;  ///< a question is under way
  std::uint64_t known_ = 0;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace palpa::session
