// The sound of the transducers on the fingers that a loop follows (`run --transfer finger`).
//
// A thread beside the loop finds where a finger stands (finger_fit.hpp), and computes the sound g of each transducer at
// the finger's foci (acoustics/bodies/moving_body.hpp). The equations of the finger's mesh are factored once, in its
// own frame. The thread takes one finger at a time, the one that waits longest. It is idle while nothing touches.
//
// An answer is a factor for each transducer and focus,
//
//   h = g / G
//
// with the free field G at the place on the skin. In a frame that comes later, the sound at the focus is h G with the
// free field at the place where the focus is now. h depends on the directions of finger and array, and changes slowly.
// A focus far from where it was on its finger, or whose answer is old, has the free field.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/moving_body.hpp"
#include "array/field/free_field.hpp"
#include "array/layouts/layout.hpp"
#include "geometry/mesh/mesh.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/surroundings.hpp"
#include "session/answer_thread.hpp"
#include "session/loop/finger_fit.hpp"
#include "session/plan/finger_sounds.hpp"
#include "session/plan/planner.hpp"
#include "session/plan/setting.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

class LiveFingers final : public FingerSounds {
 public:
  static constexpr double most_age_s = 0.5;        ///< of an answer
  static constexpr double most_shift_m = 2e-3;     ///< of a focus on its finger since then
  static constexpr double most_off_skin_m = 4e-3;  ///< of a focus
  static constexpr double least_step_s = 30e-3;    ///< from question to question

  /// All must outlive it. The setting has a finger, cameras and a layout.
  explicit LiveFingers(const SessionSetting& setting);

  /// A loop begins: the thread makes the finger's equations.
  void begin();
  /// A frame of the loop that will be planned. Keeps its images if the thread is idle and something touches.
  void saw(std::span<const sensing::DepthFrame> images, std::uint64_t sequence);
  /// The frame is planned.
  void planned(const FrameReport& report, const array::Schedule& schedule);
  FingerSoundStats stats() const { return stats_; }

  bool take(const array::Schedule& schedule) override;
  std::optional<Aimed> aimed(const Vec3& focus) const override;
  void fill(std::span<const array::FocusSource> foci, array::Weighting weighting,
            array::Columns& columns) const override;
  void fill(std::span<const array::FocusSource> foci, array::Weighting weighting, std::size_t first, std::size_t count,
            array::Columns& columns) const override;

 private:
  /// A finger of a frame. Lengths in metres, in the world.
  struct Tracked {
    std::uint32_t id = 0;
    Vec3 contacts{0};  ///< their centroid
    std::vector<Vec3> foci;
  };
  struct Question {
    std::vector<sensing::DepthFrame> images;  ///< none: only make the equations
    double time_s = 0;
    std::vector<Tracked> fingers;
  };
  /// h of each transducer, e^{i phase} times its size.
  struct Factors {
    std::vector<float> cosine, sine, phase, size;
  };
  /// What is known of a finger.
  struct Known {
    std::uint32_t id = 0;
    double asked_s = 0, time_s = 0;  ///< of the last question, and of the last answer
    std::optional<Transform> T_world_finger;
    std::vector<Vec3> foci;        ///< then
    std::vector<Vec3> places;      ///< on the skin; only of those with factors
    std::vector<Factors> factors;  ///< empty if unknown
    std::vector<double> gains;
  };
  struct Answer {
    std::uint64_t number = 0;
    std::string fault;
    std::vector<std::shared_ptr<const Known>> fingers;
    bool placed = false;  ///< the finger of the question was found in the images
    std::uint32_t id = 0;
    double took_s = 0;
  };
  /// A focus of the frame whose sound is known.
  struct Aim {
    Vec3 focus, place;
    const Factors* factors;
  };

  Answer work(const Question& question, const std::atomic<bool>& give_up);
  void hear(const Tracked& tracked, Known& known, const std::atomic<bool>& give_up) const;
  const Tracked& longest_waiting(const std::vector<Tracked>& fingers) const;
  void learn();
  const Aim* find(const Vec3& focus) const;

  const SessionSetting& setting_;
  array::FreeField free_field_;

  // The thread's.
  sensing::Surroundings surroundings_;  ///< as of the loop's planner
  acoustics::Air air_;
  std::optional<sensing::RayTables> rays_;
  std::optional<acoustics::MovingBody> finger_;
  std::optional<FingerFit> fit_;
  std::vector<std::shared_ptr<const Known>> known_;

  // The loop's.
  Question next_;  ///< its images are those of frame `next_sequence_`
  std::optional<std::uint64_t> next_sequence_;
  bool touching_ = false, told_fault_ = false;
  double asked_s_ = -1;
  std::uint64_t learned_ = 0;
  std::shared_ptr<const Answer> newest_;
  std::vector<Aim> aims_;
  FingerSoundStats stats_;
  mutable std::vector<array::FocusSource> shifted_;

  AnswerThread<Question, Answer> answers_;  ///< last: its thread uses the others
};

}  // namespace palpa::session
