#include "driver/emulate/serve.hpp"

#include <optional>

#include "base/files/output_file.hpp"
#include "driver/emulate/live_sound_picture.hpp"
#include "driver/emulate/stop.hpp"
#include "driver/emulate/trace.hpp"

namespace palpa::driver::emulate {

std::vector<Violation> serve(const Options& options, const Emulator& emulator) {
  OpenFile file;
  std::optional<ByteTrace> trace;
  if (!options.trace.empty()) trace.emplace(file = open_trace(options.trace), emulator.wire);
  write_file("-", emulator.address + "\n");

  std::mutex lock;
  std::optional<LiveSoundPicture> view;
  if (options.view) {
    view.emplace(emulator.layout, [&] {
      const std::lock_guard held(lock);
      return emulator.heard();
    });
  }
  std::size_t told = 0;
  emulator.serve(Stop::asked(), lock, [&](std::span<const std::uint8_t> bytes) {
    if (trace && !bytes.empty()) trace->bytes(emulator.now_s() - emulator.begin_s, bytes);
    tell_violations(options, since(emulator.begin_s, emulator.violations()), told);
  });
  if (view) view->end();
  view.reset();
  std::vector<Violation> violations = since(emulator.begin_s, emulator.violations());
  tell_violations(options, violations, told);
  return violations;
}

}  // namespace palpa::driver::emulate
