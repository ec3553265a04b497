// A user's loop: depth frames from a source, drives to the user's own link, events to the program. First without
// faults, then with a camera that is late for a while, then with a camera that fails in the middle of a touch.
//   live MODEL.glb FINGER.ply RIG.toml DRIVES
#include "live.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "array/layouts/layout.hpp"
#include "byte_link.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "sensing/synthetic.hpp"

namespace {

using namespace palpa;

constexpr std::uint64_t never = ~0ull;

/// A camera with the troubles of a real one.
struct Camera final : sensing::DepthSource {
  std::unique_ptr<sensing::DepthSource> good;
  std::uint64_t late_from = never, late_to = never, broken_at = never, sets = 0;

  const std::vector<sensing::Camera>& cameras() const override { return good->cameras(); }
  bool next(sensing::FrameSet& out, double timeout_s) override {
    const std::uint64_t set = sets++;
    if (set == broken_at) throw failure("camera: unplugged");
    if (set < late_from || set >= late_to) return good->next(out, timeout_s);
    std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
    out.frames.clear();
    return true;
  }
};

/// What a board would do, one letter per drive: + sounds, - is silent, and . at the end where nothing more comes.
struct Board final : session::Link {
  ByteLink& bytes;
  std::string heard;

  explicit Board(ByteLink& link) : bytes(link) {}
  void plan(const session::PlayedPlan& plan) override { bytes.plan(plan); }
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    bytes.send(slot, drive);
    heard += std::any_of(drive.begin(), drive.end(), [](const auto& t) { return t.amplitude > 0; }) ? '+' : '-';
  }
  void finish() override {
    bytes.finish();
    heard += '.';
  }
};

/// How many events of each kind there were.
struct Counts {
  int touches = 0, presses = 0, releases = 0;

  void add(const session::Event& event) {
    touches += event.kind == session::EventKind::touch;
    presses += event.kind == session::EventKind::press;
    releases += event.kind == session::EventKind::release;
  }
  bool operator==(const Counts&) const = default;
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) throw bad_usage("usage: live MODEL.glb FINGER.ply RIG.toml DRIVES");
  const geometry::Ply finger = geometry::read_ply(argv[2]);
  const std::vector<sensing::Camera> cameras = sensing::load_rig(argv[3]).cameras;
  std::vector<geometry::Solid> solids = geometry::make_solids(geometry::load_gltf(argv[1]));
  solids.at(0).haptics.press_depth_m = 3e-3;
  const array::Layout board_layout = array::load_layout("openmpd");
  const array::Layout layout = array::transformed(board_layout, board_layout.default_T_world_layout);

  const auto camera = [&](std::uint64_t frames) {
    // Any DepthSource will do: a camera, a recording, or this finger that dips 4 mm deep within 45 frames.
    Camera made;
    made.good = sensing::make_synthetic_source(cameras, {finger.positions, finger.triangles}, {},
                                               {.paced = false, .frames = frames});
    return made;
  };
  int faults = 0;
  const auto check = [&](const char* what, const Counts& counts, const Counts& wanted, const std::string& heard,
                         bool well) {
    std::printf("%s: %d touch, %d press, %d release; %s\n", what, counts.touches, counts.presses, counts.releases,
                heard.c_str());
    faults += counts != wanted || heard.find('+') == std::string::npos || !heard.ends_with("-.") || !well;
  };

  const auto run = [&](const char* what, Camera source, const Counts& wanted) {
    ByteLink bytes(argv[4], {layout, {}});
    Board board(bytes);
    Counts counts;
    std::string error;
    std::atomic<bool> stop{false};
    session::LoopStats stats;
    try {
      stats =
          run_live(source, board, solids, layout, true, stop, [&](const session::Event& event) { counts.add(event); });
    } catch (const Error& fault) {
      error = fault.what();
    }
    const bool late = source.late_from < source.late_to, broken = source.broken_at != never;
    const std::size_t sounds = std::min(board.heard.find('+'), board.heard.size());
    const bool paused = board.heard.find("-+", sounds) != std::string::npos;
    check(what, counts, wanted, board.heard,
          (paused || !late) && error.empty() != broken && (broken || stats.planned == stats.captured));
  };
  run("a touch", camera(45), {1, 1, 1});
  Camera late = camera(12), broken = camera(12);
  late.late_from = 8, late.late_to = 11;
  run("a late camera", std::move(late), {1, 0, 1});
  broken.broken_at = 8;
  run("a broken camera", std::move(broken), {1, 0, 1});
  return faults;
} catch (const palpa::Error& error) {
  std::fprintf(stderr, "live: %s\n", error.what());
  return static_cast<int>(error.code());
}
