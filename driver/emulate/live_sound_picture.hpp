// `palpa emulate --view`: shows what the boards sound on stdout, twice a second.
#pragma once

#include <exception>
#include <functional>
#include <span>
#include <string>
#include <thread>

#include "acoustics/field/incident.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::driver::emulate {

/// Where the sound of a drive is loudest in front of the boards, layout frame.
struct Loudest {
  Vec3 place;
  double pascals = 0;  ///< peak; 0: silence
};

/// The sound that boards' bytes make, as text: where it is loudest, and a vertical cut through that place.
class SoundPicture {
 public:
  /// For this layout, which must outlive this object; 20 degrees, T4010A1.
  explicit SoundPicture(const array::Layout& layout);
  /// Exact to a tenth of a millimetre if the loudest place is a focus.
  Loudest loudest(std::span<const array::TransducerDrive> drive) const;
  /// A line with the loudest place and its pressure, and below it |p| around that place: x to the right, z upward, y as
  /// in the line.
  std::string picture(std::span<const array::TransducerDrive> drive) const;

 private:
  std::vector<double> pressures(std::span<const Vec3> points, std::span<const array::TransducerDrive> drive) const;

  acoustics::Incident incident_;
  Vec3 low_, high_;  ///< the region that is searched
};

/// A thread that asks `heard` for what sounds, and prints it if it has changed, as long as this object exists.
class LiveSoundPicture {
 public:
  LiveSoundPicture(const array::Layout& layout, std::function<array::Drive()> heard);
  /// Ends the thread. Throws what the thread failed with if stdout could not be written; it has then already asked for
  /// a Stop.
  void end();

 private:
  void look(const std::stop_token& stop);

  SoundPicture view_;
  std::function<array::Drive()> heard_;
  std::string last_;
  std::exception_ptr fault_;  ///< belongs to the thread until that is joined
  std::jthread thread_;
};

}  // namespace palpa::driver::emulate
