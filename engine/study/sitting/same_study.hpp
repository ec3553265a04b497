// What must stay the same in a study: the plan for all its participants.
#pragma once

#include <filesystem>

#include "study/plan/plan.hpp"
#include "study/sitting/participant_folder.hpp"

namespace palpa::study {

/// Throws bad_usage if another participant in the folder of the study was begun with another plan. Journals that cannot
/// be read are left to their own participants.
void refuse_other_study(const StudyPlan& plan, const std::filesystem::path& study, const ParticipantFolder& own);

}  // namespace palpa::study
