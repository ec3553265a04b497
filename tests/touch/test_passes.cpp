// Each pass by itself, between guard words; and the structs that the shaders share with C++.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "gpu/barrier.hpp"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/foci/foci.h"
#include "shaders/touch/sections/sections.h"
#include "spirv/contacts_find.comp.hpp"
#include "spirv/contacts_pack.comp.hpp"
#include "spirv/contacts_surface.comp.hpp"
#include "spirv/fingers_blocks.comp.hpp"
#include "spirv/fingers_collect.comp.hpp"
#include "spirv/fingers_crowded.comp.hpp"
#include "spirv/fingers_gather.comp.hpp"
#include "spirv/fingers_insert.comp.hpp"
#include "spirv/fingers_label.comp.hpp"
#include "spirv/fingers_link.comp.hpp"
#include "spirv/fingers_place.comp.hpp"
#include "spirv/fingers_prepare.comp.hpp"
#include "spirv/fingers_select.comp.hpp"
#include "spirv/fingers_undecided.comp.hpp"
#include "spirv/foci.comp.hpp"
#include "spirv/follow.comp.hpp"
#include "spirv/glide.comp.hpp"
#include "spirv/sections_axes.comp.hpp"
#include "spirv/sections_count.comp.hpp"
#include "spirv/sections_group.comp.hpp"
#include "spirv/split_assign.comp.hpp"
#include "spirv/split_list.comp.hpp"
#include "spirv/split_look.comp.hpp"
#include "spirv/split_parts.comp.hpp"
#include "spirv/split_sample.comp.hpp"
#include "support/device.hpp"
#include "support/spirv.hpp"
#include "touch/harness.hpp"
#include "touch/sections/sector_borders.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::GuardedBuffer;

/// Everything that the passes bind, exactly as large as the contract says, between guard words and filled with rubbish.
struct Guarded {
  Guarded(gpu::Device& device, const PreparedSolids& prepared, const std::vector<sensing::SkinPoint>& skin,
          const Room& room_for)
      : room(room_for),
        points(GuardedBuffer::of<sensing::SkinPoint>(device, skin)),
        length(device, 16),
        solids(GuardedBuffer::of<shader::SolidRecord>(device, prepared.records)),
        cells(GuardedBuffer::of<shader::PlaneCell>(device, prepared.cells)),
        planes(GuardedBuffer::of<shader::vec4>(device, prepared.planes)),
        borders(GuardedBuffer::of<shader::Border>(device, sector_borders())),
        of_solid(GuardedBuffer::of<std::uint32_t>(device, prepared.foci_of)),
        total(device, 16),
        contacts(device, std::size_t{room.contacts} * 32),
        deep_total(device, 16),
        deep(device, std::size_t{room.deep} * 32),
        parents(device, std::size_t{room.clustered()} * 4),
        clusters(device, std::size_t{room.clustered()} * 8),
        header(device, sizeof(shader::TouchHeader)),
        fingers(device, std::size_t{max_fingers} * sizeof(shader::FingerRecord)),
        grouped(device, std::size_t{room.contacts} * 16),
        tracks(device, sizeof(shader::TrackTable)),
        foci(device, std::size_t{max_fingers} * max_foci * sizeof(shader::FocusRecord)),
        homes(device, sizeof(shader::Home) * shader::follow_most_tracks),
        contacts_scratch(device, ContactsPass::scratch(room)),
        fingers_scratch(device, FingersPass::scratch(room)),
        sections_scratch(device, SectionsPass::scratch()),
        solid_texels(device, solids.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "solids"),
        contact_texels(device, contacts.ref(), VK_FORMAT_R32G32B32A32_UINT, "contacts"),
        grouped_texels(device, grouped.ref(), VK_FORMAT_R32G32B32A32_UINT, "grouped contacts") {
    const auto count = static_cast<std::uint32_t>(skin.size());
    const shader::ScanTotal given{count, shader::scan_groups_of(count, ContactsPass::groups(device, room, prepared)), 1,
                                  1};
    length.write(&given, sizeof(given));
  }

