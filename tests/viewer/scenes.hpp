// Small scenes whose pictures can be predicted.
#pragma once

#include "support/shapes.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/view/viewpoint.hpp"

namespace palpa::test {

/// A view without grid and legend: a picture of nothing is then background.
inline viewer::ViewState bare_view() {
  viewer::ViewState state;
  state.layers.hide({viewer::Layer::grid, viewer::Layer::legend});
  return state;
}

inline viewer::Picture cube_picture() {
  viewer::Picture picture;
  picture.solids.push_back({"cube", box({-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02})});
  return picture;
}

/// From the front, 0.2 m in front of the origin.
inline viewer::Viewpoint front_viewpoint() {
  viewer::Viewpoint viewpoint;
  viewpoint.azimuth = 0;
  viewpoint.elevation = 0;
  viewpoint.distance = 0.2;
  return viewpoint;
}

}  // namespace palpa::test
