// AUTD3: an independent implementation of the protocol decodes what the encoder writes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <vector>

#include "driver/autd3/emulated/device.hpp"
#include "driver/autd3/emulated/server.hpp"
#include "driver/autd3/pattern.hpp"
#include "driver/autd3/wire.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::autd3 {
namespace {

using Bytes = std::array<std::uint8_t, message_size>;
constexpr float pi = std::numbers::pi_v<float>;

TEST(Autd3Wire, PhasesAreDelaysAndIntensitiesAmplitudes) {
  EXPECT_EQ(emission({1.0f, 0.0f}), (Emission{0, 255}));
  EXPECT_EQ(emission({0.5f, pi}), (Emission{128, 127})) << "128 has a pulse of 86 of 512 counts, which is 0.5035";
  EXPECT_EQ(emission({0.0f, -pi / 2}), (Emission{192, 0}));
  EXPECT_EQ(emission({0.25f, -1e-4f}), (Emission{0, 63})) << "just below a whole turn";
  EXPECT_EQ(emission({0.3f, 0}).intensity, 75) << "a pulse of 49 counts, 0.296; 50 are 0.302";
  EXPECT_EQ(emission({0.007f, 0}).intensity, 1) << "a pulse of one count";
  EXPECT_EQ(emission({0.006f, 0}).intensity, 0) << "less than a count";
  EXPECT_EQ(emission({1.5f, 2 * pi / 256}), (Emission{1, 255}));
  EXPECT_EQ(emission({1.0f, 2 * pi * 1.49f / 256}).phase, 1);
  EXPECT_EQ(emission({1.0f, 2 * pi * 1.51f / 256}).phase, 2);
}

TEST(Autd3Wire, FociHaveLimits) {
  EXPECT_TRUE(within_reach({0, 0, 40000}));
  EXPECT_FALSE(within_reach({0, 0, 46341}));
  EXPECT_FALSE(within_reach({131072, 0, 0}));
}

/// A device that was told to begin.
EmulatedDevice begun() {
  EmulatedDevice device;
  Bytes bytes{};
  put_clear_and_sync(bytes);
  device.receive(0, bytes);
  return device;
}

class Teller {
 public:
  explicit Teller(EmulatedDevice& device) : device_(device) {}
  template <typename Put>
  std::uint8_t tell(const Put& put, double now_s = 0) {
    Bytes bytes{};
    put(Message(bytes));
    set_id(bytes, static_cast<std::uint8_t>(++id_ % 16));
    device_.receive(now_s, bytes);
    EXPECT_EQ(device_.answer()[1] & 0x0f, id_ % 16);
    return device_.answer()[1] >> 4;
  }

