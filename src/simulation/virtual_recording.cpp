#include "knee_robot/simulation/virtual_recording.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/recording/recording_writer.h"

namespace knee_robot::simulation {
namespace {

constexpr double kLongestInstant_s = 0.001;

double encoded(const mechanism::Actuator& actuator, double length) {
  const double step = actuator.metresPerCount();
  return actuator.home_length_m + step * std::round((length - actuator.home_length_m) / step);
}

/// Books of the energy along the instants.
struct Books {
  double work_J = 0.0, dissipated_J = 0.0, start_J = 0.0, worst_J = 0.0;
  void add(const VirtualPlantOutput& output, double dt, double energy_J) {
    work_J += dt * output.motor_power_W;
    dissipated_J -= dt * output.friction_power_W;
    worst_J = std::max(worst_J, std::abs(work_J - dissipated_J - (energy_J - start_J)));
  }
};

}  // namespace

VirtualRun recordVirtualPlant(const mechanism::Robot& robot, VirtualPlant& plant, const AxisPath& path,
                              const VirtualRecorder& recorder, const std::string& file) {
  recording::RecordingWriter writer(file, mechanism::kLegs);
  std::mt19937_64 random(recorder.seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  const int instants = std::max(1, static_cast<int>(std::ceil(recorder.period_s / kLongestInstant_s - 1e-9)));
  const double dt = recorder.period_s / instants;
  const int rows = static_cast<int>(std::floor(path.duration() / recorder.period_s + 1e-9)) + 1;
  VirtualRun run;
  VirtualPlantOutput output;
  Books books;
  const auto move = [&](double time) {
    if (plant.follow(path.at(time), output)) return;
    throw Refusal("the closed mechanism cannot follow the reference at " + shortNumber(time) +
                  " s: it is singular there or cannot be assembled with these lengths");
  };
  move(0.0);
  books.start_J = plant.energy();
  mechanism::Lengths last_position;
  for (int row = 0; row < rows; ++row) {
    const double time = row * recorder.period_s;
    mechanism::Vector4 force = mechanism::Vector4::Zero();
    for (int k = 0; k < instants; ++k) {
      move(time + (k + 0.5) * dt);
      force += output.force / instants;
      const VirtualPlantOutput middle = output;
      move(time + (k + 1) * dt);
      books.add(middle, dt, plant.energy());
    }
    const mechanism::Lengths position = path.at(time).position;
    recording::RecordingRow values;
    values.time_s = time;
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const mechanism::Actuator& actuator = robot.actuators[axis];
      force[i] += recorder.force_noise_N * noise(random);
      values.reference_m[axis] = position[i];
      values.position_m[axis] = recorder.exact_encoders ? position[i] : encoded(actuator, position[i]);
      values.velocity_m_per_s[axis] = row == 0 ? 0.0 : (values.position_m[axis] - last_position[i]) / recorder.period_s;
      last_position[i] = values.position_m[axis];
      values.force_N[axis] = force[i];
      values.command_V[axis] = force[i] / (actuator.force_sign * actuator.force_per_volt_N);
    }
    writer.write(values);
    run.force_rms += force.cwiseAbs2();
    run.force_max = run.force_max.cwiseMax(force.cwiseAbs());
  }
  writer.close();
  run.rows = rows;
  run.force_rms = (run.force_rms / rows).cwiseSqrt();
  run.dissipated_J = books.dissipated_J;
  run.energy_error_J = books.worst_J;
  return run;
}

}  // namespace knee_robot::simulation
