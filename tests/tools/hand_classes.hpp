// The hands of hand_rates: what they do, on which solids, and in front of which cameras. A class and a seed determine
// a hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/solid.hpp"
#include "sensing/camera.hpp"
#include "sensing/synthetic.hpp"
#include "support/hand_skin.hpp"

namespace palpa::test {

namespace hands {
class Random;
}

/// Skin that moves as one. Its parts are the hand's from `first_part` on.
struct HandBody {
  const HandSkin* skin = nullptr;
  std::uint32_t first_part = 0;
  sensing::Motion pose;
};

/// One or more hands or fingers at solids, filmed by depth cameras.
struct RatedHand {
  std::uint64_t seed = 0;
  std::string what;  ///< for people
  std::vector<geometry::Solid> solids;
  std::vector<sensing::Camera> cameras;
  std::vector<HandBody> bodies;  ///< none: it is a recording
  bool moves = false;
  double rate_hz = 90, length_s = 0.5;
  std::optional<double> predict_s;  ///< the latency that is predicted
  std::filesystem::path recording;
  std::uint32_t fingers = 0;  ///< of a recording: how many are right
  bool slides = false;        ///< of a recording: the skin moves, nobody knows how

  std::uint32_t parts() const { return bodies.empty() ? 0 : bodies.back().first_part + bodies.back().skin->parts; }
  std::size_t frames() const { return static_cast<std::size_t>(length_s * rate_hz); }
  double time_of(std::size_t k) const { return static_cast<double>(k) / rate_hz; }
};

struct HandClass {
  const char* name;
  std::uint64_t first_seed;  ///< the others follow
  std::uint32_t hands;
  void (*make)(RatedHand& hand, hands::Random& random);  ///< adds to begun()'s hand
  const char* says;
  std::optional<double> predict_s{};
};
/// In the order of the table.
std::span<const HandClass> hand_classes();

/// `cameras`: 1 to 3; nothing: as many as the seed gives it.
RatedHand make_hand_of(const HandClass& kind, std::uint64_t seed, std::optional<int> cameras = {});

}  // namespace palpa::test
