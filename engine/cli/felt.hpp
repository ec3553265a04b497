// What skin feels in time, for people and programs: --spectrum, and what --tune chose.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "array/spectrum.hpp"
#include "array/tune.hpp"
#include "base/json_writer.hpp"

namespace palpa::cli {

/// The members "spectrum" and "tune" of a finger in the touch's JSON, each only where asked for.
void add_spectrum(JsonWriter& json, double perimeter_m, const array::Spectrum& spectrum);
void add_tune(JsonWriter& json, const array::Tuned& tuned);

/// The same as a few lines of text.
std::string spectrum_table(std::uint32_t finger, double perimeter_m, const array::Spectrum& spectrum);
std::string tune_line(std::uint32_t finger, const array::Tuned& tuned);

}  // namespace palpa::cli