  Room room;
  GuardedBuffer points, length, solids, cells, planes, borders, of_solid, total, contacts, deep_total, deep, parents,
      clusters, header, fingers, grouped, tracks, foci, homes;
  palpa::test::GuardedScratch contacts_scratch, fingers_scratch, sections_scratch;
  gpu::TexelView solid_texels, contact_texels, grouped_texels;

  bool intact() {
    bool all = true;
    int place = 0;
    for (GuardedBuffer* buffer :
         {&points, &length, &solids, &cells, &planes, &borders, &of_solid, &total, &contacts, &deep_total, &deep,
          &parents, &clusters, &header, &fingers, &grouped, &tracks, &foci, &homes}) {
      const bool one = buffer->intact();
      EXPECT_TRUE(one) << "guard words of buffer " << place;
      all = all && one;
      ++place;
    }
    for (const palpa::test::GuardedScratch* scratch : {&contacts_scratch, &fingers_scratch, &sections_scratch}) {
      const bool one = scratch->intact();
      EXPECT_TRUE(one) << "guard words of scratch " << place;
      all = all && one;
      ++place;
    }
    return all;
  }
};

void record_all(VkCommandBuffer commands, Guarded& b, const PreparedSolids& solids, const Parameters& parameters) {
  static ContactsPass contacts(palpa::test::test_device());
  static FingersPass fingers(palpa::test::test_device());
  static const SectionsPass sections(palpa::test::test_device());
  static const FollowPass follow(palpa::test::test_device());
  static const FociPass foci(palpa::test::test_device());
  static const GlidePass glide(palpa::test::test_device());
  contacts.prepare(solids, parameters);
  fingers.prepare(parameters);
  contacts.record(commands,
                  {.points = b.points.ref(),
                   .length = b.length.ref(),
                   .solids = b.solids.ref(),
                   .cells = b.cells.ref(),
                   .planes = b.planes.ref(),
                   .total = b.total.ref(),
                   .contacts = b.contacts.ref(),
                   .deep_total = b.deep_total.ref(),
                   .deep = b.deep.ref()},
                  b.contacts_scratch, b.room, solids, parameters);
  gpu::compute_to_compute(commands);
  fingers.record(commands,
                 {.length = b.length.ref(),
                  .solids = b.solid_texels.ref(),
                  .total = b.total.ref(),
                  .contacts = b.contact_texels.ref(),
                  .parents = b.parents.ref(),
                  .clusters = b.clusters.ref(),
                  .header = b.header.ref(),
                  .fingers = b.fingers.ref(),
                  .deep_total = b.deep_total.ref(),
                  .deep = b.deep.ref()},
                 b.fingers_scratch, b.room, parameters);
  gpu::compute_to_compute(commands);
  sections.record(
      commands,
      {b.total.ref(), b.parents.ref(), b.contact_texels.ref(), b.header.ref(), b.grouped_texels.ref(), b.fingers.ref()},
      b.sections_scratch, b.room);
  gpu::compute_to_compute(commands);
  follow.record(commands, {b.header.ref(), b.fingers.ref(), b.tracks.ref()}, shader::follow_restart, {});
  gpu::compute_to_compute(commands);
  foci.record(
      commands,
      {b.grouped_texels.ref(), b.header.ref(), b.fingers.ref(), b.foci.ref(), b.borders.ref(), b.of_solid.ref()},
      parameters);
  gpu::compute_to_compute(commands);
  glide.record(commands, {b.header.ref(), b.fingers.ref(), b.tracks.ref(), b.foci.ref(), b.homes.ref()});
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
    const std::vector<geometry::Solid> scene{everything(), cube()};
    const PreparedSolids solids = prepare_solids(scene);
    const Parameters parameters = everything_is_contact(c.gap, 2);
    Guarded guarded(device, solids, cloud, {.points = c.points, .contacts = c.room});
    palpa::test::run_on_device([&](VkCommandBuffer commands) { record_all(commands, guarded, solids, parameters); });
    EXPECT_TRUE(guarded.intact());
    EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, c.points);

    // What had room is what the twin finds among the first points.
    Touch twin;
    HostStage(scene, {}, {.parameters = parameters}).touch(std::span(cloud).first(c.room), twin);
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
  const PreparedSolids solids = prepare_solids({everything()});
  const Room room{.points = 1000, .contacts = 1000};
  Guarded guarded(device, solids, cloud, room);
  const shader::ScanTotal boastful{1'000'000,
                                   shader::scan_groups_of(1'000'000, ContactsPass::groups(device, room, solids)), 1, 1};
  guarded.length.write(&boastful, sizeof(boastful));
  palpa::test::run_on_device(
      [&](VkCommandBuffer commands) { record_all(commands, guarded, solids, everything_is_contact()); });
  EXPECT_TRUE(guarded.intact());
  EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, 1000u);
}

