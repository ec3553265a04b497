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

void ParticipantWindow::show(const App& app) {
  const Desk::ParticipantWindowState& view = app.desk().participant;
  const VkExtent2D whole = window_.size();
  if (whole.width < 2 || whole.height < 2 || !view.setting) return;
  const Shown now{
      app.surfaces_version(), *view.setting, view.hidden, app.desk().state.dark, {whole.width, whole.height}};
  if (shown_ == now) return;
  ViewState state = for_participant(app.desk().state);
  if (view.hidden) state.layers.hide({Layer::solids, Layer::edges});
  drawn_.update(app.picture(), state);  // nothing is in flight, because the eyes' pictures are waited for
  const EyeSize size = eye_size(now.participant.stereo, whole.width, whole.height);
  if (!eye_ || eye_->width() != size.width || eye_->height() != size.height)
    eye_.emplace(*device_, size.width, size.height);
  const Box objects = extent(app.picture(), Extent::objects, state);
  if (presenter_.draw(draw(now.participant, objects, whole.width, whole.height, *eye_, drawn_))) shown_ = now;
}

}  // namespace palpa::viewer
