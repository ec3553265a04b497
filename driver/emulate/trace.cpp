#include "driver/emulate/trace.hpp"

#include <utility>

#include "driver/emulate/stop.hpp"

namespace palpa::driver::emulate {
namespace {

void put_hex(std::string& out, std::span<const std::uint8_t> bytes) {
  constexpr char digits[] = "0123456789abcdef";
  out.clear();
  for (const std::uint8_t byte : bytes) {
    out += digits[byte >> 4];
    out += digits[byte & 15];
  }
}

}  // namespace

OpenFile open_trace(const std::string& name) {
  return open_output(name, {.stop = &Stop::asked()});
}

void ByteTrace::bytes(double now_s, std::span<const std::uint8_t> bytes) {
  std::string hex;
  put_hex(hex, bytes);
  JsonWriter json;
  json.begin_object(JsonWriter::Style::compact).key("t_s").rounded(now_s, 9).key("kind").value(kind_);
  json.key("hex").value(hex).end_object();
  file_.write(json.take());
}

UsbTrace::UsbTrace(const OpenFile& file, std::string serial) : file_(file), serial_(std::move(serial)) {}

void UsbTrace::begin(double now_s, const char* kind) {
  json_.clear();
  json_.begin_object(JsonWriter::Style::compact).key("t_s").rounded(now_s, 9).key("kind").value(kind);
  if (!serial_.empty()) json_.key("serial").value(serial_);
}

void UsbTrace::end(std::span<const std::uint8_t> bytes) {
  put_hex(hex_, bytes);
  if (!hex_.empty()) json_.key("hex").value(hex_);
  json_.end_object();
  file_.write(json_.finish());
}

void UsbTrace::control(double now_s, const usb::Setup& setup, std::span<const std::uint8_t> in) {
  begin(now_s, "control");
  json_.key("request_type").value(std::uint32_t{setup.request_type});
  json_.key("request").value(std::uint32_t{setup.request});
  json_.key("value").value(std::uint32_t{setup.value});
  json_.key("index").value(std::uint32_t{setup.index});
  end(in);
}

void UsbTrace::bulk(double now_s, std::uint8_t endpoint, std::span<const std::uint8_t> bytes) {
  begin(now_s, "bulk");
  json_.key("endpoint").value(std::uint32_t{endpoint});
  end(bytes);
}

}  // namespace palpa::driver::emulate
