// OpenMPD boards of which everything differs, in every order, and boards that come back: each plays its part of the
// drive with its own file, and one that was away is as a new one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/board_play.hpp"
#include "array/layouts/board_types.hpp"
#include "driver/openmpd/openmpd_files.hpp"
#include "driver/openmpd/openmpd_rig.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
constexpr float pi = std::numbers::pi_v<float>;
constexpr std::size_t count = openmpd::transducers;

/// Files of boards A, B and C, with unlike offsets and factors.
std::map<std::string, openmpd::Calibration> calibrations(const std::filesystem::path& folder) {
  std::map<std::string, openmpd::Calibration> all;
  for (const std::string serial : {"A", "B", "C"}) {
    openmpd::Calibration& one = all[serial] = made_up_calibration(static_cast<std::uint32_t>(serial[0]));
    for (std::size_t t = 0; t < count; ++t)
      one.factors[t] = 0.4f + 0.1f * static_cast<float>((t * 7 + static_cast<std::size_t>(serial[0])) % 7);
    write_text(folder / ("board_" + serial + ".pat"), board_file_text(serial, one));
  }
  return all;
}

/// Three boards of a layout, by serial number; it is theirs in this order.
struct ThreeBoards : OpenMpdRig {
  ThreeBoards(const std::string& order, const std::string& folder, bool with_steps = false, double ramp = 0)
      : OpenMpdRig({"A", "B"}) {
    emulators.push_back(std::make_unique<openmpd::EmulatedBoard>("C"));
    faults.push_back(&bus.plug(*emulators.back()));
    argument = {order[0], ',', order[1], ',', order[2]};
    files = folder;
    steps = with_steps;
    ramp_s = ramp;
    layout.transducers.resize(3 * count);
    layout.boards.resize(3, {"openmpd", 2 * count, count, 0.168, 0.168});
    open();
  }
  openmpd::Fpga& of(char serial) { return fpga(static_cast<std::size_t>(serial - 'A')); }
};

/// An unlike part for each board.
array::Drive parts_of(const std::string& order) {
  array::Drive drive;
  for (const char serial : order) {
    std::minstd_rand random(static_cast<unsigned>(serial));
    std::uniform_real_distribution<float> amplitudes(0, 1), phases(-pi, pi);
    for (std::size_t t = 0; t < count; ++t)
      drive.push_back({amplitudes(random), phases(random)});
  }
  return drive;
}

TEST(OpenMpdSeveral, EachBoardPlaysItsPartWithItsOwnFileInEveryOrder) {
  const auto folder = scratch_folder("openmpd-several");
  const auto files = calibrations(folder);
  std::string order = "ABC";
  do {
    ThreeBoards rig(order, folder);
    const array::Drive drive = parts_of(order);
    rig.play(drive, rig.slot_s);
    const std::vector<float> factors =
        openmpd::factors_of({.argument = rig.argument, .files = rig.files, .layout = rig.layout});
    ASSERT_EQ(factors.size(), drive.size());
    for (std::size_t board = 0; board < 3; ++board) {
      const openmpd::Calibration& own = files.at(std::string(1, order[board]));
      const array::Drive heard = openmpd::heard_drive(rig.of(order[board]).pulses(), own);
      for (std::size_t t = 0; t < count; ++t) {
        const auto& [amplitude, phase] = drive[board * count + t];
        ASSERT_FLOAT_EQ(factors[board * count + t], own.factors[t]) << order << board;
        ASSERT_NEAR(heard[t].amplitude, amplitude - pi / 256, pi / 256 + 1e-6f) << order << board << ' ' << t;
        const float turns = (heard[t].phase - phase) / (2 * pi);
        ASSERT_TRUE(heard[t].amplitude == 0 || std::abs(turns - std::round(turns)) <= 1.01f / 256) << order << board;
      }
    }
    EXPECT_EQ(rig.violations(), "");
  } while (std::ranges::next_permutation(order).found);
}

/// With steps between drives, each board shows the frames that it shows alone.
TEST(OpenMpdSeveral, EachBoardIsShownTheFramesThatItIsShownAlone) {
  const auto folder = scratch_folder("openmpd-frames");
  calibrations(folder);
  const auto shown_by = [](OpenMpdRig& rig, openmpd::Fpga& fpga, const array::Drive& one, const array::Drive& other) {
    std::vector<openmpd::Pulses> frames;
    rig.play(one, rig.slot_s);
    fpga.on_shown([&](double, const openmpd::Pulses& pulses) { frames.push_back(pulses); });
    rig.play(other, 2 * rig.slot_s);
    fpga.on_shown([](double, const openmpd::Pulses&) {});
    return frames;
  };
  for (const std::string order : {"ABC", "CAB"}) {
    for (std::size_t board = 0; board < 3; ++board) {
      const array::Drive one = parts_of(order), other = parts_of("BCA");
      ThreeBoards rig(order, folder, true);
      const auto frames = shown_by(rig, rig.of(order[board]), one, other);
      OpenMpdRig alone({std::string(1, order[board])});
      alone.files = folder;
      alone.steps = true;
      alone.open();
      const auto part = [&](const array::Drive& drive) {
        const auto first = drive.begin() + static_cast<std::ptrdiff_t>(board * count);
        return array::Drive(first, first + count);
      };
      EXPECT_GT(frames.size(), 5u);
      EXPECT_EQ(frames, shown_by(alone, alone.fpga(0), part(one), part(other))) << order << board;
    }
  }
}

