#include "touch/fingers/fingers.hpp"

#include "touch/fingers/admit.hpp"
#include "touch/fingers/bridge.hpp"
#include "touch/fingers/depths.hpp"
#include "touch/fingers/keep.hpp"
#include "touch/fingers/sections.hpp"
#include "touch/fingers/sectors.hpp"
#include "touch/fingers/split.hpp"
#include "touch/pass_watch.hpp"

namespace palpa::touch {

Fingers::Fingers(const StageSetting& setting, std::span<const sensing::Camera> cameras,
                 const sensing::RayTables& tables, const PreparedSolids& solids)
    : tables_(tables),
      solids_(solids),
      setting_(setting),
      cameras_(sight_cameras(cameras, tables)),
      skins_(max_fingers) {
  if (setting.follow) tracks_.emplace();
  if (setting.glides()) glide_memory_.emplace();
  if (setting.knows(!cameras.empty())) known_ = std::make_unique<KnownFingers>();
}

FingerReach Fingers::next(double time_s) {
  if (tracks_) elapsed_us_ = tracks_->clock.elapsed_us(time_s);
  has_before_ = known_ && elapsed_us_ && *elapsed_us_ <= setting_.memory_us();
  return {has_before_ ? &known_->reach : nullptr, elapsed_us_.value_or(0)};
}

void Fingers::find(std::span<const sensing::DepthFrame> images, const FingerOptions& parameters, Touch& out,
                   std::vector<gpu::PassTime>& times) {
  PassWatch watch(times);
  const bool cameras = !cameras_.empty();
  const Sight sight{cameras_, tables_, images};
  Continuations continuations{};
  if (setting_.looks_again(cameras)) {
    const Known known{elapsed_us_.value_or(0), known_ ? setting_.rules : no_rules, has_before_ ? known_.get() : nullptr,
                      static_cast<float>(parameters.finger_width_m)};
    split_fingers(sight, parameters, known, out, skins_, split_work_);
    watch.mark("split");
    bridge_fingers(sight, parameters, known, out, skins_);
    watch.mark("bridge");
    if (known_) {
      continuations = admit_fingers(sight, parameters, known, *known_, out, skins_);
      watch.mark("admit");
    }
  }
  find_sections(out);
  watch.mark("sections");
  if (tracks_) {
    follow_fingers(*tracks_, elapsed_us_, setting_, out);
    watch.mark("follow");
  }
  if (known_) {
    keep_fingers(skins_, parameters, *tracks_, continuations, setting_.rules, out, *known_);
    watch.mark("keep");
  }
  find_foci(parameters, solids_.foci_of, out);
  watch.mark("foci");
  if (glide_memory_) {
    glide_foci(*tracks_, *glide_memory_, out);
    watch.mark("glide");
  }
  if (known_) leave_out_beyond(out, places_);
  find_depths(sight, out);
  watch.mark("depths");
}

}  // namespace palpa::touch
