// Each pass by itself, between guard words; and the structs that the shaders share with C++.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "gpu/barrier.hpp"
#include "spirv/contacts_find.comp.hpp"
#include "spirv/contacts_pack.comp.hpp"
#include "spirv/contacts_surface.comp.hpp"
#include "spirv/fingers_blocks.comp.hpp"
#include "spirv/fingers_crowded.comp.hpp"
#include "spirv/fingers_insert.comp.hpp"
#include "spirv/fingers_label.comp.hpp"
#include "spirv/fingers_link.comp.hpp"
#include "spirv/fingers_prepare.comp.hpp"
#include "spirv/fingers_select.comp.hpp"
#include "spirv/foci.comp.hpp"
#include "spirv/follow.comp.hpp"
#include "spirv/frames_axes.comp.hpp"
#include "spirv/frames_count.comp.hpp"
#include "spirv/frames_group.comp.hpp"
#include "support/device.hpp"
#include "support/spirv.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::GuardedBuffer;

/// Every buffer of the chain, exactly as large as its contract says, between guard words and filled with rubbish.
struct Guarded {
  Guarded(gpu::Device& device, const SceneTable& table, const std::vector<sensing::SkinPoint>& skin, std::size_t room)
      : points(GuardedBuffer::of<sensing::SkinPoint>(device, skin)),
        length(device, 16),
        solids(GuardedBuffer::of<shader::SolidRecord>(device, table.solids)),
        planes_of(GuardedBuffer::of<shader::PlaneCell>(device, table.cells)),
        planes(GuardedBuffer::of<shader::vec4>(device, table.planes)),
        borders(GuardedBuffer::of<shader::Border>(device, sector_borders())),
        hits(device, skin.size() * 8),
        masks(device, std::size_t{4} * mask_words(static_cast<std::uint32_t>(skin.size()))),
        counts(device, std::size_t{4} * shader::contacts_chunks),
        total(device, 16),
        contacts(device, room * 32),
        nodes(device, room * 16),
        keys(device, room * 8),
        places(device, room * 4),
        slots(device, std::size_t{4} * slots_for(static_cast<std::uint32_t>(room))),
        heads(device, room * 32),
        list(device, room * 4),
        groups(device, room * 4),
        crowded(device, room * 4 + 16),
        clusters(device, room * 8),
        work(device, sizeof(shader::FingersWork)),
        parents(device, room * 4),
        header(device, sizeof(shader::TouchHeader)),
        fingers(device, std::size_t{max_fingers} * sizeof(shader::FingerRecord)),
        foci(device, std::size_t{max_fingers} * max_foci * sizeof(shader::FocusRecord)),
        finger_counts(device, std::size_t{4} * shader::frames_most_chunks * max_fingers),
        tracks(device, sizeof(shader::TrackTable)),
        of_solid(GuardedBuffer::of<std::uint32_t>(device, table.foci_of)) {
    const auto count = static_cast<std::uint32_t>(skin.size());
    const shader::ScanTotal given{count, (count + 63) / 64, 1, 1};
    length.write(&given, sizeof(given));
  }

  GuardedBuffer points, length, solids, planes_of, planes, borders, hits, masks, counts, total, contacts, nodes, keys,
      places, slots, heads, list, groups, crowded, clusters, work, parents, header, fingers, foci, finger_counts,
      tracks, of_solid;

  bool intact() {
    bool all = true;
    int place = 0;
    for (GuardedBuffer* buffer :
         {&points,   &length,  &solids, &planes_of, &planes, &borders,       &hits,   &masks,   &counts,  &total,
          &contacts, &nodes,   &keys,   &places,    &slots,  &heads,         &list,   &groups,  &crowded, &clusters,
          &work,     &parents, &header, &fingers,   &foci,   &finger_counts, &tracks, &of_solid}) {
      const bool one = buffer->intact();
      EXPECT_TRUE(one) << "guard words of buffer " << place;
      all = all && one;
      ++place;
    }
    return all;
  }
};

