// Hidden skin: patches of contacts on two sides of one fingertip, its underside seen by no camera, are one finger.
//
// Euclidean clusters of one solid are joined where three things hold (docs/touch.md tells why):
// - together they are no wider than a finger, along the line between their means;
// - between the contacts that face each other the way enters the skin at either end, as it does between any two places
//   of a convex body: the skin's outward normals are those of the depth pictures;
// - no camera saw the space between them empty: that is, something clearly farther than it, in its direction.
// The surest pair is joined first; two patches that cannot be one finger are never joined through a third.
#pragma once

#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "shaders/bridge.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// The cameras as the pass and its twin read them.
std::vector<shader::BridgeCamera> bridge_cameras(std::span<const sensing::Camera> cameras,
                                                 const sensing::RayTables& tables);

/// What the cameras saw: for the twin. One picture per camera.
struct Sight {
  std::span<const shader::BridgeCamera> cameras;
  const sensing::RayTables& tables;
  std::span<const sensing::DepthFrame> images;
};

/// C++ twin of BridgePass: joins fingers of `out`, whose contacts' points are pixels of the pictures. The arithmetic is
/// the same; where a device divides and takes roots exactly, so are the decisions.
void bridge_fingers(const Sight& sight, const Parameters& parameters, Touch& out);

/// The same on the device.
struct SightBuffers {
  gpu::BufferRef depth;    ///< in: packed by sensing::pack_depth
  gpu::BufferRef rays;     ///< in: sensing::upload_rays
  gpu::BufferRef cameras;  ///< in: bridge_cameras()
};

struct BridgeBuffers {
  SightBuffers sight;
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]
  gpu::BufferRef parents;   ///< in, out: as FingersPass leaves it; contacts of joined patches get one number
  gpu::BufferRef clusters;  ///< in, out: as FingersPass leaves it
  gpu::BufferRef header;    ///< in, out: shader::TouchHeader
  gpu::BufferRef fingers;   ///< in, out: shader::FingerRecord[max_fingers]
  gpu::BufferRef samples;   ///< scratch: shader::BridgeSample[bridge_fingers * bridge_samples]
  gpu::BufferRef patches;   ///< scratch: shader::BridgePatch[bridge_fingers]
  gpu::BufferRef pairs;     ///< scratch: shader::BridgePair[bridge_fingers * bridge_fingers]
  gpu::BufferRef work;      ///< scratch: shader::BridgeWork
  std::uint32_t most_contacts = 0;
};

/// Pipelines only; four dispatches: sample, pairs, join, relabel. With less than two fingers they do nothing.
class BridgePass {
 public:
  explicit BridgePass(const gpu::Device& device);

  /// Barriers: expects all inputs to be visible to compute and as indirect arguments; adds its own inside; the caller
  /// adds compute_to_compute afterwards.
  void record(VkCommandBuffer commands, const BridgeBuffers& buffers, const Parameters& parameters) const;

 private:
  gpu::ComputePipeline sample_, pairs_, join_, relabel_;
};

}  // namespace palpa::touch
