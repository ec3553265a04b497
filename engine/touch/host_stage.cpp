#include "touch/host_stage.hpp"

#include "touch/bridge/bridge_cameras.hpp"
#include "touch/check_parameters.hpp"
#include "touch/contacts/contacts_twin.hpp"
#include "touch/contacts/pixel_stride.hpp"
#include "touch/depths.hpp"
#include "touch/fingers/fingers_twin.hpp"
#include "touch/foci/foci_twin.hpp"
#include "touch/known/admit_twin.hpp"
#include "touch/known/keep_twin.hpp"
#include "touch/sections/sections_twin.hpp"
#include "touch/split/split_twin.hpp"

namespace palpa::touch {

HostStage::HostStage(const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras,
                     const StageSetting& setting)
    : setting_(setting),
      cameras_(cameras.begin(), cameras.end()),
      tables_(sensing::make_rays(cameras)),
      bridge_cameras_(bridge_cameras(cameras, tables_)),
      solids_(prepare_solids(solids, setting.parameters)) {
  check_parameters(setting.parameters, solids_);
  if (setting.follow) tracks_.emplace();
  if (setting.glides()) homes_.emplace();
  if (setting.knows(!cameras.empty())) known_ = std::make_unique<shader::KnownTable>();
}

std::uint32_t HostStage::most_pixel_stride() const {
  return touch::most_pixel_stride(cameras_, tables_, touchable_box(solids_), setting_.parameters);
}

void HostStage::touch(std::span<const sensing::DepthFrame> images, Touch& out, double time_s, const Mark& mark) {
  const Box box = setting_.watched(touchable_box(solids_), true);
  sensing::plan_crops(cameras_, tables_, box, crops_);
  set_stride(crops_, stride_);
  sensing::plan_drops(setting_.surroundings, box, volumes_);
  sensing::find_skin(tables_, images, box, crops_, volumes_, skin_);
  if (mark) mark("skin");
  const Sight sight{bridge_cameras_, tables_, images};
  out.dropped = skin_.dropped;
  touch(skin_.points, &sight, out, time_s, mark);
}

void HostStage::touch(std::span<const sensing::SkinPoint> points, Touch& out, double time_s, const Mark& mark) {
  out.dropped = {};
  touch(points, nullptr, out, time_s, mark);
}

void HostStage::touch(std::span<const sensing::SkinPoint> points, const Sight* sight, Touch& out, double time_s,
                      const Mark& mark) {
  const auto done = [&](const char* part) {
    if (mark) mark(part);
  };
  const Parameters parameters = at_stride(setting_.parameters, stride_);
  const std::uint32_t elapsed_us = tracks_ ? tracks_->clock.elapsed_us(time_s) : 0;
  const bool has_before = known_ && elapsed_us <= setting_.memory_us();
  find_contacts(points, solids_, parameters, {has_before ? known_.get() : nullptr, elapsed_us}, out);
  done("contacts");
  find_fingers(setting_.searched(parameters, sight != nullptr), solids_, out);
  done("fingers");
  ClaimList claims{};
  if (setting_.looks_again(sight != nullptr)) {
    const Known known{{elapsed_us, known_ ? setting_.hysteresis_rules : 0U},
                      has_before ? known_.get() : nullptr,
                      static_cast<float>(parameters.finger_width_m)};
    split_fingers(*sight, parameters, known, out);
    done("split");
    bridge_fingers(*sight, parameters, known, out);
    done("bridge");
    if (known_) {
      claims = admit_fingers(*sight, parameters, known, *known_, out);
      done("admit");
    }
  }
  find_sections(out);
  done("sections");
  if (tracks_) {
    follow_fingers(*tracks_, elapsed_us, setting_, out);
    done("follow");
  }
  if (known_) {
    keep_fingers(*sight, parameters, *tracks_, claims, setting_.hysteresis_rules, out, *known_);
    done("keep");
  }
  find_foci(parameters, solids_.foci_of, out);
  done("foci");
  if (homes_) {
    glide_foci(*tracks_, *homes_, out);
    done("glide");
  }
  if (known_) leave_out_beyond(out);
  find_depths(out);
}

}  // namespace palpa::touch