void record_all(VkCommandBuffer commands, Guarded& b, const SceneTable& table, const Parameters& parameters,
                std::uint32_t points, std::uint32_t room) {
  static const ContactsPass contacts(palpa::test::test_device());
  static const FingersPass fingers(palpa::test::test_device());
  static const FramesPass frames(palpa::test::test_device());
  static const FollowPass follow(palpa::test::test_device());
  static const FociPass foci(palpa::test::test_device());
  contacts.record(commands,
                  {b.points.ref(),
                   b.length.ref(),
                   b.solids.ref(),
                   b.planes_of.ref(),
                   b.planes.ref(),
                   b.hits.ref(),
                   b.masks.ref(),
                   b.counts.ref(),
                   b.total.ref(),
                   b.contacts.ref(),
                   points,
                   room,
                   {}},
                  table, parameters);
  gpu::compute_to_compute(commands);
  fingers.record(commands,
                 {b.length.ref(), b.solids.ref(), b.total.ref(), b.contacts.ref(), b.nodes.ref(), b.keys.ref(),
                  b.places.ref(), b.slots.ref(), b.heads.ref(), b.list.ref(), b.groups.ref(), b.crowded.ref(),
                  b.clusters.ref(), b.work.ref(), b.parents.ref(), b.header.ref(), b.fingers.ref(), room},
                 table, parameters);
  gpu::compute_to_compute(commands);
  frames.record(commands, {b.total.ref(), b.parents.ref(), b.contacts.ref(), b.header.ref(), b.finger_counts.ref(),
                           b.nodes.ref(), b.fingers.ref(), room});
  gpu::compute_to_compute(commands);
  follow.record(commands, {b.header.ref(), b.fingers.ref(), b.tracks.ref()}, shader::follow_anew);
  gpu::compute_to_compute(commands);
  foci.record(commands,
              {b.nodes.ref(), b.header.ref(), b.fingers.ref(), b.foci.ref(), b.borders.ref(), b.of_solid.ref()},
              parameters);
}

TEST(TouchPassesByThemselves, StayInsideTheirBuffers) {
  gpu::Device& device = palpa::test::test_device();
  struct Case {
    std::uint32_t points, room;
    double gap;
  };
  for (const Case& c : {Case{1, 1, 5e-3}, Case{63, 63, 5e-3}, Case{4097, 4097, 1e-3}, Case{4097, 100, 5e-3},
                        Case{5000, 4999, 0.5}, Case{6000, 6000, 4.8e-3}}) {
    SCOPED_TRACE(c.points);
    const auto cloud = indexed(random_points(c.points, Vec3(-0.05), Vec3(0.05)));
    const SceneTable table = make_scene_table({everything(), cube()});
    const Parameters parameters = everything_is_contact(c.gap, 2);
    Guarded guarded(device, table, cloud, c.room);
    palpa::test::run_on_device(
        [&](VkCommandBuffer commands) { record_all(commands, guarded, table, parameters, c.points, c.room); });
    EXPECT_TRUE(guarded.intact());
    EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, c.points);

    // What had room is what the twin finds among the first points.
    Touch twin;
    touch_points(std::span(cloud).first(c.room), table, parameters, twin);
    const auto header = guarded.header.read<shader::TouchHeader>()[0];
    EXPECT_EQ(header.contacts, c.points);
    EXPECT_EQ(header.points, c.points);
    EXPECT_EQ(header.clusters, twin.cluster_count);
    const auto contacts = guarded.contacts.read<shader::ContactRecord>();
    const auto finger = finger_of_contacts(twin);
    for (std::uint32_t i = 0; i < c.room; ++i) {
      ASSERT_EQ(contacts[i].point, i);
      ASSERT_EQ(contacts[i].finger, static_cast<std::uint32_t>(finger[i])) << "contact " << i;
    }
  }
}

TEST(TouchPassesByThemselves, LeavePointsBeyondTheirRoomAlone) {
  gpu::Device& device = palpa::test::test_device();
  const auto cloud = indexed(random_points(1000, Vec3(-0.05), Vec3(0.05)));
  const SceneTable table = make_scene_table({everything()});
  Guarded guarded(device, table, cloud, 1000);
  const shader::ScanTotal boastful{1'000'000, 15'625, 1, 1};
  guarded.length.write(&boastful, sizeof(boastful));
  palpa::test::run_on_device(
      [&](VkCommandBuffer commands) { record_all(commands, guarded, table, everything_is_contact(), 1000, 1000); });
  EXPECT_TRUE(guarded.intact());
  EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, 1000u);
}

