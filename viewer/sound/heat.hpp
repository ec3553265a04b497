// The pressure on the finger, kept up to date beside whoever draws it (session/previews/skin_preview.hpp): a picture
// that is not of what sounds now says so, and is drawn dimmer until the next is there.
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

/// What is asked of a finger's closed mesh, which stands where `now` says. `now` has a plan and a place for it.
session::SkinQuestion skin_question(const std::string& file, const geometry::Mesh& mesh, const Sounding& now);
/// Puts the answer into the picture.
void show_answer(Picture& picture, const session::SkinQuestion& question, const session::SkinAnswer& answer);

class Heat {
 public:
  /// `file`: the finger's closed mesh, loaded beside, too, for sound in `air`.
  Heat(std::string file, const acoustics::Air& air);

  /// Asks where something else is felt than was asked last, and puts into the picture what has been answered. Waits
  /// for nothing.
  Change look(const Sounding& now, Picture& picture);
  /// The picture is another: all of it is to be shown again.
  void forget();
  /// Whether the picture will change by itself.
  bool busy() const { return stale_; }
  /// Why there is nothing; else empty.
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
