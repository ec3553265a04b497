#include "array/solvers/climb_lanes.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "array/field/transfer.hpp"
#include "array/solvers/greedy.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;
using Lane = Lanes8;
using Vector = Lane::Float;
static_assert(Lane::width == lanes_together);

constexpr float none = 1e-30F;  // squares below this are 0

/// A factor for each focus.
struct Pulls {
  std::array<float, most_solved_foci> re{}, im{};

  explicit Pulls(std::span<const Complex> factors) {
    for (std::size_t j = 0; j < factors.size(); ++j) {
      re[j] = static_cast<float>(factors[j].real());
      im[j] = static_cast<float>(factors[j].imag());
    }
  }
};

/// One block: what each focus hears of it, G x.
struct Heard {
  std::array<Vector, most_solved_foci> re, im;
};

struct Work {
  const LaneColumns& columns;
  const LaneDrives& drive;
  const Pulls& pull;
  const Pulls& stiff;
  float soft;
};

[[gnu::always_inline]] inline Vector zero() {
  return Vector{0, 0, 0, 0, 0, 0, 0, 0};
}

[[gnu::always_inline]] inline void hear_block(const LaneColumns& columns, std::size_t block, const Vector& x,
                                              const Vector& y, Heard& heard) {
  const std::size_t first = block * columns.foci * lanes_together;
  for (std::size_t j = 0; j < columns.foci; ++j) {
    const Vector re = load_lanes<Lane>(&columns.re[first + j * lanes_together]);
    const Vector im = load_lanes<Lane>(&columns.im[first + j * lanes_together]);
    heard.re[j] = x * re - y * im;
    heard.im[j] = x * im + y * re;
  }
}

/// D_n.
[[gnu::always_inline]] inline Vector stiffness_of(const Work& work, const Heard& heard) {
  Vector re = zero(), im = zero();
  for (std::size_t j = 0; j < work.columns.foci; ++j) {
    re += work.stiff.re[j] * heard.re[j] - work.stiff.im[j] * heard.im[j];
    im += work.stiff.re[j] * heard.im[j] + work.stiff.im[j] * heard.re[j];
  }
  const Vector square = re * re + im * im + none;
  return square * inverse_root<Lane>(square) + work.soft;
}

using Sums = std::array<Vector, most_solved_foci>;

[[gnu::always_inline]] inline void listen_all(const LaneColumns& columns, const LaneDrives& drive, Sums& re, Sums& im) {
  for (std::size_t block = 0; block < columns.blocks; ++block) {
    Heard heard;
    hear_block(columns, block, load_lanes<Lane>(&drive.re[block * lanes_together]),
               load_lanes<Lane>(&drive.im[block * lanes_together]), heard);
    for (std::size_t j = 0; j < columns.foci; ++j) {
      re[j] += heard.re[j];
      im[j] += heard.im[j];
    }
  }
}

[[gnu::always_inline]] inline void turn_all(const Work& work, float stiffness, float most_turn, LaneDrives& tried,
                                            Sums& sum_re, Sums& sum_im) {
  const std::size_t foci = work.columns.foci;
  for (std::size_t block = 0; block < work.columns.blocks; ++block) {
    const Vector x = load_lanes<Lane>(&work.drive.re[block * lanes_together]);
    const Vector y = load_lanes<Lane>(&work.drive.im[block * lanes_together]);
    Heard heard;
    hear_block(work.columns, block, x, y, heard);
    Vector pulled = zero();
    for (std::size_t j = 0; j < foci; ++j)
      pulled += work.pull.re[j] * heard.im[j] + work.pull.im[j] * heard.re[j];
    Vector by = -pulled / (stiffness * stiffness_of(work, heard));
    by = by < -most_turn ? zero() - most_turn : by;
    by = by > most_turn ? zero() + most_turn : by;
    // Taylor's series, within 1e-7 up to 1 rad.
    const Vector square = by * by;
    const Vector sine =
        by * (1.0F + square * (-1.0F / 6 + square * (1.0F / 120 + square * (-1.0F / 5040 + square * (1.0F / 362880)))));
    const Vector cosine =
        1.0F + square * (-0.5F + square * (1.0F / 24 + square * (-1.0F / 720 + square * (1.0F / 40320))));
    store_lanes<Lane>(x * cosine - y * sine, &tried.re[block * lanes_together]);
    store_lanes<Lane>(x * sine + y * cosine, &tried.im[block * lanes_together]);
    for (std::size_t j = 0; j < foci; ++j) {
      sum_re[j] += heard.re[j] * cosine - heard.im[j] * sine;
      sum_im[j] += heard.re[j] * sine + heard.im[j] * cosine;
    }
  }
}

/// The sums of the pairs j, k <= j, at j (j + 1) / 2 + k.
using Pairs = std::array<Vector, most_solved_foci*(most_solved_foci + 1) / 2>;

