// Boards behind a server or a port that goes away and comes back without what it had: afterwards, all that they play
// and how they play it is as with a new one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "driver/autd3/autd3_rig.hpp"
#include "driver/sonicsurface/sonicsurface_rig.hpp"
#include "support/files.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

/// Everything that a server and its units have, without what depends on when.
std::string state_of(const Autd3Rig& rig) {
  std::string text;
  for (const auto& [position, turn] : rig.server.poses())
    text += fmt::format("pose {} {}\n", fmt::join(position, " "), fmt::join(turn, " "));
  const double now_s = rig.device_now_s();
  for (const auto& device : rig.server.devices()) {
    text += fmt::format("silencer {} {}\n", device.phase_steps(), device.intensity_steps());
    // A whole cycle of the pattern, and of the modulation.
    std::map<std::string, std::pair<int, int>> outputs;
    for (int i = 0; i < 600; ++i) {
      std::string phases;
      int loudest = 0;
      for (const auto& [phase, intensity] : device.output(now_s + i * 25e-6)) {
        phases += static_cast<char>(phase);
        loudest = std::max<int>(loudest, intensity);
      }
      auto& [least, most] = outputs.try_emplace(phases, loudest / 8, loudest / 8).first->second;
      least = std::min(least, loudest / 8);
      most = std::max(most, loudest / 8);
    }
    for (const auto& [phases, range] : outputs)
      text += fmt::format("{} {} {}\n", std::hash<std::string>{}(phases), range.first, range.second);
  }
  return text;
}

struct Played {
  const char* what;
  std::function<void(Autd3Rig&)> prepare;
  double modulation_hz = 0;
};

TEST(BoardsBack, AnAutd3ServerThatComesBackHasTheStateOfANewOne) {
  const Played cases[]{{"drives", [](Autd3Rig&) {}},
                       {"modulated",
                        [](Autd3Rig& rig) {
                          std::ranges::fill(rig.drives, array::TransducerDrive{1, 2});
                        },
                        200},
                       {"nulls", [](Autd3Rig& rig) { rig.nulls = true; }},
                       {"foci, slower sound", [](Autd3Rig& rig) {
                          rig.sound_speed_m_s = 335;
                          for (std::size_t part = 0; part < 10; ++part) {
                            rig.foci.emplace_back(0.002 * static_cast<double>(part), 0.01, 0.15);
                            for (std::size_t t = 0; t < rig.silence.size(); ++t) {
                              const double turns = -glm::length(rig.foci.back() - rig.layout.transducers[t].position) *
                                                   40e3 / rig.sound_speed_m_s;
                              rig.drives[part * rig.silence.size() + t] = {
                                  0.8f, static_cast<float>(2 * std::numbers::pi * (turns - std::round(turns)))};
                            }
                          }
                        }}};
  for (const auto& [what, prepare, modulation_hz] : cases) {
    SCOPED_TRACE(what);
    const auto played = [&](Autd3Rig& rig) {
      rig.plan(modulation_hz);
      ASSERT_TRUE(rig.sounds());
    };
    Autd3Rig fresh;
    prepare(fresh);
    fresh.open();
    played(fresh);
    Autd3Rig rig;
    prepare(rig);
    rig.open();
    played(rig);
    const std::size_t before = rig.notes.warnings.size();
    rig.serving.end();
    ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() > before; }));
    rig.server = driver::autd3::EmulatedServer(1);
    rig.serving.listen();
    ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() > before + 1; }));
    EXPECT_CONTAINS(rig.notes.warnings.back(), "the server is back");
    played(rig);
    EXPECT_EQ(state_of(rig), state_of(fresh));
  }
}

TEST(BoardsBack, ASerialBoardThatComesBackIsCalibratedAndModulatedAsANewOne) {
  PALPA_TERMINAL_OR_SKIP();
  const auto folder = scratch_folder("serial-board-back");
  std::string degrees;
  for (std::size_t t = 0; t < driver::sonicsurface::transducers; ++t)
    degrees += t % 3 == 0 ? "180 " : "0 ";
  write_text(folder / "sonicsurface.txt", degrees);
  SonicSurfaceRig rig;
  const auto port = folder / "tty";
  auto vanishing = std::make_unique<driver::sonicsurface::Pty>();
  std::filesystem::create_symlink(vanishing->path(), port);
  rig.argument = port.string();
  rig.files = folder.string();
  rig.open_still();
  rig.plan(200);
  vanishing.reset();
  std::filesystem::remove(port);
  ASSERT_TRUE(rig.tend_until([&] { return !rig.notes.warnings.empty(); }));
  std::filesystem::create_symlink(rig.path(), port);
  ASSERT_TRUE(rig.tend_until([&] { return rig.notes.warnings.size() == 2; }));
  rig.plan(200);
  array::Drive corrected = rig.drive;
  for (std::size_t t = 0; t < corrected.size(); t += 3)
    corrected[t].phase += std::numbers::pi_v<float>;
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(corrected); }));
  const std::uint64_t swaps = rig.machine.swaps();
  EXPECT_TRUE(rig.tend_until([&] { return rig.machine.swaps() > swaps + 20; })) << "the modulation";
  rig.end_silent();
}

}  // namespace
}  // namespace palpa::test
