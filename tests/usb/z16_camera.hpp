// An emulated depth camera that looks like a D435 on USB: UVC 1.5 with an extension unit, frames of 16-bit depths over
// one bulk endpoint, 848x480 at 90 Hz among others. Tests can inject faults.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "usb/d400_unit.hpp"
#include "usb/gadget.hpp"

namespace palpa::test {

class Z16Camera final : public Gadget {
 public:
  explicit Z16Camera(const std::string& serial);

  /// Depths, row by row. A frame of another size shows the part of them that fits, followed by zeros.
  using Picture = std::vector<std::uint16_t>;
  /// The picture of all frames that begin from now on. The port must be held.
  void show(Picture picture) { picture_ = std::make_shared<const Picture>(std::move(picture)); }

  enum class Fault {
    none,
    frozen,       ///< frames stop
    short_frame,  ///< every frame ends after its upper half
    broken_frame  ///< every frame is marked as broken
  };
  std::atomic<Fault> fault{Fault::none};
  std::atomic<std::uint32_t> period_ns{0};  ///< the period that was requested last; 0: none was
  std::atomic<bool> streams{false};

  D400Unit unit;  ///< the port must be held

  const Descriptors& descriptors() const override { return descriptors_; }
  Answer control(double now_s, const ControlRequest& request, std::vector<std::uint8_t>& bytes) override;
  Answer carry(double now_s, UsbTransfer& transfer) override;
  void advance(double) override {}
  void halt_cleared(std::uint8_t endpoint) override;
  void unplugged(double now_s) override;

 private:
  void begin_stream(double now_s);
  std::size_t frame_bytes() const;

  Descriptors descriptors_;
  std::vector<std::uint8_t> probe_;  ///< the last agreement
  std::shared_ptr<const Picture> picture_ = std::make_shared<const Picture>();
  std::shared_ptr<const Picture> sent_;  ///< the picture of the current frame
  std::size_t at_ = 0;                   ///< bytes of it that have been sent
  double due_s_ = 0;                     ///< when the next frame may begin
  std::uint8_t toggle_ = 0;              ///< changes from frame to frame
};

}  // namespace palpa::test
