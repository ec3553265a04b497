// What must stay the same in a study: the plan for all its participants, and the models of its shapes.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "study/plan/order.hpp"
#include "study/plan/plan.hpp"
#include "study/sitting/journal.hpp"
#include "study/sitting/participant_folder.hpp"

namespace palpa::study {

/// Throws bad_usage if a touch was played with another model than the plan's shape has now (PlanShape::model_sha256).
/// `journal`: its file, for messages.
void refuse_other_models(const StudyPlan& plan, std::span<const Step> steps, std::span<const Entry> entries,
                         const std::string& journal);

/// Throws bad_usage if another participant in the folder of the study was begun with another plan, or touched other
/// models. Journals that cannot be read are left to their own participants.
void refuse_other_study(const StudyPlan& plan, const std::filesystem::path& study, const ParticipantFolder& own);

}  // namespace palpa::study
