// A sensation: where a focus is at each time, and how loud. From a pattern, or from a function. SI units; times count
// from the start.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/math.hpp"
#include "base/random.hpp"
#include "sensation/evaluate.hpp"
#include "sensation/pattern.hpp"

namespace palpa::sensation {

/// The focus at one time.
struct Point {
  Vec3 place_m{0};       ///< in the array's own frame
  double height_m = 0;   ///< the part of place_m.z that a hand's height replaces
  double gain = 0;       ///< 0..1; 0 for a place or an intensity that is not finite
  double pattern_s = 0;  ///< the pattern's own time
  bool stop = false;     ///< it has ended
};

/// How far a sensation has got. A copy goes on from the same time.
struct State {
  double begin_s = 0;       ///< where it began
  std::uint64_t steps = 0;  ///< the steps taken since
  Progress progress;
  Random random{0};

  /// At the beginning: `begin_s` on the pattern's own time, too.
  static State at(double begin_s, std::uint64_t seed = 0) {
    return {begin_s, 0, {.last_ms = 1e3 * begin_s}, Random(seed)};
  }
};

class Sensation {
 public:
  virtual ~Sensation() = default;
  /// Appends the points of the ascending times, none before the state's. Throws Error.
  virtual void points(std::span<const double> times_s, State& state, std::vector<Point>& out) = 0;
  /// Whether other threads have changed something, which take_changes() takes. Both are for the thread that calls
  /// points().
  virtual bool has_changes() { return false; }
  virtual bool take_changes() { return false; }
  /// The highest frequency of its path and its modulation; 0 if it has none or is not known.
  virtual double fastest_hz() const { return 0; }
};

/// How finely a pattern is evaluated while it plays, as Adaptics' engine does: a jump is at most this late.
inline constexpr double step_s = 0.05e-3;
/// Faster brushes and modulations are refused.
inline constexpr double most_hz = 500;

/// A pattern that plays. Points are evaluated from steps of step_s.
class PatternSensation final : public Sensation {
 public:
  /// Throws bad_usage as values_of does.
  explicit PatternSensation(Pattern pattern, const std::map<std::string, double>& given = {}, double speed = 1);

  void points(std::span<const double> times_s, State& state, std::vector<Point>& out) override;
  bool has_changes() override;
  bool take_changes() override;
  double fastest_hz() const override;

  /// One evaluation, raw: the state goes on from the time before to this one, without steps in between.
  Evaluation step(double time_s, State& state) const { return step(time_s, now_.values, state); }
  /// The same with other values of its parameters.
  Evaluation step(double time_s, const Values& values, State& state) const;

  /// What it plays. Only for the thread that calls points().
  const std::map<std::string, double>& given() const { return now_.given; }
  const Pattern& pattern() const { return *now_.pattern; }
  const Values& values() const { return now_.values; }

  // On any thread, from the next take_changes() on. Each throws as the constructor does.
  /// All parameters, those that are left out at their defaults.
  void set_parameters(std::map<std::string, double> given);
  /// One of them.
  void set_parameter(const std::string& name, double value);
  /// Another pattern, at the same time.
  void set_pattern(Pattern pattern);
  /// Each parameter with the value that it was given last, or its default, within its limits.
  std::vector<std::pair<std::string, double>> parameters() const;
  /// Multiplies the pattern's own speed.
  void set_speed(double speed);
  /// Applied to places in millimetres, before the brush; any matrix. Places are divided by their fourth coordinate.
  void set_matrix(const Transform& matrix);

 private:
  struct Content {
    std::shared_ptr<const Pattern> pattern;
    std::map<std::string, double> given;
    Values values;
    std::optional<Transform> matrix;
    double speed = 1;
  };
  template <typename Change>
  void change(Change change);
  Point point_of(const Evaluation& at, double time_s);
  Evaluation step_at(double time_ms, const Values& values, State& state) const;

  Content now_;
  bool warned_ = false;
  mutable std::mutex mutex_;
  Content next_;
  bool changed_ = false;
};

/// A function of time: fills a place in metres and a gain for each of the times.
class FunctionSensation final : public Sensation {
 public:
  using Function =
      std::function<void(std::span<const double> times_s, std::vector<Vec3>& places_m, std::vector<double>& gains)>;
  /// `hz` is its highest frequency, if it is known.
  explicit FunctionSensation(Function function, double hz = 0) : function_(std::move(function)), hz_(hz) {}

  /// Throws bad_usage for another number of places or gains than of times.
  void points(std::span<const double> times_s, State& state, std::vector<Point>& out) override;
  double fastest_hz() const override { return hz_; }

 private:
  Function function_;
  double hz_;
  bool warned_ = false;
  std::vector<Vec3> places_;
  std::vector<double> gains_;
};

}  // namespace palpa::sensation
