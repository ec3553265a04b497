#include "viewer/window/participant_window.hpp"

#include <algorithm>
#include <cstddef>

namespace palpa::viewer {

ParticipantWindow::ParticipantWindow(const gpu::Device& device, std::size_t monitor)
    : device_(&device),
      window_(monitor, "palpa participant"),
      surface_(device, window_),
      drawn_(device),
      presenter_(device, surface_.get()) {}

void ParticipantWindow::take(std::vector<WindowEvent>& events) {
  const std::size_t before = events.size();
  window_.take(events);
  const bool damaged = std::any_of(events.begin() + static_cast<std::ptrdiff_t>(before), events.end(),
                                   [](const WindowEvent& event) { return event.kind == WindowEvent::Kind::damage; });
  if (damaged) shown_.reset();  // the old picture is lost
}

Size ParticipantWindow::show(const App& app) {
  const PanelData::ParticipantWindowState& view = app.data().participant;
  const VkExtent2D whole = window_.size();
  const Size filled{whole.width, whole.height};
  if (whole.width < 2 || whole.height < 2 || !view.setting) return filled;
  const Shown now{app.surfaces_version(), *view.setting,          view.hidden,
                  app.data().state.dark,  view.says_how_to_leave, filled};
  if (shown_ == now) return filled;
  ViewState state = for_participant(app.data().state);
  if (view.hidden) state.layers.hide({Layer::solids, Layer::edges});
  drawn_.update(app.picture(), state);  // nothing is in flight, because the eyes' pictures are waited for
  const EyeSize size = eye_size(now.participant.stereo, whole.width, whole.height);
  if (!eye_ || eye_->width() != size.width || eye_->height() != size.height)
    eye_.emplace(*device_, size.width, size.height);
  const Box objects = extent(app.picture(), Extent::objects, state);
  drawing::Pixels picture = draw(now.participant, objects, whole.width, whole.height, *eye_, drawn_);
  if (view.says_how_to_leave) write_line(picture, "P or Escape closes this window, Q quits", window_.pixel_ratio());
  if (presenter_.draw(picture)) shown_ = now;
  return filled;
}

}  // namespace palpa::viewer
