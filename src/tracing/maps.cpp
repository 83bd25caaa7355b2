#include <algorithm>
#include <functional>

#include "hats.h"
#include "platform_maps.h"
#include "platform_matrices.h"
#include "surfaces.h"

namespace knee_robot::tracing {
namespace {

constexpr double kBothSigns = 0.25;  ///< least share of a signal's range below or above zero for knots close to zero

using SignalOf = std::function<Eigen::VectorXd(const EffectInput&, int actuator)>;

/// What a map's function multiplies.
enum class MapFactor {
  One,        ///< a force
  Direction,  ///< dry friction
  Velocity,   ///< viscous friction
};

/// A signal that maps are made of.
struct MapSignal {
  std::string name;  ///< "#": number of the actuator itself
  SignalOf of;
  MapFactor factor = MapFactor::One;
  bool rests_on_model = false;
  bool history = false;    ///< what has passed since something: what it does, it does soon
  std::string words = {};  ///< what its name does not say
  int other = 0;           ///< of a pair: "@" is the actuator that comes so many after "#", the first after the last
  bool of_drive = false;   ///< Candidate::ofDrive
  bool symmetric = false;  ///< changes its sign, and what depends on it does
};

/// Piecewise linear function of one signal, times its factor: hat functions on knots at equal shares of the training
/// samples.
class Map : public Candidate {
 public:
  Map(MapSignal signal, std::vector<std::vector<double>> knots)
      : signal_(std::move(signal)), knots_(std::move(knots)) {}

  std::string name() const override { return "unnamed"; }
  bool isMap() const override { return true; }
  double leastFloors() const override { return 2.0; }
  std::string sentence() const override {
    const char* const what[] = {"force", "dry friction", "viscous friction"};
    return std::string("No named effect fits; the ") + what[static_cast<int>(signal_.factor)] +
           " depends smoothly on " +
           (signal_.words.empty() ? signal_.name : signal_.words + " (" + signal_.name + ")") + ".";
  }
  bool worksOnBench() const override { return true; }
  bool isForceField() const override {
    const auto begins = [&](const char* word) { return signal_.name.rfind(word, 0) == 0; };
    return signal_.factor == MapFactor::One && (begins("position_") || begins("pose_") || begins("leg_"));
  }
  bool restsOnModel() const override { return signal_.rests_on_model; }
  bool ofDrive() const override { return signal_.of_drive; }
  bool goesWithTime() const override { return signal_.name == "time_s"; }
  bool isFriction() const override { return signal_.factor == MapFactor::Direction; }
  std::vector<ShapeParameter> shapeParameters() const override { return knotParameters(); }
  std::vector<std::vector<double>> shapes(const EffectInput&, int actuator) const override {
    return {knots_[static_cast<std::size_t>(actuator)]};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return knotCoefficients("force", "N"); }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& knots) const override {
    Eigen::MatrixXd out = hats(signal_.of(input, actuator), knots);
    if (signal_.factor == MapFactor::One) return out;
    const bool dry = signal_.factor == MapFactor::Direction;
    return (dry ? input.share : input.signals().velocity_m_per_s).col(actuator).asDiagonal() * out;
  }
  int positionOf(int actuator) const override {
    if (signal_.name.rfind("position_", 0) != 0) return -1;
    return signal_.name[9] == '#' ? actuator : signal_.name[9] - '1';
  }
  std::string dependsOn(int actuator) const override {
    const std::string own = std::to_string(actuator + 1);
    const char* const factor[] = {"", "_times_direction", "_times_velocity"};
    std::string text = signal_.name;
    const std::size_t at = text.find('#');
    if (at != std::string::npos) text.replace(at, 1, own);
    const std::size_t other = text.find('@');
    if (other != std::string::npos)
      text.replace(other, 1, std::to_string((actuator + signal_.other) % static_cast<int>(knots_.size()) + 1));
    return text + factor[static_cast<int>(signal_.factor)];
  }

