#include "viewer/options/monitor.hpp"

#include "base/error.hpp"

namespace palpa::viewer {

std::size_t chosen_monitor(const std::vector<std::string>& names, const std::string& wanted) {
  if (wanted.empty()) return names.empty() ? 0 : names.size() - 1;
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string number = std::to_string(i + 1), &name = names[i];
    if (wanted == number || wanted == name || wanted == name.substr(0, name.rfind(' '))) return i;
    if (i > 0) all += ", ";
    all.append(number).append(" (").append(name).append(")");
  }
  throw bad_usage("--monitor: unknown monitor '" + wanted + "'; give one of " + all);
}

}  // namespace palpa::viewer
