// The noise in the participant's headphones, so that nobody hears what the array plays. With SDL2; palpa can be built
// without it, and then plays nothing.
#pragma once

#include <memory>
#include <string>

namespace palpa::viewer {

class Masking {
 public:
  /// `kind`: `white`, `off`, or a WAV file, which is repeated. Throws failure() if palpa was built without SDL2 or if
  /// there is no audio device; bad_input for a file that SDL2 does not read. `off` needs neither.
  explicit Masking(const std::string& kind);
  ~Masking();
  Masking(const Masking&) = delete;
  Masking& operator=(const Masking&) = delete;

  /// Begins and ends the sound.
  void play(bool on);
  /// What plays, for the log: "off", or kind and device.
  const std::string& name() const { return name_; }

  /// Whether palpa was built with it.
  static bool available();

 private:
  struct Device;
  std::unique_ptr<Device> device_;
  std::string name_;
};

}  // namespace palpa::viewer
