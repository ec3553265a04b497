#include "touch/points/device_points.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "shaders/shared/scan.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/contacts/contacts.h"

namespace palpa::touch {
namespace {

constexpr std::uint32_t least_points = 4096;
/// This many contacts are read with the frame's own submit. The rest needs another one, but hardly any frame has it.
constexpr std::uint32_t first_read = 16'384;
constexpr std::uint32_t most_passes = 16;

/// Room for a frame with this many skin points. This is the only place that decides it.
Capacity capacity_for(const StageSetting& setting, std::uint32_t points, std::uint32_t contacts) {
  Capacity capacity{.points = std::max(points, 1U), .inside = setting.parameters.cluster == Cluster::inside};
  capacity.contacts = std::clamp(setting.most_contacts != 0 ? setting.most_contacts : contacts, 1U, capacity.points);
  capacity.deep = setting.parameters.wants_deep() ? capacity.contacts : 0;
  return capacity;
}

std::uint32_t most_points(const StageSetting& setting) {
  return setting.most_points != 0 ? setting.most_points : shader::contacts_most_points;
}

Contact contact_of(const shader::ContactRecord& record) {
  return {record.point, record.solid, record.depth, {record.x, record.y, record.z}, record.beyond};
}

}  // namespace

DevicePoints::DevicePoints(Passes& passes, const sensing::RayTables& tables, const PreparedSolids& solids,
                           const StageSetting& setting)
    : passes_(passes),
      tables_(tables),
      solids_(solids),
      setting_(setting),
      rays_(sensing::upload_rays(passes.device(), tables)),
      limits_(sensing::upload_limits(passes.device(), tables)),
      solids_memory_(passes.device(), solids),
      times_(passes.device(), most_passes),
      recorder_(passes.device(), "points"),
      timeline_(passes.device(), "points") {
  if (setting.most_points > shader::contacts_most_points) {
    throw bad_usage(
        fmt::format("{} skin points per frame: at most {}", setting.most_points, shader::contacts_most_points));
  }
  passes.prepare(solids, tables, setting);
  read_times_.reserve(most_passes);
  if (tables.pixels != 0) {
    make(capacity_for(setting, static_cast<std::uint32_t>(std::min<std::uint64_t>(tables.pixels, most_points(setting))),
                      default_contacts));
  } else if (setting.most_points != 0) {
    make(capacity_for(setting, setting.most_points, setting.most_points));
  }
}

void DevicePoints::make(const Capacity& capacity) {
  const gpu::Device& device = passes_.device();
  const bool cameras = tables_.pixels != 0;
  const std::uint64_t contacts = capacity.contacts, clustered = capacity.clustered(), deep = capacity.deep;
  capacity_ = capacity;
  if (cameras) {
    const std::size_t volumes = std::max<std::size_t>(sensing::most_drops(setting_.surroundings), 1);
    volumes_ = gpu::Upload(device, volumes * sizeof(shader::SkinVolume), "surroundings");
    dropped_ = gpu::Readback(device, shader::skin_kept * sizeof(std::uint32_t), "dropped points");
    depth_ = gpu::Upload(device, sensing::packed_bytes(tables_), "depth frames");
    // One for every pixel, so that the total counts all points; finish() reports if it exceeds the capacity.
    seen_ = gpu::Buffer(device, tables_.pixels * sizeof(sensing::SkinPoint), "skin points");
    seen_total_ = gpu::Buffer(device, sizeof(shader::ScanTotal), "skin total");
    skin_scratch_ = gpu::Scratch(device, sensing::SkinPass::scratch(tables_), "skin");
    if (setting_.knows(cameras)) reach_ = gpu::Upload(device, sizeof(shader::ReachTable), "reaching fingers");
  } else {
    points_ = gpu::Upload(device, std::uint64_t{capacity.points} * sizeof(sensing::SkinPoint), "skin points");
    given_ = gpu::Upload(device, sizeof(shader::ScanTotal), "skin total");
  }
  // At least one, so that there is a texel to bind.
  const std::size_t solids = std::max<std::size_t>(solids_.records.size(), 1);
  poses_ = gpu::Upload(device, solids * sizeof(shader::SolidRecord), "solids");
  pose_texels_ = gpu::TexelView(device, poses_.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "solids");
  total_ = gpu::Buffer(device, sizeof(shader::ScanTotal), "contact total");
  contacts_ = gpu::Readback(device, contacts * sizeof(shader::ContactRecord), "contacts");
  contact_texels_ = gpu::TexelView(device, contacts_.ref(), VK_FORMAT_R32G32B32A32_UINT, "contacts");
  deep_ = gpu::Readback(device, deep * sizeof(shader::ContactRecord), "deep points");
  deep_total_ = gpu::Readback(device, sizeof(shader::ScanTotal), "deep total");
  contacts_scratch_ = gpu::Scratch(device, ContactsPass::scratch(capacity), "contacts");
  parents_ = gpu::Readback(device, clustered * 4, "cluster parents");
  clusters_ = gpu::Buffer(device, clustered * sizeof(shader::Cluster), "clusters");
  header_ = gpu::Readback(device, sizeof(shader::TouchHeader), "touch header");
  selected_ = gpu::Readback(device, std::uint64_t{max_fingers} * sizeof(shader::ClusterRecord), "selected clusters");
  clusters_scratch_ = gpu::Scratch(device, ClustersPass::scratch(capacity), "clusters");
}

void DevicePoints::set(std::span<const sensing::SkinPoint> points) {
  const std::uint32_t most = most_points(setting_);
  if (points.size() > most) {
    throw bad_usage(fmt::format("{} skin points in one frame: there is room for {}", points.size(), most));
  }
  const auto count = static_cast<std::uint32_t>(points.size());
  // Powers of two, so that a growing cloud needs new memory only occasionally.
  if (count > capacity_.points || capacity_.points == 0) {
    const std::uint32_t some = std::min(std::bit_ceil(std::max(count, least_points)), most);
    make(capacity_for(setting_, some, some));
  }
  if (!points.empty()) std::memcpy(points_.data(), points.data(), points.size_bytes());
  const shader::ScanGroups cut = ContactsPass::groups(passes_.device(), capacity_, solids_);
  given_.as<shader::ScanTotal>()[0] = {count, shader::scan_groups_of(count, cut), 1, 1};
}

void DevicePoints::start(const Skin& skin) {
  if (tables_.pixels != 0) {
    sensing::pack_depth(tables_, skin.images, depth_.as<std::uint16_t>());
  } else {
    set(skin.points);
  }
  record(recorder_.begin(), skin);
  submitted_ = timeline_.submit(recorder_.end());
}

void DevicePoints::record_skin(VkCommandBuffer commands, const Skin& skin) {
  depth_.record(commands);
  if (!skin.volumes.empty()) {
    std::memcpy(volumes_.data(), skin.volumes.data(), skin.volumes.size_bytes());
    volumes_.record(commands, skin.volumes.size_bytes());
  }
  passes_.skin_.record(commands,
                       {.depth = depth_.ref(),
                        .rays = rays_.ref(),
                        .points = seen_.ref(),
                        .total = seen_total_.ref(),
                        .volumes = volumes_.ref(),
                        .limits = limits_.ref(),
                        .dropped = dropped_.ref()},
                       skin_scratch_, tables_, skin.box, skin.crops,
                       ContactsPass::groups(passes_.device(), capacity_, solids_), &times_, skin.volumes.size());
  gpu::compute_to_compute(commands);
}

void DevicePoints::record(VkCommandBuffer commands, const Skin& skin) {
  times_.begin(commands);
  const bool cameras = tables_.pixels != 0;
  const gpu::BufferRef points = cameras ? seen_.ref() : points_.ref();
  const gpu::BufferRef length = cameras ? seen_total_.ref() : given_.ref();
  if (!solids_.records.empty()) {
    std::memcpy(poses_.data(), solids_.records.data(), solids_.records.size() * sizeof(shader::SolidRecord));
  }
  poses_.record(commands);
  const bool reaches = skin.reach.table != nullptr && skin.reach.table->count != 0;
  if (reaches) {
    std::memcpy(reach_.data(), skin.reach.table, sizeof(shader::ReachTable));
    reach_.record(commands);
  }
  if (cameras) {
    record_skin(commands, skin);
  } else {
    points_.record(commands);
    given_.record(commands);
  }
  passes_.contacts_.record(commands,
                           {.points = points,
                            .length = length,
                            .solids = poses_.ref(),
                            .cells = solids_memory_.cells(),
                            .planes = solids_memory_.planes(),
                            .total = total_.ref(),
                            .contacts = contacts_.ref(),
                            .surface = solids_memory_.surfaces().surface(),
                            .parts = solids_memory_.surfaces().parts(),
                            .deep_total = deep_total_.ref(),
                            .deep = deep_.ref(),
                            .reach = reaches ? reach_.ref() : gpu::BufferRef{}},
                           contacts_scratch_, capacity_, solids_, skin.parameters, &times_,
                           reaches ? skin.reach.elapsed_us : shader::reach_none);
  gpu::compute_to_compute(commands);
  passes_.clusters_.record(commands,
                           {.length = length,
                            .solids = pose_texels_.ref(),
                            .total = total_.ref(),
                            .contacts = contact_texels_.ref(),
                            .parents = parents_.ref(),
                            .clusters = clusters_.ref(),
                            .header = header_.ref(),
                            .selected = selected_.ref(),
                            .deep_total = deep_total_.ref(),
                            .deep = deep_.ref()},
                           clusters_scratch_, capacity_, skin.clustering, &times_);
  record_readback(commands);
}

void DevicePoints::record_readback(VkCommandBuffer commands) const {
  const std::uint64_t first = std::min(first_read, capacity_.contacts);
  contacts_.record(commands, first * sizeof(shader::ContactRecord));
  parents_.record(commands, first * sizeof(std::uint32_t));
  if (tables_.pixels != 0) dropped_.record(commands);
  header_.record(commands);
  selected_.record(commands);
  if (!setting_.parameters.wants_deep()) return;
  deep_.record(commands, std::min<std::uint64_t>(first_read, capacity_.deep) * sizeof(shader::ContactRecord));
  deep_total_.record(commands);
}

std::uint32_t DevicePoints::deep_count() const {
  return setting_.parameters.wants_deep() ? deep_total_.as<shader::ScanTotal>()[0].total : 0;
}

void DevicePoints::check_capacity() const {
  const shader::TouchHeader& header = header_.as<shader::TouchHeader>()[0];
  if (header.points > capacity_.points) {
    throw TooMuchSkin(
        fmt::format("{} skin points in one frame: there is room for {}; narrow the region that the cameras watch",
                    header.points, capacity_.points));
  }
  if (header.contacts > capacity_.contacts) {
    throw TooMuchSkin(
        fmt::format("{} contacts in one frame: there is room for {}; give a smaller delta or fewer points",
                    header.contacts, capacity_.contacts));
  }
  if (deep_count() > capacity_.deep) {
    throw TooMuchSkin(fmt::format("{} deep points in one frame: there is room for {}; touch less of the solid",
                                  deep_count(), capacity_.deep));
  }
}

/// The contacts and deep points that did not come with the frame's own submit.
void DevicePoints::read_rest() {
  const std::uint64_t contacts = header_.as<shader::TouchHeader>()[0].contacts, deep = deep_count();
  if (passes_.device().unified_memory() || (contacts <= first_read && deep <= first_read)) return;
  const VkCommandBuffer commands = recorder_.begin();
  if (contacts > first_read) {
    contacts_.record(commands, contacts * sizeof(shader::ContactRecord));
    parents_.record(commands, contacts * sizeof(std::uint32_t));
  }
  if (deep > first_read) deep_.record(commands, deep * sizeof(shader::ContactRecord));
  timeline_.wait(timeline_.submit(recorder_.end()));
}

void DevicePoints::finish(Touch& out, std::vector<gpu::PassTime>& times) {
  timeline_.wait(submitted_);
  times_.read(read_times_);
  times.insert(times.end(), read_times_.begin(), read_times_.end());
  check_capacity();
  read_rest();
  const shader::TouchHeader& header = header_.as<shader::TouchHeader>()[0];
  out.dropped = {};
  if (const auto counts = dropped_.as<std::uint32_t>(); !counts.empty())
    std::ranges::copy(counts.first(shader::skin_kept), out.dropped.counts.begin());
  out.deep.clear();
  for (const shader::ContactRecord& record : deep_.as<shader::ContactRecord>().first(deep_count()))
    out.deep.push_back(contact_of(record));

  out.cluster_count = header.clusters;
  out.finger_count = header.selected;
  if (out.fingers.size() < header.selected) out.fingers.resize(header.selected);
  const auto parents = parents_.as<std::uint32_t>();
  std::array<std::uint32_t, max_fingers> roots{};  // of the fingers
  for (std::uint32_t f = 0; f < header.selected; ++f) {
    const shader::ClusterRecord& record = selected_.as<shader::ClusterRecord>()[f];
    Finger& finger = out.fingers[f];
    roots[f] = parents[record.first];
    finger.solid = record.solid;
    finger.contact_count = record.contacts;
    finger.contacts.clear();
    finger.contacts.reserve(record.contacts);
  }
  const auto own = std::span(roots).first(header.selected);
  out.contacts.clear();
  out.contacts.reserve(header.contacts);
  std::uint32_t f = 0;  // most contacts belong to the finger of the one before
  for (const shader::ContactRecord& record : contacts_.as<shader::ContactRecord>().first(header.contacts)) {
    const auto i = static_cast<std::uint32_t>(out.contacts.size());
    out.contacts.push_back(contact_of(record));
    if (f >= own.size() || own[f] != parents[i])
      f = static_cast<std::uint32_t>(std::ranges::find(own, parents[i]) - own.begin());
    if (f < own.size()) out.fingers[f].contacts.push_back(i);
  }
}

}  // namespace palpa::touch