TEST(TouchPassesByThemselves, StayInsideTheirBuffersWithDeepPoints) {
  gpu::Device& device = palpa::test::test_device();
  // Half of the cube's points are contacts or deep; little room for either.
  const auto cloud = indexed(random_points(5000, {-0.02, -0.08, -0.02}, {0.02, 0, 0.02}));
  const std::vector<geometry::Solid> scene{cube()};
  const PreparedSolids solids = prepare_solids(scene);
  const Parameters parameters{.delta_m = 4e-3, .finger_gap_m = 2e-3, .cluster = Cluster::inside};
  Touch twin;
  HostStage(scene, {}, {.parameters = parameters}).touch(cloud, twin);
  for (const Room& room : {Room{.points = 5000, .contacts = 5000, .deep = 5000, .inside = true},
                           Room{.points = 5000, .contacts = 301, .deep = 203, .inside = true},
                           Room{.points = 5000, .contacts = 1, .deep = 1, .inside = true}}) {
    SCOPED_TRACE(room.contacts);
    Guarded guarded(device, solids, cloud, room);
    palpa::test::run_on_device([&](VkCommandBuffer commands) { record_all(commands, guarded, solids, parameters); });
    EXPECT_TRUE(guarded.intact());
    EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, twin.contacts.size());
    EXPECT_EQ(guarded.deep_total.read<shader::ScanTotal>()[0].total, twin.deep.size());
  }
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
  expect_struct(
      find, "SolidRecord", sizeof(shader::SolidRecord),
      {MEMBER(SolidRecord, centre), MEMBER(SolidRecord, low), MEMBER(SolidRecord, high),
       MEMBER(SolidRecord, cells_per_metre), MEMBER(SolidRecord, first_cell), MEMBER(SolidRecord, cells_per_axis),
       MEMBER(SolidRecord, delta), MEMBER(SolidRecord, asked_by), MEMBER(SolidRecord, turn)},
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
  // contacts_pack writes them as vectors.
  const auto count = palpa::test::read_spirv(spirv::sections_count_comp);
  expect_struct(count, "ContactRecord", sizeof(shader::ContactRecord),
                {MEMBER(ContactRecord, x), MEMBER(ContactRecord, point), MEMBER(ContactRecord, solid),
                 MEMBER(ContactRecord, depth), MEMBER(ContactRecord, finger)},
                true);
  const auto link = palpa::test::read_spirv(spirv::fingers_link_comp);
  const auto crowded = palpa::test::read_spirv(spirv::fingers_crowded_comp);
  expect_struct(crowded, "CrowdedPair", sizeof(shader::CrowdedPair),
                {MEMBER(CrowdedPair, first_a), MEMBER(CrowdedPair, first_b), MEMBER(CrowdedPair, cells_a),
                 MEMBER(CrowdedPair, cells_b)},
                true);
  expect_struct(link, "FingersWork", sizeof(shader::FingersWork),
                {MEMBER(FingersWork, collect_x), MEMBER(FingersWork, cells), MEMBER(FingersWork, blocks_x),
                 MEMBER(FingersWork, blocks), MEMBER(FingersWork, links_x), MEMBER(FingersWork, links),
                 MEMBER(FingersWork, crowded_x), MEMBER(FingersWork, crowded), MEMBER(FingersWork, undecided_x),
                 MEMBER(FingersWork, undecided), MEMBER(FingersWork, rest_x), MEMBER(FingersWork, large)},
                false);
  expect_struct(link, "FingersPush", sizeof(shader::FingersPush),
                {MEMBER(FingersPush, cells_per_metre), MEMBER(FingersPush, limit), MEMBER(FingersPush, most_contacts),
                 MEMBER(FingersPush, min_points)},
                false);
  const auto select = palpa::test::read_spirv(spirv::fingers_select_comp);
  expect_struct(select, "Cluster", sizeof(shader::Cluster), {MEMBER(Cluster, smallest), MEMBER(Cluster, size)}, true);
  expect_struct(select, "TouchHeader", sizeof(shader::TouchHeader),
                {MEMBER(TouchHeader, fingers), MEMBER(TouchHeader, clusters), MEMBER(TouchHeader, contacts),
                 MEMBER(TouchHeader, points), MEMBER(TouchHeader, look_x), MEMBER(TouchHeader, parts_x),
                 MEMBER(TouchHeader, assign_x), MEMBER(TouchHeader, list_x), MEMBER(TouchHeader, patches_x),
                 MEMBER(TouchHeader, join_x), MEMBER(TouchHeader, relabel_x), MEMBER(TouchHeader, relabel_z)},
                false);
  const auto sections = palpa::test::read_spirv(spirv::sections_axes_comp);
  expect_struct(sections, "FingerRecord", sizeof(shader::FingerRecord),
                {MEMBER(FingerRecord, first), MEMBER(FingerRecord, solid), MEMBER(FingerRecord, contacts),
                 MEMBER(FingerRecord, point_like), MEMBER(FingerRecord, id), MEMBER(FingerRecord, start),
                 MEMBER(FingerRecord, foci), MEMBER(FingerRecord, centre), MEMBER(FingerRecord, axis1),
                 MEMBER(FingerRecord, axis2), MEMBER(FingerRecord, axis3), MEMBER(FingerRecord, turn),
                 MEMBER(FingerRecord, mean), MEMBER(FingerRecord, lean), MEMBER(FingerRecord, held_low)},
                true);
  expect_struct(count, "SectionsPush", sizeof(shader::SectionsPush), {MEMBER(SectionsPush, most_contacts)}, false);
  const auto split = palpa::test::read_spirv(spirv::split_sample_comp);
  expect_struct(split, "SplitPush", sizeof(shader::SplitPush),
                {MEMBER(SplitPush, most_contacts), MEMBER(SplitPush, cameras), MEMBER(SplitPush, finger_width)}, false);
  expect_struct(split, "SplitState", sizeof(shader::SplitState),
                {MEMBER(SplitState, kind), MEMBER(SplitState, samples), MEMBER(SplitState, parts_low),
                 MEMBER(SplitState, parts_high), MEMBER(SplitState, root)},
                true);
  const auto parts = palpa::test::read_spirv(spirv::split_parts_comp);
  expect_struct(parts, "SplitEvidence", sizeof(shader::SplitEvidence),
                {MEMBER(SplitEvidence, looked_low), MEMBER(SplitEvidence, looked_high),
                 MEMBER(SplitEvidence, valley_low), MEMBER(SplitEvidence, valley_high)},
                true);
  const auto follow = palpa::test::read_spirv(spirv::follow_comp);
  expect_struct(follow, "FollowPush", sizeof(shader::FollowPush),
                {MEMBER(FollowPush, elapsed_us), MEMBER(FollowPush, steady), MEMBER(FollowPush, memory_us)}, false);
  expect_struct(follow, "Track", sizeof(shader::Track),
                {MEMBER(Track, id), MEMBER(Track, solid), MEMBER(Track, carrier), MEMBER(Track, unseen_us),
                 MEMBER(Track, contacts), MEMBER(Track, flags), MEMBER(Track, home), MEMBER(Track, since_us),
                 MEMBER(Track, place), MEMBER(Track, velocity), MEMBER(Track, axis1), MEMBER(Track, axis3),
                 MEMBER(Track, spread_a), MEMBER(Track, spread_b)},
                true);
  expect_struct(follow, "TrackTable", sizeof(shader::TrackTable),
                {MEMBER(TrackTable, count), MEMBER(TrackTable, next_id), MEMBER(TrackTable, tracks)}, false);
  const auto foci = palpa::test::read_spirv(spirv::foci_comp);
  expect_struct(foci, "FocusRecord", sizeof(shader::FocusRecord),
                {MEMBER(FocusRecord, x), MEMBER(FocusRecord, y), MEMBER(FocusRecord, z), MEMBER(FocusRecord, points)},
                true);
  const auto glide = palpa::test::read_spirv(spirv::glide_comp);
  expect_struct(glide, "GlidingFocus", sizeof(shader::GlidingFocus),
                {MEMBER(GlidingFocus, x), MEMBER(GlidingFocus, empty_us), MEMBER(GlidingFocus, speed_x)}, true);
  expect_struct(glide, "Home", sizeof(shader::Home),
                {MEMBER(Home, centre), MEMBER(Home, velocity), MEMBER(Home, axis1), MEMBER(Home, axis3),
                 MEMBER(Home, foci), MEMBER(Home, focus)},
                true);
  expect_struct(foci, "Border", sizeof(shader::Border), {MEMBER(Border, x), MEMBER(Border, y)}, true);
  expect_struct(foci, "FociPush", sizeof(shader::FociPush), {MEMBER(FociPush, foci), MEMBER(FociPush, spacing)}, false);
}