 private:
  MapSignal signal_;
  std::vector<std::vector<double>> knots_;  ///< per actuator
};

/// Empty when the signal hardly varies.
std::vector<double> knotsOf(const std::vector<EffectInput>& inputs, const MapSignal& signal, int actuator) {
  std::vector<double> values;
  for (const EffectInput& input : inputs) {
    const Eigen::VectorXd x = signal.of(input, actuator);
    values.insert(values.end(), x.data(), x.data() + x.size());
  }
  const Range range = rangeOf(values);
  const double largest = std::max(-range.low, range.high);
  if (!range.varies()) return {};
  if (signal.symmetric) return knotsAtZero({-largest, largest});
  if (signal.of_drive && std::min(-range.low, range.high) > kBothSigns * largest) return knotsAtZero(range);
  return evenKnots(values, range, signal.history);
}

/// The bearing of the actuator's own leg: angles of its universal (leg 4: revolute) joint.
Eigen::VectorXd legAngle(const EffectInput& in, int i, bool second) {
  return in.leg_angle_rad.col(2 * i + (second ? 1 : 0));
}

Eigen::VectorXd poseCoordinate(const EffectInput& in, int k) {
  Eigen::VectorXd out(in.samples());
  for (int n = 0; n < in.samples(); ++n)
    out[n] = in.observation->motion.motion[static_cast<std::size_t>(n)].pose[k];
  return out;
}

/// Signals of the actuator itself.
void addOwnSignals(std::vector<MapSignal>& all) {
  const auto velocity = [](const EffectInput& in, int i) -> Eigen::VectorXd {
    return in.signals().velocity_m_per_s.col(i);
  };
  const auto load = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.load_N.col(i); };
  const auto way = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.since_reversal_m.col(i); };
  const auto since = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.since_reversal_s.col(i); };
  const auto time = [](const EffectInput& in, int) -> Eigen::VectorXd {
    return Eigen::VectorXd::LinSpaced(in.samples(), 0.0, in.time(in.samples() - 1));
  };
  all.push_back({"velocity_#_m_per_s", velocity});
  all.push_back({"distance_since_reversal_#_m", way, MapFactor::Direction, false, true});
  all.push_back({"time_since_reversal_#_s", since, MapFactor::Direction, false, true});
  const auto age = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.place_age_s.col(i); };
  for (const MapFactor factor : {MapFactor::Direction, MapFactor::Velocity})
    all.push_back({"age_of_place_#_s", age, factor, false, true, "how long ago the actuator was last at its place"});
  for (const MapFactor factor : {MapFactor::One, MapFactor::Direction, MapFactor::Velocity}) {
    all.push_back({"load_#_N", load, factor, true});
    all.push_back({"time_s", time, factor});
  }
}

/// What a drive loses or adds by the force that it has to give: dead time of its bridge, a dead zone, saturation; or by
/// another drive's: crosstalk of cables, of current sensors.
void addDrive(std::vector<MapSignal>& all, int axes) {
  const auto needed = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.needed_N.col(i); };
  MapSignal drive{"needed_force_#_N", needed};
  drive.rests_on_model = drive.of_drive = true;
  drive.words = "the force that its motion needs: the drive gives another one than its command says";
  all.push_back(drive);
  for (int other = 1; other < axes; ++other) {
    const auto others = [other](const EffectInput& in, int i) -> Eigen::VectorXd {
      return in.needed_N.col((i + other) % in.axes());
    };
    MapSignal crosstalk{"needed_force_@_N", others};
    crosstalk.rests_on_model = true;
    crosstalk.other = other;
    crosstalk.words = "the force that another actuator's motion needs: crosstalk of drives";
    all.push_back(crosstalk);
  }
}

