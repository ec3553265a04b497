// Fingers: exact Euclidean clusters of each solid's contacts. Two contacts of one solid no farther apart than the
// finger gap are in one cluster, and so is whatever hangs together through others; a cluster of at least min_points is
// a finger.
//
// Method: cells so small that all contacts of one cell are in one cluster (Wang, Gu, Shun 2020), eight to a block,
// blocks in a hash table; pairs of contacts are tested only between cells of blocks that touch, up to the first hit; a
// lock-free union-find with path halving joins them (Jaiganesh and Burtscher's ECL-CC, HPDC 2018).
#pragma once

#include <algorithm>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/timestamps.hpp"
#include "shaders/fingers.h"
#include "touch/scene_table.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Throws bad_usage unless delta and finger gap are finite and positive, the finger width finite and not negative, 1 <=
/// foci <= max_foci, and the gap is not so small against the largest solid (1/18,000 of half its size) that single
/// precision could not place a contact in a cell.
void check(const Parameters& parameters, const SceneTable& table);

/// C++ twin of FingersPass: fills `out.fingers` (solid and contacts), `finger_count` and `cluster_count` from
/// `out.contacts`, with Cluster::inside from `out.deep` as well. The distance test is the same single-precision
/// arithmetic, so the partition is the same.
void find_fingers(const Parameters& parameters, const SceneTable& table, Touch& out);

/// What the pass reads and writes, with room for `most_contacts`.
struct FingersBuffers {
  gpu::BufferRef length;    ///< in: shader::ScanTotal of the skin points, for the header only
  gpu::BufferRef solids;    ///< in: shader::SolidRecord[]
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]
  gpu::BufferRef nodes;     ///< scratch: 16 bytes per contact
  gpu::BufferRef keys;      ///< scratch: 8 bytes per contact
  gpu::BufferRef places;    ///< scratch: 4 bytes per contact
  gpu::BufferRef slots;     ///< scratch: 4 bytes for each of slots_for(most_contacts)
  gpu::BufferRef heads;     ///< scratch: 32 bytes per contact
  gpu::BufferRef list;      ///< scratch: 4 bytes per contact
  gpu::BufferRef groups;    ///< scratch: 4 bytes per contact
  gpu::BufferRef crowded;   ///< scratch: 4 bytes per contact, at least 16
  gpu::BufferRef clusters;  ///< scratch: 8 bytes per contact
  gpu::BufferRef work;      ///< scratch: shader::FingersWork
  gpu::BufferRef parents;   ///< out: per contact a number that its cluster alone has (not the same on every run)
  gpu::BufferRef header;    ///< out: shader::TouchHeader
  gpu::BufferRef fingers;   ///< out: shader::FingerRecord[max_fingers], first, solid and contacts
  std::uint32_t most_contacts = 0;
  // Only for Cluster::inside; the scratch and `parents` then have room for most_contacts + most_deep.
  gpu::BufferRef deep_total = {};    ///< in: shader::ScanTotal of the deep points
  gpu::BufferRef deep = {};          ///< in: shader::ContactRecord[]
  gpu::BufferRef inside_total = {};  ///< scratch: shader::ScanTotal
  gpu::BufferRef inside = {};        ///< scratch: shader::ContactRecord[]
  std::uint32_t most_deep = 0;
};

/// Side of the cells for a gap; contacts of one cell are within the gap, whatever rounding does.
inline float cells_per_metre(float gap) {
  return 1.0F / (static_cast<float>(shader::fingers_cell_thousandths) * 1e-3F * gap);
}
/// The gap as single precision has it. Beyond every solid it means one cluster per solid; its square must stay a
/// number.
inline float float_gap(const Parameters& parameters) {
  return std::min(static_cast<float>(parameters.finger_gap_m), 1e9F);
}

/// Slots of the hash table for that many contacts.
std::uint32_t slots_for(std::uint32_t contacts);

/// Pipelines only; eight dispatches, and gather before them for Cluster::inside: prepare, insert, blocks, link,
/// crowded, rest, label, select. Every loop is bounded; the fingers do not depend on the order in which anything ran.
class FingersPass {
 public:
  explicit FingersPass(const gpu::Device& device);

  /// Barriers: expects total and contacts to be visible to compute and as indirect arguments; adds its own inside; the
  /// caller adds compute_to_compute afterwards. Throws what check() throws.
  /// With `times`, marks "cells", "links" and "fingers".
  void record(VkCommandBuffer commands, const FingersBuffers& buffers, const SceneTable& table,
              const Parameters& parameters, gpu::Timestamps* times = nullptr) const;

 private:
  gpu::ComputePipeline gather_, label_inside_, prepare_, insert_, blocks_, link_, crowded_, rest_, label_, select_;
};

}  // namespace palpa::touch
