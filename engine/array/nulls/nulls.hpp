// Nulls: places where the sound of a drive is to be zero. Computed once for an array; the drives of all slots use it.
//
//   G_i   the sound at place i from each transducer at full amplitude and phase 0, a row
//   Q     rows that span the G_i, by Gram and Schmidt: Q Q^H = I
//
// A drive x is silent at every place if Q x = 0, and x - Q^H Q x is the nearest drive that is.
//
// A null with a radius is a ball. A sound without sources in a ball is known from few places in it and on its surface.
// They are chosen one after the other, beginning with the centre: next comes the place whose sound the ones before
// explain least. What they leave of its sound, relative to the centre's, is its `rest`. Rows are ordered by it, so that
// the rows up to a rest are always the first ones: they make the whole ball silent to about that rest.
//
// docs/notes/nulls.md has the derivation and the figures.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "array/field/directivity.hpp"
#include "array/field/split_rows.hpp"
#include "array/layouts/layout.hpp"
#include "array/medium.hpp"
#include "array/nulls/null.hpp"
#include "base/math.hpp"

namespace palpa::array {

/// The most rows, and the most entries of all rows, unless there are more nulls. The rows with the smallest rests are
/// left out: time grows with the square of their number. Four balls as wide as a wavelength have about 320 rows in
/// `paper`.
inline constexpr std::size_t most_null_rows = 320, most_null_entries = 5u << 18;
inline constexpr double null_deepest_rest = 1e-4;  ///< the smallest rest of a row
inline constexpr double null_loosest_rest = 1e-2;  ///< rows above it are left out last (null_drive.hpp)

class Nulls {
 public:
  /// In the free field. Nulls at which nothing arrives have no rows. At most most_nulls, with at most
  /// most_null_radius_m.
  Nulls(const Layout& layout, const Medium& medium, Directivity directivity, std::span<const Null> nulls);

  std::span<const Null> nulls() const { return nulls_; }
  const SplitRows& rows() const { return rows_; }  ///< Q
  /// How many rows have this rest or more.
  std::size_t rows_to(double rest) const;
  /// For each row: |G| at the centre of its null, in 1/m (times the source level: Pa).
  std::span<const double> loudness() const { return loudness_; }
  /// G at the centres of the nulls that have rows, in their order.
  const SplitRows& centres() const { return centres_; }

 private:
  std::vector<Null> nulls_;
  SplitRows rows_, centres_;
  std::vector<double> rests_, loudness_;
};

}  // namespace palpa::array
