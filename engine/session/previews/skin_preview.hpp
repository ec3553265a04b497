// The pressure on a finger, for drawing while foci, array or finger change. It is computed beside the drawing thread,
// the newest question first.
//
// The equations are solved in the finger's own frame; the array is moved into that frame. The equations are factored
// once per mesh and tone (acoustics/bodies/body_cache.hpp). If the finger moves as a whole, if foci move, or if the
// array or the schedule changes, only the right-hand sides are recomputed. That takes 0.2 s for the paper's case.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_cache.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "session/answer_thread.hpp"
#include "session/plan/plan.hpp"

namespace palpa::session {

struct SkinQuestion {
  std::string name = "the finger";  ///< its file, for messages
  geometry::Mesh finger;            ///< in its own frame, as acoustics::body_mesh returns it
  Transform T_world_finger{1.0};    ///< rigid
  Plan plan;                        ///< made for the layout with these options; silent without a voice
  array::Layout layout;             ///< in the world
  array::DriveOptions drive;
  acoustics::Air air;
  bool afferents = false;  ///< whether `rates` are wanted, too
};

struct SkinAnswer {
  std::uint64_t number = 0;       ///< number of the question; 0: no question yet
  acoustics::SkinPressure faces;  ///< time averages, Pa
  std::vector<double> vertices;   ///< `langevin` of `faces`, at each vertex of the mesh
  /// The rates of SA1, RA and PC at each vertex, 1/s; NaN beyond the fingertip. Empty unless they were asked for, and
  /// from answer(), which knows no afferents (experiment/skin_rates.hpp).
  std::vector<std::array<double, 3>> rates;
  std::string fault;  ///< the error message if there is no result; empty on success
};

/// Answers on the calling thread. Throws bad_input if the finger intersects the array, GivenUp
/// (base/system/parallel.hpp) soon after `give_up` became true.
SkinAnswer answer(const SkinQuestion& question, acoustics::BodyCache& bodies,
                  const std::atomic<bool>* give_up = nullptr);

/// Answers beside the asking thread (session/answer_thread.hpp). The computation reports its activity through doing()
/// (base/activity.hpp).
class SkinPreview {
 public:
  /// Called on the preview's thread. It may throw as answer() does.
  using Work = std::function<SkinAnswer(const SkinQuestion&, acoustics::BodyCache&, const std::atomic<bool>* give_up)>;
  explicit SkinPreview(Work work = answer);

  std::uint64_t ask(SkinQuestion question) { return answers_.ask(std::move(question)); }
  std::shared_ptr<const SkinAnswer> newest() const { return answers_.newest(); }
  /// Whether there is a newer question than the one that newest() answers. A picture of that answer should be marked.
  bool stale() const { return answers_.stale(); }

 private:
  acoustics::BodyCache bodies_;  ///< used by the thread only
  AnswerThread<SkinQuestion, SkinAnswer> answers_;
};

}  // namespace palpa::session
