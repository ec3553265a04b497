#include "touch/fingers/follow.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/inplace_vector.hpp"
#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/members.hpp"
#include "touch/fingers/steady_axes.hpp"

namespace palpa::touch {
namespace {

/// A finger that has merged into another's cluster is remembered for this time.
constexpr std::uint32_t merged_memory_us = 1000000;

constexpr float near_m = 0.009F;        // a finger is found within this distance of where it is expected,
constexpr float surprise_mps = 1.0F;    // plus this much per second since the frame before: 20 mm at 90 Hz,
constexpr float drift_mps = 0.05F;      // plus this much per second that it was not seen
constexpr float velocity_s = 0.03F;     // velocities adapt within this time
constexpr float new_finger = 2.0F;      // cost of taking a finger for a new one, in squared reaches
constexpr float second_class = 1.0F;    // a candidate that was not seen in the frame before yields to one that was
constexpr float out_of_reach = 1.0e6F;  // marks a pair that is never matched
constexpr float no_cost_yet = 1.0e9F;

/// The largest distance of a finger from where it is expected.
float reach_of(float frame_s, float unseen_s, float stray) {
  return near_m + surprise_mps * frame_s + drift_mps * unseen_s + stray;
}

/// Factor from a position error to a change of velocity: 1 / (the time that the error took + velocity_s). Two frames of
/// the same time give no change.
float velocity_gain(float over_s) {
  return over_s > 0 ? 1 / (over_s + velocity_s) : 0;
}

using Index = std::optional<std::uint32_t>;

/// A track as it was, and extrapolated to this frame.
struct Candidate {
  Track old{};
  bool alive = false;
  std::uint32_t unseen_us = 0;
  glm::vec3 place{}, velocity{};
  float reach = 0, penalty = 0, stray = 0;
  Index row{};    ///< the finger that continues it
  Index owner{};  ///< that finger, or the one whose cluster it is in
  bool merged = false, seen = false;
  bool stays = false;  ///< remembered, but without its own finger

  float weight() const { return static_cast<float>(old.contacts); }
  bool rides_with(std::uint32_t finger) const { return merged && owner == finger; }
  /// Whether a finger's foci may continue from where they were: the finger was in the frame before, however long ago
  /// that is, or was missing for no longer than it coasts, and the data kept of its foci is its own.
  bool glides_on() const { return !old.left_home && (old.unseen_us == 0 || unseen_us <= coasting_us); }
};

// ---- merged clusters ----

float trace_of(const glm::mat3& m) {
  return m[0][0] + m[1][1] + m[2][2];
}

/// Whether a cluster of this covariance looks like more than one finger, whose covariance alone was `alone`.
bool looks_merged(const glm::mat3& cluster, const glm::mat3& alone) {
  return trace_of(cluster) > 1.3F * trace_of(alone);
}

/// Squared distance from a cluster's centroid in units of its ellipsoid: two standard deviations and 4 mm.
float inside_square(const CrossSection& cluster, const glm::vec3& from_centroid) {
  glm::vec3 e;
  for (int k = 0; k < 3; ++k) {
    const float reach = 2 * std::sqrt(cluster.eigenvalues[static_cast<std::size_t>(k)]) + 0.004F;
    e[k] = glm::dot(cluster.axes[static_cast<std::size_t>(k)], from_centroid) / reach;
  }
  return glm::dot(e, e);
}

/// Keeps a merged finger within its cluster: at most 0.8 of the ellipsoid from the centroid.
glm::vec3 kept_inside(const CrossSection& cluster, const glm::vec3& from_centroid) {
  const float square = inside_square(cluster, from_centroid);
  return square <= 0.64F ? from_centroid : from_centroid * (0.8F / std::sqrt(square));
}

/// The estimate of the way from one finger to the other from the shape of their cluster.
struct Parting {
  glm::vec3 correction{0};  ///< to the expected way
  float trust = 0;          ///< 0: the two are too near to be distinguished; 1: clearly apart
};

/// A finger's share of the contacts of its cluster, and its covariance alone.
struct Alone {
  float share;
  const glm::mat3& covariance;
};

/// The cluster's covariance is that of the two alone plus a.share b.share r r^T. One step of power iteration from the
/// expected r gives r with its sign kept.
Parting parting_of(const glm::mat3& cluster, const Alone& a, const Alone& b, const glm::vec3& expected) {
  const glm::mat3 excess = cluster - a.share * a.covariance - b.share * b.covariance;
  const float single = 0.5F * (a.share * trace_of(a.covariance) + b.share * trace_of(b.covariance));
  const float length_square = glm::dot(expected, expected);
  if (!(length_square > 1.0e-12F) || !(single > 0)) return {};
  const glm::vec3 along = excess * expected;
  const float variance = glm::dot(expected, along) / length_square;
  if (!(variance > 0)) return {};
  const glm::vec3 seen = along * (1 / std::sqrt(a.share * b.share * variance * length_square));
  return {seen - expected, std::clamp(glm::dot(seen, seen) / single - 1, 0.0F, 1.0F)};
}

// ---- one frame ----

struct Follow {
  std::span<Finger> fingers;
  std::uint32_t elapsed_us;
  std::uint32_t memory_us;
  bool steady;
  float frame_s = shader::seconds_of(elapsed_us);
  float scale = reach_of(frame_s, 0, 0);
  std::uint32_t known = 0;
  std::array<Candidate, Tracks::most> candidates{};
  std::array<float, max_fingers> birth_cost{};
  std::array<Index, max_fingers> track_of{};
  std::array<bool, Tracks::most> home_taken{};