TEST(TouchShaders, HaveTheWorkgroupsThatTheirHeadersName) {
  const auto size_of = [](const gpu::Kernel& kernel) { return palpa::test::read_spirv(kernel).local_size[0]; };
  EXPECT_EQ(size_of(spirv::contacts_find_comp), shader::contacts_group);
  EXPECT_EQ(size_of(spirv::contacts_surface_comp), shader::contacts_group);
  EXPECT_EQ(size_of(spirv::contacts_pack_comp), shader::contacts_group);
  for (const gpu::Kernel* kernel :
       {&spirv::fingers_gather_comp, &spirv::fingers_prepare_comp, &spirv::fingers_insert_comp,
        &spirv::fingers_collect_comp, &spirv::fingers_place_comp, &spirv::fingers_label_comp}) {
    EXPECT_EQ(size_of(*kernel), shader::contact_group) << kernel->name;
  }
  for (const gpu::Kernel* kernel : {&spirv::fingers_blocks_comp, &spirv::fingers_link_comp,
                                    &spirv::fingers_crowded_comp, &spirv::fingers_undecided_comp}) {
    EXPECT_EQ(size_of(*kernel), shader::blocks_group) << kernel->name;
  }
  for (const gpu::Kernel* kernel :
       {&spirv::split_sample_comp, &spirv::split_look_comp, &spirv::split_parts_comp, &spirv::split_list_comp}) {
    EXPECT_EQ(size_of(*kernel), shader::split_group) << kernel->name;
  }
  EXPECT_EQ(size_of(spirv::split_assign_comp), shader::contact_group);
  EXPECT_EQ(size_of(spirv::fingers_select_comp), shader::fingers_select_group);
  EXPECT_EQ(size_of(spirv::sections_count_comp), shader::sections_chunk_group);
  EXPECT_EQ(size_of(spirv::sections_group_comp), shader::sections_chunk_group);
  EXPECT_EQ(size_of(spirv::sections_axes_comp), shader::sections_group);
  EXPECT_EQ(size_of(spirv::follow_comp), shader::follow_group);
  EXPECT_EQ(size_of(spirv::foci_comp), shader::foci_group);
  EXPECT_EQ(size_of(spirv::glide_comp), shader::glide_group);
}

}  // namespace
}  // namespace palpa::touch::test
