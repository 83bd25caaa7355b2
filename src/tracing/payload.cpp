#include "knee_robot/tracing/payload.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/rigid_body.h"
#include "knee_robot/identification/motion_model.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::tracing {
namespace {

constexpr int kMass = 4;              ///< mass and first moments
constexpr double kMassErrors = 5.0;   ///< standard errors of the mass
constexpr double kSmall = 0.02;       ///< of the platform's mass
constexpr double kExplains = 0.5;     ///< of the squares by which the URDF misses the free fit
constexpr double kAllButAll = 0.99;   ///< of those squares: then it need not be as good as the free fit
constexpr double kFitsAsWell = 1.25;  ///< rms of the free fit
constexpr double kToldCenter_m = 0.1;
constexpr int kMomentPasses = 4;  ///< between first moments and moments of inertia

/// Friction, rotor and offset columns of the baseline.
std::vector<Eigen::Index> ownColumns(const BaseFit& base) {
  std::vector<Eigen::Index> own;
  for (const bool bounded : {true, false}) {
    for (std::size_t c = 0; c < base.columns.size(); ++c) {
      if (base.columns[c].role != identification::ColumnRole::Rigid && base.columns[c].isNonNegative() == bounded)
        own.push_back(static_cast<Eigen::Index>(c));
    }
  }
  return own;
}

/// Directions of the rigid parameters: what is known, the point mass's moments of inertia, mass and first moments on
/// the last body.
struct Directions {
  Eigen::VectorXd known;
  Eigen::MatrixXd mass;

  explicit Directions(Eigen::VectorXd parameters)
      : known(std::move(parameters)), mass(Eigen::MatrixXd::Zero(known.size(), kMass)) {
    mass(last() + 9, 0) = 1.0;
    for (int k = 0; k < 3; ++k)
      mass(last() + 6 + k, 1 + k) = 1.0;
  }
  /// First parameter of the body that carries: the platform, or a chain's last one.
  Eigen::Index last() const { return known.size() - dynamics::kLinkParameters; }
  double carrier_kg(const Eigen::VectorXd& prior) const { return prior[last() + 9]; }
  /// The same with the moments of inertia (about the body's origin) of a point mass.
  Eigen::VectorXd with(double point_kg, const mechanism::Vector3& center) const {
    dynamics::LinkInertia point;
    point.mass = point_kg;
    point.center = center;
    Eigen::VectorXd out = known;
    out.segment<6>(last()) += dynamics::toParameters(point).head<6>();
    return out;
  }
};

/// Rows of all actuators, weighted: own columns (those with a sign first), mass columns, and the rigid ones apart.
struct Rows {
  identification::Equations own;
  Eigen::MatrixXd rigid;
  int bounded = 0;
};

Rows rowsOf(const std::vector<identification::Observation>& recordings, const Stack& stack, const BaseFit& base,
            const Eigen::VectorXd& noise_N, const Directions& directions) {
  const std::vector<Eigen::Index> own = ownColumns(base);
  Rows rows;
  for (const Eigen::Index c : own)
    rows.bounded += base.columns[static_cast<std::size_t>(c)].isNonNegative() ? 1 : 0;
  const Eigen::Index count = static_cast<Eigen::Index>(own.size()), p = stack.size();
  rows.own.axes = stack.axes;
  rows.own.blocks = stack.blocks;
  rows.own.a.resize(p * stack.axes, count + kMass);
  rows.own.b.resize(p * stack.axes);
  const Eigen::Index rigid = directions.known.size();
  rows.rigid.resize(p * stack.axes, rigid);
  const Eigen::VectorXd scale = rowScale(stack, recordings, Attention::Moving);
  for (int i = 0; i < stack.axes; ++i) {
    std::vector<Eigen::MatrixXd> columns;
    for (const identification::Observation& o : recordings)
      columns.push_back(o.regressor[static_cast<std::size_t>(i)]);
    const Eigen::VectorXd weight = scale.segment(i * p, p) / noise_N[i];
    const Eigen::MatrixXd all = weight.asDiagonal() * gather(stack, recordings, std::move(columns));
    for (Eigen::Index c = 0; c < count; ++c)
      rows.own.a.col(c).segment(i * p, p) = all.col(own[static_cast<std::size_t>(c)]);
    rows.rigid.middleRows(i * p, p) = all.leftCols(rigid);
    rows.own.b.segment(i * p, p) = weight.cwiseProduct(gatherForce(stack, recordings, i));
    for (const Pick& pick : stack.picks) {
      rows.own.actuator.push_back(i);
      rows.own.block.push_back(pick.block);
    }
  }
  rows.own.a.rightCols(kMass) = rows.rigid * directions.mass;
  return rows;
}

Eigen::VectorXd solve(const Eigen::MatrixXd& triangle, int bounded) {
  const Eigen::Index p = triangle.cols() - 1;
  const Eigen::VectorXd scale = triangle.leftCols(p).colwise().norm().transpose().cwiseMax(1e-12);
  return identification::boundedLeastSquares(triangle.leftCols(p) * scale.cwiseInverse().asDiagonal(), triangle.col(p),
                                             bounded)
      .cwiseQuotient(scale);
}

double rms(const Eigen::VectorXd& rows) {
  return rows.norm() / std::sqrt(static_cast<double>(rows.size()));
}

std::string massText(const PayloadTest& t) {
  return shortNumber(t.mass_kg, 3) + " +- " + shortNumber(t.mass_std_kg, 2) + " kg";
}

std::string centerText(const PayloadTest& t) {
  std::string out;
  for (int k = 0; k < 3; ++k) {
    if (!(t.center_std_m[k] < kToldCenter_m)) continue;
    out += (out.empty() ? " at " : ", ") + std::string(1, "xyz"[k]) + " = " + shortNumber(t.center_m[k], 2) + " +- " +
           shortNumber(t.center_std_m[k], 2) + " m";
  }
  return out.empty() ? " at a place that the motion does not tell" : out + " (platform frame)";
}

void concludePayload(double platform_kg, PayloadTest& t) {
  const double missed = t.prior_rms * t.prior_rms - t.free_rms * t.free_rms;
  const double explained = t.prior_rms * t.prior_rms - t.payload_rms * t.payload_rms;
  const bool seen = t.mass_kg > kMassErrors * t.mass_std_kg && t.mass_kg > kSmall * platform_kg;
  const bool alone = t.payload_rms <= kFitsAsWell * t.free_rms;
  t.stated = seen && (explained >= kAllButAll * missed || (alone && explained >= kExplains * missed));
  if (t.stated) {
    t.sentence = "payload: the change against the URDF's inertia is consistent with a payload of " + massText(t) +
                 centerText(t) +
                 " (or with a platform that much heavier than the URDF says); the base parameters have absorbed it";
    return;
  }
  t.sentence =
      "payload: a mass on the platform changes the platform's inertia parameters, which are fitted; against the "
      "URDF's inertia ";
  if (alone) {
    t.sentence += "none is seen (" + massText(t) + ")";
  } else {
    t.sentence += "none can be told, because the fitted base differs from the URDF in more than a mass (rms " +
                  shortNumber(t.prior_rms / t.free_rms, 3) + " times the free fit's, with a point mass still " +
                  shortNumber(t.payload_rms / t.free_rms, 3) + ")";
  }
}

/// The same sentence of a body that is no platform.
void speakOfChain(const mechanism::Chain& chain, PayloadTest& t) {
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = t.sentence.find(from); at != std::string::npos; at = t.sentence.find(from, at + to.size()))
      t.sentence.replace(at, from.size(), to);
  };
  replace("platform frame", "frame of joint " + chain.joints.back().name);
  replace("a platform that much heavier than the URDF says", "a last body that much heavier");
  replace("the platform's inertia", "the last body's inertia");
  replace("the platform", "the last body");
  replace("the URDF's inertia", "what is known of the bodies (URDF, or given model)");
  replace("the URDF", "that");
}

}  // namespace

