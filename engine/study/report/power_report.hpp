// The reports of a simulation of power.
#pragma once

#include <string>
#include <vector>

#include "study/power.hpp"

namespace palpa::study {

std::string power_text(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others);
std::string power_json(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others);
/// One row per number of participants.
std::string power_csv(const PowerResult& result);
std::string power_html(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others);

}  // namespace palpa::study
