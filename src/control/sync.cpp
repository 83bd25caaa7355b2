#include "sync.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {

AxisValues accelerationLimits(const mechanism::Robot& robot) {
  AxisValues limits{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    limits[i] = robot.actuators.at(i).acceleration_max_m_per_s2;
  return limits;
}

AxisValues scaled(const AxisValues& values, double factor) noexcept {
  AxisValues result{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    result[i] = factor * values[i];
  return result;
}

/// For so long the Drivers carry before a path begins, the brakes' opening included.
constexpr rt::Nanoseconds kWeighs = 400'000'000;

}  // namespace

Sync::Sync(const std::string& name, const mechanism::Robot& robot)
    : rt::TaskContext(name), acceleration_max_(accelerationLimits(robot)) {}

bool Sync::startHook() {
  out_.phase = SyncPhase::Idle;
  time_scale_ = 0.0;
  return true;
}

void Sync::updateHook(const rt::Cycle& cycle) {
  SupervisorCommand order;
  // Counted in own cycles: a pause of the whole machine is not the Supervisor's silence.
  const rt::FlowStatus flow = orders.read(order);
  silent_ = flow == rt::FlowStatus::NewData ? 0 : silent_ + cycle.period;
  measurement.read(measured_);
  const bool orders_timed_out = flow == rt::FlowStatus::NoData || silent_ > rt::fromSeconds(orders_timeout_s);

  carried_ = order.driversCarry() ? carried_ + cycle.period : 0;
  ++out_.sequence;
  out_.start = cycle.time;
  out_.duration = cycle.period;
  const bool moving =
      out_.phase == SyncPhase::Playing || out_.phase == SyncPhase::Stopping || out_.phase == SyncPhase::Paused;
  if ((!order.drivers_active || order.guiding) && !(moving && orders_timed_out)) {
    standBy(order);
  } else if (moving) {
    advance(cycle, order, order.stop_path || orders_timed_out);
  } else if (order.play != handled_play_ && carried_ >= kWeighs && !orders_timed_out) {
    tryToPlay(order);
    if (out_.phase == SyncPhase::Playing) advance(cycle, order, false);
  } else if (out_.phase == SyncPhase::Holding) {
    restSegment(SyncPhase::Holding);
  }
  set_point.write(out_);
}

/// Nobody carries the platform: what was played before must never be resumed.
void Sync::standBy(const SupervisorCommand& order) {
  out_.phase = SyncPhase::Idle;
  out_.time_scale = time_scale_ = 0.0;
  out_.path_time_s = path_time_ = 0.0;
  handled_play_ = order.play;
}

void Sync::tryToPlay(const SupervisorCommand& order) {
  handled_play_ = order.play;
  path_ = store_.adopt();
  PlayRefusal refusal = PlayRefusal::None;
  if (path_ == nullptr) refusal = PlayRefusal::NoReference;
  if (measured_.status != hardware::IoStatus::Ok || order.stop_path) refusal = PlayRefusal::NotReady;
  out_.refused_axis = 0;
  out_.refused_distance_m = 0.0;
  for (std::size_t i = 0; i < hardware::kAxes && refusal == PlayRefusal::None; ++i) {
    const double distance = std::abs(measured_.position_m[i] - path_->points.front()[i]);
    if (distance <= start_tolerance_m) continue;
    refusal = PlayRefusal::NotAtStart;
    out_.refused_axis = static_cast<int>(i) + 1;
    out_.refused_distance_m = distance;
  }
  if (refusal != PlayRefusal::None) {
    out_.refusal = refusal;
    out_.refused_run = order.play;
    if (out_.phase == SyncPhase::Holding) restSegment(SyncPhase::Holding);
    return;
  }
  out_.phase = SyncPhase::Playing;
  out_.run = order.play;
  out_.path_duration_s = path_->duration();
  out_.to_m = path_->points.front();
  path_time_ = 0.0;
  // A reference begins at rest: its check counts it as held before its first point.
  time_scale_ = targetScale(order);
}

double Sync::targetScale(const SupervisorCommand& order) noexcept {
  const bool usable = order.speed >= 0.0 && order.speed <= 1.0;  // what is not a number is not: then it stands
  return order.pause_path || !usable ? 0.0 : order.speed;
}

/// Largest change of the time scale per second. Slowing down in T adds at most fastest / T to an axis' acceleration.
double Sync::scaleRate() const noexcept {
  double time = stop_time_s;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    time = std::max(time, path_->fastest[i] / (0.5 * acceleration_max_[i]));
  return 1.0 / time;
}

void Sync::advance(const rt::Cycle& cycle, const SupervisorCommand& order, bool stop) {
  if (stop) out_.phase = SyncPhase::Stopping;
  const bool stopping = out_.phase == SyncPhase::Stopping;
  const double dt = rt::toSeconds(cycle.period);
  const double target = stopping ? 0.0 : targetScale(order);
  const double next_scale = time_scale_ + std::clamp(target - time_scale_, -scaleRate() * dt, scaleRate() * dt);
  const double next_time = std::min(path_time_ + 0.5 * (time_scale_ + next_scale) * dt, path_->duration());
  out_.path_time_s = path_time_;
  out_.time_scale = time_scale_;
  const bool at_rest = time_scale_ == 0.0 && next_scale == 0.0;
  if (path_time_ >= path_->duration() || (at_rest && stopping)) {
    time_scale_ = 0.0;
    restSegment(SyncPhase::Holding);
    return;
  }
  if (at_rest) return restSegment(SyncPhase::Paused);
  if (!stopping) out_.phase = SyncPhase::Playing;
  out_.from_m = out_.to_m;
  out_.from_velocity = scaled(path_->velocityAt(path_time_), time_scale_);
  out_.to_m = path_->positionAt(next_time);
  out_.to_velocity = scaled(path_->velocityAt(next_time), next_scale);
  path_time_ = next_time;
  time_scale_ = next_scale;
}

/// At rest where the last segment ended (and not where a path that was offered meanwhile has its points).
void Sync::restSegment(SyncPhase phase) {
  out_.phase = phase;
  out_.time_scale = 0.0;
  out_.path_time_s = path_time_;
  out_.from_m = out_.to_m;
  out_.from_velocity = out_.to_velocity = AxisValues{};
}

}  // namespace knee_robot::control