PayloadTest testPayload(const mechanism::Robot& robot, const std::vector<identification::Observation>& recordings,
                        const Stack& stack, const BaseFit& base, const Eigen::VectorXd& noise_N) {
  PayloadTest t;
  t.sentence = "payload: a mass on the platform changes the platform's inertia parameters, which are fitted";
  if (robot.kind == mechanism::MechanismKind::Axes || robot.urdf.empty()) return t;
  Eigen::VectorXd prior;
  try {
    prior = identification::motionModelOf(robot)->bodies().prior;
  } catch (const InputError& e) {
    t.sentence += std::string("; it was not compared with the URDF's inertia (") + e.what() + ")";
    return t;
  }
  t.tested = true;
  // A chain's URDF is often a guess: against a given model, its parameters are what is known.
  const Directions directions(robot.chain ? Eigen::VectorXd(base.start.head(prior.size())) : prior);
  Rows rows = rowsOf(recordings, stack, base, noise_N, directions);
  const Eigen::VectorXd force = rows.own.b;
  const Eigen::Index own = rows.own.a.cols() - kMass;
  Eigen::VectorXd z;
  for (int pass = 0; pass < kMomentPasses; ++pass) {
    rows.own.b = force - rows.rigid * directions.with(std::max(0.0, t.mass_kg), t.center_m);
    const std::vector<Eigen::MatrixXd> blocks = identification::compressBlocks(rows.own);
    z = solve(identification::joinBlocks(blocks, -1), rows.bounded);
    Eigen::MatrixXd left_out(z.size(), stack.blocks);
    const std::vector<Eigen::MatrixXd> others = identification::joinOthers(blocks);
    for (int b = 0; b < stack.blocks; ++b)
      left_out.col(b) = solve(others[static_cast<std::size_t>(b)], rows.bounded);
    const double factor = (stack.blocks - 1.0) / stack.blocks;
    const auto stdOf = [&](const Eigen::RowVectorXd& v) {
      return std::sqrt(factor * (v.array() - v.mean()).square().sum());
    };
    t.mass_kg = z[own];
    t.mass_std_kg = stdOf(left_out.row(own));
    for (int k = 0; k < 3; ++k) {
      t.center_m[k] = std::clamp(z[own + 1 + k] / std::max(1e-3, std::abs(t.mass_kg)), -1.0, 1.0);
      t.center_std_m[k] = stdOf(left_out.row(own + 1 + k)) / std::max(1e-3, std::abs(t.mass_kg));
    }
  }
  t.payload_rms = rms(rows.own.b - rows.own.a * z);
  rows.own.b = force - rows.rigid * directions.known;
  rows.own.a.conservativeResize(Eigen::NoChange, own);
  t.prior_rms =
      rms(rows.own.b -
          rows.own.a * solve(identification::joinBlocks(identification::compressBlocks(rows.own), -1), rows.bounded));
  const Eigen::VectorXd scale = rowScale(stack, recordings, Attention::Moving);
  BaseFit weighted = base;
  weighted.noise_N = noise_N;
  const Eigen::MatrixXd a = scale.asDiagonal() * baseRows(weighted, recordings, stack);
  const Eigen::VectorXd b = scale.cwiseProduct(forceRows(weighted, recordings, stack));
  t.free_rms = rms(b - a * identification::boundedLeastSquares(a, b, base.bounded));
  concludePayload(directions.carrier_kg(prior), t);
  if (robot.chain) speakOfChain(*robot.chain, t);
  return t;
}

}  // namespace knee_robot::tracing
