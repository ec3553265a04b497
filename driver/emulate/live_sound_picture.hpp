// `palpa emulate --view`: shows what the boards sound on stdout, twice a second.
#pragma once

#include <exception>
#include <functional>
#include <string>
#include <thread>

#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "driver/emulate/sound_picture.hpp"

namespace palpa::driver::emulate {

/// A thread that asks `heard` for what sounds, and prints it if it has changed, as long as this object exists.
class LiveSoundPicture {
 public:
  LiveSoundPicture(const array::Layout& layout, std::function<array::Drive()> heard);
  /// Ends the thread. Throws what the thread failed with if stdout could not be written; it has then already asked for
  /// a Stop.
  void end();

 private:
  void look(const std::stop_token& stop);

  SoundPicture view_;
  std::function<array::Drive()> heard_;
  std::string last_;
  std::exception_ptr fault_;  ///< belongs to the thread until that is joined
  std::jthread thread_;
};

}  // namespace palpa::driver::emulate