[[gnu::always_inline]] inline void grow_all(const Work& work, std::size_t every, Pairs& pairs) {
  const std::size_t foci = work.columns.foci;
  for (std::size_t block = 0; block < work.columns.blocks; block += every) {
    Heard heard;
    hear_block(work.columns, block, load_lanes<Lane>(&work.drive.re[block * lanes_together]),
               load_lanes<Lane>(&work.drive.im[block * lanes_together]), heard);
    const Vector held = stiffness_of(work, heard);
    Sums slopes;
    for (std::size_t j = 0; j < foci; ++j)
      slopes[j] = -(work.pull.re[j] * heard.im[j] + work.pull.im[j] * heard.re[j]);
    std::size_t pair = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      const Vector part = slopes[j] / held;
      for (std::size_t k = 0; k <= j; ++k)
        pairs[pair++] += part * slopes[k];
    }
  }
}

double total(const Vector& lanes) {
  double sum = 0;
  for (std::size_t lane = 0; lane < lanes_together; ++lane)
    sum += static_cast<double>(lanes[lane]);
  return sum;
}

void total(const Sums& re, const Sums& im, std::span<Complex> pressure) {
  for (std::size_t j = 0; j < pressure.size(); ++j)
    pressure[j] = {total(re[j]), total(im[j])};
}

}  // namespace

void take_lanes(const Columns& columns, std::size_t count, LaneColumns& lanes) {
  const std::size_t foci = columns.foci;
  const bool everyone = count >= columns.transducers;
  lanes.foci = foci;
  lanes.transducers = std::min(count, columns.transducers);
  lanes.blocks = (lanes.transducers + lanes_together - 1) / lanes_together;
  lanes.re.resize(lanes.blocks * foci * lanes_together);
  lanes.im.resize(lanes.blocks * foci * lanes_together);
  const std::size_t stride = everyone ? 1 : greedy_stride(static_cast<std::uint32_t>(columns.transducers));
  const double* const loud = columns.loud.data();
  const double* const cosine = columns.cosine.data();
  const double* const sine = columns.sine.data();
  float* const re = lanes.re.data();
  float* const im = lanes.im.data();
  for (std::size_t i = 0, n = 0; i < lanes.transducers; ++i, n = (n + stride) % columns.transducers) {
    const std::size_t first = i / lanes_together * foci * lanes_together + i % lanes_together, from = n * foci;
    for (std::size_t j = 0; j < foci; ++j) {
      re[first + j * lanes_together] = static_cast<float>(loud[from + j] * cosine[from + j]);
      im[first + j * lanes_together] = static_cast<float>(loud[from + j] * sine[from + j]);
    }
  }
  for (std::size_t i = lanes.transducers; i < lanes.blocks * lanes_together; ++i) {
    const std::size_t first = i / lanes_together * foci * lanes_together + i % lanes_together;
    for (std::size_t j = 0; j < foci; ++j)
      re[first + j * lanes_together] = im[first + j * lanes_together] = 0;
  }
}

void hear_lanes(const LaneColumns& columns, const LaneDrives& drive, std::span<Complex> pressure) {
  Sums re{}, im{};
  in_lanes([&](auto) PALPA_INLINED { listen_all(columns, drive, re, im); });
  total(re, im, pressure);
}

void turn_lanes(const LaneColumns& columns, const LaneDrives& drive, std::span<const Complex> pull,
                const Stiffness& held, double stiffness, double most_turn, LaneDrives& tried,
                std::span<Complex> pressure) {
  tried.re.resize(drive.re.size());
  tried.im.resize(drive.im.size());
  const Pulls pulls(pull), stiff(held.stiff);
  Sums re{}, im{};
  const Work work{columns, drive, pulls, stiff, static_cast<float>(held.soft)};
  in_lanes([&](auto) PALPA_INLINED {
    turn_all(work, static_cast<float>(stiffness), static_cast<float>(most_turn), tried, re, im);
  });
  total(re, im, pressure);
}

void find_growth(const LaneColumns& columns, const LaneDrives& drive, std::span<const Complex> turn,
                 const Stiffness& held, std::size_t every, std::span<double> growth) {
  assert(columns.foci <= most_solved_foci && growth.size() == columns.foci * columns.foci);
  const Pulls turns(turn), stiff(held.stiff);
  Pairs pairs;
  const std::size_t foci = columns.foci;
  std::fill_n(pairs.begin(), foci * (foci + 1) / 2, zero());
  const Work work{columns, drive, turns, stiff, static_cast<float>(held.soft)};
  in_lanes([&](auto) PALPA_INLINED { grow_all(work, every, pairs); });
  std::size_t pair = 0;
  for (std::size_t j = 0; j < foci; ++j) {
    for (std::size_t k = 0; k <= j; ++k)
      growth[j * foci + k] = growth[k * foci + j] = static_cast<double>(every) * total(pairs[pair++]);
  }
}

}  // namespace palpa::array
