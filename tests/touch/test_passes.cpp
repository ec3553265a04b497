// Each pass by itself, between guard words; and the structs that the shaders share with C++.
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <string>

#include "gpu/barrier.hpp"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/contacts/contacts.h"
#include "spirv/clusters_blocks.comp.hpp"
#include "spirv/clusters_collect.comp.hpp"
#include "spirv/clusters_crowded.comp.hpp"
#include "spirv/clusters_gather.comp.hpp"
#include "spirv/clusters_insert.comp.hpp"
#include "spirv/clusters_label.comp.hpp"
#include "spirv/clusters_link.comp.hpp"
#include "spirv/clusters_place.comp.hpp"
#include "spirv/clusters_prepare.comp.hpp"
#include "spirv/clusters_select.comp.hpp"
#include "spirv/clusters_undecided.comp.hpp"
#include "spirv/contacts_find.comp.hpp"
#include "spirv/contacts_pack.comp.hpp"
#include "spirv/contacts_surface.comp.hpp"
#include "support/device.hpp"
#include "support/spirv.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::GuardedBuffer;

/// Everything that the passes bind, exactly as large as the contract says, between guard words and filled with rubbish.
struct Guarded {
  Guarded(gpu::Device& device, const PreparedSolids& prepared, const std::vector<sensing::SkinPoint>& skin,
          const Capacity& capacity_for)
      : capacity(capacity_for),
        points(GuardedBuffer::of<sensing::SkinPoint>(device, skin)),
        length(device, 16),
        solids(GuardedBuffer::of<shader::SolidRecord>(device, prepared.records)),
        cells(GuardedBuffer::of<shader::PlaneCell>(device, prepared.cells)),
        planes(GuardedBuffer::of<shader::vec4>(device, prepared.planes)),
        total(device, 16),
        contacts(device, std::size_t{capacity.contacts} * 32),
        deep_total(device, 16),
        deep(device, std::size_t{capacity.deep} * 32),
        parents(device, std::size_t{capacity.clustered()} * 4),
        clusters(device, std::size_t{capacity.clustered()} * 8),
        header(device, sizeof(shader::TouchHeader)),
        selected(device, std::size_t{max_fingers} * sizeof(shader::ClusterRecord)),
        contacts_scratch(device, ContactsPass::scratch(capacity)),
        clusters_scratch(device, ClustersPass::scratch(capacity)),
        solid_texels(device, solids.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "solids"),
        contact_texels(device, contacts.ref(), VK_FORMAT_R32G32B32A32_UINT, "contacts") {
    const auto count = static_cast<std::uint32_t>(skin.size());
    const shader::ScanTotal given{
        count, shader::scan_groups_of(count, ContactsPass::groups(device, capacity, prepared)), 1, 1};
    length.write(&given, sizeof(given));
  }

  Capacity capacity;
  GuardedBuffer points, length, solids, cells, planes, total, contacts, deep_total, deep, parents, clusters, header,
      selected;
  palpa::test::GuardedScratch contacts_scratch, clusters_scratch;
  gpu::TexelView solid_texels, contact_texels;

  void expect_intact() {
    int place = 0;
    for (GuardedBuffer* buffer : {&points, &length, &solids, &cells, &planes, &total, &contacts, &deep_total, &deep,
                                  &parents, &clusters, &header, &selected}) {
      EXPECT_TRUE(buffer->intact()) << "guard words of buffer " << place;
      ++place;
    }
    EXPECT_TRUE(contacts_scratch.intact()) << "guard words of the contacts' scratch";
    EXPECT_TRUE(clusters_scratch.intact()) << "guard words of the clusters' scratch";
  }
};

