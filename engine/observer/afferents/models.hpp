// The afferents of TouchSim (Saal, Delhaye, Rayhaun and Bensmaia 2017, PNAS 114, E5693): seventeen models of single
// afferents, fitted to recordings from monkeys. Four are slowly adapting (SA1), nine rapidly adapting (RA), four
// Pacinian (PC). The equations are in response.hpp; this is an implementation of its own.
//
// Inside this folder, units are those of the model: mm, N, N/mm2 and samples of 0.2 ms.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "base/words.hpp"

namespace palpa::observer {

enum class AfferentClass { sa1, ra, pc };
inline constexpr Word<AfferentClass> afferent_words[] = {
    {"SA1", AfferentClass::sa1}, {"RA", AfferentClass::ra}, {"PC", AfferentClass::pc}};
inline constexpr std::size_t afferent_classes = 3;

/// The rate of samples of all signals, 1/s.
inline constexpr double afferent_rate_hz = 5000;

/// The parameters of one model. [x]+ is max(x, 0), [x]- is max(-x, 0).
struct AfferentModel {
  AfferentClass kind;
  double cutoff_hz;                ///< of the low-pass filter
  double stress_up, stress_down;   ///< weights of [stress]+ and [stress]-, per N/mm2
  double rate_up, rate_down;       ///< of the dynamic signal
  double change_up, change_down;   ///< of its change from sample to sample
  double saturation;               ///< the current's limit; 0: none
  double memory;                   ///< time constant of the membrane, samples
  double after_quick, after_slow;  ///< weights of the two currents that follow a spike
};

std::span<const AfferentModel> afferent_models();
/// How many models a class has.
std::size_t models_of(AfferentClass kind);

/// The depth of a class below the skin, mm.
double depth_mm(AfferentClass kind);
/// Afferents per cm2 of a fingertip.
double density_per_cm2(AfferentClass kind);

}  // namespace palpa::observer
