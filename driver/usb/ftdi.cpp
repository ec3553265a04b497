#include "driver/usb/ftdi.hpp"

#include <array>

namespace palpa::driver::usb::ftdi {

const char* text_of(Channel channel) {
  switch (channel) {
    case Channel::uart:
      return "serial (UART)";
    case Channel::fifo:
      return "245 FIFO";
    case Channel::optical:
      return "fast serial";
    case Channel::cpu:
      return "CPU FIFO";
    case Channel::ft1284:
      return "FT1284";
    case Channel::blank:
      return "nothing: it is blank, which means serial (UART)";
  }
  return "an unknown mode";
}

Outcome read_channel(Device& device, Channel& channel) {
  std::array<std::uint8_t, 2> word{};
  std::size_t received = 0;
  const Outcome outcome = device.request({0xc0, read_eeprom, 0, 0}, word, received);
  if (outcome != Outcome::done) return outcome;
  if (received != word.size()) return Outcome::failed;
  channel = static_cast<Channel>(word[0] & 0x0f);
  return Outcome::done;
}

}  // namespace palpa::driver::usb::ftdi
