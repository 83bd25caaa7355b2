#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {

/// A parameter that bends the columns (a Stribeck velocity, a screw's pitch), searched on a grid.
struct ShapeParameter {
  std::string name;  ///< as in report.json, unit in the name
  double low = 0.0, high = 0.0;
  bool fixed = false;  ///< chosen on the grid, or follows from the recording: not refined together with other shapes
  std::optional<double> in_older_files = {};  ///< its value in model files that were written before it was thought of
};

/// A parameter that multiplies a column.
struct Coefficient {
  std::string name;           ///< as in report.json, unit in the name
  bool non_negative = false;  ///< physics allows one sign only
};

/// One effect that the rigid model with Coulomb and viscous friction lacks, as columns that are added to the linear
/// model. One class and one file an effect: effects/NAME.cpp. Stateless.
class Candidate {
 public:
  virtual ~Candidate() = default;

  virtual std::string name() const = 0;      ///< as in docs/tracing.md; of a map: unnamed
  virtual std::string sentence() const = 0;  ///< the physics, for the report
  /// Name of the simpler effect that is a special case of this one; this one must be clearly better to be preferred.
  /// Empty: none.
  virtual std::string generalizes() const { return {}; }
  /// Name of a simpler effect on the same actuator that it can be taken for, if the law near rest beside it is not the
  /// machine's own: that one is preferred where it does as well with a law of its own. Empty: none.
  virtual std::string takenFor() const { return {}; }
  /// True: one set of coefficients acts on all actuators together (a spring at the platform).
  virtual bool shared() const { return false; }
  /// True: sits on one actuator and changes what the others carry, too (reach).
  virtual bool reachesOthers() const { return false; }
  /// False: belongs to one recording and predicts nothing elsewhere.
  virtual bool transfers() const { return true; }
  /// False: acts elsewhere, too, from a state that nobody knows there (where a mass lay): it is fitted again without it.
  virtual bool knownElsewhere() const { return true; }
  /// True: acts during a part of a recording only. What was held back outside it says nothing, and inside it there may
  /// be a single block: pieces of that part are held back instead.
  virtual bool local() const { return false; }
  /// True: acts in a small part of a brisk motion, and through the whole of a slow one: how large it is there counts as
  /// well, not only what it adds to the rms of training.
  virtual bool actsNearRest() const { return false; }
  /// True: shows in fast motion only; looked for in a second, higher band as well.
  virtual bool actsFast() const { return false; }
  /// True: the command runs ahead of the force that the motion needs, by its one coefficient, s.
  virtual bool leads() const { return false; }
  /// True: the recorded forces run behind those that the motion needs.
  virtual bool lags() const { return false; }
  /// True: lies between the command and the force that the motion needs, as what leads does, or what a drive loses. Such
  /// effects look at the needed force and do not see each other.
  virtual bool ofDrive() const { return leads(); }
  /// True: goes on in the same way at every position of its actuator.
  virtual bool periodic() const { return false; }
  /// How many by this name may act on one actuator, with different periods (the first shape parameter).
  virtual int mostOnOneActuator() const { return 1; }
  /// True: goes with time, so that positions that were held back say nothing about it.
  virtual bool goesWithTime() const { return false; }
  /// True: its force depends on the pose alone.
  virtual bool isForceField() const { return false; }
  /// True: a smooth map of a signal, which no class of its own describes.
  virtual bool isMap() const { return false; }
  /// Noise floors that it must explain where held-back positions say nothing for it: one where its shapes are many.
  virtual double leastFloors() const { return goesWithTime() || local() ? 1.0 : 0.0; }
  /// True: changes sign with the direction of travel.
  virtual bool isFriction() const { return false; }
  /// True: its columns look at loads, forces or friction's size, which every fit changes. False lets them be kept.
  virtual bool restsOnModel() const { return true; }
  /// False: needs the platform.
  virtual bool worksOnBench() const { return !shared(); }
  /// False: is not looked for on this robot.
  virtual bool worksOn(const mechanism::Robot& robot) const;

