// `palpa emulate --view`: twice a second, what the boards sound, on stdout.
#pragma once

#include <exception>
#include <functional>
#include <string>
#include <thread>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "driver/emulate/sound_picture.hpp"

namespace palpa::driver::emulate {

/// A thread of its own that asks `heard` for what sounds, and prints it where it has changed, until this object's end.
class LiveSoundPicture {
 public:
  LiveSoundPicture(const array::Layout& layout, std::function<array::Drive()> heard);
  /// Ends it. Throws what it failed with, where stdout could not be written; a Stop was asked for then.
  void end();

 private:
  void look(const std::stop_token& stop);

  SoundPicture view_;
  std::function<array::Drive()> heard_;
  std::string last_;
  std::exception_ptr fault_;  ///< of its thread, until that is joined
  std::jthread thread_;
};

}  // namespace palpa::driver::emulate
