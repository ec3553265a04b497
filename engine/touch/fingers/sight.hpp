// The cameras' view of the skin around contacts, for the steps that look at the depth frames again.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "base/inplace_vector.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"
#include "touch/fingers/exact.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// A camera with the data to use its picture in both directions: pixel to point and point to pixel.
struct SightCamera {
  glm::mat4 T_world_camera, T_camera_world;
  float fx, fy, cx, cy;
  float k1, k2, p1, p2, k3;
  float reach;                // the square of the longest ray of the picture: beyond it the lens model may fold back
  float depth_unit;           // metres
  std::uint32_t first_depth;  // raw depths below are no data
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t pitch;        // pixels from row to row of the padded arrangement
  std::uint32_t first_pixel;  // of the padded arrangement
  std::uint32_t first_index;  // of the camera's skin points
};

std::vector<SightCamera> sight_cameras(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables);

/// One picture per camera.
struct Sight {
  std::span<const SightCamera> cameras;
  const sensing::RayTables& tables;
  std::span<const sensing::DepthFrame> images;
};

std::uint32_t raw_at(const Sight& sight, std::size_t camera, std::uint32_t u, std::uint32_t v);

/// The pixel at which a camera sees a skin point.
struct SeenPixel {
  std::size_t camera;
  std::uint32_t u, v;
};
SeenPixel pixel_of(const Sight& sight, std::uint32_t point);

/// A place in a camera's coordinates.
glm::vec3 seen_from(const SightCamera& camera, const glm::vec3& world);

/// The pixel and depth at which a place in front of a camera appears. Outside the picture: depth 0.
struct Appearance {
  std::uint32_t u = 0, v = 0;
  float depth = 0;
};
Appearance appearance(const SightCamera& camera, const glm::vec3& world);

/// A larger step in depth than this is the edge of another object.
inline constexpr float surface_step_m = 4e-3F;

/// How much two depths at this distance from a camera may differ on one surface, metres: a depth camera's noise grows
/// with the distance. A valley is at least as deep.
float noise_at(float depth);

/// Whether enough pixels around a contact's pixel, itself included, are about as far away. Flying pixels are not firm.
bool is_firm(const Sight& sight, std::uint32_t point);

/// Moves flying pixels from `points` to the end of `flying`. Both keep their order.
void part_flying(const Sight& sight, std::vector<sensing::SkinPoint>& points, std::vector<sensing::SkinPoint>& flying);

/// The skin's outward normal at a contact's pixel. It is zero if the pixel's neighbours do not give one: such pixels
/// lie on rims or float beside them.
glm::vec3 normal_at(const Sight& sight, std::uint32_t point);

/// A contact that represents others, and the skin's outward normal at that contact.
struct SkinSample {
  glm::vec3 position, normal;
};

/// At most most_samples of a finger's contacts, in the order of a hash of their skin points. Skin at rest, of which a
/// camera sees the same pixels in each frame, therefore keeps most of its samples.
inline constexpr std::uint32_t most_samples = 64;
using SampledContacts = InplaceVector<std::uint32_t, most_samples>;
SampledContacts sample_contacts(const Touch& touch, const Finger& finger);
/// The same samples with their normals; contacts without a normal are left out.
using SkinSamples = InplaceVector<SkinSample, most_samples>;
SkinSamples sample_skin(const Sight& sight, const Touch& touch, const Finger& finger);

/// The direction of the mean of their normals. Zero if they do not give one.
glm::vec3 normal_of(const SkinSamples& samples);

/// The point inside a finger of that width, below its skin.
glm::vec3 inside_of(const SkinSample& sample, float finger_width);

}  // namespace palpa::touch
