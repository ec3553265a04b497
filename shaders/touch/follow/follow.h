// Shared by engine/touch/follow/follow_pass.cpp and shaders/touch/follow/follow.comp.
#ifndef PALPA_SHADERS_FOLLOW_H
#define PALPA_SHADERS_FOLLOW_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST follow_group = 128u;  // a single group: a thread per track and per finger
PALPA_CONST follow_most_tracks = 128u;
PALPA_CONST follow_none = 0xffffffffu;

// In FollowPush::elapsed_us: there is no frame before this one, and no id has been given. In Track::since_us: the
// finger is new, was in another's cluster since it was last seen by itself, or was missing for longer than it coasts.
PALPA_CONST follow_restart = 0xffffffffu;

struct FollowPush {
  uint elapsed_us;  // from the frame before to this frame
  uint steady;      // axes are steadied; 0: they stay the principal ones
  uint memory_us;   // an unseen finger is remembered for this time
  uint unused2;
};
PALPA_CHECK_SIZE(FollowPush, 16);
PALPA_CHECK_OFFSET(FollowPush, memory_us, 8);

// Bits of Track::flags.
PALPA_CONST track_has_axes = 1u;
PALPA_CONST track_left_home = 2u;  // it has been in another's cluster since it was last seen by itself

// The data on a finger, present or past. The first tracks are those of the frame's fingers, in their order.
struct Track {
  uint id;
  uint solid;
  uint carrier;    // the track into whose cluster this one has merged, or follow_none
  uint unseen_us;  // since it was last seen, by itself or in a cluster that looks like two fingers
  uint contacts;   // when it was last seen by itself
  uint flags;
  uint home;      // 0 to follow_most_tracks - 1, fixed as long as the track is known: passes keep their data on it
                  // there
  uint since_us;  // of this frame's fingers: time since it was last seen by itself, or follow_restart
  vec4 place;     // where its centroid is, or is expected; w: its distance from the centroid of its cluster
  vec4 velocity;  // m/s
  vec4 axis1;     // steady w1
  vec4 axis3;     // steady w3
  vec4 spread_a;  // covariance when last seen by itself: xx, xy, xz, yy
  vec4 spread_b;  // yz, zz
};
PALPA_CHECK_SIZE(Track, 128);
PALPA_CHECK_OFFSET(Track, contacts, 16);
PALPA_CHECK_OFFSET(Track, home, 24);
PALPA_CHECK_OFFSET(Track, place, 32);
PALPA_CHECK_OFFSET(Track, axis1, 64);
PALPA_CHECK_OFFSET(Track, spread_b, 112);

struct TrackTable {
  uint count;
  uint next_id;
  uint unused0;
  uint unused1;
  Track tracks[follow_most_tracks];
};
PALPA_CHECK_SIZE(TrackTable, 16 + 128 * 128);
PALPA_CHECK_OFFSET(TrackTable, tracks, 16);

PALPA_SHADER_END
#endif
