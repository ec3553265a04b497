#include "touch/fingers/follow.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/follow_math.hpp"
#include "touch/fingers/members.hpp"

namespace palpa::touch {
namespace {

constexpr std::uint32_t most = follow_most_tracks;
constexpr std::uint32_t none = follow_none;

shader::vec4 vec4(const Float3& v, float w = 0) {
  return {v.x, v.y, v.z, w};
}

PrincipalAxes axes_of(const Finger& finger) {
  const CrossSection& s = finger.section;
  return {float3(s.axes[0]), float3(s.axes[1]), float3(s.axes[2]),
          s.eigenvalues[0],  s.eigenvalues[1],  s.eigenvalues[2]};
}
Sym3 spread_of(const Track& t) {
  return {t.spread_a.x, t.spread_a.y, t.spread_a.z, t.spread_a.w, t.spread_b.x, t.spread_b.y};
}

/// A track as it was, and extrapolated to this frame.
struct Candidate {
  Track old{};
  bool alive = false;
  std::uint32_t unseen_us = 0;
  Float3 place{}, velocity{};
  float reach = 0, penalty = 0, stray = 0;
  std::uint32_t row = none;    ///< the finger that continues it
  std::uint32_t owner = none;  ///< that finger, or the one whose cluster it is in
  bool merged = false, seen = false;
  bool stays = false;  ///< remembered, but without its own finger
};

/// One frame's work.
struct Follow {
  std::span<Finger> fingers;
  std::uint32_t elapsed_us;
  std::uint32_t memory_us;
  bool steady;
  float frame_s = shader::seconds_of(elapsed_us);
  float scale = reach_of(frame_s, 0, 0);
  std::uint32_t known = 0;
  std::array<Candidate, most> candidates{};
  std::array<float, max_fingers> birth_cost{};
  std::array<std::uint32_t, max_fingers> track_of{};
  std::array<bool, most> home_taken{};

  std::span<Candidate> tracks() { return std::span(candidates).first(known); }