void record_all(VkCommandBuffer commands, Guarded& b, const PreparedSolids& solids, const FingerOptions& parameters) {
  static ContactsPass contacts(palpa::test::test_device());
  static ClustersPass clusters(palpa::test::test_device());
  contacts.prepare(solids, parameters);
  clusters.prepare(parameters);
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
                  b.contacts_scratch, b.capacity, solids, parameters);
  gpu::compute_to_compute(commands);
  clusters.record(commands,
                  {.length = b.length.ref(),
                   .solids = b.solid_texels.ref(),
                   .total = b.total.ref(),
                   .contacts = b.contact_texels.ref(),
                   .parents = b.parents.ref(),
                   .clusters = b.clusters.ref(),
                   .header = b.header.ref(),
                   .selected = b.selected.ref(),
                   .deep_total = b.deep_total.ref(),
                   .deep = b.deep.ref()},
                  b.clusters_scratch, b.capacity, parameters);
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
    const FingerOptions parameters = everything_is_contact(c.gap, 2);
    Guarded guarded(device, solids, cloud, {.points = c.points, .contacts = c.room});
    palpa::test::run_on_device([&](VkCommandBuffer commands) { record_all(commands, guarded, solids, parameters); });
    guarded.expect_intact();
    EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, c.points);

    // What had room is what the twin finds among the first points.
    Touch twin;
    Stage(scene, {}, {.parameters = parameters}).touch(std::span(cloud).first(c.room), twin);
    const auto header = guarded.header.read<shader::TouchHeader>()[0];
    EXPECT_EQ(header.contacts, c.points);
    EXPECT_EQ(header.points, c.points);
    EXPECT_EQ(header.clusters, twin.cluster_count);
    const auto contacts = guarded.contacts.read<shader::ContactRecord>();
    const auto selected = guarded.selected.read<shader::ClusterRecord>();
    const auto parents = guarded.parents.read<std::uint32_t>();
    std::map<std::uint32_t, int> finger_of_root;
    for (std::uint32_t f = 0; f < header.selected; ++f)
      finger_of_root[parents[selected[f].first]] = static_cast<int>(f);
    const auto finger = finger_of_contacts(twin);
    for (std::uint32_t i = 0; i < c.room; ++i) {
      ASSERT_EQ(contacts[i].point, i);
      const auto found = finger_of_root.find(parents[i]);
      ASSERT_EQ(found == finger_of_root.end() ? -1 : found->second, finger[i]) << "contact " << i;
    }
  }
}

TEST(TouchPassesByThemselves, LeavePointsBeyondTheirRoomAlone) {
  gpu::Device& device = palpa::test::test_device();
  const auto cloud = indexed(random_points(1000, Vec3(-0.05), Vec3(0.05)));
  const PreparedSolids solids = prepare_solids({everything()});
  const Capacity capacity{.points = 1000, .contacts = 1000};
  Guarded guarded(device, solids, cloud, capacity);
  const shader::ScanTotal boastful{
      1'000'000, shader::scan_groups_of(1'000'000, ContactsPass::groups(device, capacity, solids)), 1, 1};
  guarded.length.write(&boastful, sizeof(boastful));
  palpa::test::run_on_device(
      [&](VkCommandBuffer commands) { record_all(commands, guarded, solids, everything_is_contact()); });
  guarded.expect_intact();
  EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, 1000u);
}

TEST(TouchPassesByThemselves, StayInsideTheirBuffersWithDeepPoints) {
  gpu::Device& device = palpa::test::test_device();
  // Half of the cube's points are contacts or deep; little room for either.
  const auto cloud = indexed(random_points(5000, {-0.02, -0.08, -0.02}, {0.02, 0, 0.02}));
  const std::vector<geometry::Solid> scene{cube()};
  const PreparedSolids solids = prepare_solids(scene);
  const FingerOptions parameters{.delta_m = 4e-3, .finger_gap_m = 2e-3, .cluster = Cluster::inside};
  Touch twin;
  Stage(scene, {}, {.parameters = parameters}).touch(cloud, twin);
  for (const Capacity& capacity : {Capacity{.points = 5000, .contacts = 5000, .deep = 5000, .inside = true},
                                   Capacity{.points = 5000, .contacts = 301, .deep = 203, .inside = true},
                                   Capacity{.points = 5000, .contacts = 1, .deep = 1, .inside = true}}) {
    SCOPED_TRACE(capacity.contacts);
    Guarded guarded(device, solids, cloud, capacity);
    palpa::test::run_on_device([&](VkCommandBuffer commands) { record_all(commands, guarded, solids, parameters); });
    guarded.expect_intact();
    EXPECT_EQ(guarded.total.read<shader::ScanTotal>()[0].total, twin.contacts.size());
    EXPECT_EQ(guarded.deep_total.read<shader::ScanTotal>()[0].total, twin.deep.size());
  }
}

