// The parts of a picture that are lines and flat faces in the world: grid, boards, camera frusta, cross-sections.
#pragma once

#include <vector>

#include "shaders/viewer/view_scene.h"
#include "viewer/picture/picture.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

struct WorldMarks {
  std::vector<shader::ViewStroke> lines;     ///< coordinates in the world
  std::vector<shader::ViewVertex> boards;    ///< faces in the theme's colour of boards
  std::vector<shader::ViewVertex> sections;  ///< faces in their fingers' colours
  std::vector<shader::ViewVertex> tile;      ///< of the marker, in its colour
};

/// Replaces `marks` by those of the layers that are shown. `floor`: the grid lies on its underside.
void build_marks(const Picture& picture, const ViewState& state, const Box& floor, WorldMarks& marks);

}  // namespace palpa::viewer
