// A user's loop: depth frames from a source, events to the program, drives to a link of its own.
//   live MODEL.glb FINGER.ply RIG.toml DRIVES
#include <cstdio>

#include "array/layout.hpp"
#include "byte_link.hpp"
#include "geometry/gltf.hpp"
#include "geometry/ply.hpp"
#include "sensing/synthetic.hpp"
#include "session/toucher.hpp"

int main(int argc, char** argv) try {
  using namespace palpa;
  if (argc != 5) throw bad_usage("usage: live MODEL.glb FINGER.ply RIG.toml DRIVES");
  // Any DepthSource will do: a camera, a recording, or this finger that dips in and out.
  const geometry::Ply finger = geometry::read_ply(argv[2]);
  const auto source = sensing::make_synthetic_source(
      sensing::load_rig(argv[3]).cameras, {finger.positions, finger.triangles}, {}, {.paced = false, .frames = 12});
  session::ToucherOptions options;
  options.cameras = source->cameras();
  session::Toucher toucher(geometry::make_solids(geometry::load_gltf(argv[1])), options);

  const array::Layout board = array::load_layout("openmpd");
  const array::Layout layout = array::transformed(board, board.default_T_world_layout);
  ByteLink link(argv[4], {layout, {}, toucher.schedule().slot_s});
  array::Drive drive(layout.transducers.size());
  std::vector<array::SlotFocus> foci;
  sensing::FrameSet set;
  std::uint64_t slot = 0;
  int touches = 0, sounding = 0;
  while (source->next(set, 0.1)) {
    toucher.touch(set.frames, set.time_s);
    for (const session::Event& event : toucher.events())
      touches += event.kind == session::EventKind::touch;
    for (int n = 0; n < 7; ++n) {  // a frame of 90 Hz lasts seven slots
      array::foci_of_slot(toucher.schedule(), slot, foci);
      array::drive_for(layout, foci, {}, drive);
      link.send(slot++, drive);
      sounding += !foci.empty();
    }
  }
  link.send(slot, array::Drive(drive.size(), {0, 0}));  // silence is the last thing it gets
  link.finish();
  std::printf("%d touch, %d of %d slots sound\n", touches, sounding, static_cast<int>(slot));
  return touches == 1 && sounding > 0 ? 0 : 1;
} catch (const palpa::Error& error) {
  std::fprintf(stderr, "live: %s\n", error.what());
  return static_cast<int>(error.code());
}
