// The pressure on a finger for whoever draws it while foci, array or finger change: computed beside the drawing thread,
// the newest question first.
//
// The equations are solved in the finger's own frame, into which the array is moved: they are factored once per mesh
// and tone (acoustics/bodies/body_cache.hpp), and a finger that moves as a whole, foci that move, another array or
// schedule cost right-hand sides only, 0.2 s for the paper's case.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_cache.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "session/links/plan.hpp"
#include "session/previews/beside.hpp"

namespace palpa::session {

struct SkinQuestion {
  std::string name = "the finger";  ///< its file, for messages
  geometry::Mesh finger;            ///< in its own frame, as acoustics::body_mesh returns it
  Transform T_world_finger{1.0};    ///< rigid
  Plan plan;                        ///< of the layout, by these options; without a voice it is silent
  array::Layout layout;             ///< in the world
  array::DriveOptions drive;
  acoustics::Air air;
};

struct SkinAnswer {
  std::uint64_t number = 0;       ///< of the question; 0: there was none yet
  acoustics::SkinPressure faces;  ///< time averages, Pa
  std::vector<double> vertices;   ///< `langevin` of these: at each vertex of the mesh
  std::string fault;              ///< why there is nothing of that, as the error said it; empty: it is all there
};

/// Answers on the calling thread. Throws bad_input where the finger stands in the array, GivenUp (base/parallel.hpp)
/// soon after `give_up` became true.
SkinAnswer answer(const SkinQuestion& question, acoustics::BodyCache& bodies,
                  const std::atomic<bool>* give_up = nullptr);

/// Beside whoever asks (beside.hpp). What is computed says so where doing() is looked at (base/activity.hpp).
class SkinPreview {
 public:
  SkinPreview();

  std::uint64_t ask(SkinQuestion question) { return beside_.ask(std::move(question)); }
  std::shared_ptr<const SkinAnswer> newest() const { return beside_.newest(); }
  /// Whether something newer was asked than newest() answers: a picture of it is to be marked.
  bool stale() const { return beside_.stale(); }

 private:
  acoustics::BodyCache bodies_;  ///< of the thread
  Beside<SkinQuestion, SkinAnswer> beside_;
};

}  // namespace palpa::session