  void move_on(const Tracks& before);
  float cost_of(std::uint32_t finger, std::uint32_t column) const;
  void find_birth_costs();
  void assign();
  void merge();
  void move_cluster(std::uint32_t finger, Candidate& track, std::uint32_t passengers);
  void choose_who_stays();
  Float3 joined(std::uint32_t finger, const Tracks& all) const;
  Track followed(std::uint32_t finger, std::uint32_t new_id, std::uint32_t new_home, const Float3& joined);
};

void Follow::move_on(const Tracks& before) {
  known = before.count;
  for (std::uint32_t t = 0; t < known; ++t) {
    Candidate& c = candidates[t];
    c.old = before.tracks[t];
    c.unseen_us = us_after(c.old.unseen_us, elapsed_us);
    const bool carried = c.old.carrier != none;
    c.alive = c.unseen_us <= memory_of(carried, memory_us);
    const std::uint32_t coasts_us = std::min(c.unseen_us, coasting_us) - std::min(c.old.unseen_us, coasting_us);
    c.velocity = float3(c.old.velocity);
    c.place = moved(float3(c.old.place), c.velocity, carried ? frame_s : shader::seconds_of(coasts_us));
    c.reach = reach_of(frame_s, shader::seconds_of(c.old.unseen_us), c.old.place.w);
    c.penalty = c.old.unseen_us == 0 && !carried ? 0 : second_class;
  }
}

float Follow::cost_of(std::uint32_t finger, std::uint32_t column) const {
  if (column >= most) return column - most == finger ? birth_cost[finger] : out_of_reach;
  const Candidate& c = candidates[column];
  if (!c.alive || c.old.solid != fingers[finger].solid) return out_of_reach;
  return follow_cost(float3(fingers[finger].section.centroid), c.place, c.reach, scale, c.penalty);
}

/// If a remembered finger fits, a birth costs more than that finger.
void Follow::find_birth_costs() {
  for (std::uint32_t f = 0; f < fingers.size(); ++f) {
    birth_cost[f] = new_finger;
    for (std::uint32_t t = 0; t < known; ++t) {
      if (candidates[t].penalty == 0 && candidates[t].reach <= scale) continue;
      const float cost = cost_of(f, t);
      if (cost < out_of_reach) birth_cost[f] = std::max(birth_cost[f], cost + 1);
    }
  }
}

/// Finds the least sum of costs with the Hungarian method by shortest augmenting paths. Rows are fingers; columns are
/// tracks and births. If costs are equal, the first column wins: track 0, birth 0, track 1, ...
void Follow::assign() {
  const auto count = static_cast<std::uint32_t>(fingers.size());
  constexpr std::uint32_t columns = most + max_fingers;
  std::array<float, max_fingers> row_price{};
  std::array<float, columns> price{};
  std::array<std::uint32_t, columns> row_of{}, way{}, order{};
  row_of.fill(none);
  std::uint32_t width = 0;
  for (std::uint32_t t = 0; t < std::max(known, count); ++t) {
    if (t < known) order[width++] = t;
    if (t < count) order[width++] = most + t;
  }
  for (std::uint32_t finger = 0; finger < count; ++finger) {
    std::array<float, columns> least{};
    least.fill(no_cost_yet);
    std::array<bool, columns> visited{};
    std::uint32_t current = none, row = finger;
    while (row != none) {
      float best = no_cost_yet;
      std::uint32_t best_column = none;
      for (const std::uint32_t column : std::span(order).first(width)) {
        if (visited[column]) continue;
        const float reduced = cost_of(row, column) - row_price[row] - price[column];
        if (reduced < least[column]) {
          least[column] = reduced;
          way[column] = current;
        }
        if (least[column] < best) {
          best = least[column];
          best_column = column;
        }
      }
      for (const std::uint32_t column : std::span(order).first(width)) {
        if (visited[column]) {
          row_price[row_of[column]] += best;
          price[column] -= best;
        } else {
          least[column] -= best;
        }
      }
      row_price[finger] += best;
      current = best_column;
      visited[current] = true;
      row = row_of[current];
    }
    while (current != none) {
      const std::uint32_t before = way[current];
      row_of[current] = before == none ? finger : row_of[before];
      current = before;
    }
  }
  track_of.fill(none);
  for (std::uint32_t t = 0; t < known; ++t) {
    candidates[t].row = candidates[t].owner = row_of[t];
    if (row_of[t] != none) track_of[row_of[t]] = t;
  }
}

/// For tracks without a finger: finds the cluster into which they have merged.
void Follow::merge() {
  for (Candidate& c : tracks()) {
    if (c.row != none || !c.alive) continue;
    if (c.old.carrier == none && c.old.unseen_us > coasting_us) continue;
    if (c.old.carrier < known) c.owner = candidates[c.old.carrier].row;
    float best = 1;
    for (std::uint32_t f = 0; f < fingers.size(); ++f) {
      if (fingers[f].solid != c.old.solid) continue;
      const float square = inside_square(axes_of(fingers[f]), minus(c.place, float3(fingers[f].section.centroid)));
      if (square < best) {
        best = square;
        c.owner = f;
      }
    }
    c.merged = c.owner != none;
  }
}

void Follow::choose_who_stays() {
  std::size_t room = most - fingers.size();
  for (Candidate& c : tracks()) {
    c.stays = c.row == none && c.alive && (c.merged || c.unseen_us <= memory_us) && room > 0;
    if (c.stays) --room;
    if (c.stays || c.row != none) home_taken[c.old.home] = true;
  }
}

void Follow::move_cluster(std::uint32_t finger, Candidate& track, std::uint32_t passengers) {
  const PrincipalAxes axes = axes_of(fingers[finger]);
  const Float3 found = float3(fingers[finger].section.centroid);
  const Sym3 cluster = covariance_of(axes);
  const float gain = velocity_gain(frame_s);
  const auto weight = [](const Candidate& c) { return static_cast<float>(c.old.contacts); };
  const auto is_member = [&](const Candidate& c) { return &c == &track || (c.merged && c.owner == finger); };
  float total = weight(track);
  Candidate* other = &track;
  for (Candidate& c : tracks()) {
    if (!c.merged || c.owner != finger) continue;
    total += weight(c);
    other = &c;
  }
  Float3 mean{0, 0, 0};
  for (const Candidate& c : tracks()) {
    if (is_member(c)) mean = moved(mean, c.place, weight(c) / total);
  }
  const Float3 shift = minus(found, mean);
  for (Candidate& c : tracks()) {
    if (!is_member(c)) continue;
    c.place = moved(c.place, shift, 1);
    c.velocity = moved(c.velocity, shift, gain);
  }
  if (passengers == 1) {
    const float share = weight(track) / total, other_share = weight(*other) / total;
    const Parting parting = parting_of(cluster, spread_of(track.old), spread_of(other->old), share, other_share,
                                       minus(other->place, track.place));
    const float part = 0.5F * parting.trust;
    const float back = other_share * part, on = share * part;
    track.place = moved(track.place, parting.correction, -back);
    other->place = moved(other->place, parting.correction, on);
    track.velocity = moved(track.velocity, parting.correction, -back * gain);
    other->velocity = moved(other->velocity, parting.correction, on * gain);
  }
  const bool looks = looks_merged(cluster, spread_of(track.old));
  for (Candidate& c : tracks()) {
    if (!is_member(c)) continue;
    const Float3 offset = kept_inside(axes, minus(c.place, found));
    c.place = moved(found, offset, 1);
    c.stray = std::sqrt(dot3(offset, offset));
    c.seen = looks;
  }
}

/// Zero for a finger that is nearly where it is expected, or was not in the frame before.
Float3 Follow::joined(std::uint32_t f, const Tracks& all) const {
  const std::uint32_t t = track_of[f];
  if (t == none || t >= all.skin_before.fingers) return {0, 0, 0};
  const Candidate& track = candidates[t];
  constexpr float near = 0.3e-3F;
  if (square_apart(float3(fingers[f].section.centroid), track.place) <= near * near) return {0, 0, 0};
  return moved_by_members(all.skin_before.places[t], all.skin.places[f], minus(track.place, float3(track.old.place)));
}

Track Follow::followed(std::uint32_t f, std::uint32_t new_id, std::uint32_t new_home, const Float3& joined) {
  Finger& finger = fingers[f];
  CrossSection& section = finger.section;
  const PrincipalAxes axes = axes_of(finger);
  const Sym3 spread = covariance_of(axes);
  const Float3 lean = float3(section.lean);
  Track t{};
  t.id = new_id;
  t.home = new_home;
  t.since_us = follow_restart;
  t.solid = finger.solid;
  t.carrier = none;
  t.contacts = static_cast<std::uint32_t>(finger.contacts.size());
  t.joined = joined;
  t.flags = finger.point_like ? 0 : track_has_axes;
  t.place = vec4(float3(section.centroid));
  t.axis1 = vec4(axes.w1, axes.l1);
  t.axis3 = vec4(axes.w3, axes.l3);
  t.spread_a = {spread.xx, spread.xy, spread.xz, spread.yy};
  t.spread_b = {spread.yz, spread.zz, 0, 0};
  Steady turned{axes, 1, 0};
  bool has_frame = false;
  if (track_of[f] != none) {
    Candidate& track = candidates[track_of[f]];
    t.home = track.old.home;
    if (glides_on(track.old.flags, track.old.unseen_us, track.unseen_us)) t.since_us = track.unseen_us;
    const float since_s = shader::seconds_of(track.unseen_us);
    const auto passengers = static_cast<std::uint32_t>(
        std::count_if(tracks().begin(), tracks().end(), [&](const Candidate& c) { return c.merged && c.owner == f; }));
    t.id = track.old.id;
    if (passengers == 0) {
      const Float3 surprise = minus(minus(float3(section.centroid), joined), track.place);
      track.velocity = moved(track.velocity, surprise, velocity_gain(since_s));
    } else {
      move_cluster(f, track, passengers);
      t.contacts = track.old.contacts;
      t.spread_a = track.old.spread_a;
      t.spread_b = track.old.spread_b;
      t.place = vec4(track.place, track.stray);
    }
    t.velocity = vec4(track.velocity);
    const bool had_axes = (track.old.flags & track_has_axes) != 0;
    if (had_axes && finger.point_like) {
      t.flags = track_has_axes;
      t.axis1 = track.old.axis1;
      t.axis3 = track.old.axis3;
    } else if (had_axes) {
      has_frame = true;
      if (steady) turned = steady_axes(axes, lean, float3(track.old.axis1), float3(track.old.axis3), since_s);
    }
  }
  if (steady && !finger.point_like) {
    if (!has_frame) turned = first_axes(axes, lean);
    const PrincipalAxes& a = turned.axes;
    t.axis1 = vec4(a.w1, a.l1);
    t.axis3 = vec4(a.w3, a.l3);
    section.axes = {to_vec(a.w1), to_vec(a.w2), to_vec(a.w3)};
    section.eigenvalues = {a.l1, a.l2, a.l3};
    section.turn = {turned.cosine, turned.sine};
  }
  finger.id = t.id;
  return t;
}

/// Keeps the places of the fingers' contacts, and of those of the frame before.
void keep_skin(const Touch& touch, Tracks& tracks) {
  std::swap(tracks.skin, tracks.skin_before);
  tracks.skin.fingers = touch.finger_count;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    std::vector<Float3>& places = tracks.skin.places[f];
    const std::vector<std::uint32_t>& contacts = touch.fingers[f].contacts;
    places.clear();
    if (places.capacity() < contacts.size()) {  // more, so that it does not grow again in each frame with a few more
      for (Tracks::Skin* skin : {&tracks.skin, &tracks.skin_before})
        skin->places[f].reserve(std::max<std::size_t>(2 * contacts.size(), 1024));
    }
    for (const std::uint32_t i : contacts)
      places.push_back(float3(touch.contacts[i].position));
  }
}

}  // namespace

