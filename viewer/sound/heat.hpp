// The pressure on the finger, updated in the background (session/previews/skin_preview.hpp). If the picture does not
// show what sounds now, it says so and is drawn dimmer until the next result is ready.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "geometry/mesh/mesh.hpp"
#include "session/previews/skin_preview.hpp"
#include "viewer/picture/field_marks.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/sound/sounding.hpp"

namespace palpa::viewer {

/// The question about a finger's closed mesh, placed as `now` says. `now` must have a plan and a place for the mesh.
session::SkinQuestion skin_question(const std::string& file, const geometry::Mesh& mesh, const Sounding& now);
/// Puts the answer into the picture.
void show_answer(Picture& picture, const session::SkinQuestion& question, const session::SkinAnswer& answer);

class Heat {
 public:
  /// `file`: the finger's closed mesh, which is also loaded in the background. The sound is in `air`.
  Heat(std::string file, const acoustics::Air& air);

  /// Asks again if what is felt has changed since the last question, and puts answers into the picture. Never waits.
  Change look(const Sounding& now, Picture& picture);
  /// Call for another picture: everything must be shown again.
  void forget();
  /// Whether the picture will change by itself.
  bool busy() const { return stale_; }
  /// Why there is no result; else empty.
  const std::string& fault() const { return fault_; }

 private:
  bool is_of(const Sounding& now) const;
  Change tell(Picture& picture, Standing standing);

  std::string file_;
  std::future<geometry::Mesh> loading_;
  std::optional<geometry::Mesh> mesh_;
  std::string fault_;
  std::optional<session::SkinQuestion> asked_;
  std::uint64_t shown_ = 0;
  bool stale_ = true;
  session::SkinPreview preview_;
};

}  // namespace palpa::viewer
