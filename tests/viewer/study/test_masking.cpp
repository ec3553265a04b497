// The noise in the headphones.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/error.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "viewer/study/masking.hpp"

namespace palpa::viewer {
namespace {

/// SDL2's choice of a device, for the length of a test.
class AudioDriver {
 public:
  explicit AudioDriver(const char* name) { setenv("SDL_AUDIODRIVER", name, 1); }
  ~AudioDriver() { unsetenv("SDL_AUDIODRIVER"); }
  AudioDriver(const AudioDriver&) = delete;
  AudioDriver& operator=(const AudioDriver&) = delete;
};

std::string fault_of(const std::string& kind, Exit code) {
  return test::error_of([&] { const Masking masking(kind); }, code);
}

/// A WAV file of 8-bit samples, one channel.
std::string wav(std::uint32_t samples, std::uint32_t rate_hz = 8000, char sample = '\x40') {
  const auto number = [](std::uint32_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i)
      text += static_cast<char>(value >> (8 * i) & 0xff);
    return text;
  };
  return "RIFF" + number(36 + samples, 4) + "WAVEfmt " + number(16, 4) + number(1, 2) + number(1, 2) +
         number(rate_hz, 4) + number(rate_hz, 4) + number(1, 2) + number(8, 2) + "data" + number(samples, 4) +
         std::string(samples, sample);
}

TEST(Masking, OnlyOffBeginsWithoutADevice) {
  const AudioDriver none("no such driver");
  Masking masking("off");
  masking.play(true);
  EXPECT_EQ(masking.name(), "off");
  EXPECT_CONTAINS(fault_of("white", Exit::failed), "masking = \"off\"");
}

TEST(Masking, WarnsOfWhatMasksNothing) {
  if (!Masking::available()) GTEST_SKIP() << "skipped: built without SDL2";
  const AudioDriver dummy("dummy");
  const std::filesystem::path folder = test::scratch_folder("masking-nothing");
  const auto said = [&](const std::string& sound) {
    test::write_text(folder / "sound.wav", sound);
    return test::stderr_of([&] { const Masking masking((folder / "sound.wav").string()); });
  };
  constexpr char silent = '\x80';
  EXPECT_CONTAINS(said(wav(16000, 8000, silent)), "sound.wav: is silent");
  EXPECT_CONTAINS(said(wav(300)), "lasts only");
  const std::string usual = said(wav(16000));
  EXPECT_EQ(usual.find("sound.wav"), std::string::npos) << usual;
  EXPECT_CONTAINS(usual, "audio driver is 'dummy'");
}

TEST(Masking, PlaysNoiseOrAFile) {
  if (!Masking::available()) GTEST_SKIP() << "skipped: built without SDL2";
  const AudioDriver dummy("dummy");
  const std::filesystem::path folder = test::scratch_folder("masking");
  test::write_text(folder / "sea.wav", wav(400));
  for (const std::string& kind : {std::string("white"), (folder / "sea.wav").string()}) {
    Masking masking(kind);
    masking.play(true);
    masking.play(true);
    masking.play(false);
    EXPECT_EQ(masking.name(), kind == "white" ? "white (dummy)" : "sea.wav (dummy)") << "no path in the log";
  }
  test::write_text(folder / "text.wav", "no sound at all");
  EXPECT_CONTAINS(fault_of((folder / "text.wav").string(), Exit::bad_input), "no WAV file");
  test::write_text(folder / "slow.wav", wav(1'000'000, 1));
  EXPECT_CONTAINS(fault_of((folder / "slow.wav").string(), Exit::bad_input), "too low a rate (1 Hz)");
  test::write_text(folder / "empty.wav", wav(0));
  EXPECT_CONTAINS(fault_of((folder / "empty.wav").string(), Exit::bad_input), "empty.wav");
}

}  // namespace
}  // namespace palpa::viewer