  /// True: has so many shapes that what one recording leaves is fitted by some of them. Looked for in two or more.
  virtual bool needsTwoRecordings() const { return false; }
  /// False: this recording has nothing that could show it, and what it would explain there is something else.
  virtual bool shownIn(const EffectInput& /*input*/, int /*actuator*/) const { return true; }

  virtual std::vector<ShapeParameter> shapeParameters() const { return {}; }
  /// Values of the shape parameters that are tried, given one of the recordings (`actuator` -1: shared).
  virtual std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const;
  /// Shapes beside one with several parameters, within `step` (1 and less) of the grid's distance: for refinement.
  /// None: as it is.
  virtual std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const;
  /// The shape whose columns are about `times` as large, within its bounds, where the one coefficient is the share of a
  /// forward model and should be one. Empty: no shape does that.
  virtual std::vector<double> ofSize(const std::vector<double>& shape, double times) const;
  /// True: so many coefficients are pulled to zero (kPull); columns that the base explains all but a little of have a
  /// force of their own in any size otherwise.
  virtual bool isPulled(Eigen::Index coefficients) const { return coefficients > 2; }
  /// False: with this shape it is something else.
  virtual bool plausibleShape(const std::vector<double>& /*shape*/) const { return true; }
  virtual std::vector<Coefficient> coefficients(const EffectInput& input) const = 0;
  /// Force on `actuator` per unit of each coefficient: samples x coefficients.
  virtual Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const = 0;
  /// The same of every actuator. To be overridden where they share most of the work.
  virtual std::vector<Eigen::MatrixXd> columnsOfAll(const EffectInput& input, const std::vector<double>& shape) const;
  /// Of what sits on `actuator`: the columns of every actuator. Only where it reaches others.
  virtual std::vector<Eigen::MatrixXd> reach(const EffectInput& input, int actuator,
                                             const std::vector<double>& shape) const;
  /// Coefficients for a recording that is none of the training ones; empty when the effect predicts nothing there.
  /// Usually those of training, if the effect transfers.
  virtual Eigen::VectorXd elsewhere(const Eigen::VectorXd& coefficients) const;
  /// The same for a recording that shares its homing with some training recordings, `same_home` (not empty).
  virtual Eigen::VectorXd atHome(const Eigen::VectorXd& coefficients, const std::vector<int>& same_home) const;
  /// False: no machine has such coefficients.
  virtual bool plausible(const Eigen::VectorXd& coefficients) const;
  /// False: the force may be there, but hardly by this name (a limb heavier than anybody's): the name is doubted.
  virtual bool believable(const Eigen::VectorXd& /*coefficients*/) const { return true; }
  /// True: it bends to so much that its name, where nothing else speaks against it, was something else on every machine
  /// whose truth became known (docs/results/blind_simulators.md): the name is doubted.
  virtual bool looksLikeMuch() const { return false; }
  /// Index of the actuator on whose position it depends when it sits on `actuator`; -1: on no position.
  virtual int positionOf(int /*actuator*/) const { return -1; }
  /// What a map depends on, as report.json writes it; empty for named effects.
  virtual std::string dependsOn(int actuator) const;
};

using CandidateList = std::vector<std::unique_ptr<Candidate>>;

using CandidateMaker = std::unique_ptr<Candidate> (*)();
/// Of src/tracing/effects/, by name (cmake/effects.cmake writes the table).
const std::vector<CandidateMaker>& candidateMakers();
/// All named effects that can be traced on this kind of robot.
CandidateList namedCandidates(const mechanism::Robot& robot);
/// Smooth maps over every available signal, for what no named effect explains.
CandidateList mapCandidates(const std::vector<EffectInput>& inputs);
/// The map of a model file, by what it depends on (Candidate::dependsOn) and its knots; null when there is no such
/// signal.
std::unique_ptr<Candidate> mapCandidate(const mechanism::Robot& robot, const std::string& depends_on, int actuator,
                                        const std::vector<double>& knots);

/// `count` values from low to high in equal ratios.
std::vector<std::vector<double>> geometricGrid(double low, double high, int count);
/// Every shape with each of these values of one more parameter, the last.
std::vector<std::vector<double>> withLast(const std::vector<std::vector<double>>& grid,
                                          const std::vector<double>& values);

}  // namespace knee_robot::tracing
