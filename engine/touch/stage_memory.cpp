#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/error.hpp"
#include "shaders/shared/scan.h"
#include "shaders/touch/bridge/bridge.h"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/foci/foci.h"
#include "touch/depths.hpp"
#include "touch/stage.hpp"

namespace palpa::touch {
namespace {

/// Default number of contacts of one frame with cameras.
constexpr std::uint32_t usual_contacts = 262'144;
constexpr std::uint32_t least_points = 4096;

/// Room for a frame with this many skin points. This is the only place that decides it.
Room room_for(const StageSetting& setting, std::uint32_t points, std::uint32_t contacts) {
  Room room{.points = std::max(points, 1U), .inside = setting.parameters.cluster == Cluster::inside};
  room.contacts = std::clamp(setting.most_contacts != 0 ? setting.most_contacts : contacts, 1U, room.points);
  room.deep = setting.parameters.wants_deep() ? room.contacts : 0;
  return room;
}

}  // namespace

StageMemory::StageMemory(const Stage& stage) : stage_(&stage) {
  const StageSetting& setting = stage.setting_;
  if (setting.most_points > shader::contacts_most_points) {
    throw bad_usage(
        fmt::format("{} skin points per frame: at most {}", setting.most_points, shader::contacts_most_points));
  }
  if (stage.tables_.pixels != 0) {
    const std::uint32_t most = setting.most_points != 0 ? setting.most_points : shader::contacts_most_points;
    make(room_for(setting, static_cast<std::uint32_t>(std::min<std::uint64_t>(stage.tables_.pixels, most)),
                  usual_contacts));
  } else if (setting.most_points != 0) {
    make(room_for(setting, setting.most_points, setting.most_points));
  }
}

void StageMemory::make(const Room& room) {
  const gpu::Device& device = stage_->passes_.device();
  const sensing::RayTables& tables = stage_->tables_;
  const bool cameras = tables.pixels != 0;
  const std::uint64_t contacts = room.contacts, clustered = room.clustered(), deep = room.deep;
  room_ = room;
  if (cameras) {
    crops_.reserve(tables.cameras.size());
    const std::size_t volumes = std::max<std::size_t>(sensing::most_drops(stage_->setting_.surroundings), 1);
    drops_.reserve(volumes);
    volumes_ = gpu::Upload(device, volumes * sizeof(shader::SkinVolume), "surroundings");
    dropped_ = gpu::Readback(device, shader::skin_kept * sizeof(std::uint32_t), "dropped points");
    depth_ = gpu::Upload(device, sensing::packed_bytes(tables), "depth frames");
    // One for every pixel, so that the total counts all points; read() reports if it exceeds the room.
    seen_ = gpu::Buffer(device, tables.pixels * sizeof(sensing::SkinPoint), "skin points");
    seen_total_ = gpu::Buffer(device, sizeof(shader::ScanTotal), "skin total");
    skin_scratch_ = gpu::Scratch(device, sensing::SkinPass::scratch(tables), "skin");
    if (stage_->setting_.looks_again(cameras)) {
      split_scratch_ = gpu::Scratch(device, SplitPass::scratch(), "split");
      bridge_scratch_ = gpu::Scratch(device, BridgePass::scratch(), "bridge");
      if (stage_->setting_.knows(cameras)) known_scratch_ = gpu::Scratch(device, KnownPass::scratch(), "known");
    }
  } else {
    points_ = gpu::Upload(device, std::uint64_t{room.points} * sizeof(sensing::SkinPoint), "skin points");
    given_ = gpu::Upload(device, sizeof(shader::ScanTotal), "skin total");
  }
  // At least one, so that there is a texel to bind.
  const std::size_t solids = std::max<std::size_t>(stage_->solids_.records.size(), 1);
  solids_ = gpu::Upload(device, solids * sizeof(shader::SolidRecord), "solids");
  solid_texels_ = gpu::TexelView(device, solids_.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "solids");
  total_ = gpu::Buffer(device, sizeof(shader::ScanTotal), "contact total");
  contacts_ = gpu::Readback(device, contacts * sizeof(shader::ContactRecord), "contacts");
  contact_texels_ = gpu::TexelView(device, contacts_.ref(), VK_FORMAT_R32G32B32A32_UINT, "contacts");
  deep_ = gpu::Readback(device, deep * sizeof(shader::ContactRecord), "deep points");
  deep_total_ = gpu::Readback(device, sizeof(shader::ScanTotal), "deep total");
  contacts_scratch_ = gpu::Scratch(device, ContactsPass::scratch(room), "contacts");
  parents_ = gpu::Buffer(device, clustered * 4, "finger parents");
  clusters_ = gpu::Buffer(device, (clustered + split_clusters) * sizeof(shader::Cluster), "finger clusters");
  header_ = gpu::Readback(device, sizeof(shader::TouchHeader), "touch header");
  fingers_ = gpu::Readback(device, std::uint64_t{max_fingers} * sizeof(shader::FingerRecord), "fingers");
  fingers_scratch_ = gpu::Scratch(device, FingersPass::scratch(room), "fingers");
  grouped_ = gpu::Buffer(device, contacts * sizeof(shader::uvec4), "grouped contacts");
  grouped_texels_ = gpu::TexelView(device, grouped_.ref(), VK_FORMAT_R32G32B32A32_UINT, "grouped contacts");
  sections_scratch_ = gpu::Scratch(device, SectionsPass::scratch(), "sections");
  foci_ = gpu::Readback(device, std::uint64_t{max_fingers} * max_foci * sizeof(shader::FocusRecord), "foci");
}

void StageMemory::set(std::span<const sensing::DepthFrame> images) {
  sensing::pack_depth(stage_->tables_, images, depth_.as<std::uint16_t>());
}

void StageMemory::set(std::span<const sensing::SkinPoint> points) {
  const StageSetting& setting = stage_->setting_;
  if (stage_->tables_.pixels != 0) throw bad_usage("a stage with cameras takes depth frames, not skin points");
  const std::uint32_t most = setting.most_points != 0 ? setting.most_points : shader::contacts_most_points;
  if (points.size() > most) {
    throw bad_usage(fmt::format("{} skin points in one frame: there is room for {}", points.size(), most));
  }
  const auto count = static_cast<std::uint32_t>(points.size());
  // Powers of two, so that a growing cloud needs new memory only occasionally.
  if (count > room_.points || room_.points == 0) {
    const std::uint32_t some = std::min(std::bit_ceil(std::max(count, least_points)), most);
    make(room_for(setting, some, some));
  }
  if (!points.empty()) std::memcpy(points_.data(), points.data(), points.size_bytes());
  const shader::ScanGroups cut = ContactsPass::groups(stage_->passes_.device(), room_, stage_->solids_);
  given_.as<shader::ScanTotal>()[0] = {count, shader::scan_groups_of(count, cut), 1, 1};
}

void read(const StageMemory& memory, Touch& out) {
  const StageSetting& setting = memory.stage_->setting();
  const bool with_deep = setting.parameters.wants_deep();
  const shader::TouchHeader& header = memory.header_.as<shader::TouchHeader>()[0];
  if (header.points > memory.room_.points) {
    throw failure(
        fmt::format("{} skin points in one frame: there is room for {}; narrow the region that the cameras watch",
                    header.points, memory.room_.points));
  }
  if (header.contacts > memory.room_.contacts) {
    throw failure(fmt::format("{} contacts in one frame: there is room for {}; give a smaller delta or fewer points",
                              header.contacts, memory.room_.contacts));
  }
  const std::uint32_t deep = with_deep ? memory.deep_total_.as<shader::ScanTotal>()[0].total : 0;
  if (deep > memory.room_.deep) {
    throw failure(fmt::format("{} deep points in one frame: there is room for {}; touch less of the solid", deep,
                              memory.room_.deep));
  }
  out.deep.resize(deep);
  for (std::uint32_t i = 0; i < deep; ++i) {
    const shader::ContactRecord& record = memory.deep_.as<shader::ContactRecord>()[i];
    out.deep[i] = {record.point, record.solid, record.depth, {record.x, record.y, record.z}};
  }
  out.dropped = {};
  if (const auto counts = memory.dropped_.as<std::uint32_t>(); !counts.empty())
    std::ranges::copy(counts.first(shader::skin_kept), out.dropped.counts.begin());
  out.cluster_count = header.clusters;
  out.finger_count = header.fingers;
  if (out.fingers.size() < header.fingers) out.fingers.resize(header.fingers);
  const auto fingers = memory.fingers_.as<shader::FingerRecord>();
  const auto foci = memory.foci_.as<shader::FocusRecord>();
  const auto vec = [](const shader::vec4& v) { return glm::vec3(v.x, v.y, v.z); };
  for (std::uint32_t f = 0; f < header.fingers; ++f) {
    const shader::FingerRecord& record = fingers[f];
    Finger& finger = out.fingers[f];
    finger.solid = record.solid;
    finger.id = record.id;
    finger.point_like = record.point_like != 0;
    finger.section.centroid = vec(record.centre);
    finger.section.axes = {vec(record.axis1), vec(record.axis2), vec(record.axis3)};
    finger.section.eigenvalues = {record.axis1.w, record.axis2.w, record.axis3.w};
    finger.section.turn = {record.turn.x, record.turn.y};
    finger.section.lean = vec(record.lean);
    finger.placed = record.placed != 0;
    finger.holds = record.holds != 0;
    finger.contact_count = record.contacts - record.beyond;
    finger.contacts.clear();
    finger.foci.resize(record.foci);
    for (std::size_t n = 0; n < finger.foci.size(); ++n) {
      const shader::FocusRecord& focus = foci[std::size_t{f} * max_foci + n];
      const std::uint32_t held = n < 32 ? record.held_low : record.held_high;
      finger.foci[n] = {{focus.x, focus.y, focus.z}, focus.points, (held >> n % 32 & 1U) != 0};
    }
  }
  out.contacts.clear();
  if (setting.detail == Detail::fingers) return find_depths(out);
  for (std::uint32_t f = 0; f < header.fingers; ++f)
    out.fingers[f].contacts.reserve(out.fingers[f].contact_count);
  const auto contacts = memory.contacts_.as<shader::ContactRecord>().first(header.contacts);
  // Without those beyond the shell's edges: only hysteresis sets `beyond`.
  const bool may_reach = setting.knows(!memory.stage_->cameras().empty());
  out.contacts.reserve(contacts.size());
  for (const shader::ContactRecord& record : contacts) {
    if (may_reach && record.beyond != 0) continue;
    if (record.finger < header.fingers)
      out.fingers[record.finger].contacts.push_back(static_cast<std::uint32_t>(out.contacts.size()));
    out.contacts.push_back({record.point, record.solid, record.depth, {record.x, record.y, record.z}});
  }
  find_depths(out);
}

}  // namespace palpa::touch
