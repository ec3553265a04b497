// How loud the array of a study will be to a participant's ears, in dB(A): the sound that the air makes of changes of
// its power (acoustics/audible.hpp), beside the tone of 40 kHz (sitting/ear_level.hpp).
#pragma once

#include <span>

#include "acoustics/audible.hpp"
#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "study/plan/plan.hpp"

namespace palpa::study {

/// The level of the plan's loudest method at its ceiling, at the ear that is nearer to its array: foci on a ring of 35
/// mm, as on a fingertip that is 3 mm deep, or in its middle, on top of the objects. `objects` and `placed` as for
/// predict_ear_level.
acoustics::EarLevel predict_heard_level(const StudyPlan& plan, std::span<const Box> objects,
                                        const array::Layout* placed = nullptr);

}  // namespace palpa::study
