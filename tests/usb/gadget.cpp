#include "usb/gadget.hpp"

#include <algorithm>

namespace palpa::test {
namespace {

enum Standard : std::uint8_t {
  get_status = 0,
  clear_feature = 1,
  set_feature = 3,
  get_descriptor = 6,
  get_configuration = 8,
  set_configuration = 9,
  set_interface = 11,
};

std::vector<std::uint8_t> string_descriptor(const Descriptors& descriptors, unsigned number) {
  if (number == 0) return {4, 3, 0x09, 0x04};  // the languages: English
  if (number > descriptors.strings.size()) return {};
  const std::string& text = descriptors.strings[number - 1];
  std::vector<std::uint8_t> out{static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
  for (const char letter : text) {
    out.push_back(static_cast<std::uint8_t>(letter));
    out.push_back(0);
  }
  return out;
}

}  // namespace

Answer standard_request(Gadget& gadget, const ControlRequest& request, std::vector<std::uint8_t>& bytes) {
  const Descriptors& descriptors = gadget.descriptors();
  std::vector<std::uint8_t> reply;
  switch (request.request) {
    case get_status:
      reply = {0, 0};
      break;
    case get_configuration:
      reply = {1};
      break;
    case get_descriptor:
      if (request.value >> 8 == 1) reply = descriptors.device;
      if (request.value >> 8 == 2) reply = descriptors.configuration;
      if (request.value >> 8 == 3) reply = string_descriptor(descriptors, request.value & 0xff);
      if (reply.empty()) return Answer::stalled;
      break;
    case clear_feature:
      if (request.type == 0x02 && request.value == 0) gadget.halt_cleared(low(request.index));
      break;
    case set_feature:
    case set_configuration:
    case set_interface:
      break;
    default:
      return Answer::stalled;
  }
  if (request.to_host()) {
    reply.resize(std::min<std::size_t>(reply.size(), request.length));
    bytes = reply;
  }
  return Answer::done;
}

}  // namespace palpa::test