/// What sounds, and how: the frames of the next slots, and the divider, of every board.
std::string state_of(ThreeBoards& rig, const array::Drive& one, const array::Drive& other) {
  std::string text;
  std::vector<std::string> frames(3);
  for (std::size_t board = 0; board < 3; ++board) {
    rig.fpga(board).on_shown([&, board](double, const openmpd::Pulses& pulses) {
      for (const auto& [phase, width] : pulses)
        frames[board] += std::to_string(phase) + "/" + std::to_string(width) + " ";
    });
  }
  for (int i = 0; i < 2; ++i) {
    rig.play(one, 2 * rig.slot_s);
    rig.play(other, 2 * rig.slot_s);
  }
  for (std::size_t board = 0; board < 3; ++board) {
    rig.fpga(board).on_shown([](double, const openmpd::Pulses&) {});
    text += std::to_string(std::hash<std::string>{}(frames[board])) + " divider " +
            std::to_string(rig.fpga(board).divider()) + "\n";
  }
  return text;
}

TEST(OpenMpdSeveral, ABoardThatWasAwayIsAsANewOne) {
  const auto folder = scratch_folder("openmpd-back");
  calibrations(folder);
  const array::Drive one = parts_of("ABC"), other = parts_of("BCA");
  for (const auto& [steps, ramp_s] : {std::pair{false, 0.0}, {true, 0.0}, {false, 4e-3}}) {
    ThreeBoards fresh("ABC", folder, steps, ramp_s);
    fresh.play(one, 0.5);
    const std::string wanted = state_of(fresh, one, other);
    for (const std::size_t away : {0u, 2u}) {
      ThreeBoards rig("ABC", folder, steps, ramp_s);
      rig.play(other, 0.05);
      rig.faults[away]->unplug_after = 700;
      rig.play(other, 0.2);
      // It comes back without what it had.
      rig.faults[away]->unplugged = true;
      const auto before = std::move(rig.emulators[away]);
      rig.emulators[away] = std::make_unique<openmpd::EmulatedBoard>(std::string(1, static_cast<char>('A' + away)));
      rig.bus.plug(*rig.emulators[away]);
      rig.play(one, 2.2);
      EXPECT_TRUE(rig.board->in_step());
      EXPECT_EQ(state_of(rig, one, other), wanted) << away << steps << ramp_s;
    }
  }
}

/// Boards of several types play their parts as alone, in every order. The least amplitude is the least of theirs.
TEST(BoardPlaySeveral, EachTypeOfBoardPlaysItsPartAsAlone) {
  std::vector<std::string> order;
  for (const array::BoardType& type : array::board_types())
    order.emplace_back(type.name);
  std::minstd_rand random(1);
  std::uniform_real_distribution<float> amplitudes(0, 1);
  std::map<std::string, array::Drive> parts;
  std::map<std::string, std::vector<float>> factors;
  for (const std::string& name : order) {
    const std::size_t transducers = array::load_layout(name).transducers.size();
    for (std::size_t t = 0; t < transducers; ++t) {
      parts[name].push_back({amplitudes(random), 0});
      factors[name].push_back(0.5f + amplitudes(random) / 2);
    }
    parts[name][0].amplitude = 1;  // the loudest is the same in each
  }
  for (const bool calibrated : {false, true}) {
    std::map<std::string, array::Drive> rounded;
    double least = 1;
    for (const auto& [name, part] : parts) {
      array::Layout alone = array::load_layout(name);
      if (calibrated) alone.factors = factors[name];
      const array::BoardPlay play(alone);
      rounded[name] = part;
      play.round(rounded[name], 0.7);
      least = std::min(least, play.least());
    }
    do {
      array::Layout layout;
      array::Drive drive, wanted;
      for (const std::string& name : order) {
        const array::Layout alone = array::load_layout(name);
        array::Board board = alone.boards[0];
        board.first = static_cast<std::uint32_t>(layout.transducers.size());
        layout.boards.push_back(board);
        layout.transducers.insert(layout.transducers.end(), alone.transducers.begin(), alone.transducers.end());
        if (calibrated) layout.factors.insert(layout.factors.end(), factors[name].begin(), factors[name].end());
        drive.insert(drive.end(), parts[name].begin(), parts[name].end());
        wanted.insert(wanted.end(), rounded[name].begin(), rounded[name].end());
      }
      const array::BoardPlay play(layout);
      EXPECT_EQ(play.least(), least);
      std::vector<float> played(drive.size());
      play.play(drive, 1, 0.7, played);
      play.round(drive, 0.7);
      for (std::size_t t = 0; t < drive.size(); ++t) {
        ASSERT_EQ(drive[t].amplitude, wanted[t].amplitude) << t;
        ASSERT_EQ(played[t], wanted[t].amplitude) << t;
      }
    } while (std::ranges::next_permutation(order).found);
  }
}

}  // namespace
}  // namespace palpa::test