void expect_struct(const palpa::test::SpirvModule& module, const std::string& name, std::uint32_t size,
                   const std::map<std::string, std::uint32_t>& offsets, bool in_array) {
  const auto found = module.structs.find(name);
  ASSERT_NE(found, module.structs.end()) << name;
  for (const auto& [member, offset] : offsets) {
    ASSERT_TRUE(found->second.offsets.count(member)) << name << "." << member;
    EXPECT_EQ(found->second.offsets.at(member), offset) << name << "." << member;
  }
  if (in_array) {
    ASSERT_TRUE(module.array_strides.count(name)) << name;
    EXPECT_EQ(module.array_strides.at(name), size) << name;
  }
}

#define MEMBER(type, member) \
  { #member, static_cast < std::uint32_t>(offsetof(shader::type, member)) }

TEST(TouchShaders, LayOutTheirStructsAsCppDoes) {
  const auto find = palpa::test::read_spirv(spirv::contacts_find_comp);
  expect_struct(find, "SolidRecord", sizeof(shader::SolidRecord),
                {MEMBER(SolidRecord, centre), MEMBER(SolidRecord, low), MEMBER(SolidRecord, high),
                 MEMBER(SolidRecord, cells_per_metre), MEMBER(SolidRecord, first_cell),
                 MEMBER(SolidRecord, cells_per_axis), MEMBER(SolidRecord, delta), MEMBER(SolidRecord, by_surface)},
                true);
  expect_struct(
      find, "PlaneCell", sizeof(shader::PlaneCell),
      {MEMBER(PlaneCell, first), MEMBER(PlaneCell, count), MEMBER(PlaneCell, shallowest), MEMBER(PlaneCell, deepest)},
      true);
  expect_struct(find, "Hit", sizeof(shader::Hit), {MEMBER(Hit, solid), MEMBER(Hit, depth)}, true);
  expect_struct(find, "ContactsPush", sizeof(shader::ContactsPush),
                {MEMBER(ContactsPush, only), MEMBER(ContactsPush, solids), MEMBER(ContactsPush, delta),
                 MEMBER(ContactsPush, most_points), MEMBER(ContactsPush, most_contacts)},
                false);
  const auto pack = palpa::test::read_spirv(spirv::contacts_pack_comp);
  expect_struct(pack, "ContactRecord", sizeof(shader::ContactRecord),
                {MEMBER(ContactRecord, x), MEMBER(ContactRecord, point), MEMBER(ContactRecord, solid),
                 MEMBER(ContactRecord, depth), MEMBER(ContactRecord, finger)},
                true);
  const auto link = palpa::test::read_spirv(spirv::fingers_link_comp);
  expect_struct(link, "BlockKey", sizeof(shader::BlockKey), {MEMBER(BlockKey, xy), MEMBER(BlockKey, z_solid)}, true);
  expect_struct(link, "CrowdedPair", sizeof(shader::CrowdedPair),
                {MEMBER(CrowdedPair, block_a), MEMBER(CrowdedPair, block_b), MEMBER(CrowdedPair, cells_a),
                 MEMBER(CrowdedPair, cells_b)},
                true);
  expect_struct(link, "FingersWork", sizeof(shader::FingersWork),
                {MEMBER(FingersWork, blocks_x), MEMBER(FingersWork, blocks), MEMBER(FingersWork, links_x),
                 MEMBER(FingersWork, crowded_x), MEMBER(FingersWork, crowded), MEMBER(FingersWork, rest_x)},
                false);
  expect_struct(link, "FingersPush", sizeof(shader::FingersPush),
                {MEMBER(FingersPush, cells_per_metre), MEMBER(FingersPush, limit), MEMBER(FingersPush, most_contacts),
                 MEMBER(FingersPush, min_points)},
                false);
  const auto select = palpa::test::read_spirv(spirv::fingers_select_comp);
  expect_struct(select, "Cluster", sizeof(shader::Cluster), {MEMBER(Cluster, smallest), MEMBER(Cluster, size)}, true);
  expect_struct(select, "TouchHeader", sizeof(shader::TouchHeader),
                {MEMBER(TouchHeader, fingers), MEMBER(TouchHeader, clusters), MEMBER(TouchHeader, contacts),
                 MEMBER(TouchHeader, points)},
                false);
  const auto frames = palpa::test::read_spirv(spirv::frames_axes_comp);
  expect_struct(frames, "FingerRecord", sizeof(shader::FingerRecord),
                {MEMBER(FingerRecord, first), MEMBER(FingerRecord, solid), MEMBER(FingerRecord, contacts),
                 MEMBER(FingerRecord, point_like), MEMBER(FingerRecord, id), MEMBER(FingerRecord, start),
                 MEMBER(FingerRecord, foci), MEMBER(FingerRecord, centre), MEMBER(FingerRecord, axis1),
                 MEMBER(FingerRecord, axis2), MEMBER(FingerRecord, axis3), MEMBER(FingerRecord, turn),
                 MEMBER(FingerRecord, mean)},
                true);
  const auto count = palpa::test::read_spirv(spirv::frames_count_comp);
  expect_struct(count, "FramesPush", sizeof(shader::FramesPush), {MEMBER(FramesPush, most_contacts)}, false);
  const auto follow = palpa::test::read_spirv(spirv::follow_comp);
  expect_struct(follow, "FollowPush", sizeof(shader::FollowPush), {MEMBER(FollowPush, elapsed_us)}, false);
  expect_struct(follow, "Track", sizeof(shader::Track),
                {MEMBER(Track, id), MEMBER(Track, solid), MEMBER(Track, carrier), MEMBER(Track, unseen_us),
                 MEMBER(Track, contacts), MEMBER(Track, has_axes), MEMBER(Track, place), MEMBER(Track, velocity),
                 MEMBER(Track, axis1), MEMBER(Track, axis3), MEMBER(Track, spread_a), MEMBER(Track, spread_b)},
                true);
  expect_struct(follow, "TrackTable", sizeof(shader::TrackTable),
                {MEMBER(TrackTable, count), MEMBER(TrackTable, next_id), MEMBER(TrackTable, tracks)}, false);
  const auto foci = palpa::test::read_spirv(spirv::foci_comp);
  expect_struct(foci, "FocusRecord", sizeof(shader::FocusRecord),
                {MEMBER(FocusRecord, x), MEMBER(FocusRecord, y), MEMBER(FocusRecord, z), MEMBER(FocusRecord, points)},
                true);
  expect_struct(foci, "Border", sizeof(shader::Border), {MEMBER(Border, x), MEMBER(Border, y)}, true);
  expect_struct(foci, "FociPush", sizeof(shader::FociPush), {MEMBER(FociPush, foci), MEMBER(FociPush, spacing)}, false);
}

TEST(TouchShaders, HaveTheWorkgroupsThatTheirHeadersName) {
  const auto size_of = [](std::span<const std::uint32_t> words) {
    return palpa::test::read_spirv(words).local_size[0];
  };
  EXPECT_EQ(size_of(spirv::contacts_find_comp), shader::contacts_group);
  EXPECT_EQ(size_of(spirv::contacts_surface_comp), shader::contacts_group);
  EXPECT_EQ(size_of(spirv::contacts_pack_comp), shader::contacts_group);
  for (const auto words : {std::span<const std::uint32_t>(spirv::fingers_prepare_comp),
                           std::span<const std::uint32_t>(spirv::fingers_insert_comp),
                           std::span<const std::uint32_t>(spirv::fingers_label_comp)}) {
    EXPECT_EQ(size_of(words), shader::contact_group);
  }
  for (const auto words : {std::span<const std::uint32_t>(spirv::fingers_blocks_comp),
                           std::span<const std::uint32_t>(spirv::fingers_link_comp),
                           std::span<const std::uint32_t>(spirv::fingers_crowded_comp)}) {
    EXPECT_EQ(size_of(words), shader::blocks_group);
  }
  EXPECT_EQ(size_of(spirv::fingers_select_comp), shader::fingers_select_group);
  EXPECT_EQ(size_of(spirv::frames_count_comp), shader::frames_chunk_group);
  EXPECT_EQ(size_of(spirv::frames_group_comp), shader::frames_chunk_group);
  EXPECT_EQ(size_of(spirv::frames_axes_comp), shader::frames_group);
  EXPECT_EQ(size_of(spirv::follow_comp), shader::follow_group);
  EXPECT_EQ(size_of(spirv::foci_comp), shader::foci_group);
}

}  // namespace
}  // namespace palpa::touch::test
