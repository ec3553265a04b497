// Which USB devices boards are looked for among: those of this machine, and beside them this user's emulators. A guard
// that opens a board goes through here, so this is the one place that decides that it looks for emulators, too: it is
// how `palpa run --link openmpd:EMU1` finds a board that `palpa emulate` plays.
#pragma once

#include <memory>

#include "driver/usb/device.hpp"

namespace palpa::driver::usb {

/// The devices of both, `real` ones first. Where there are emulated ones a problem of `real` is not named: a machine
/// without USB can play to emulators. Opens each with the one of the two that has listed it, see is_emulated().
std::unique_ptr<Transport> with_emulators(std::unique_ptr<Transport> real, std::unique_ptr<Transport> emulated);

/// libusb's devices, and the emulators that listen in the runtime folder (local.hpp).
std::unique_ptr<Transport> system_transport();

}  // namespace palpa::driver::usb
