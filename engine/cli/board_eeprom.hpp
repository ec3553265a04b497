// `palpa doctor --write-eeprom`: the configuration with which the program ftdi_eeprom sets up the FT232H of an OpenMPD
// board. palpa itself never writes to a device's EEPROM.
#pragma once

#include <string>

namespace palpa::cli {

/// Throws bad_usage, naming --serial, for a serial number that is empty, longer than 16 characters, or has anything but
/// letters, digits, - and _, which the names of links need.
void check_serial(const std::string& serial);

/// The text of the configuration file. `file`: the name under which it will be written.
std::string eeprom_configuration(const std::string& serial, const std::string& file);

}  // namespace palpa::cli