 private:
  EmulatedDevice& device_;
  int id_ = 0;
};

std::vector<Emission> some(std::uint8_t seed, bool full = false) {
  std::vector<Emission> out(transducers);
  for (std::size_t t = 0; t < transducers; ++t)
    out[t] = {static_cast<std::uint8_t>(t * 7 + seed), full ? std::uint8_t{255} : static_cast<std::uint8_t>(t ^ seed)};
  return out;
}

testing::AssertionResult sounds(const EmulatedDevice& device, double at_s, const std::vector<Emission>& expected) {
  const auto heard = device.output(at_s);
  for (std::size_t t = 0; t < transducers; ++t) {
    if (heard[t].phase != expected[t].phase || heard[t].intensity != expected[t].intensity)
      return testing::AssertionFailure() << "transducer " << t << " at " << at_s << " s: " << int{heard[t].phase}
                                         << ", " << int{heard[t].intensity};
  }
  return testing::AssertionSuccess();
}

TEST(Autd3Wire, APatternSoundsByTheDevicesClockOnceItIsWhole) {
  for (const bool full : {false, true}) {
    for (const std::uint32_t parts : {2u, 3u, 10u, 65u}) {
      EmulatedDevice device = begun();
      Teller teller(device);
      const std::uint32_t each = full ? 2 : 1;
      for (std::uint32_t p = 0; p < parts; p += each) {
        EXPECT_TRUE(device.silent(1)) << "nothing of it sounds before its end";
        const PatternStep step{1, 60, p == 0, p + each >= parts};
        const auto part = some(static_cast<std::uint8_t>(p), full), next = some(static_cast<std::uint8_t>(p + 1), full);
        const std::span<const Emission> second = p + 1 < parts ? std::span(next) : std::span<const Emission>();
        EXPECT_EQ(teller.tell([&](Message m) {
          full ? put_pattern_phases(m, step, part, second) : put_pattern(m, step, part);
        }),
                  0);
      }
      for (std::uint32_t p = 0; p < 2 * parts; ++p)
        EXPECT_TRUE(sounds(device, (p + 0.5) * 1.5e-3, some(static_cast<std::uint8_t>(p % parts), full)));
      EXPECT_EQ(device.violations().count(), 0u);
    }
  }
}

TEST(Autd3Wire, AModulationIsHeardByTheDevicesClock) {
  EmulatedDevice device = begun();
  Teller teller(device);
  const std::vector<Emission> loud(transducers, {7, 200});
  teller.tell([&](Message m) { put_gain(m, 1, loud); });
  const ModulationSamples samples = modulation_samples(200, array::Modulation::amplitude_sine, 100, 1000, 100.4);
  EXPECT_EQ(samples.count, 20u);
  EXPECT_EQ(teller.tell([&](Message m) {
    put_modulation(m, 1, samples.divider, std::span(samples.samples).first(samples.count));
  }),
            0);
  // Slot 0 began at 100 on the loop's clock, 1000 before that began the day.
  for (int i = 0; i < 40; ++i) {
    const double after_s = 3 + (i + 0.5) / 4000;
    const double gain = array::modulation_gain(array::Modulation::amplitude_sine, 200, after_s);
    EXPECT_NEAR(device.output(100 + 1000 - epoch_s + 2 * epoch_s + after_s)[5].intensity, 200 * gain, 1.2) << i;
  }
  for (const double hz : {1000 / 15.0, 199.0, 120.5}) {
    const ModulationSamples odd = modulation_samples(hz, array::Modulation::pressure_sine, 0, 0, 1);
    const double cycles = static_cast<double>(odd.count) * hz / 4000;
    EXPECT_NEAR(cycles, std::round(cycles), 0.02 * cycles) << hz;
  }
  EXPECT_EQ(device.violations().count(), 0u);
}

// In samples of 0.25 ms, a message has no cycle of less than 15.75 Hz.
TEST(Autd3Wire, AModulationHasItsFrequencyHoweverSlowOrFastItIs) {
  for (const double hz : {0.01, 0.3, 1.0, 2.5, 5.0, 7.3, 10.0, 15.7, 15.8, 33.3, 200.0, 999.0, 1000.0}) {
    SCOPED_TRACE(hz);
    EmulatedDevice device = begun();
    Teller teller(device);
    teller.tell([&](Message m) { put_gain(m, 1, std::vector<Emission>(transducers, {7, 255})); });
    const ModulationSamples samples = modulation_samples(hz, array::Modulation::amplitude_sine, 0, epoch_s, 0);
    teller.tell(
        [&](Message m) { put_modulation(m, 1, samples.divider, std::span(samples.samples).first(samples.count)); });
    const double length_s = static_cast<double>(samples.count) * samples.divider / 40e3;
    const double cycles = std::round(length_s * hz);
    ASSERT_GE(cycles, 1);
    EXPECT_NEAR(cycles / length_s, hz, 3e-3 * hz);
    // What is heard over one length has this frequency: all of its power but that of the mean.
    std::complex<double> line = 0;
    double mean = 0, power = 0;
    constexpr int times = 4000;
    for (int i = 0; i < times; ++i) {
      const double at = (i + 0.5) / times, heard = device.output(at * length_s)[5].intensity / 255.0;
      line += std::polar(heard / times, 2 * std::numbers::pi * cycles * at);
      mean += heard / times;
      power += heard * heard / times;
    }
    EXPECT_NEAR(mean, 0.5, 0.01);
    EXPECT_NEAR(std::abs(line), 0.25, hz < 500 ? 0.01 : 0.05);
    EXPECT_NEAR(2 * std::norm(line), power - mean * mean, hz < 500 ? 0.005 : 0.04);
  }
}

TEST(Autd3Emulator, ComputesFociAsItsFirmwareDoes) {
  // From the firmware's own tables: transducers 0, 19, 32, 124 and 248, and sums over all.
  struct Known {
    FixedPoint focus;
    std::array<int, 5> some;
    int sum, by_place;
  };
  for (const Known& known : {Known{{3454, 2641, 6000}, {106, 62, 206, 99, 105}, 32782, 4095727},
                             Known{{-1200, 9000, 4000}, {24, 127, 168, 28, 132}, 31584, 3865715}}) {
    const auto phases = EmulatedDevice::phases_of_focus(known.focus.x, known.focus.y, known.focus.z, 21965);
    EXPECT_EQ((std::array<int, 5>{phases[0], phases[19], phases[32], phases[124], phases[248]}), known.some);
    int sum = 0, by_place = 0;
    for (int t = 0; t < static_cast<int>(phases.size()); ++t) {
      sum += phases[t];
      by_place += (t + 1) * phases[t];
    }
    EXPECT_EQ(sum, known.sum);
    EXPECT_EQ(by_place, known.by_place);
  }
}

TEST(Autd3Emulator, RefusesWhatTheFirmwareRefuses) {
  const auto part = some(1);
  {
    EmulatedDevice fresh;
    Teller(fresh).tell([&](Message m) { put_gain(m, 1, part); });
    EXPECT_EQ(fresh.violations().count(), 1u) << "before clear and sync";
  }
  EmulatedDevice device = begun();
  Teller teller(device);
  EXPECT_EQ(teller.tell([&](Message m) {
    put_pattern(m, {1, 39, true, false}, part);
  }),
            7)
      << "faster than its silencer";
  EXPECT_EQ(teller.tell([](Message m) { put_silencer(m, 10, 30); }), 0);
  EXPECT_EQ(teller.tell([&](Message m) { put_pattern(m, {1, 39, true, false}, part); }), 0);
  std::size_t count = device.violations().count();
  EXPECT_EQ(count, 1u);
  teller.tell([&](Message m) { put_pattern(m, {0, 60, true, false}, part); });
  EXPECT_GT(device.violations().count(), count) << "into the segment that sounds";
  count = device.violations().count();
  EXPECT_EQ(teller.tell([&](Message m) { put_pattern(m, {1, 60, false, true}, part); }), 5) << "no beginning";
  EXPECT_GT(device.violations().count(), count);
  EXPECT_EQ(teller.tell([](Message m) { m[4] = 0x77; }), 1);
}

std::vector<std::uint8_t> geometry(std::uint32_t count) {
  std::vector<std::uint8_t> out{0x01, static_cast<std::uint8_t>(count), 0, 0, 0};
  for (std::uint32_t d = 0; d < count; ++d) {
    out.insert(out.end(), 12, 0);
    for (const float value : {1.0f, 0.0f, 0.0f, 0.0f}) {
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
      out.insert(out.end(), bytes, bytes + 4);
    }
  }
  return out;
}

TEST(Autd3Emulator, TakesRequestsHoweverTheyAreCut) {
  std::vector<std::uint8_t> all(hello_request.begin(), hello_request.end());
  const auto add = [&](const std::vector<std::uint8_t>& more) { all.insert(all.end(), more.begin(), more.end()); };
  add(geometry(2));
  std::vector<std::uint8_t> send(1 + 2 * message_size);
  send[0] = 0x03;
  send[1] = send[1 + message_size] = 5;
  add(send);
  add({0x04, 0x05});
  const std::vector<std::uint8_t> expected{0, 0, 0, 0, 0, 5, 0, 5, 0};
  for (std::size_t cut = 0; cut < all.size(); cut += cut < 90 ? 1 : 41) {
    EmulatedServer server(2);
    std::vector<std::uint8_t> answer;
    server.client_came();
    EXPECT_TRUE(server.take(0, std::span(all).first(cut), answer));
    EXPECT_FALSE(server.take(0, std::span(all).subspan(cut), answer)) << "a goodbye is the end";
    EXPECT_EQ(answer, expected) << cut;
    EXPECT_EQ(server.violation_count(), 0u);
  }
}

TEST(Autd3Emulator, EachProgramMustSayGoodbyeAndLeaveSilence) {
  EmulatedServer server(1);
  const auto program = [&](bool goodbye, bool sounds = false) {
    std::vector<std::uint8_t> answer, bytes(hello_request.begin(), hello_request.end());
    const auto opening = geometry(1);
    bytes.insert(bytes.end(), opening.begin(), opening.end());
    const std::size_t before = server.violation_count();
    server.client_came();
    EXPECT_TRUE(server.take(0, bytes, answer)) << "hello and geometry are asked of each";
    if (sounds) {
      Teller teller(server.devices()[0]);
      teller.tell(put_clear_and_sync);
      teller.tell([&](Message m) { put_gain(m, 1, some(1)); });
    }
    if (goodbye) {
      EXPECT_FALSE(server.take(0, std::vector<std::uint8_t>{0x05}, answer));
    }
    server.client_left(0);
    return server.violation_count() - before;
  };
  EXPECT_EQ(program(true), 0u);
  EXPECT_EQ(program(false), 1u) << "after one that said goodbye";
  EXPECT_EQ(program(true), 0u);
  EXPECT_EQ(program(true, true), 1u);
  EXPECT_CONTAINS(server.violations().back().what, "sound");
}

TEST(Autd3Emulator, RefusesRequestsOutOfOrder) {
  const std::vector<std::uint8_t> hello(hello_request.begin(), hello_request.end());
  auto newer = hello, other = hello;
  newer[1] = 2;
  other[5] = 'X';
  for (const auto& wrong : {newer, other, geometry(1), std::vector<std::uint8_t>{0x04}}) {
    EmulatedServer server(1);
    std::vector<std::uint8_t> answer;
    EXPECT_FALSE(server.take(0, wrong, answer));
    EXPECT_EQ(answer.at(0), 0xff);
    EXPECT_EQ(server.violation_count(), 1u);
  }
  EmulatedServer server(1);
  std::vector<std::uint8_t> answer;
  EXPECT_TRUE(server.take(0, hello, answer));
  EXPECT_FALSE(server.take(0, geometry(2), answer));
}

}  // namespace
}  // namespace palpa::driver::autd3
