#include "base/text.hpp"

namespace palpa {

std::string printable(std::string_view text, std::size_t most, char instead) {
  std::size_t length = text.size() < most ? text.size() : most;
  while (length < text.size() && length > 0 && (static_cast<unsigned char>(text[length]) & 0xc0) == 0x80)
    --length;
  std::string shown(text.substr(0, length));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = instead;
  }
  if (length < text.size()) shown += "...";
  return shown;
}

std::string one_line(std::string_view message, std::size_t most) {
  const std::size_t last = message.find_last_not_of(" .\t\r\n");
  return printable(message.substr(0, last == std::string_view::npos ? 0 : last + 1), most, ' ');
}

}  // namespace palpa
