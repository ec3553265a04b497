#include "usb/ft232h_gadget.hpp"

#include <algorithm>
#include <span>

#include "driver/usb/ftdi.hpp"

namespace palpa::test {

namespace ftdi = driver::usb::ftdi;
using driver::usb::Outcome;

Ft232hGadget::Ft232hGadget(driver::usb::Peripheral& peripheral) : peripheral_(peripheral) {
  const auto& identity = peripheral.identity();
  // The descriptors of a real FT232H module: one interface of the vendor's class, two bulk endpoints, 90 mA.
  descriptors_.device = {18, 1, 0x00, 0x02, 0, 0, 0, 64};
  for (const unsigned id : {identity.vendor, identity.product, identity.release})
    append(descriptors_.device, {low(id), high(id)});
  append(descriptors_.device, {1, 2, 3, 1});
  descriptors_.configuration = {9, 2, 32, 0, 1, 1, 0, 0xa0, 45};
  append(descriptors_.configuration, {9, 4, 0, 0, 2, 0xff, 0xff, 0xff, 2});
  for (const std::uint8_t endpoint : {ftdi::endpoint_in, ftdi::endpoint_out})
    append(descriptors_.configuration, {7, 5, endpoint, 2, 0x00, 0x02, 0});
  descriptors_.strings = {"FTDI", "UM232H", identity.serial};
}

Answer Ft232hGadget::control(double now_s, const ControlRequest& request, std::vector<std::uint8_t>& bytes) {
  // The kernel's own driver reads the chip's latency and sets 16 ms. A board never gets this request.
  constexpr std::uint8_t get_latency = 10, usual_latency_ms = 16;
  if (request.request == get_latency) {
    bytes = {usual_latency_ms};
    return Answer::done;
  }
  if (request.request == ftdi::set_latency && request.value == usual_latency_ms) return Answer::done;
  ++requests;
  std::size_t filled = 0;
  const Outcome outcome = peripheral_.control(now_s, {request.type, request.request, request.value, request.index},
                                              request.to_host() ? std::span(bytes) : std::span<std::uint8_t>(), filled);
  if (request.to_host()) bytes.resize(filled);
  return outcome == Outcome::done ? Answer::done : Answer::stalled;
}

Answer Ft232hGadget::carry(double now_s, UsbTransfer& transfer) {
  if (transfer.endpoint == ftdi::endpoint_in) return Answer::later;  // a board never writes back
  if (stalls) return Answer::stalled;
  if (takes_nothing) return Answer::later;
  std::span<const std::uint8_t> rest = std::span<const std::uint8_t>(transfer.bytes).subspan(transfer.done);
  rest = rest.first(std::min<std::size_t>(rest.size(), unplug_after));
  const std::size_t taken = peripheral_.bulk_out(now_s, transfer.endpoint, rest);
  transfer.done += taken;
  bytes_taken += taken;
  if (unplug_after != never) {
    unplug_after -= taken;
    if (unplug_after == 0) {
      unplug_after = never;
      return Answer::unplugged;
    }
  }
  return transfer.done == transfer.bytes.size() ? Answer::done : Answer::later;
}

void Ft232hGadget::halt_cleared(std::uint8_t endpoint) {
  if (endpoint == ftdi::endpoint_out) stalls = false;
}

}  // namespace palpa::test