  std::span<Candidate> tracks() { return std::span(candidates).first(known); }

  void move_on(const Tracks& before);
  float cost_of(std::uint32_t finger, std::uint32_t column) const;
  void find_birth_costs();
  void assign();
  void merge();
  void move_cluster(std::uint32_t finger, Candidate& track, std::uint32_t passengers);
  void part(const glm::mat3& cluster, float total, Candidate& track, Candidate& other) const;
  void choose_who_stays();
  glm::vec3 joined(std::uint32_t finger, const Tracks& all) const;
  Track followed(std::uint32_t finger, std::uint32_t new_id, std::uint32_t new_home, const glm::vec3& joined);
  void go_on(std::uint32_t finger, Candidate& track, Track& now);
  void turn(CrossSection& section, const Candidate* before) const;
};

void Follow::move_on(const Tracks& before) {
  known = before.count;
  for (std::uint32_t t = 0; t < known; ++t) {
    Candidate& c = candidates[t];
    c.old = before.tracks[t];
    c.unseen_us = us_after(c.old.unseen_us, elapsed_us);
    const bool carried = c.old.carrier.has_value();
    c.alive = c.unseen_us <= (carried ? std::max(merged_memory_us, memory_us) : memory_us);
    const std::uint32_t coasts_us = std::min(c.unseen_us, coasting_us) - std::min(c.old.unseen_us, coasting_us);
    c.velocity = c.old.velocity;
    c.place = c.old.place + c.velocity * (carried ? frame_s : shader::seconds_of(coasts_us));
    c.reach = reach_of(frame_s, shader::seconds_of(c.old.unseen_us), c.old.stray);
    c.penalty = c.old.unseen_us == 0 && !carried ? 0 : second_class;
  }
}

/// Cost of matching a finger with a track: the squared distance, in reaches of a track that was just seen; out_of_reach
/// if it is farther than the track's own reach. Columns beyond the tracks are births.
float Follow::cost_of(std::uint32_t finger, std::uint32_t column) const {
  if (column >= Tracks::most) return column - Tracks::most == finger ? birth_cost[finger] : out_of_reach;
  const Candidate& c = candidates[column];
  if (!c.alive || c.old.solid != fingers[finger].solid) return out_of_reach;
  const float square = square_apart(fingers[finger].section.centroid, c.place);
  return square > c.reach * c.reach ? out_of_reach : square / (scale * scale) + c.penalty;
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
class Assignment {
 public:
  explicit Assignment(const Follow& follow)
      : follow_(follow), count_(static_cast<std::uint32_t>(follow.fingers.size())) {
    for (std::uint32_t t = 0; t < std::max(follow.known, count_); ++t) {
      if (t < follow.known) order_.push_back(t);
      if (t < count_) order_.push_back(Tracks::most + t);
    }
    for (std::uint32_t finger = 0; finger < count_; ++finger)
      find_path(finger);
  }
  /// The finger of a column.
  Index row_of(std::uint32_t column) const { return row_of_[column]; }

 private:
  static constexpr std::uint32_t columns = Tracks::most + max_fingers;

  /// The shortest path from a finger to a column without one. Each finger on it moves to the next column.
  void find_path(std::uint32_t finger) {
    least_.fill(no_cost_yet);
    visited_ = {};
    Index current, row = finger;
    while (row) {
      look_from(*row, current);
      current = nearest_;
      row_price_[finger] += best_;
      visited_[nearest_] = true;
      row = row_of_[nearest_];
    }
    while (current) {
      const Index before = way_[*current];
      row_of_[*current] = before ? row_of_[*before] : finger;
      current = before;
    }
  }

  /// Finds the nearest column that is not visited, from a row at which column `current` led, and lowers all costs by
  /// its.
  void look_from(std::uint32_t row, const Index& current) {
    best_ = no_cost_yet;
    for (const std::uint32_t column : order_) {
      if (visited_[column]) continue;
      const float reduced = follow_.cost_of(row, column) - row_price_[row] - price_[column];
      if (reduced < least_[column]) {
        least_[column] = reduced;
        way_[column] = current;
      }
      if (least_[column] < best_) {
        best_ = least_[column];
        nearest_ = column;
      }
    }
    for (const std::uint32_t column : order_) {
      if (visited_[column]) {
        row_price_[*row_of_[column]] += best_;
        price_[column] -= best_;
      } else {
        least_[column] -= best_;
      }
    }
  }

  const Follow& follow_;
  std::uint32_t count_;
  InplaceVector<std::uint32_t, columns> order_;
  std::array<float, max_fingers> row_price_{};
  std::array<float, columns> price_{}, least_{};
  std::array<Index, columns> row_of_{}, way_{};
  std::array<bool, columns> visited_{};
  float best_ = 0;             ///< the least cost found,
  std::uint32_t nearest_ = 0;  ///< and its column
};

void Follow::assign() {
  const Assignment assignment(*this);
  for (std::uint32_t t = 0; t < known; ++t) {
    const Index row = candidates[t].row = candidates[t].owner = assignment.row_of(t);
    if (row) track_of[*row] = t;
  }
}

/// For tracks without a finger: finds the cluster into which they have merged.
void Follow::merge() {
  for (Candidate& c : tracks()) {
    if (c.row || !c.alive) continue;
    if (!c.old.carrier && c.old.unseen_us > coasting_us) continue;
    if (c.old.carrier && *c.old.carrier < known) c.owner = candidates[*c.old.carrier].row;
    float best = 1;
    for (std::uint32_t f = 0; f < fingers.size(); ++f) {
      if (fingers[f].solid != c.old.solid) continue;
      const float square = inside_square(fingers[f].section, c.place - fingers[f].section.centroid);
      if (square < best) {
        best = square;
        c.owner = f;
      }
    }
    c.merged = c.owner.has_value();
  }
}

void Follow::choose_who_stays() {
  std::size_t room = Tracks::most - fingers.size();
  for (Candidate& c : tracks()) {
    c.stays = !c.row && c.alive && (c.merged || c.unseen_us <= memory_us) && room > 0;
    if (c.stays) --room;
    if (c.stays || c.row) home_taken[c.old.home] = true;
  }
}

/// Moves a track and the passengers of its cluster so that their mean is the cluster's centroid.
void Follow::move_cluster(std::uint32_t finger, Candidate& track, std::uint32_t passengers) {
  const CrossSection& section = fingers[finger].section;
  const glm::mat3 cluster = covariance_of(section);
  const auto is_member = [&](const Candidate& c) { return &c == &track || c.rides_with(finger); };
  float total = track.weight();
  Candidate* other = &track;
  for (Candidate& c : tracks()) {
    if (!c.rides_with(finger)) continue;
    total += c.weight();
    other = &c;
  }
  glm::vec3 mean{0};
  for (const Candidate& c : tracks()) {
    if (is_member(c)) mean += c.place * (c.weight() / total);
  }
  const glm::vec3 shift = section.centroid - mean;
  for (Candidate& c : tracks()) {
    if (!is_member(c)) continue;
    c.place += shift;
    c.velocity += shift * velocity_gain(frame_s);
  }
  if (passengers == 1) part(cluster, total, track, *other);
  const bool looks = looks_merged(cluster, track.old.covariance);
  for (Candidate& c : tracks()) {
    if (!is_member(c)) continue;
    const glm::vec3 offset = kept_inside(section, c.place - section.centroid);
    c.place = section.centroid + offset;
    c.stray = glm::length(offset);
    c.seen = looks;
  }
}

/// Corrects the way between the two fingers of a cluster.
void Follow::part(const glm::mat3& cluster, float total, Candidate& track, Candidate& other) const {
  const float share = track.weight() / total, other_share = other.weight() / total;
  const auto [correction, trust] = parting_of(cluster, {share, track.old.covariance},
                                              {other_share, other.old.covariance}, other.place - track.place);
  const float part = 0.5F * trust, back = other_share * part, on = share * part, gain = velocity_gain(frame_s);
  track.place -= correction * back;
  other.place += correction * on;
  track.velocity -= correction * (back * gain);
  other.velocity += correction * (on * gain);
}

/// Zero for a finger that is nearly where it is expected, or was not in the frame before.
glm::vec3 Follow::joined(std::uint32_t f, const Tracks& all) const {
  const Index t = track_of[f];
  if (!t || *t >= all.skin_before.fingers) return glm::vec3(0);
  const Candidate& track = candidates[*t];
  constexpr float near = 0.3e-3F;
  if (square_apart(fingers[f].section.centroid, track.place) <= near * near) return glm::vec3(0);
  return moved_by_members(all.skin_before.places[*t], all.skin.places[f], track.place - track.old.place);
}

/// What a track that goes on in a finger keeps.
void Follow::go_on(std::uint32_t f, Candidate& track, Track& now) {
  now.id = track.old.id;
  now.home = track.old.home;
  if (track.glides_on()) now.since_us = track.unseen_us;
  const auto passengers =
      static_cast<std::uint32_t>(std::ranges::count_if(tracks(), [&](const Candidate& c) { return c.rides_with(f); }));
  if (passengers == 0) {
    const glm::vec3 surprise = now.place - now.joined - track.place;
    track.velocity += surprise * velocity_gain(shader::seconds_of(track.unseen_us));
  } else {
    move_cluster(f, track, passengers);
    now.contacts = track.old.contacts;
    now.covariance = track.old.covariance;
    now.place = track.place;
    now.stray = track.stray;
  }
  now.velocity = track.velocity;
}

/// Turns a section's principal axes to steady ones.
void Follow::turn(CrossSection& section, const Candidate* before) const {
  if (before && before->old.has_axes) {
    take_steady_axes(section, before->old.axis1, before->old.axis3, shader::seconds_of(before->unseen_us));
  } else {
    take_first_axes(section);
  }
}

Track Follow::followed(std::uint32_t f, std::uint32_t new_id, std::uint32_t new_home, const glm::vec3& joined) {
  Finger& finger = fingers[f];
  Candidate* const before = track_of[f] ? &candidates[*track_of[f]] : nullptr;
  Track now{.id = new_id,
            .solid = finger.solid,
            .home = new_home,
            .place = finger.section.centroid,
            .has_axes = !finger.point_like,
            .contacts = static_cast<std::uint32_t>(finger.contacts.size()),
            .covariance = covariance_of(finger.section),
            .joined = joined};
  if (before) go_on(f, *before, now);
  if (steady && !finger.point_like) turn(finger.section, before);
  now.axis1 = finger.section.axes[0];
  now.axis3 = finger.section.axes[2];
  if (finger.point_like && before && before->old.has_axes) {
    now.has_axes = true;
    now.axis1 = before->old.axis1;
    now.axis3 = before->old.axis3;
  }
  finger.id = now.id;
  return now;
}

/// Keeps the places of the fingers' contacts, and of those of the frame before.
void keep_skin(const Touch& touch, Tracks& tracks) {
  std::swap(tracks.skin, tracks.skin_before);
  tracks.skin.fingers = touch.finger_count;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    std::vector<glm::vec3>& places = tracks.skin.places[f];
    const std::vector<std::uint32_t>& contacts = touch.fingers[f].contacts;
    places.clear();
    if (places.capacity() < contacts.size()) {  // more, so that it does not grow again in each frame with a few more
      for (Tracks::Skin* skin : {&tracks.skin, &tracks.skin_before})
        skin->places[f].reserve(std::max<std::size_t>(2 * contacts.size(), 1024));
    }
    for (const std::uint32_t i : contacts)
      places.push_back(touch.contacts[i].position);
  }
}

}  // namespace

std::optional<std::uint32_t> FrameClock::elapsed_us(double time_s) {
  const std::optional<double> last_s = std::exchange(last_s_, time_s);
  if (!last_s) return {};
  const double elapsed = (time_s - *last_s) * 1e6;
  constexpr double forever = 4e9;
  return static_cast<std::uint32_t>(elapsed >= 0 && elapsed < forever ? std::llround(elapsed) : std::llround(forever));
}

void follow_fingers(Tracks& tracks, std::optional<std::uint32_t> elapsed_us, const StageSetting& setting,
                    Touch& touch) {
  Follow follow{std::span(touch.fingers).first(touch.finger_count), elapsed_us.value_or(0), setting.memory_us(),
                setting.axes == Axes::steady};
  if (!elapsed_us) tracks.count = tracks.skin.fingers = 0;
  keep_skin(touch, tracks);
  follow.move_on(tracks);
  follow.find_birth_costs();
  follow.assign();
  follow.merge();
  follow.choose_who_stays();
  tracks.count = 0;
  std::uint32_t home = 0;  // the first home that may be free
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const bool born = !follow.track_of[f];
    while (born && follow.home_taken[home])
      ++home;
    const glm::vec3 joined = setting.rules.members ? follow.joined(f, tracks) : glm::vec3(0);
    tracks.tracks[tracks.count++] = follow.followed(f, tracks.next_id, home, joined);
    if (!born) continue;
    ++tracks.next_id;
    ++home;
  }
  for (const Candidate& c : follow.tracks()) {
    if (!c.stays) continue;
    Track& t = tracks.tracks[tracks.count++] = c.old;
    t.carrier = c.merged ? c.owner : std::nullopt;
    t.left_home = t.left_home || c.merged;
    t.unseen_us = c.seen ? 0 : c.unseen_us;
    t.place = c.place;
    t.stray = c.stray;
    t.velocity = c.velocity;
  }
}

}  // namespace palpa::touch
