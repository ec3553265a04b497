// What the finger feels, the pressure or the rates of its afferents, updated in the background
// (session/previews/skin_preview.hpp, experiment/skin_rates.hpp). If the picture does not show what sounds now,
// it says so and is drawn dimmer until the next result is ready.
#pragma once

#include <cstdint>
#include <future>
#include <optional>
#include <string>

#include "geometry/mesh/mesh.hpp"
#include "session/previews/skin_preview.hpp"
#include "viewer/picture/field_marks.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/sound/sounding.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// The question about a finger's closed mesh, placed as `now` says. `now` must have a plan and a place for the mesh.
session::SkinQuestion skin_question(const std::string& file, const geometry::Mesh& mesh, const Sounding& now);
/// Puts the answer into the picture. The question must have asked for the rates if `colour` is one of a class.
void show_answer(Picture& picture, const session::SkinQuestion& question, const session::SkinAnswer& answer,
                 SkinColour colour);

class Heat {
 public:
  /// `file`: the finger's closed mesh, which is also loaded in the background. The sound is in `air`.
  Heat(std::string file, const acoustics::Air& air);

  /// Asks again if what is felt has changed since the last question, and puts answers into the picture. Never waits.
  Change look(const Sounding& now, Picture& picture, SkinColour colour = SkinColour::pressure);
  /// Call for another picture: everything must be shown again.
  void forget();
  /// Whether the picture will change by itself.
  bool busy() const { return stale_; }
  /// Why there is no result; else empty.
  const std::string& fault() const { return fault_; }

 private:
  bool is_of(const Sounding& now, SkinColour colour) const;
  Change tell(Picture& picture, Standing standing, SkinColour colour);

  std::string file_;
  std::future<geometry::Mesh> loading_;
  std::optional<geometry::Mesh> mesh_;
  std::string fault_;
  std::optional<session::SkinQuestion> asked_;
  std::uint64_t shown_ = 0;
  SkinColour shown_colour_ = SkinColour::pressure;
  bool stale_ = true;
  session::SkinPreview preview_;
};

}  // namespace palpa::viewer