std::uint32_t FrameClock::elapsed_us(double time_s) {
  const double elapsed = last_s_ ? (time_s - *last_s_) * 1e6 : 0;
  const bool first = !last_s_;
  last_s_ = time_s;
  if (first) return follow_restart;
  constexpr double forever = 4e9;
  return static_cast<std::uint32_t>(elapsed >= 0 && elapsed < forever ? std::llround(elapsed) : std::llround(forever));
}

void follow_fingers(Tracks& tracks, std::uint32_t elapsed_us, const StageSetting& setting, Touch& touch) {
  Follow follow{std::span(touch.fingers).first(touch.finger_count), elapsed_us == follow_restart ? 0 : elapsed_us,
                setting.memory_us(), setting.axes == Axes::steady};
  if (elapsed_us == follow_restart) tracks.count = 0;
  if (elapsed_us == follow_restart) tracks.skin.fingers = 0;
  keep_skin(touch, tracks);
  follow.move_on(tracks);
  follow.find_birth_costs();
  follow.assign();
  follow.merge();
  follow.choose_who_stays();
  tracks.count = 0;
  const bool members = (setting.hysteresis_rules & known_members) != 0;
  std::uint32_t home = 0;  // the first home that may be free
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const bool born = follow.track_of[f] == none;
    while (born && follow.home_taken[home])
      ++home;
    const Float3 joined = members ? follow.joined(f, tracks) : Float3{0, 0, 0};
    tracks.tracks[tracks.count++] = follow.followed(f, tracks.next_id, home, joined);
    if (!born) continue;
    ++tracks.next_id;
    ++home;
  }
  for (const Candidate& c : follow.tracks()) {
    if (!c.stays) continue;
    Track& t = tracks.tracks[tracks.count++] = c.old;
    t.carrier = c.merged ? c.owner : none;
    if (c.merged) t.flags |= track_left_home;
    t.unseen_us = c.seen ? 0 : c.unseen_us;
    t.place = vec4(c.place, c.stray);
    t.velocity = vec4(c.velocity);
  }
}

}  // namespace palpa::touch
