#include "cli/board_eeprom.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "base/error.hpp"
#include "base/text.hpp"

namespace palpa::cli {

void check_serial(const std::string& serial) {
  constexpr std::size_t most = 16;
  constexpr std::string_view allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  if (serial.empty() || serial.size() > most || serial.find_first_not_of(allowed) != std::string::npos) {
    throw bad_usage(
        fmt::format("--serial {}: give 1 to {} letters, digits, - and _, such as LAB1", printable(serial, 60), most));
  }
}

std::string eeprom_configuration(const std::string& serial, const std::string& file) {
  return fmt::format(
      "# By palpa doctor: for the program ftdi_eeprom, which writes the EEPROM of an OpenMPD board's FT232H.\n"
      "# Plug in only this board, take away other devices with an FT232H, and run\n"
      "#   sudo ftdi_eeprom --read-eeprom {1}      # keeps the old contents in old-{0}.bin\n"
      "#   mv old-{0}.bin saved-{0}.bin            # because the next command writes that file, too\n"
      "#   sudo ftdi_eeprom --flash-eeprom {1}\n"
      "# Then unplug the board and plug it in again. palpa doctor lists it with its new serial number.\n"
      "filename=old-{0}.bin\n"
      "vendor_id=0x0403\n"
      "product_id=0x6014\n"
      "manufacturer=\"FTDI\"\n"
      "product=\"OpenMPD\"\n"
      "serial=\"{0}\"\n"
      "use_serial=true\n"
      "max_power=90\n"
      "self_powered=false\n"
      "remote_wakeup=false\n"
      "cha_type=FIFO      # 245 FIFO, which the board's firmware reads\n"
      "cha_vcp=false      # no serial port\n",
      serial, file);
}

}  // namespace palpa::cli
