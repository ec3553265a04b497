#include <lo/lo.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <type_traits>

#include "session/control/osc_message.hpp"

namespace palpa::session {

namespace {

/// A text of OSC: it ends with a zero byte, and is filled up with more to a length that is a multiple of four.
std::optional<std::string_view> text_at(std::span<const char> bytes, std::size_t at) {
  const std::string_view rest = std::string_view(bytes.data(), bytes.size()).substr(std::min(at, bytes.size()));
  const std::size_t end = rest.find('\0');
  return end == std::string_view::npos ? std::nullopt : std::optional(rest.substr(0, end));
}

/// A message of OSC with types that liblo does not read, such as colours and arrays; palpa takes none of them.
std::optional<OscMessage> without_arguments(std::span<const char> bytes) {
  const std::optional<std::string_view> address = text_at(bytes, 0);
  if (!address) return std::nullopt;
  const std::optional<std::string_view> types = text_at(bytes, (address->size() / 4 + 1) * 4);
  const bool others = types && types->starts_with(',') && types->find_first_of("[]r") != std::string_view::npos &&
                      types->find_first_not_of(",ifsbhtdScrmTFNI[]") == std::string_view::npos;
  return others ? std::optional(OscMessage{.address = *address, .numbers = {}}) : std::nullopt;
}

}  // namespace

void check_osc() {}

std::optional<OscMessage> read_osc_message(std::span<char> bytes) {
  if (bytes.empty() || bytes.front() != '/') return std::nullopt;
  int fault = 0;
  using Message = std::remove_pointer_t<lo_message>;  // void, or a struct from liblo 0.32 on
  const std::unique_ptr<Message, decltype(&lo_message_free)> message(
      lo_message_deserialise(bytes.data(), bytes.size(), &fault), lo_message_free);
  if (!message) return without_arguments(bytes);
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
