#pragma once

#include <optional>

#include "search.h"
#include "selection.h"

namespace knee_robot::tracing {

constexpr double kMostPieces = 0.8;  ///< share of a local effect's held-back pieces that must gain
constexpr double kMapErrors =
    2.5;  ///< standard errors by which a map must help: it bends to much, and extrapolates badly

/// A hypothesis that is being compared.
struct Trial {
  Hypothesis hypothesis;
  std::size_t place = 0;  ///< in the library
  double share = 0.0;     ///< of squared noise, explained by projection
  JointFit fit;
  Eigen::VectorXd joint_gain;   ///< per held-back block, weighted squares: everything fitted without the block
  Eigen::VectorXd nested_gain;  ///< only the effect fitted without the block, its shape chosen without it too
  bool by_joint =
      true;  ///< which of them speaks more clearly: where the baseline extrapolates badly the first says nothing
  Eigen::VectorXd gain;  ///< that one
  HeldBackGain held;     ///< of it

  const std::string name() const { return hypothesis.place.candidate->name(); }
  bool isMap() const { return hypothesis.place.candidate->isMap(); }
};

/// The places that are compared in a pass, with the columns that they are scored by.
struct Ranking {
  Projection projection;      ///< onto the model as it stands
  std::vector<Trial> trials;  ///< with refined shapes and held-back gains; best held-back gain first
};

/// Where an effect of one of the library's places could be added to the model as it stands: there, or, when it is in
/// the model, as a further one with another period (Candidate::mostOnOneActuator). Nothing when neither may be.
/// `like`: only this effect, of this order (Place::order), on other actuators; null: any.
std::optional<Place> openPlace(const Search& search, const Place& place, const Place* like);

/// Compares the library's places that are open beside the model as it stands. Sets search.fit.
Ranking rankPlaces(Search& search, const Place* like);

/// Gains of the held-back blocks (weighted squares) when the effect's coefficients are fitted, and its shape is chosen
/// among `shapes`, without them; the baseline is fitted to everything with and without the effect.
Eigen::VectorXd nestedGain(const Search& search, const Projection& projection, const std::vector<Hypothesis>& shapes);

/// Empty when the trial may be accepted, but for the null; otherwise why not. `sibling`: the same effect was found on
/// another actuator, so that less is asked for.
std::string objection(const Search& search, const Trial& trial, bool sibling);

}  // namespace knee_robot::tracing
