#include "driver/usb/device.hpp"

namespace palpa::driver::usb {

const char* text_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::done:
      return "done";
    case Outcome::stalled:
      return "the device refuses it";
    case Outcome::timed_out:
      return "the device does not answer";
    case Outcome::cancelled:
      return "cancelled";
    case Outcome::gone:
      return "the device is gone";
    case Outcome::failed:
      return "the transfer failed";
  }
  return "unknown";
}

}  // namespace palpa::driver::usb
