// The data that SplitPass and BridgePass work on, between guard words.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/known/known.h"
#include "shaders/touch/split/split.h"
#include "support/device.hpp"
#include "touch/bridge/bridge_cameras.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {

/// The output of FingersPass for a touch that is neither split nor bridged, as buffers exactly as large as the contract
/// says.
struct GuardedFingers {
  GuardedFingers(gpu::Device& device, const std::vector<sensing::Camera>& cameras, const sensing::RayTables& tables,
                 const std::vector<sensing::DepthFrame>& images, const Touch& touch,
                 std::vector<gpu::ScratchBuffer> pieces, std::uint32_t more_clusters = 0)
      : depth(device, sensing::packed_bytes(tables)),
        rays(palpa::test::GuardedBuffer::of<glm::vec2>(device, tables.rays)),
        records(palpa::test::GuardedBuffer::of<shader::BridgeCamera>(device, bridge_cameras(cameras, tables))),
        total(device, sizeof(shader::ScanTotal)),
        contacts(device, touch.contacts.size() * sizeof(shader::ContactRecord)),
        parents(device, touch.contacts.size() * 4),
        clusters(device, (touch.contacts.size() + more_clusters) * sizeof(shader::Cluster)),
        header(device, sizeof(shader::TouchHeader)),
        fingers(device, max_fingers * sizeof(shader::FingerRecord)),
        known(device, sizeof(shader::KnownTable)),
        scratch(device, std::move(pieces)) {
    std::vector<std::uint16_t> packed(tables.padded_pixels);
    sensing::pack_depth(tables, images, packed);
    depth.write(packed.data(), packed.size() * 2);
    const auto count = static_cast<std::uint32_t>(touch.contacts.size());
    const shader::ScanTotal found{count, gpu::groups_for(count, shader::contact_group), 1, 1};
    total.write(&found, sizeof(found));
    std::vector<shader::ContactRecord> all(count);
    std::vector<std::uint32_t> roots(count);
    std::vector<shader::Cluster> sizes(count, {shader::fingers_nothing, 0});
    for (std::uint32_t i = 0; i < count; ++i) {
      const Contact& c = touch.contacts[i];
      all[i] = {c.position.x, c.position.y, c.position.z, c.point, c.solid, c.depth_m};
      roots[i] = i;
      sizes[i] = {i, 1};
    }
    std::vector<shader::FingerRecord> list(max_fingers);
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      const Finger& finger = touch.fingers[f];
      // Any member may be the root: here, it is the last one.
      for (const std::uint32_t i : finger.contacts)
        roots[i] = finger.contacts.back();
      sizes[finger.contacts.back()] = {finger.contacts.front(), finger.contact_count};
      list[f].first = finger.contacts.front();
      list[f].solid = finger.solid;
      list[f].contacts = finger.contact_count;
    }
    shader::TouchHeader head{touch.finger_count, 1, 1, touch.cluster_count, count};
    head.look_y = shader::split_looks;
    head.look_z = head.parts_y = head.parts_z = head.assign_y = head.assign_z = head.list_y = head.list_z = 1;
    head.patches_x = touch.finger_count > 1 ? touch.finger_count : 0;
    head.join_x = touch.finger_count > 1 ? 1 : 0;
    head.patches_y = head.patches_z = head.join_y = head.join_z = head.relabel_y = head.relabel_z = 1;
    contacts.write(all.data(), all.size() * sizeof(all[0]));
    parents.write(roots.data(), roots.size() * 4);
    clusters.write(sizes.data(), sizes.size() * sizeof(sizes[0]));
    header.write(&head, sizeof(head));
    fingers.write(list.data(), list.size() * sizeof(list[0]));
  }

  /// BridgeBindings, and SplitBindings as well.
  template <typename Bindings>
  Bindings bindings() const {
    return {depth.ref(),   rays.ref(),     records.ref(), total.ref(),   contacts.ref(),
            parents.ref(), clusters.ref(), header.ref(),  fingers.ref(), known.ref()};
  }

  palpa::test::GuardedBuffer depth, rays, records, total, contacts, parents, clusters, header, fingers, known;
  palpa::test::GuardedScratch scratch;

  bool intact() {
    bool all = scratch.intact();
    for (palpa::test::GuardedBuffer* buffer :
         {&depth, &rays, &records, &total, &contacts, &parents, &clusters, &header, &fingers, &known})
      all = buffer->intact() && all;
    return all;
  }
};

}  // namespace palpa::touch::test
