#pragma once

namespace knee_robot::dynamics {

/// A place along a stroke where something differs: exp(-((q - center) / width)^2) over the positions that training has
/// seen. Where its top lies among them and the bell has fallen below its mean at an end, the place ends there: the bell
/// goes on. Otherwise nobody knows what comes; the value goes from that at the end of what was seen back to the mean
/// over it, within the place's own width: near the end it is what it was there, far from it no better guess than the
/// mean is left. A wide place, a trend along the stroke, hardly changes.
class StrokePlace {
 public:
  /// Center, width (positive) and the range that training has seen, all in m; to_m below from_m counts as from_m.
  StrokePlace(double center_m, double width_m, double from_m, double to_m) noexcept;
  /// Share in [0, 1] at a position, m. Real-time safe.
  double at(double position_m) const noexcept;

 private:
  double within(double position_m) const noexcept;
  /// The flank at that end of what was seen is that of a place whose top was seen too.
  bool endsWithin(double end_m) const noexcept;
  double center_m_, width_m_, from_m_, to_m_, mean_;
};

}  // namespace knee_robot::dynamics
