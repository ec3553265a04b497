#include "viewer/study/masking.hpp"

#include "base/error.hpp"
#include "setup/options/study_options.hpp"

#ifdef PALPA_SDL2
#include <SDL.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <vector>

#include "base/files/input_file.hpp"
#include "base/log.hpp"
#include "base/random.hpp"
#include "base/text.hpp"
#endif

namespace palpa::viewer {

#ifdef PALPA_SDL2

struct Masking::Device {
  SDL_AudioDeviceID id = 0;
  bool on = false;
  Random random{1};
  std::vector<std::uint8_t> sound;  ///< of a file, in the device's form; empty: white noise
  std::size_t next = 0;

  ~Device() {
    if (id != 0) SDL_CloseAudioDevice(id);
    SDL_QuitSubSystem(SDL_INIT_AUDIO);
  }
  /// Fills SDL's buffer, on SDL's thread.
  static void fill(void* self, std::uint8_t* out, int bytes) {
    auto& device = *static_cast<Device*>(self);
    auto left = static_cast<std::size_t>(bytes);
    if (device.sound.empty()) {
      for (std::size_t i = 0; i + sizeof(float) <= left; i += sizeof(float)) {
        constexpr double loudness = 0.25;  // peak, of full scale
        const auto value = static_cast<float>(loudness * (2 * device.random.uniform() - 1));
        std::memcpy(out + i, &value, sizeof value);
      }
      return;
    }
    while (left > 0) {
      const std::size_t piece = std::min(left, device.sound.size() - device.next);
      std::memcpy(out, device.sound.data() + device.next, piece);
      device.next = (device.next + piece) % device.sound.size();
      out += piece;
      left -= piece;
    }
  }
};

namespace {

constexpr int rate_hz = 48'000, channels = 2;
constexpr std::uint64_t most_sound_bytes = 256u << 20, most_played_bytes = 1u << 30;

/// The file's sound as the device plays it.
std::vector<std::uint8_t> sound_of(const std::string& file) {
  SDL_AudioSpec spec;
  std::uint8_t* samples = nullptr;
  std::uint32_t bytes = 0;
  const std::string content = read_file(file, most_sound_bytes);
  SDL_RWops* const stream = SDL_RWFromConstMem(content.data(), static_cast<int>(content.size()));
  if (SDL_LoadWAV_RW(stream, 1, &spec, &samples, &bytes) == nullptr)
    throw bad_input(file, fmt::format("is no WAV file that SDL2 reads: {}", printable(SDL_GetError(), 100)));
  std::vector<std::uint8_t> sound;
  SDL_AudioCVT conversion;
  const int needed =
      SDL_BuildAudioCVT(&conversion, spec.format, spec.channels, spec.freq, AUDIO_F32SYS, channels, rate_hz);
  if (needed >= 0 && bytes > 0) {
    conversion.len = static_cast<int>(bytes);
    const std::uint64_t needs = std::uint64_t{bytes} * static_cast<std::uint64_t>(std::max(conversion.len_mult, 1));
    if (needs > most_played_bytes) {
      SDL_FreeWAV(samples);
      throw bad_input(file, fmt::format("is too long, or has too low a rate ({} Hz): as the device plays it, it would "
                                        "need {} MiB, and at most {} are possible",
                                        spec.freq, needs >> 20, most_played_bytes >> 20));
    }
    sound.resize(needs);
    std::memcpy(sound.data(), samples, bytes);
    conversion.buf = sound.data();
    if (needed > 0 && SDL_ConvertAudio(&conversion) != 0) sound.clear();
    if (needed > 0 && !sound.empty()) sound.resize(static_cast<std::size_t>(conversion.len_cvt));
  }
  SDL_FreeWAV(samples);
  sound.resize(sound.size() / (sizeof(float) * channels) * (sizeof(float) * channels));
  if (sound.empty()) throw bad_input(file, "has no sound that SDL2 can convert");
  return sound;
}

/// Warns of a file's sound that hardly masks anything.
void doubt(const std::string& file, const std::vector<std::uint8_t>& sound) {
  constexpr double faint = 1e-3, short_s = 1;
  double peak = 0;
  for (std::size_t i = 0; i < sound.size(); i += sizeof(float)) {
    float value = 0;
    std::memcpy(&value, &sound[i], sizeof value);
    peak = std::max(peak, std::abs(double{value}));
  }
  const std::size_t samples = sound.size() / (sizeof(float) * channels);
  const double lasts_s = static_cast<double>(samples) / rate_hz;
  if (peak < faint) {
    log::warning(fmt::format("{}: is silent, so it masks nothing: its loudest sample is {:.2g} % of full scale", file,
                             100 * peak));
  } else if (lasts_s < short_s) {
    log::warning(fmt::format("{}: lasts only {:.2g} s, and is repeated: give a longer sound", file, lasts_s));
  }
}

}  // namespace

Masking::Masking(const std::string& kind) : name_(kind) {
  if (kind == "off") return;
  const auto no_device = [&] {
    return failure(
        fmt::format("masking = \"{}\": there is no audio device ({}): plug in the headphones, or write "
                    "masking = \"off\" into the [run] of the plan",
                    kind, printable(SDL_GetError(), 100)));
  };
  if (SDL_InitSubSystem(SDL_INIT_AUDIO) != 0) throw no_device();
  device_ = std::make_unique<Device>();
  if (kind != "white") {
    device_->sound = sound_of(kind);
    doubt(kind, device_->sound);
  }
  SDL_AudioSpec wanted{};
  wanted.freq = rate_hz;
  wanted.format = AUDIO_F32SYS;
  wanted.channels = channels;
  wanted.samples = 1024;
  wanted.callback = Device::fill;
  wanted.userdata = device_.get();
  device_->id = SDL_OpenAudioDevice(nullptr, 0, &wanted, nullptr, 0);
  if (device_->id == 0) throw no_device();
  const char* const device = SDL_GetCurrentAudioDriver();
  if (device != nullptr && (std::strcmp(device, "dummy") == 0 || std::strcmp(device, "disk") == 0))
    log::warning(fmt::format("SDL2's audio driver is '{}', so nothing is heard in the headphones", device));
  // The log has no paths, which may have people's names.
  name_ = fmt::format("{} ({})", kind == "white" ? kind : std::filesystem::path(kind).filename().string(),
                      device != nullptr ? device : "?");
}

Masking::~Masking() = default;

void Masking::play(bool on) {
  if (!device_ || device_->on == on) return;
  device_->on = on;
  SDL_PauseAudioDevice(device_->id, on ? 0 : 1);
}

bool Masking::available() {
  return true;
}

#else

struct Masking::Device {};

Masking::Masking(const std::string& kind) : name_(kind) {
  if (kind == "off") return;
  throw failure("masking = \"" + kind + "\": this palpa was built without SDL2, so it plays no sound in headphones: " +
                setup::how_to_get_sdl2 + ", or write masking = \"off\" into the [run] of the plan");
}

Masking::~Masking() = default;

void Masking::play(bool) {}

bool Masking::available() {
  return false;
}

#endif

}  // namespace palpa::viewer