/// What runs along two legs, a rope or a cable chain, feels the sum of their velocities or the difference.
void addPairs(std::vector<MapSignal>& all, int axes) {
  for (int other = 1; other < axes; ++other) {
    for (const double sign : {1.0, -1.0}) {
      const auto velocity = [other, sign](const EffectInput& in, int i) -> Eigen::VectorXd {
        const Eigen::MatrixXd& v = in.signals().velocity_m_per_s;
        return v.col(i) + sign * v.col((i + other) % in.axes());
      };
      MapSignal pair{sign > 0.0 ? "velocity_#_plus_velocity_@_m_per_s" : "velocity_#_minus_velocity_@_m_per_s",
                     velocity};
      pair.other = other;
      pair.symmetric = true;
      pair.words = sign > 0.0 ? "its velocity plus another actuator's" : "its velocity less another actuator's";
      all.push_back(pair);
    }
  }
}

std::vector<MapSignal> mapSignals(bool bench, int axes) {
  std::vector<MapSignal> all;
  addOwnSignals(all);
  addDrive(all, axes);
  for (const MapFactor factor : {MapFactor::One, MapFactor::Direction, MapFactor::Velocity}) {
    if (bench) {  // independent axes: another one's motion cannot matter
      const auto own = [](const EffectInput& in, int i) -> Eigen::VectorXd { return in.signals().position_m.col(i); };
      all.push_back({"position_#_m", own, factor});
      continue;
    }
    for (int k = 0; k < axes; ++k) {
      const auto position = [k](const EffectInput& in, int) -> Eigen::VectorXd {
        return in.signals().position_m.col(k);
      };
      all.push_back({"position_" + std::to_string(k + 1) + "_m", position, factor});
    }
    const char* const pose[] = {"pose_x_m", "pose_z_m", "pose_theta_rad", "pose_psi_rad"};
    for (int k = 0; k < 4; ++k)
      all.push_back({pose[k], [k](const EffectInput& in, int) { return poseCoordinate(in, k); }, factor});
    all.push_back({"leg_#_angle_q1_rad", [](const EffectInput& in, int i) { return legAngle(in, i, false); }, factor});
    all.push_back({"leg_#_angle_q2_rad", [](const EffectInput& in, int i) { return legAngle(in, i, true); }, factor});
  }
  for (int k = 0; k < axes && !bench; ++k) {
    const auto velocity = [k](const EffectInput& in, int) -> Eigen::VectorXd {
      return in.signals().velocity_m_per_s.col(k);
    };
    all.push_back({"velocity_" + std::to_string(k + 1) + "_m_per_s", velocity});
  }
  if (!bench) addPairs(all, axes);
  return all;
}

}  // namespace

CandidateList mapCandidates(const std::vector<EffectInput>& inputs) {
  CandidateList maps;
  for (const MapSignal& signal : mapSignals(inputs.front().force_per_pose_force.empty(), inputs.front().axes())) {
    std::vector<std::vector<double>> knots;
    for (int i = 0; i < inputs.front().axes(); ++i) {
      knots.push_back(knotsOf(inputs, signal, i));
      if (knots.back().empty()) break;
    }
    if (!knots.back().empty()) maps.push_back(std::make_unique<Map>(signal, std::move(knots)));
  }
  addPlatformMaps(inputs, maps);
  addPlatformMatrices(inputs, maps);
  return maps;
}

std::unique_ptr<Candidate> mapCandidate(const mechanism::Robot& robot, const std::string& depends_on, int actuator,
                                        const std::vector<double>& knots) {
  if (auto found = surface(depends_on, actuator, knots)) return found;
  if (robot.mechanism) {
    if (auto map = platformMatrix(depends_on)) return map;
  }
  if (knots.size() != static_cast<std::size_t>(kKnots)) return nullptr;
  if (robot.mechanism) {
    if (auto map = platformMap(depends_on, knots)) return map;
  }
  for (const MapSignal& signal : mapSignals(!robot.mechanism, robot.axes())) {
    std::vector<std::vector<double>> all(static_cast<std::size_t>(robot.axes()), knots);
    auto map = std::make_unique<Map>(signal, std::move(all));
    if (map->dependsOn(actuator) == depends_on) return map;
  }
  return nullptr;
}

}  // namespace knee_robot::tracing
