// The cameras' view of the skin around contacts, for the steps that look at the depth frames again.
#pragma once

#include <cstdint>
#include <span>

#include "base/inplace_vector.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "touch/fingers/bridge_math.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// One picture per camera.
struct Sight {
  std::span<const BridgeCamera> cameras;  ///< bridge_cameras()
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

/// The skin's outward normal at a contact's pixel; zero if its neighbours do not determine one.
Float3 normal_at(const Sight& sight, std::uint32_t point);

/// A contact that represents others, and the skin's outward normal at that contact.
struct SkinSample {
  Float3 position, normal;
};

/// At most bridge_samples of a finger's contacts, in the order of a hash of their numbers. The same contacts therefore
/// give the same samples.
using SampledContacts = InplaceVector<std::uint32_t, bridge_samples>;
SampledContacts sample_contacts(const Finger& finger);
/// The same samples with their normals; contacts without a normal are left out.
using SkinSamples = InplaceVector<SkinSample, bridge_samples>;
SkinSamples sample_skin(const Sight& sight, const Touch& touch, const Finger& finger);

}  // namespace palpa::touch
