#include "pose_rows.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/dynamics/coulomb_memory.h"
#include "knee_robot/identification/observation.h"
#include "knee_robot/recording/filter.h"

namespace knee_robot::tracing {
namespace {

constexpr int kFewestRows = 200;     ///< rows that a recording must offer
constexpr double kWidthCounts = 10;  ///< distance over which a leg's play is taken up, at least; or
constexpr double kWidth_m = 1e-4;
constexpr double kLoadCutoff_hz = 2.0;
constexpr double kLoadShare = 0.1;  ///< of the force's rms: width of the change of sign
constexpr double kMoved_m = 2e-4;   ///< what stands still says the same again and again: one row in
constexpr double kStanding_s = 1.0;
constexpr int kDimensions = 11;
constexpr double kDifference = 1e-6;

double* dimension(mechanism::Geometry& g, int index) {
  const auto at = static_cast<std::size_t>(index);
  if (index < 3) return &g.R[at];
  if (index == 3) return &g.ds;
  if (index == 4) return &g.beta_FD;
  if (index == 5) return &g.beta_FI;
  if (index < 9) return &g.Rm[at - 6];
  return index == 9 ? &g.beta_MD : &g.beta_MI;
}

mechanism::Mechanism withDimension(const mechanism::Mechanism& mechanism, int index, double change) {
  mechanism::Geometry geometry = mechanism.geometry;
  *dimension(geometry, index) += change;
  return mechanism::Mechanism(geometry);
}

Eigen::MatrixXd travelOf(const mechanism::Robot& robot, const recording::Recording& r) {
  Eigen::MatrixXd out(r.rows(), r.position_m.cols());
  for (Eigen::Index i = 0; i < out.cols(); ++i) {
    const double width =
        std::max(kWidth_m, kWidthCounts * robot.actuators[static_cast<std::size_t>(i)].metresPerCount());
    dynamics::CoulombMemory memory;
    for (Eigen::Index n = 0; n < out.rows(); ++n)
      out(n, i) = memory.step(r.position_m(n, i) - r.position_m(std::max<Eigen::Index>(0, n - 1), i), width);
  }
  return out;
}

Eigen::MatrixXd loadOf(const mechanism::Robot& robot, const recording::Recording& r) {
  Eigen::MatrixXd force = recording::commandedForce(r, identification::forcePerVolt(robot));
  const recording::ZeroPhaseLowPass filter(kLoadCutoff_hz, 1.0 / recording::medianPeriod(r.time_s));
  filter.applyToColumns(force);
  for (Eigen::Index i = 0; i < force.cols(); ++i) {
    const double width = std::max(1e-9, kLoadShare * std::sqrt(force.col(i).squaredNorm() / force.rows()));
    force.col(i) = (force.col(i) / width).array().tanh();
  }
  return force;
}

/// Rows that can be compared: known, regular, on the camera's branch, and not far from all others.
void chooseRows(const mechanism::Mechanism& mechanism, double condition_max, PoseView& view) {
  const recording::Recording& r = *view.recording;
  std::vector<double> distance;
  std::vector<Eigen::Index> regular;
  for (Eigen::Index i = 0; i < view.camera.rows(); ++i) {
    if (!view.camera.row(i).allFinite() || !view.measured.pose.row(i).allFinite()) continue;
    const mechanism::Pose camera = cameraInRobot(view.own, view.camera.row(i).transpose());
    const mechanism::Pose measured = view.measured.pose.row(i).transpose();
    mechanism::Pose other;
    if (otherSolution(mechanism, r.position_m.row(i).transpose(), camera, measured, other)) {
      ++view.other_solution;
    } else if (view.measured.condition[i] >= condition_max) {
      ++view.near_singular;
    } else {
      regular.push_back(i);
      distance.push_back(poseDistance(camera, measured));
    }
  }
  if (regular.empty()) return;
  const double limit = 8.0 * median(distance) + 1e-4;
  for (std::size_t n = 0; n < regular.size(); ++n) {
    if (distance[n] <= limit)
      view.rows.push_back(regular[n]);
    else
      ++view.distrusted;
  }
}

double directionOf(const PoseView& view, const PoseHypothesis& h, Eigen::Index row) {
  return h.cause == PoseCause::TravelClearance ? view.travel(row, h.index) : view.load(row, h.index);
}

}  // namespace

PoseView viewPose(const mechanism::Robot& robot, const recording::Recording& recording, double condition_max,
                  double delay_s) {
  PoseView view;
  view.recording = &recording;
  if (recording.mocap.cols() != 4) return view;
  view.measured = posesOf(*robot.mechanism, recording.position_m);
  view.own = alignCamera(recording, view.measured, condition_max);
  if (!view.own.known) return view;
  view.camera = cameraAtRows(recording, std::isnan(delay_s) ? view.own.delay_s : delay_s);
  view.travel = travelOf(robot, recording);
  view.load = loadOf(robot, recording);
  chooseRows(*robot.mechanism, condition_max, view);
  if (view.rows.size() < static_cast<std::size_t>(kFewestRows)) view.rows.clear();
  return view;
}

void setDelay(PoseView& view, double delay_s) {
  view.camera = cameraAtRows(*view.recording, delay_s);
  view.rows.erase(std::remove_if(view.rows.begin(), view.rows.end(),
                                 [&](Eigen::Index row) { return !view.camera.row(row).allFinite(); }),
                  view.rows.end());
}

std::vector<PoseHypothesis> poseHypotheses(const std::vector<PoseView>& views) {
  std::vector<PoseHypothesis> out;
  for (int i = 0; i < mechanism::kLegs; ++i)
    out.push_back({PoseCause::HomeOffset, i});
  for (int i = 0; i < kDimensions; ++i)
    out.push_back({PoseCause::GeometryError, i});
  for (int i = 0; i < mechanism::kLegs; ++i)
    out.push_back({PoseCause::TravelClearance, i});
  for (int i = 0; i < mechanism::kLegs; ++i) {
    double least = 1.0, most = -1.0;  // a force that never changes its sign says nothing
    for (const PoseView& view : views) {
      for (const Eigen::Index row : view.rows) {
        least = std::min(least, view.load(row, i));
        most = std::max(most, view.load(row, i));
      }
    }
    if (least < -0.5 && most > 0.5) out.push_back({PoseCause::LoadClearance, i});
  }
  return out;
}

mechanism::Mechanism changedMechanism(const mechanism::Mechanism& mechanism, const PoseModel& model) {
  mechanism::Geometry geometry = mechanism.geometry;
  for (std::size_t k = 0; k < model.causes.size(); ++k) {
    if (model.causes[k].cause != PoseCause::GeometryError) continue;
    *dimension(geometry, model.causes[k].index) += model.values[static_cast<Eigen::Index>(k)];
  }
  return mechanism::Mechanism(geometry);
}

Eigen::MatrixXd changedLengths(const PoseView& view, const PoseModel& model) {
  Eigen::MatrixXd lengths = view.recording->position_m;
  for (std::size_t k = 0; k < model.causes.size(); ++k) {
    const PoseHypothesis& h = model.causes[k];
    const double value = model.values[static_cast<Eigen::Index>(k)];
    if (h.cause == PoseCause::HomeOffset) lengths.col(h.index).array() += value;
    if (h.cause == PoseCause::TravelClearance) lengths.col(h.index) -= value * view.travel.col(h.index);
    if (h.cause == PoseCause::LoadClearance) lengths.col(h.index) -= value * view.load.col(h.index);
  }
  return lengths;
}

PoseStack stackPose(const std::vector<PoseView>& views, double rate_hz) {
  constexpr int kPieces = 8;
  PoseStack stack;
  const bool several = views.size() > 1;
  for (std::size_t v = 0; v < views.size(); ++v) {
    double next = -std::numeric_limits<double>::infinity();
    Eigen::RowVectorXd last;
    for (const Eigen::Index row : views[v].rows) {
      const double t = views[v].recording->time_s[static_cast<std::size_t>(row)];
      const Eigen::RowVectorXd q = views[v].recording->position_m.row(row);
      const bool stands = last.size() > 0 && (q - last).cwiseAbs().maxCoeff() < kMoved_m;
      if (t < next || (stands && t < next + kStanding_s)) continue;
      next = t + 0.999 / rate_hz;
      last = q;
      stack.picks.push_back({v, row, static_cast<int>(v)});
    }
  }
  stack.pieces = several ? static_cast<int>(views.size()) : kPieces;
  if (several) return stack;
  for (std::size_t n = 0; n < stack.picks.size(); ++n)
    stack.picks[n].piece = static_cast<int>(n * kPieces / stack.picks.size());
  return stack;
}

PoseEquations poseEquations(const mechanism::Robot& robot, const std::vector<PoseView>& views, const PoseStack& stack,
                            const PoseModel& model, const std::vector<PoseHypothesis>& hypotheses) {
  const mechanism::Mechanism mechanism = changedMechanism(*robot.mechanism, model);
  std::vector<std::pair<mechanism::Mechanism, mechanism::Mechanism>> varied;
  for (int i = 0; i < kDimensions; ++i)
    varied.emplace_back(withDimension(mechanism, i, kDifference), withDimension(mechanism, i, -kDifference));
  std::vector<Eigen::MatrixXd> lengths;
  for (const PoseView& view : views)
    lengths.push_back(changedLengths(view, model));

  const auto n = static_cast<Eigen::Index>(stack.picks.size());
  PoseEquations out{Eigen::VectorXd::Zero(4 * n), Eigen::MatrixXd::Zero(4 * n, 4),
                    Eigen::MatrixXd::Zero(4 * n, static_cast<Eigen::Index>(hypotheses.size()))};
  for (Eigen::Index k = 0; k < n; ++k) {
    const PoseStack::Pick& pick = stack.picks[static_cast<std::size_t>(k)];
    const PoseView& view = views[pick.view];
    const mechanism::Lengths q = lengths[pick.view].row(pick.row).transpose();
    const mechanism::ForwardResult found =
        mechanism::forwardKinematics(mechanism, q, view.measured.pose.row(pick.row).transpose());
    if (!found.ok()) continue;  // a zero row says nothing
    const mechanism::Pose camera = cameraInRobot(model.frame, view.camera.row(pick.row).transpose());
    out.residual.segment<4>(4 * k) = camera - found.pose;
    const double x = camera[0] - model.frame.shift_x_m, z = camera[1] - model.frame.shift_z_m;
    out.frame.block<4, 4>(4 * k, 0) << z, 1, 0, 0, -x, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1;
    const mechanism::Matrix4 per_length = mechanism::lengthJacobian(mechanism, found.pose).inverse();
    for (std::size_t h = 0; h < hypotheses.size(); ++h) {
      const PoseHypothesis& hypothesis = hypotheses[h];
      mechanism::Vector4 change = mechanism::Vector4::Zero();  // of the lengths that this pose stands for
      if (hypothesis.cause == PoseCause::GeometryError) {
        const auto& [up, down] = varied[static_cast<std::size_t>(hypothesis.index)];
        change =
            -(mechanism::legLengths(up, found.pose) - mechanism::legLengths(down, found.pose)) / (2.0 * kDifference);
      } else {
        change[hypothesis.index] =
            hypothesis.cause == PoseCause::HomeOffset ? 1.0 : -directionOf(view, hypothesis, pick.row);
      }
      out.hypotheses.block<4, 1>(4 * k, static_cast<Eigen::Index>(h)) = -(per_length * change);
    }
  }
  return out;
}

void fitPose(const mechanism::Robot& robot, const std::vector<PoseView>& views, const PoseStack& stack,
             const mechanism::Vector4& sigma, const std::vector<char>& use, PoseModel& model) {
  constexpr int kSteps = 5;
  const auto count = static_cast<Eigen::Index>(model.causes.size());
  for (int step = 0; step < kSteps; ++step) {
    const PoseEquations e = poseEquations(robot, views, stack, model, model.causes);
    Eigen::MatrixXd a(e.frame.rows(), 4 + count);
    a << e.frame, e.hypotheses;
    Eigen::VectorXd b = e.residual;
    for (Eigen::Index k = 0; k < a.rows(); ++k) {
      const bool used = use.empty() || use[static_cast<std::size_t>(k / 4)];
      const double weight = used ? 1.0 / sigma[k % 4] : 0.0;
      a.row(k) *= weight;
      b[k] *= weight;
    }
    const Eigen::VectorXd scale = a.colwise().norm().cwiseMax(1e-12).transpose();
    const Eigen::VectorXd change =
        -scale.cwiseInverse().cwiseProduct((a * scale.cwiseInverse().asDiagonal()).colPivHouseholderQr().solve(b));
    model.frame.rotation_rad += change[0];
    model.frame.shift_x_m += change[1];
    model.frame.shift_z_m += change[2];
    model.frame.plate_rad += change[3];
    // The turn is about the camera's origin: shifts are those of the turned frame already.
    model.values += change.tail(count);
    for (std::size_t k = 0; k < model.causes.size(); ++k) {
      double& value = model.values[static_cast<Eigen::Index>(k)];
      const bool play =
          model.causes[k].cause == PoseCause::TravelClearance || model.causes[k].cause == PoseCause::LoadClearance;
      if (play) value = std::max(0.0, value);
    }
    if (change.cwiseProduct(scale).norm() < 1e-9 * std::max(1.0, b.norm())) break;
  }
}

Eigen::MatrixXd modelPoses(const mechanism::Robot& robot, const PoseModel& model, const recording::Recording& recording,
                           const PosePath& measured) {
  PoseView view;
  view.recording = &recording;
  view.travel = travelOf(robot, recording);
  view.load = loadOf(robot, recording);
  const mechanism::Mechanism mechanism = changedMechanism(*robot.mechanism, model);
  const Eigen::MatrixXd lengths = changedLengths(view, model);
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(recording.rows(), 4, kNan);
  for (Eigen::Index n = 0; n < out.rows(); ++n) {
    if (!measured.pose.row(n).allFinite()) continue;
    const mechanism::ForwardResult found =
        mechanism::forwardKinematics(mechanism, lengths.row(n).transpose(), measured.pose.row(n).transpose());
    if (found.ok()) out.row(n) = found.pose.transpose();
  }
  return out;
}

}  // namespace knee_robot::tracing
