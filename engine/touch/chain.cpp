#include "touch/chain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/commands.hpp"

namespace palpa::touch {
namespace {

template <typename T>
gpu::Upload upload(const gpu::Device& device, VkCommandBuffer commands, const std::vector<T>& values,
                   const char* name) {
  gpu::Upload buffer(device, values.size() * sizeof(T), name);
  if (!values.empty()) std::memcpy(buffer.data(), values.data(), values.size() * sizeof(T));
  buffer.record(commands);
  return buffer;
}

Capacity checked(const Capacity& capacity) {
  if (capacity.points > shader::contacts_most_points) {
    throw bad_usage(fmt::format("{} skin points per frame: at most {}", capacity.points, shader::contacts_most_points));
  }
  const std::uint32_t points = std::max(capacity.points, 1U);
  return {points, std::clamp(capacity.contacts, 1U, points), std::min(capacity.deep, points), capacity.inside};
}

/// Most points that are clustered.
std::uint32_t clustered(const Capacity& capacity) {
  return capacity.contacts + (capacity.inside ? capacity.deep : 0);
}

}  // namespace

Capacity capacity_for(const Parameters& parameters, Capacity capacity) {
  if (parameters.wants_deep()) capacity.deep = std::max(capacity.deep, capacity.contacts);
  capacity.inside = parameters.cluster == Cluster::inside;
  return capacity;
}

SolidTable::SolidTable(const gpu::Device& device, const std::vector<geometry::Solid>& solids,
                       const Parameters& parameters)
    : host_(make_scene_table(solids, parameters)) {
  const gpu::Recorder recorder(device, "solids");
  gpu::Timeline timeline(device, "solids");
  const VkCommandBuffer commands = recorder.begin();
  cells_ = upload(device, commands, host_.cells, "plane cells");
  planes_ = upload(device, commands, host_.planes, "planes");
  borders_ = upload(device, commands, sector_borders(), "sector borders");
  surfaces_ = SurfaceTables(device, host_);
  surfaces_.record(commands);
  foci_of_ = upload(device, commands, host_.foci_of, "foci of solids");
  timeline.wait(timeline.submit(recorder.end()));
}

TouchBuffers::TouchBuffers(const gpu::Device& device, const Capacity& capacity)
    : capacity_(checked(capacity)),
      hits_(device, std::uint64_t{capacity_.points} * sizeof(shader::Hit), "contact hits"),
      masks_(device, std::uint64_t{mask_words(capacity_.points)} * 4, "contact masks"),
      counts_(device, std::uint64_t{shader::contacts_chunks} * 4, "contact counts"),
      total_(device, sizeof(shader::ScanTotal), "contact total"),
      nodes_(device, std::uint64_t{clustered(capacity_)} * sizeof(shader::uvec4), "finger nodes"),
      keys_(device, std::uint64_t{clustered(capacity_)} * sizeof(shader::BlockKey), "finger keys"),
      places_(device, std::uint64_t{clustered(capacity_)} * 4, "finger places"),
      slots_(device, std::uint64_t{slots_for(clustered(capacity_))} * 4, "finger slots"),
      heads_(device, std::uint64_t{clustered(capacity_)} * 4 * shader::fingers_block_cells, "finger heads"),
      list_(device, std::uint64_t{clustered(capacity_)} * 4, "finger blocks"),
      groups_(device, std::uint64_t{clustered(capacity_)} * 4, "finger groups"),
      crowded_(device, std::uint64_t{clustered(capacity_)} * 4 + 16, "finger crowded"),
      work_(device, sizeof(shader::FingersWork), "finger work"),
      parents_(device, std::uint64_t{clustered(capacity_)} * 4, "finger parents"),
      clusters_(device, std::uint64_t{clustered(capacity_)} * sizeof(shader::Cluster), "finger clusters"),
      samples_(device, std::uint64_t{max_fingers} * shader::bridge_samples * sizeof(shader::BridgeSample),
               "bridge samples"),
      patches_(device, std::uint64_t{max_fingers} * sizeof(shader::BridgePatch), "bridge patches"),
      pairs_(device, std::uint64_t{max_fingers} * max_fingers * sizeof(shader::BridgePair), "bridge pairs"),
      bridge_work_(device, sizeof(shader::BridgeWork), "bridge work"),
      inside_(device, capacity_.inside ? std::uint64_t{clustered(capacity_)} * sizeof(shader::ContactRecord) : 0,
              "points inside"),
      inside_total_(device, sizeof(shader::ScanTotal), "inside total"),
      deep_masks_(device, capacity_.deep == 0 ? 0 : std::uint64_t{mask_words(capacity_.points)} * 4, "deep masks"),
      deep_counts_(device, std::uint64_t{shader::contacts_chunks} * 4, "deep counts"),
      finger_counts_(device, std::uint64_t{shader::frames_most_chunks} * max_fingers * 4, "finger counts"),
      solids_(device, sizeof(shader::SolidRecord), "solids"),
      contacts_(device, std::uint64_t{capacity_.contacts} * sizeof(shader::ContactRecord), "contacts"),
      header_(device, sizeof(shader::TouchHeader), "touch header"),
      fingers_(device, std::uint64_t{max_fingers} * sizeof(shader::FingerRecord), "fingers"),
      foci_(device, std::uint64_t{max_fingers} * max_foci * sizeof(shader::FocusRecord), "foci"),
      deep_(device, std::uint64_t{capacity_.deep} * sizeof(shader::ContactRecord), "deep points"),
      deep_total_(device, sizeof(shader::ScanTotal), "deep total"),
      device_(&device) {}

TouchPasses::TouchPasses(const gpu::Device& device)
    : contacts_(device), fingers_(device), bridge_(device), frames_(device), follow_(device), foci_(device) {}

void TouchPasses::record(VkCommandBuffer commands, const SolidTable& table, TouchBuffers& b, gpu::BufferRef points,
                         gpu::BufferRef total, const Parameters& parameters, gpu::Timestamps* times, Detail detail,
                         const SightBuffers* sight, const Following& following) const {
  check(parameters, table.host());
  if (parameters.wants_deep() && b.capacity_.deep == 0) {
    throw bad_usage("deep points are asked for: give Capacity::deep room for them");
  }
  if (parameters.cluster == Cluster::inside && !b.capacity_.inside) {
    throw bad_usage("clusters of all points inside are asked for: set Capacity::inside");
  }
  const std::vector<shader::SolidRecord>& solids = table.host().solids;
  const std::size_t solid_bytes = solids.size() * sizeof(shader::SolidRecord);
  if (solid_bytes > b.solids_.ref().size)
    b.solids_ = gpu::Upload(*b.device_, solid_bytes, "solids");  // the first time only
  if (!solids.empty()) std::memcpy(b.solids_.data(), solids.data(), solid_bytes);
  b.solids_.record(commands);
  b.with_deep_ = parameters.wants_deep();
  const auto mark = [&](const char* name) {
    if (times) times->mark(commands, name);
  };
  contacts_.record(commands,
                   {.points = points,
                    .length = total,
                    .solids = b.solids_.ref(),
                    .cells = table.cells(),
                    .planes = table.planes(),
                    .hits = b.hits_.ref(),
                    .masks = b.masks_.ref(),
                    .counts = b.counts_.ref(),
                    .total = b.total_.ref(),
                    .contacts = b.contacts_.ref(),
                    .most_points = b.capacity_.points,
                    .most_contacts = b.capacity_.contacts,
                    .surface = table.surfaces().surface(),
                    .parts = table.surfaces().parts(),
                    .deep_masks = b.deep_masks_.ref(),
                    .deep_counts = b.deep_counts_.ref(),
                    .deep_total = b.deep_total_.ref(),
                    .deep = b.deep_.ref(),
                    .most_deep = b.capacity_.deep},
                   table.host(), parameters, times);
  gpu::compute_to_compute(commands);
  fingers_.record(commands,
                  {.length = total,
                   .solids = b.solids_.ref(),
                   .total = b.total_.ref(),
                   .contacts = b.contacts_.ref(),
                   .nodes = b.nodes_.ref(),
                   .keys = b.keys_.ref(),
                   .places = b.places_.ref(),
                   .slots = b.slots_.ref(),
                   .heads = b.heads_.ref(),
                   .list = b.list_.ref(),
                   .groups = b.groups_.ref(),
                   .crowded = b.crowded_.ref(),
                   .clusters = b.clusters_.ref(),
                   .work = b.work_.ref(),
                   .parents = b.parents_.ref(),
                   .header = b.header_.ref(),
                   .fingers = b.fingers_.ref(),
                   .most_contacts = b.capacity_.contacts,
                   .deep_total = b.deep_total_.ref(),
                   .deep = b.deep_.ref(),
                   .inside_total = b.inside_total_.ref(),
                   .inside = b.inside_.ref(),
                   .most_deep = b.capacity_.deep},
                  table.host(), parameters, times);
  gpu::compute_to_compute(commands);
  if (sight && parameters.finger_width_m > 0) {
    bridge_.record(commands,
                   {.sight = *sight,
                    .total = b.total_.ref(),
                    .contacts = b.contacts_.ref(),
                    .parents = b.parents_.ref(),
                    .clusters = b.clusters_.ref(),
                    .header = b.header_.ref(),
                    .fingers = b.fingers_.ref(),
                    .samples = b.samples_.ref(),
                    .patches = b.patches_.ref(),
                    .pairs = b.pairs_.ref(),
                    .work = b.bridge_work_.ref(),
                    .most_contacts = b.capacity_.contacts},
                   parameters);
    gpu::compute_to_compute(commands);
    mark("bridge");
  }
  // The grid's nodes have done their work: the contacts in order of their fingers take their place.
  frames_.record(commands,
                 {.total = b.total_.ref(),
                  .parents = b.parents_.ref(),
                  .contacts = b.contacts_.ref(),
                  .header = b.header_.ref(),
                  .counts = b.finger_counts_.ref(),
                  .grouped = b.nodes_.ref(),
                  .fingers = b.fingers_.ref(),
                  .most_contacts = b.capacity_.contacts},
                 times);
  gpu::compute_to_compute(commands);
  if (following.tracks) {
    follow_.record(commands,
                   {.header = b.header_.ref(), .fingers = b.fingers_.ref(), .tracks = following.tracks->ref()},
                   following.tracks->clock.elapsed_us(following.time_s));
    mark("follow");
    gpu::compute_to_compute(commands);
  }
  foci_.record(commands,
               {.grouped = b.nodes_.ref(),
                .header = b.header_.ref(),
                .fingers = b.fingers_.ref(),
                .foci = b.foci_.ref(),
                .borders = table.borders(),
                .of_solid = table.foci_of()},
               parameters);
  mark("foci");
  b.detail_ = detail;
  if (detail == Detail::contacts) b.contacts_.record(commands);
  b.header_.record(commands);
  b.fingers_.record(commands);
  b.foci_.record(commands);
  if (parameters.wants_deep()) {
    b.deep_.record(commands);
    b.deep_total_.record(commands);
  }
}

void read(const TouchBuffers& b, Touch& out) {
  const shader::TouchHeader& header = b.header_.as<shader::TouchHeader>()[0];
  if (header.points > b.capacity_.points) {
    throw failure(
        fmt::format("{} skin points in one frame: there is room for {}; narrow the region that the cameras watch",
                    header.points, b.capacity_.points));
  }
  if (header.contacts > b.capacity_.contacts) {
    throw failure(fmt::format("{} contacts in one frame: there is room for {}; give a smaller delta or fewer points",
                              header.contacts, b.capacity_.contacts));
  }
  const std::uint32_t deep = b.with_deep_ ? b.deep_total_.as<shader::ScanTotal>()[0].total : 0;
  if (deep > b.capacity_.deep) {
    throw failure(fmt::format("{} deep points in one frame: there is room for {}; touch less of the solid", deep,
                              b.capacity_.deep));
  }
  out.deep.resize(deep);
  for (std::uint32_t i = 0; i < deep; ++i) {
    const shader::ContactRecord& record = b.deep_.as<shader::ContactRecord>()[i];
    out.deep[i] = {record.point, record.solid, record.depth, {record.x, record.y, record.z}};
  }
  out.cluster_count = header.clusters;
  out.finger_count = header.fingers;
  if (out.fingers.size() < header.fingers) out.fingers.resize(header.fingers);
  const auto fingers = b.fingers_.as<shader::FingerRecord>();
  const auto foci = b.foci_.as<shader::FocusRecord>();
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
    finger.contact_count = record.contacts;
    finger.contacts.clear();
    finger.foci.resize(record.foci);
    for (std::size_t n = 0; n < finger.foci.size(); ++n) {
      const shader::FocusRecord& focus = foci[std::size_t{f} * max_foci + n];
      finger.foci[n] = {{focus.x, focus.y, focus.z}, focus.points};
    }
  }
  out.contacts.clear();
  if (b.detail_ == Detail::fingers) return;
  for (std::uint32_t f = 0; f < header.fingers; ++f)
    out.fingers[f].contacts.reserve(out.fingers[f].contact_count);
  const auto contacts = b.contacts_.as<shader::ContactRecord>().first(header.contacts);
  out.contacts.resize(contacts.size());
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    const shader::ContactRecord& record = contacts[i];
    out.contacts[i] = {record.point, record.solid, record.depth, {record.x, record.y, record.z}};
    if (record.finger < header.fingers) out.fingers[record.finger].contacts.push_back(i);
  }
}

void touch_points(std::span<const sensing::SkinPoint> points, const SceneTable& table, const Parameters& parameters,
                  Touch& out, Tracks* tracks, double time_s) {
  check(parameters, table);
  find_contacts(points, table, parameters, out);
  find_fingers(parameters, table, out);
  find_frames(out);
  if (tracks) follow_fingers(*tracks, time_s, out);
  find_foci(parameters, table.foci_of, out);
}

void touch_points(std::span<const glm::vec3> points, const std::vector<geometry::Solid>& solids,
                  const Parameters& parameters, Touch& out) {
  std::vector<sensing::SkinPoint> skin(points.size());
  for (std::uint32_t i = 0; i < skin.size(); ++i)
    skin[i] = {points[i], i};
  touch_points(skin, make_scene_table(solids, parameters), parameters, out);
}

}  // namespace palpa::touch
