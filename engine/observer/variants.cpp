#include "observer/variants.hpp"

namespace palpa::observer {
namespace {

constexpr Variant variants[]{
    {.name = "reference", .what = "the design: square roots of the spikes of all afferents, with delays"},
    {.name = "placement known", .what = "the observer knows where the finger is", .placement = Placement::known},
    {.name = "counts", .what = "noise on the counts instead of their square roots", .scale = Scale::plain},
    {.name = "depth offset", .what = "depths are known to 3 mm only", .depth = Depth::offset},
    {.name = "depths averaged", .what = "only the spikes of all depths together", .depth = Depth::averaged},
    {.name = "no wave delays", .what = "all deflections arrive at once", .cue = Cue::spikes_at_once},
    {.name = "PC alone", .what = "only Pacinian afferents", .classes = Classes::pc},
    {.name = "RA alone", .what = "only rapidly adapting afferents", .classes = Classes::ra},
    {.name = "class sums", .what = "only the spikes of each class together", .cue = Cue::class_sums},
    {.name = "linear level", .what = "the design at the linear pressures, which are not physical", .linear = true},
    {.name = "linear, PC alone", .what = "the same, only Pacinian afferents", .classes = Classes::pc, .linear = true},
    {.name = "linear, RA alone",
     .what = "the same, only rapidly adapting afferents",
     .classes = Classes::ra,
     .linear = true},
    {.name = "linear, class sums",
     .what = "the same, only the spikes of each class together",
     .cue = Cue::class_sums,
     .linear = true},
    {.name = "stress", .what = "no afferents: the mean stress at 0.3 mm", .cue = Cue::stress, .scale = Scale::plain},
    {.name = "stress, log", .what = "its logarithm", .cue = Cue::stress, .scale = Scale::logarithm},
    {.name = "stress, pattern", .what = "only its pattern", .cue = Cue::stress, .scale = Scale::pattern},
    {.name = "stress, total", .what = "only its sum", .cue = Cue::stress, .scale = Scale::total},
    {.name = "flutter",
     .what = "no afferents: vibration in the band of RA",
     .cue = Cue::flutter,
     .scale = Scale::plain},
    {.name = "flutter, log", .what = "its logarithm", .cue = Cue::flutter, .scale = Scale::logarithm},
    {.name = "flutter, pattern", .what = "only its pattern", .cue = Cue::flutter, .scale = Scale::pattern},
    {.name = "vibration",
     .what = "no afferents: vibration in the band of PC",
     .cue = Cue::vibration,
     .scale = Scale::plain},
    {.name = "vibration, log", .what = "its logarithm", .cue = Cue::vibration, .scale = Scale::logarithm},
    {.name = "vibration, pattern", .what = "only its pattern", .cue = Cue::vibration, .scale = Scale::pattern},
    {.name = "vibration, total", .what = "only its sum", .cue = Cue::vibration, .scale = Scale::total},
};

}  // namespace

std::span<const Variant> observer_variants() {
  return variants;
}

}  // namespace palpa::observer
