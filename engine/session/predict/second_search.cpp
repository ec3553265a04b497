#include "session/predict/second_search.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "touch/contacts/contacts_twin.hpp"
#include "touch/contacts/pixel_stride.hpp"
#include "touch/fingers/known.hpp"
#include "touch/fingers/sections.hpp"
#include "touch/fingers/sectors.hpp"
#include "touch/fingers/steady_axes.hpp"

namespace palpa::session {
namespace {

/// If wide clusters are not examined, fingers have no stated width.
constexpr double default_width_m = 25e-3;
/// A finger with more pixels around it is examined at every 2nd or 3rd pixel of every 2nd or 3rd row. Only the
/// differences between two places count, and both have the same points.
constexpr std::size_t enough_pixels = 3000;
constexpr std::uint32_t most_stride = 3;
/// A finger with fewer contacts at a stride is not silenced before every pixel was examined.
constexpr std::uint32_t enough_contacts = 8;

double square_apart(const Box& box, const glm::vec3& p) {
  const Vec3 way = Vec3(p) - glm::clamp(Vec3(p), box.low, box.high);
  return glm::dot(way, way);
}

}  // namespace

Box contact_box(const touch::Finger& finger) {
  const touch::CrossSection& section = finger.section;
  Vec3 variance(0);
  for (int axis = 0; axis < 3; ++axis) {
    // The eigenvalues are those of the plane's principal directions, which the axes need not be.
    const double value = axis < 2 ? std::max(section.eigenvalues[0], section.eigenvalues[1]) : section.eigenvalues[2];
    variance += value * Vec3(section.axes[axis]) * Vec3(section.axes[axis]);
  }
  // If points fill a circle or a line evenly, none is farther from the middle than two standard deviations.
  const Vec3 half = 2.0 * glm::sqrt(glm::max(variance, Vec3(0)));
  return {Vec3(section.centroid) - half, Vec3(section.centroid) + half};
}

SecondSearch::SecondSearch(const CameraView& view, const touch::PreparedSolids& solids,
                           const touch::FingerOptions& parameters)
    : view_(view),
      solids_(solids),
      parameters_(parameters),
      reach_m_(parameters.finger_width_m > 0 ? parameters.finger_width_m : default_width_m) {
  parameters_.deep = false;
  parameters_.cluster = touch::Cluster::contacts;
  for (touch::Touch* touch : {&before_, &after_})
    touch->fingers.resize(1);
}

/// Takes the skin that moves with the finger, at every pixel, or at a stride if it has many.
void SecondSearch::take_points(const touch::Touch& seen, std::uint32_t f, const KeptFrames& frames, const Vec3& way,
                               std::uint32_t largest_stride) {
  const Box contacts = contact_box(seen.fingers[f]);
  const Box box{contacts.low - reach_m_, contacts.high + reach_m_};
  sensing::plan_crops(view_.cameras, view_.tables, box, crops_);
  std::size_t pixels = 0;
  for (const sensing::Crop& crop : crops_)
    pixels += std::size_t{crop.blocks()} * sensing::block_pixels;
  std::uint32_t stride = stride_;
  while (stride < largest_stride && pixels > enough_pixels * stride * stride)
    ++stride;
  points_stride_ = stride;
  touch::set_stride(crops_, stride);
  volumes_.clear();
  if (view_.surroundings) sensing::plan_drops(*view_.surroundings, box, volumes_);
  sensing::find_skin(view_.tables, frames.images(), box, crops_, volumes_, skin_);
  points_ = skin_.points;
  others_.clear();
  for (std::uint32_t other = 0; other < seen.finger_count; ++other) {
    if (other != f) others_.push_back(contact_box(seen.fingers[other]));
  }
  std::erase_if(points_, [&](const sensing::SkinPoint& point) {
    const double own = square_apart(contacts, point.position);
    for (const Box& other : others_) {
      if (square_apart(other, point.position) < own) return true;
    }
    return own > reach_m_ * reach_m_;
  });
  moved_ = points_;
  for (sensing::SkinPoint& point : moved_)
    point.position += glm::vec3(way);
}

bool SecondSearch::find(const touch::Finger& finger, std::span<const sensing::SkinPoint> points,
                        const touch::FingerOptions& parameters, touch::Touch& out) const {
  find_contacts(points, solids_, parameters, {}, out);
  touch::Finger& found = out.fingers[0];
  found.solid = finger.solid;
  found.contacts.clear();
  for (std::uint32_t i = 0; i < out.contacts.size(); ++i) {
    if (out.contacts[i].solid == finger.solid) found.contacts.push_back(i);
  }
  found.contact_count = static_cast<std::uint32_t>(found.contacts.size());
  if (found.contact_count < touch::least_contacts(parameters.min_points, finger.holds)) return false;
  out.finger_count = 1;
  find_sections(out);
  if (!found.point_like) take_axes(found.section, finger.section.axes);
  find_foci(parameters, solids_.foci_of, out);
  return true;
}

bool SecondSearch::is_near(const touch::Finger& finger, std::span<const sensing::SkinPoint> points,
                           const touch::FingerOptions& parameters) {
  if (finger.inward == glm::vec3(0)) return false;
  constexpr float everywhere = 3.0e38F;
  reach_.count = 1;
  reach_.fingers[0] = {.velocity = {},
                       .centre = {0, 0, 0, everywhere},
                       .inward = {finger.inward.x, finger.inward.y, finger.inward.z, 0},
                       .solid = finger.solid};
  find_contacts(points, solids_, parameters, {&reach_, 0}, after_);
  return std::ranges::any_of(after_.contacts,
                             [&](const touch::Contact& contact) { return contact.solid == finger.solid; });
}

bool SecondSearch::move(const touch::Touch& seen, std::uint32_t f, const Vec3& way, const KeptFrames& frames,
                        touch::Touch& out) {
  if (move_at(seen, f, way, frames, most_stride, out)) return true;
  // If few contacts are left at a stride, every pixel must tell.
  const touch::Finger& finger = seen.fingers[f];
  const bool few = finger.contact_count < enough_contacts * points_stride_ * points_stride_;
  return finger.holds && few && points_stride_ > stride_ && move_at(seen, f, way, frames, stride_, out);
}

bool SecondSearch::move_at(const touch::Touch& seen, std::uint32_t f, const Vec3& way, const KeptFrames& frames,
                           std::uint32_t largest_stride, touch::Touch& out) {
  const touch::Finger& finger = seen.fingers[f];
  take_points(seen, f, frames, way, largest_stride);
  const touch::FingerOptions parameters = touch::at_stride(parameters_, points_stride_);
  // If the skin was not kept, nothing is known of it.
  if (!find(finger, points_, parameters, before_)) {
    add_moved(seen, f, way, out);
    return true;
  }
  if (!find(finger, moved_, parameters, after_)) {
    if (!finger.holds || !is_near(finger, moved_, parameters)) return false;
    add_moved(seen, f, way, out);
    return true;
  }
  const touch::Finger &old = before_.fingers[0], &now = after_.fingers[0];
  touch::Finger& moved = add_moved(seen, f, way, out);
  out.contacts.resize(out.contacts.size() - moved.contacts.size());
  moved.contacts.clear();
  for (const std::uint32_t i : now.contacts) {
    moved.contacts.push_back(static_cast<std::uint32_t>(out.contacts.size()));
    out.contacts.push_back(after_.contacts[i]);
  }
  moved.contact_count = now.contact_count;
  moved.section = now.section;
  const glm::vec3 mean_way = now.section.centroid - old.section.centroid;
  moved.section.centroid = finger.section.centroid + mean_way;
  if (finger.point_like || now.point_like) {
    moved.section.axes = finger.section.axes;
    for (std::size_t n = 0; n < moved.foci.size(); ++n)
      moved.foci[n].position = finger.foci[n].position + mean_way;
    return true;
  }
  for (std::size_t n = 0; n < moved.foci.size() && n < now.foci.size(); ++n) {
    touch::Focus& focus = moved.foci[n];
    const bool both = n < old.foci.size() && old.foci[n].points > 0 && now.foci[n].points > 0;
    focus.position = finger.foci[n].position + (both ? now.foci[n].position - old.foci[n].position : mean_way);
    if (!moved.placed) focus.points = now.foci[n].points;
    if (!moved.placed && finger.foci[n].points == 0) focus.position = now.foci[n].position;
  }
  return true;
}

touch::Finger& add_moved(const touch::Touch& seen, std::uint32_t f, const Vec3& way, touch::Touch& out) {
  if (out.finger_count == out.fingers.size()) out.fingers.emplace_back();
  touch::Finger& moved = out.fingers[out.finger_count++];
  moved = seen.fingers[f];
  moved.section.centroid += glm::vec3(way);
  for (touch::Focus& focus : moved.foci)
    focus.position += glm::vec3(way);
  for (std::uint32_t& contact : moved.contacts) {
    touch::Contact copy = seen.contacts[contact];
    copy.position += glm::vec3(way);
    contact = static_cast<std::uint32_t>(out.contacts.size());
    out.contacts.push_back(copy);
  }
  return moved;
}

}  // namespace palpa::session
