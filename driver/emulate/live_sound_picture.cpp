#include "driver/emulate/live_sound_picture.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "base/files/output_file.hpp"
#include "base/math.hpp"
#include "driver/emulate/stop.hpp"
#include "session/links/hand_over.hpp"

namespace palpa::driver::emulate {
namespace {

constexpr double margin = 20e-3;  ///< nearer to transducers it is loud, but no finger is there
constexpr double reach = 250e-3;  ///< above boards that face nothing
constexpr double coarse = 6e-3;   ///< a focus is 8 mm wide

std::vector<Vec3> grid(const Vec3& low, const Vec3& high, double step) {
  std::vector<Vec3> points;
  for (double z = low.z; z <= high.z + 1e-9; z += step) {
    for (double y = low.y; y <= high.y + 1e-9; y += step) {
      for (double x = low.x; x <= high.x + 1e-9; x += step)
        points.emplace_back(x, y, z);
    }
  }
  return points;
}

}  // namespace

SoundPicture::SoundPicture(const array::Layout& layout)
    : incident_(layout, acoustics::air_of({}, layout.frequency_hz), array::Directivity::t4010a1) {
  Box box;
  for (const array::Transducer& transducer : layout.transducers)
    box.add(transducer.position);
  const bool facing = box.high.z - box.low.z > 3 * margin;
  low_ = box.low + Vec3(0, 0, margin);
  high_ = facing ? box.high - Vec3(0, 0, margin) : Vec3(box.high.x, box.high.y, box.high.z + reach);
}

std::vector<double> SoundPicture::pressures(std::span<const Vec3> points,
                                            std::span<const array::TransducerDrive> drive) const {
  acoustics::Waves waves;
  incident_.at(points, {}, acoustics::strengths_of(drive), waves);
  std::vector<double> out(points.size());
  std::transform(waves.pressures.begin(), waves.pressures.end(), out.begin(),
                 [](const std::complex<double>& p) { return std::abs(p); });
  return out;
}

Loudest SoundPicture::loudest(std::span<const array::TransducerDrive> drive) const {
  Loudest found;
  if (!session::sounds(drive)) return found;
  Vec3 low = low_, high = high_;
  for (double step = coarse; step > 4e-5; step /= 5) {
    const std::vector<Vec3> points = grid(low, high, step);
    const std::vector<double> loud = pressures(points, drive);
    const auto most = std::max_element(loud.begin(), loud.end());
    found = {points[static_cast<std::size_t>(most - loud.begin())], *most};
    low = found.place - Vec3(step);
    high = found.place + Vec3(step);
  }
  return found;
}

std::string SoundPicture::picture(std::span<const array::TransducerDrive> drive) const {
  const Loudest most = loudest(drive);
  if (most.pascals == 0) return "silence\n";
  constexpr int columns = 61, rows = 21;
  constexpr double width = 120e-3, height = 80e-3;
  constexpr std::string_view shades = " .:-=+*#%@";
  std::string text = fmt::format("{:.0f} Pa at {:.1f}, {:.1f}, {:.1f} mm\n", most.pascals, 1e3 * most.place.x,
                                 1e3 * most.place.y, 1e3 * most.place.z);
  std::vector<Vec3> points;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      points.push_back(most.place +
                       Vec3(width * (column / double{columns - 1} - 0.5), 0, height * (0.5 - row / double{rows - 1})));
    }
  }
  const std::vector<double> loud = pressures(points, drive);
  for (std::size_t i = 0; i < loud.size(); ++i) {
    const double share = std::min(loud[i] / most.pascals, 1.0);
    text += shades[static_cast<std::size_t>(std::lround(share * static_cast<double>(shades.size() - 1)))];
    if (i % columns == columns - 1) text += '\n';
  }
  return text;
}

LiveSoundPicture::LiveSoundPicture(const array::Layout& layout, std::function<array::Drive()> heard)
    : view_(layout), heard_(std::move(heard)), thread_([this](const std::stop_token& stop) { look(stop); }) {}

void LiveSoundPicture::look(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const std::string picture = view_.picture(heard_());
    if (picture == last_) continue;
    last_ = picture;
    try {
      write_file("-", picture);
    } catch (...) {
      fault_ = std::current_exception();
      Stop::ask();
      return;
    }
  }
}

void LiveSoundPicture::end() {
  thread_.request_stop();
  thread_.join();
  if (fault_) std::rethrow_exception(fault_);
}

}  // namespace palpa::driver::emulate
