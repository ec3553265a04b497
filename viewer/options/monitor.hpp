// Which monitor --monitor names.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpa::viewer {

/// The index of the monitor `wanted`: its number from 1, its name with or without its size, or "" for the last. `names`
/// are "NAME WxH". 0 without monitors. Throws bad_usage, which lists the monitors, for another name.
std::size_t chosen_monitor(const std::vector<std::string>& names, const std::string& wanted);

}  // namespace palpa::viewer
