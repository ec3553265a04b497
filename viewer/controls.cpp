#include "viewer/controls.hpp"

namespace palpa::viewer {

Reply Controls::handle(const Event& event, Camera& camera, const Box& home, double width, double height) {
  switch (event.kind) {
    case Event::Kind::damage:
      return Reply::redraw;
    case Event::Kind::press:
      if (event.button == Button::right) return Reply::nothing;
      drag_ = event.button == Button::middle || event.shift ? Drag::pan : Drag::orbit;
      x_ = event.x;
      y_ = event.y;
      return Reply::nothing;
    case Event::Kind::release:
      drag_ = Drag::none;
      return Reply::nothing;
    case Event::Kind::move: {
      const double dx = event.x - x_, dy = event.y - y_;
      x_ = event.x;
      y_ = event.y;
      if (drag_ == Drag::none || (dx == 0 && dy == 0)) return Reply::nothing;
      drag_ == Drag::orbit ? orbit(camera, dx, dy, height) : pan(camera, dx, dy, height);
      return Reply::redraw;
    }
    case Event::Kind::scroll:
      zoom(camera, event.y);
      return Reply::redraw;
    case Event::Kind::key:
      break;
  }
  switch (event.key) {
    case Key::one:
      look(camera, StandardView::front);
      return Reply::redraw;
    case Key::three:
      look(camera, StandardView::right);
      return Reply::redraw;
    case Key::seven:
      look(camera, StandardView::top);
      return Reply::redraw;
    case Key::five:
      camera.orthographic = !camera.orthographic;
      return Reply::redraw;
    case Key::frame:
      frame(camera, home, width / (height > 0 ? height : 1));
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
