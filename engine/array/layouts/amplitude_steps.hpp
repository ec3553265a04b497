// The amplitudes that a transducer of a board can play. Between silence and full amplitude there is only a limited
// number of pulse widths, and the smallest of them is the least amplitude that sounds.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace palpa::array {

class AmplitudeSteps {
 public:
  struct Step {
    double level;       ///< amplitude, 0 to 1
    std::uint8_t code;  ///< the number that the board is sent for it
  };
  /// Levels ascend from 0 to 1; at most 256 of them.
  explicit AmplitudeSteps(const std::vector<Step>& steps);

  /// The amplitude of step `number`, from 0 on.
  float level(std::size_t number) const { return levels_[number]; }
  std::uint8_t code(std::size_t number) const { return codes_[number]; }
  /// The least amplitude that sounds.
  float least() const { return levels_[1]; }

  /// The highest step that is not above the amplitude, apart from rounding to a float. NaN and what is below 0 count as
  /// 0, and what is above 1 as 1.
  std::size_t below(float amplitude) const;
  /// The step nearest to the amplitude, at most `most`; the lower one of two that are equally near.
  std::size_t nearest(float amplitude, std::size_t most) const;

 private:
  static constexpr std::size_t entries = 1024;
  std::vector<float> levels_;
  std::vector<std::uint8_t> codes_;
  std::array<std::uint8_t, entries + 1> below_{};  ///< the highest step not above i / entries
};

}  // namespace palpa::array
