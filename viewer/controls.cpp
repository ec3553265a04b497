#include "viewer/controls.hpp"

namespace palpa::viewer {

Reply Controls::handle(const WindowEvent& event, Viewpoint& viewpoint, const Box& home, double width, double height) {
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
      zoom(viewpoint, event.y);
      return Reply::redraw;
    case WindowEvent::Kind::key:
      break;
  }
  switch (event.key) {
    case Key::one:
      look(viewpoint, StandardView::front);
      return Reply::redraw;
    case Key::three:
      look(viewpoint, StandardView::right);
      return Reply::redraw;
    case Key::seven:
      look(viewpoint, StandardView::top);
      return Reply::redraw;
    case Key::five:
      viewpoint.orthographic = !viewpoint.orthographic;
      return Reply::redraw;
    case Key::frame:
      fit(viewpoint, home, width / (height > 0 ? height : 1));
      return Reply::redraw;
    case Key::space:
      return Reply::toggle_pause;
    case Key::quit:
      return Reply::quit;
    case Key::other:
      break;
  }
  return Reply::nothing;
}

}  // namespace palpa::viewer
