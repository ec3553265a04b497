#include "touch/stage.hpp"

#include <cstring>

#include "gpu/barrier.hpp"
#include "gpu/commands.hpp"
#include "touch/bridge/bridge_cameras.hpp"
#include "touch/check_parameters.hpp"
#include "touch/contacts/pixel_stride.hpp"
#include "touch/sections/sector_borders.hpp"

namespace palpa::touch {
namespace {

PreparedSolids checked(PreparedSolids solids, const Parameters& parameters) {
  check_parameters(parameters, solids);
  return solids;
}

}  // namespace

Stage::Stage(Passes& passes, const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras,
             const StageSetting& setting)
    : passes_(passes),
      setting_(setting),
      cameras_(cameras.begin(), cameras.end()),
      tables_(sensing::make_rays(cameras)),
      rays_(sensing::upload_rays(passes.device(), tables_)),
      limits_(sensing::upload_limits(passes.device(), tables_)),
      solids_(checked(prepare_solids(solids, setting.parameters), setting.parameters)),
      solids_memory_(passes.device(), solids_) {
  const gpu::Device& device = passes.device();
  passes.prepare(solids_, tables_, setting);
  if (setting.follow) tracks_.emplace(device);
  if (setting.glides()) homes_.emplace(device);
  if (setting.looks_again(!cameras.empty())) known_.emplace(device);
  const std::vector<shader::BridgeCamera> seeing = bridge_cameras(cameras, tables_);
  const std::vector<shader::Border> borders = sector_borders();
  const gpu::Recorder recorder(device, "stage");
  gpu::Timeline timeline(device, "stage");
  const VkCommandBuffer commands = recorder.begin();
  bridge_cameras_ = gpu::uploaded(device, commands, std::span(seeing), "bridge cameras");
  borders_ = gpu::uploaded(device, commands, std::span(borders), "sector borders");
  timeline.wait(timeline.submit(recorder.end()));
}

std::uint32_t Stage::most_pixel_stride() const {
  return touch::most_pixel_stride(cameras_, tables_, touchable_box(solids_), setting_.parameters);
}

void Stage::record_skin(VkCommandBuffer commands, StageMemory& memory, gpu::Timestamps* times) const {
  memory.depth_.record(commands);
  const Box box = setting_.watched(touchable_box(solids_), true);
  sensing::plan_crops(cameras_, tables_, box, memory.crops_);
  set_stride(memory.crops_, stride_);
  sensing::plan_drops(setting_.surroundings, box, memory.drops_);
  if (!memory.drops_.empty()) {
    const std::size_t bytes = memory.drops_.size() * sizeof(shader::SkinVolume);
    std::memcpy(memory.volumes_.data(), memory.drops_.data(), bytes);
    memory.volumes_.record(commands, bytes);
  }
  passes_.skin_.record(commands,
                       {.depth = memory.depth_.ref(),
                        .rays = rays_.ref(),
                        .points = memory.seen_.ref(),
                        .total = memory.seen_total_.ref(),
                        .volumes = memory.volumes_.ref(),
                        .limits = limits_.ref(),
                        .dropped = memory.dropped_.ref()},
                       memory.skin_scratch_, tables_, box, memory.crops_,
                       ContactsPass::groups(passes_.device(), memory.room_, solids_), times, memory.drops_.size());
  gpu::compute_to_compute(commands);
}

void Stage::record(VkCommandBuffer commands, StageMemory& m, double time_s, gpu::Timestamps* times) {
  const bool cameras = tables_.pixels != 0;
  const Parameters parameters = at_stride(setting_.parameters, stride_);
  const std::uint32_t elapsed_us = tracks_ ? tracks_->clock.elapsed_us(time_s) : shader::follow_restart;
  const bool knows = setting_.knows(cameras);
  const KnownFrame frame{knows && elapsed_us <= setting_.memory_us() ? elapsed_us : shader::known_restart,
                         knows ? setting_.hysteresis_rules : 0U};
  const gpu::BufferRef points = cameras ? m.seen_.ref() : m.points_.ref();
  const gpu::BufferRef length = cameras ? m.seen_total_.ref() : m.given_.ref();
  if (cameras) {
    record_skin(commands, m, times);
  } else {
    m.points_.record(commands);
    m.given_.record(commands);
  }
  if (!solids_.records.empty()) {
    std::memcpy(m.solids_.data(), solids_.records.data(), solids_.records.size() * sizeof(shader::SolidRecord));
  }
  m.solids_.record(commands);
  const auto mark = [&](const char* name) {
    if (times) times->mark(commands, name);
  };
  passes_.contacts_.record(commands,
                           {.points = points,
                            .length = length,
                            .solids = m.solids_.ref(),
                            .cells = solids_memory_.cells(),
                            .planes = solids_memory_.planes(),
                            .total = m.total_.ref(),
                            .contacts = m.contacts_.ref(),
                            .surface = solids_memory_.surfaces().surface(),
                            .parts = solids_memory_.surfaces().parts(),
                            .deep_total = m.deep_total_.ref(),
                            .deep = m.deep_.ref(),
                            .known = known_ ? known_->ref() : gpu::BufferRef{}},
                           m.contacts_scratch_, m.room_, solids_, parameters, times, frame.elapsed_us);
  gpu::compute_to_compute(commands);
  passes_.fingers_.record(commands,
                          {.length = length,
                           .solids = m.solid_texels_.ref(),
                           .total = m.total_.ref(),
                           .contacts = m.contact_texels_.ref(),
                           .parents = m.parents_.ref(),
                           .clusters = m.clusters_.ref(),
                           .header = m.header_.ref(),
                           .fingers = m.fingers_.ref(),
                           .deep_total = m.deep_total_.ref(),
                           .deep = m.deep_.ref()},
                          m.fingers_scratch_, m.room_, setting_.searched(parameters, cameras), times);
  gpu::compute_to_compute(commands);
  const auto known_bindings = [&] {
    return KnownBindings{.depth = m.depth_.ref(),
                         .rays = rays_.ref(),
                         .cameras = bridge_cameras_.ref(),
                         .total = m.total_.ref(),
                         .contacts = m.contacts_.ref(),
                         .parents = m.parents_.ref(),
                         .header = m.header_.ref(),
                         .fingers = m.fingers_.ref(),
                         .known = known_->ref(),
                         .tracks = tracks_->ref()};
  };
  if (setting_.looks_again(cameras)) {
    passes_.split_->record(commands,
                           {.depth = m.depth_.ref(),
                            .rays = rays_.ref(),
                            .cameras = bridge_cameras_.ref(),
                            .total = m.total_.ref(),
                            .contacts = m.contacts_.ref(),
                            .parents = m.parents_.ref(),
                            .clusters = m.clusters_.ref(),
                            .header = m.header_.ref(),
                            .fingers = m.fingers_.ref(),
                            .known = known_->ref()},
                           m.split_scratch_, m.room_, parameters, frame);
    gpu::compute_to_compute(commands);
    mark("split");
    passes_.bridge_->record(commands,
                            {.depth = m.depth_.ref(),
                             .rays = rays_.ref(),
                             .cameras = bridge_cameras_.ref(),
                             .total = m.total_.ref(),
                             .contacts = m.contacts_.ref(),
                             .parents = m.parents_.ref(),
                             .clusters = m.clusters_.ref(),
                             .header = m.header_.ref(),
                             .fingers = m.fingers_.ref(),
                             .known = known_->ref()},
                            m.bridge_scratch_, m.room_, parameters, frame);
    gpu::compute_to_compute(commands);
    mark("bridge");
    if (knows) {
      passes_.known_->admit(commands, known_bindings(), m.known_scratch_, m.room_, parameters, frame);
      gpu::compute_to_compute(commands);
      mark("admit");
    }
  }
  passes_.sections_.record(commands,
                           {.total = m.total_.ref(),
                            .parents = m.parents_.ref(),
                            .contacts = m.contact_texels_.ref(),
                            .header = m.header_.ref(),
                            .grouped = m.grouped_texels_.ref(),
                            .fingers = m.fingers_.ref()},
                           m.sections_scratch_, m.room_, times);
  gpu::compute_to_compute(commands);
  if (tracks_) {
    passes_.follow_->record(commands,
                            {.header = m.header_.ref(), .fingers = m.fingers_.ref(), .tracks = tracks_->ref()},
                            elapsed_us, setting_);
    mark("follow");
    gpu::compute_to_compute(commands);
    if (knows) {
      passes_.known_->keep(commands, known_bindings(), m.known_scratch_, m.room_, parameters, frame);
      gpu::compute_to_compute(commands);  // the foci's kernels write into the fingers that it reads
      mark("keep");
    }
  }
  passes_.foci_.record(commands,
                       {.grouped = m.grouped_texels_.ref(),
                        .header = m.header_.ref(),
                        .fingers = m.fingers_.ref(),
                        .foci = m.foci_.ref(),
                        .borders = borders_.ref(),
                        .of_solid = solids_memory_.foci_of()},
                       parameters);
  mark("foci");
  if (homes_) {
    gpu::compute_to_compute(commands);
    passes_.glide_->record(commands, {.header = m.header_.ref(),
                                      .fingers = m.fingers_.ref(),
                                      .tracks = tracks_->ref(),
                                      .foci = m.foci_.ref(),
                                      .homes = homes_->ref()});
    mark("glide");
  }
  if (setting_.detail == Detail::contacts) m.contacts_.record(commands);
  if (cameras) m.dropped_.record(commands);
  m.header_.record(commands);
  m.fingers_.record(commands);
  m.foci_.record(commands);
  if (parameters.wants_deep()) {
    m.deep_.record(commands);
    m.deep_total_.record(commands);
  }
}

}  // namespace palpa::touch