/// Members are numbers of four bytes and vectors of four of them, so C++ leaves no gaps between them. The shader does
/// not either if a late member is where C++ has it and, in an array, the next struct.
void expect_struct(const palpa::test::SpirvModule& module, const std::string& name, std::size_t size,
                   const std::string& late, std::size_t offset, bool in_array) {
  SCOPED_TRACE(name + "." + late);
  ASSERT_TRUE(module.structs.contains(name));
  const auto& offsets = module.structs.at(name).offsets;
  ASSERT_TRUE(offsets.contains(late));
  EXPECT_EQ(offsets.at(late), offset);
  if (!in_array) return;
  ASSERT_TRUE(module.array_strides.contains(name));
  EXPECT_EQ(module.array_strides.at(name), size);
}

#define EXPECT_STRUCT(module, type, late, in_array) \
  expect_struct(module, #type, sizeof(shader::type), #late, offsetof(shader::type, late), in_array)

TEST(TouchShaders, LayOutTheirStructsAsCppDoes) {
  const auto find = palpa::test::read_spirv(spirv::contacts_find_comp);
  EXPECT_STRUCT(find, SolidRecord, asked_by, true);
  EXPECT_STRUCT(find, PlaneCell, deepest, true);
  EXPECT_STRUCT(find, Hit, depth, true);
  EXPECT_STRUCT(find, ContactsPush, most_contacts, false);
  EXPECT_STRUCT(find, ReachingFinger, solid, true);
  EXPECT_STRUCT(find, ReachTable, fingers, false);
  // contacts_pack writes them as vectors.
  const auto select = palpa::test::read_spirv(spirv::clusters_select_comp);
  EXPECT_STRUCT(select, ContactRecord, deep, true);
  EXPECT_STRUCT(select, Cluster, size, true);
  EXPECT_STRUCT(select, TouchHeader, points, false);
  EXPECT_STRUCT(select, ClusterRecord, contacts, true);
  const auto link = palpa::test::read_spirv(spirv::clusters_link_comp);
  EXPECT_STRUCT(link, ClustersWork, large, false);
  EXPECT_STRUCT(link, ClustersPush, min_points, false);
  EXPECT_STRUCT(palpa::test::read_spirv(spirv::clusters_crowded_comp), CrowdedPair, cells_b, true);
}

TEST(TouchShaders, HaveTheWorkgroupsThatTheirHeadersName) {
  const auto size_of = [](const gpu::Kernel& kernel) { return palpa::test::read_spirv(kernel).local_size[0]; };
  EXPECT_EQ(size_of(spirv::contacts_find_comp), shader::contacts_group);
  EXPECT_EQ(size_of(spirv::contacts_surface_comp), shader::contacts_group);
  EXPECT_EQ(size_of(spirv::contacts_pack_comp), shader::contacts_group);
  for (const gpu::Kernel* kernel :
       {&spirv::clusters_gather_comp, &spirv::clusters_prepare_comp, &spirv::clusters_insert_comp,
        &spirv::clusters_collect_comp, &spirv::clusters_place_comp, &spirv::clusters_label_comp}) {
    EXPECT_EQ(size_of(*kernel), shader::contact_group) << kernel->name;
  }
  for (const gpu::Kernel* kernel : {&spirv::clusters_blocks_comp, &spirv::clusters_link_comp,
                                    &spirv::clusters_crowded_comp, &spirv::clusters_undecided_comp}) {
    EXPECT_EQ(size_of(*kernel), shader::blocks_group) << kernel->name;
  }
  EXPECT_EQ(size_of(spirv::clusters_select_comp), shader::clusters_select_group);
}

}  // namespace
}  // namespace palpa::touch::test
