#include <lo/lo.h>

#include <memory>
#include <string_view>
#include <type_traits>

#include "session/control/osc_message.hpp"

namespace palpa::session {

void check_osc() {}

std::optional<OscMessage> read_osc_message(std::span<char> bytes) {
  if (bytes.empty() || bytes.front() != '/') return std::nullopt;
  int fault = 0;
  using Message = std::remove_pointer_t<lo_message>;  // void, or a struct from liblo 0.32 on
  const std::unique_ptr<Message, decltype(&lo_message_free)> message(
      lo_message_deserialise(bytes.data(), bytes.size(), &fault), lo_message_free);
  if (!message) return std::nullopt;
  const std::string_view types = lo_message_get_types(message.get());
  lo_arg** const arguments = lo_message_get_argv(message.get());
  OscMessage read{.address = bytes.data(), .numbers = {}};  // liblo has found its end
  if (types.size() > OscMessage::most) return read;
  std::array<double, OscMessage::most> numbers{};
  for (const char letter : types) {
    const auto type = static_cast<lo_type>(letter);
    if (lo_is_numerical_type(type) != 0) {
      numbers[read.count] = static_cast<double>(lo_hires_val(type, arguments[read.count]));
    } else if (type == LO_TRUE || type == LO_FALSE) {
      numbers[read.count] = type == LO_TRUE ? 1 : 0;
    } else {
      return read;
    }
    ++read.count;
  }
  read.numbers = numbers;
  return read;
}

}  // namespace palpa::session
