// A link for a board that takes two bytes per transducer and slot: amplitude, then phase, in 256 steps each. Copy,
// rename, adapt.
#pragma once

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "session/links/link.hpp"

class ByteLink final : public palpa::session::Link {
 public:
  // Everything that can go wrong goes wrong here, before the loop starts, or throws in send().
  ByteLink(const std::string& file, const palpa::session::LinkSetting& setting)
      : file_(file), port_(std::fopen(file.c_str(), "wb"), &std::fclose) {
    if (!port_) throw palpa::failure(file_ + ": cannot be opened: " + std::strerror(errno));
    frame_.resize(2 * setting.layout.transducers.size());  // send() must not allocate
  }

  // For boards that play a pattern by their own clock; this one plays what it is sent.
  void plan(const palpa::session::PlayedPlan&) override {}

  void send(std::uint64_t, std::span<const palpa::array::TransducerDrive> drive) override {
    std::size_t at = 0;
    for (const auto& [amplitude, phase] : drive) {
      frame_[at++] = static_cast<std::uint8_t>(std::lround(255.0f * amplitude));
      frame_[at++] = phase_step(phase);
    }
    if (std::fwrite(frame_.data(), 1, frame_.size(), port_.get()) != frame_.size()) {
      throw palpa::failure(file_ + ": cannot be written: " + std::strerror(errno));
    }
  }

  void finish() override {
    if (std::fflush(port_.get()) != 0) throw palpa::failure(file_ + ": cannot be written: " + std::strerror(errno));
  }

  // Radians in (-pi, pi] to 1/256 turns in 0..255. Reduced to turns before it is quantized, see docs/conventions.md.
  static std::uint8_t phase_step(float phase) {
    const double turns = phase / (2 * std::numbers::pi);
    return static_cast<std::uint8_t>(static_cast<int>(std::floor(256 * (turns - std::floor(turns)) + 0.5)) % 256);
  }

 private:
  std::string file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> port_;
  std::vector<std::uint8_t> frame_;
};

// How it is called on the command line: --link bytes:/dev/ttyUSB0
inline palpa::session::LinkKind byte_link() {
  return {"bytes", "bytes:FILE  two bytes per transducer and slot",
          [](const std::string& file, const palpa::session::LinkSetting& setting) {
            return std::make_unique<ByteLink>(file, setting);
          }};
}
