#include "viewer/hands/controls.hpp"

#include <numbers>

namespace palpa::viewer {
namespace {

/// Looks from the other side.
void look_back(Viewpoint& viewpoint) {
  if (viewpoint.elevation != 0) {
    viewpoint.elevation = -viewpoint.elevation;
  } else {
    viewpoint.azimuth += std::numbers::pi;
  }
}

}  // namespace

void zoom_at(Viewpoint& viewpoint, double steps, double x, double y, double width, double height) {
  const Projected target = project(projection(viewpoint, width, height), viewpoint.target);
  const Basis b = basis(viewpoint);
  const double scale = metres_per_pixel(viewpoint, height);
  const Vec3 under = viewpoint.target + (b.right * (x - target.x) - b.up * (y - target.y)) * scale;
  const double before = viewpoint.distance;
  zoom(viewpoint, steps);
  viewpoint.target = under + (viewpoint.target - under) * (viewpoint.distance / before);
}

Reply Controls::handle(const WindowEvent& event, Viewpoint& viewpoint, const Box& home, double width, double height) {
  if (!(width > 0 && height > 0)) return Reply::nothing;
  switch (event.kind) {
    case WindowEvent::Kind::damage:
      return Reply::redraw;
    case WindowEvent::Kind::press:
      if (event.button == Button::right) return Reply::nothing;
      drag_ = event.button == Button::middle || event.shift ? Drag::pan : Drag::orbit;
      x_ = event.x;
      y_ = event.y;
      return Reply::nothing;
    case WindowEvent::Kind::release:
      drag_ = Drag::none;
      return Reply::nothing;
    case WindowEvent::Kind::move: {
      const double dx = event.x - x_, dy = event.y - y_;
      x_ = event.x;
      y_ = event.y;
      if (drag_ == Drag::none || (dx == 0 && dy == 0)) return Reply::nothing;
      drag_ == Drag::orbit ? orbit(viewpoint, dx, dy, height) : pan(viewpoint, dx, dy, height);
      return Reply::redraw;
    }
    case WindowEvent::Kind::scroll:
      zoom_at(viewpoint, event.steps, event.x, event.y, width, height);
      return Reply::redraw;
    case WindowEvent::Kind::key:
      return event.down ? key(event, viewpoint, home, width / height) : Reply::nothing;
    case WindowEvent::Kind::text:
    case WindowEvent::Kind::drop:
      break;
  }
  return Reply::nothing;
}

Reply Controls::key(const WindowEvent& event, Viewpoint& viewpoint, const Box& home, double aspect) {
  const auto turn = [&](StandardView view) {
    look(viewpoint, view);
    if (event.ctrl) look_back(viewpoint);
    return Reply::redraw;
  };
  switch (static_cast<char>(event.key)) {
    case '1':
      return turn(StandardView::front);
    case '3':
      return turn(StandardView::right);
    case '7':
      return turn(StandardView::top);
    case '9':
      return turn(StandardView::iso);
    case '5':
      viewpoint.orthographic = !viewpoint.orthographic;
      return Reply::redraw;
    case 'f':
      fit(viewpoint, home, aspect);
      return Reply::redraw;
    default:
      return Reply::nothing;
  }
}

}  // namespace palpa::viewer
