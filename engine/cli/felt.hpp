// What skin feels in time, for people and programs: --spectrum, and what --tune chose.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acoustics/skin.hpp"
#include "acoustics/spectrum.hpp"
#include "acoustics/tune.hpp"
#include "array/schedule.hpp"
#include "base/json_writer.hpp"

namespace palpa::cli {

/// The members "spectrum" and "tune" of a finger in the touch's JSON, each only where asked for.
void add_spectrum(JsonWriter& json, double perimeter_m, const acoustics::Spectrum& spectrum);
void add_tune(JsonWriter& json, const acoustics::Tuned& tuned);

/// The same as a few lines of text.
std::string spectrum_table(std::uint32_t finger, double perimeter_m, const acoustics::Spectrum& spectrum);
std::string tune_line(std::uint32_t finger, const acoustics::Tuned& tuned);

}  // namespace palpa::cli
