// The reports of a simulation of power.
#pragma once

#include <string>

#include "study/power.hpp"

namespace palpa::study {

std::string power_text(const PowerSetting& setting, const PowerResult& result);
std::string power_json(const PowerSetting& setting, const PowerResult& result);
/// One row per number of participants.
std::string power_csv(const PowerResult& result);
std::string power_html(const PowerSetting& setting, const PowerResult& result);

}  // namespace palpa::study
