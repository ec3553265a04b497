#include "driver/emulate/live_view.hpp"

#include <chrono>
#include <cstdio>
#include <utility>

namespace palpa::driver::emulate {

LiveView::LiveView(const array::Layout& layout, std::function<array::Drive()> heard)
    : view_(layout), heard_(std::move(heard)), thread_([this](const std::stop_token& stop) { look(stop); }) {}

void LiveView::look(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const std::string picture = view_.picture(heard_());
    if (picture == last_) continue;
    last_ = picture;
    std::fwrite(picture.data(), 1, picture.size(), stdout);
    std::fflush(stdout);
  }
}

}  // namespace palpa::driver::emulate
