// The data that a board was sent, as a file of JSON lines (docs/boards.md), one per transfer. The line of a transfer is
// in the file before the next transfer begins.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "driver/usb/local_server.hpp"

namespace palpa::driver::emulate {

/// Replaces the file, to which several boards may write; "-" is stdout. Throws failure() that names it.
OpenFile open_trace(const std::string& name);

/// A line that has only bytes. `kind` is "tcp" or "serial".
class ByteTrace {
 public:
  ByteTrace(const OpenFile& file, const char* kind) : file_(file), kind_(kind) {}
  void bytes(double now_s, std::span<const std::uint8_t> bytes);

 private:
  const OpenFile& file_;
  const char* kind_;
};

/// One board's USB. If `serial` is not empty, each line has it, because several boards are in that file.
class UsbTrace final : public usb::Wiretap {
 public:
  UsbTrace(const OpenFile& file, std::string serial);
  void control(double now_s, const usb::Setup& setup, std::span<const std::uint8_t> in) override;
  void bulk(double now_s, std::uint8_t endpoint, std::span<const std::uint8_t> bytes) override;

 private:
  void begin(double now_s, const char* kind);
  void end(std::span<const std::uint8_t> bytes);

  const OpenFile& file_;
  std::string serial_, hex_;
  JsonWriter json_;
};

}  // namespace palpa::driver::emulate
