// The USB devices among which boards are looked for: those of this machine, and this user's emulators. Guards open
// their boards through this header, so it is the only place that decides to look for emulators, too. This is how
// `palpa run --link openmpd:EMU1` finds a board that `palpa emulate` plays.
#pragma once

#include <memory>

#include "driver/usb/device.hpp"

namespace palpa::driver::usb {

/// The devices of both, `real` ones first. If there are emulated ones, a problem of `real` is not named, because a
/// machine without USB can play to emulators. Opens each device with the transport that has listed it, see
/// is_emulated().
std::unique_ptr<Transport> with_emulators(std::unique_ptr<Transport> real, std::unique_ptr<Transport> emulated);

/// libusb's devices, and the emulators that listen in the runtime folder (local.hpp).
std::unique_ptr<Transport> system_transport();

}  // namespace palpa::driver::usb
