#include "driver/emulate/live_sound_picture.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include "base/files/output_file.hpp"
#include "driver/emulate/stop.hpp"

namespace palpa::driver::emulate {

LiveSoundPicture::LiveSoundPicture(const array::Layout& layout, std::function<array::Drive()> heard)
    : view_(layout), heard_(std::move(heard)), thread_([this](const std::stop_token& stop) { look(stop); }) {}

void LiveSoundPicture::look(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const std::string picture = view_.picture(heard_());
    if (picture == last_) continue;
    last_ = picture;
    try {
      write_file("-", picture);
    } catch (...) {
      fault_ = std::current_exception();
      Stop::ask();
      return;
    }
  }
}

void LiveSoundPicture::end() {
  thread_.request_stop();
  thread_.join();
  if (fault_) std::rethrow_exception(fault_);
}

}  // namespace palpa::driver::emulate
