// The excitation's cost, limits and exact gradients for other optimisers (scripts/benchmarks/excitation.py): a shared
// library with plain C functions. One problem at a time.

#include <ctime>
#include <memory>

#include "src/excitation/excitation_search.h"
#include "src/excitation/excitation_setup.h"

namespace {

using namespace knee_robot;

std::unique_ptr<excitation::ExcitationSetup> setup;
excitation::ExcitationOptions options;
std::vector<excitation::Candidate> starts;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Eigen::VectorXd asVariables(const double* x) {
  return Eigen::Map<const Eigen::VectorXd>(x, setup->problem.variables());
}

}  // namespace

extern "C" {

/// Numbers of variables and limits into `sizes`. Returns the number of starts: the best of 100 random series that keep
/// the limits.
int peer_open(const char* robot_file, double velocity, double duration, int directions, int iterations, int* sizes) {
  options = {};
  options.velocity_max = velocity;
  options.shape.duration_s = duration;
  options.directions = directions;
  options.iterations = iterations;
  options.starts = 8;
  options.seconds_budget = 1e9;
  const mechanism::Robot robot = mechanism::loadRobot(robot_file);
  setup = std::make_unique<excitation::ExcitationSetup>(excitation::setUpExcitation(robot, options));
  sizes[0] = setup->problem.variables();
  sizes[1] = setup->problem.limits();
  starts = excitation::randomStarts(setup->problem, options);
  return static_cast<int>(starts.size());
}

void peer_start(int number, double* x) {
  Eigen::Map<Eigen::VectorXd>(x, setup->problem.variables()) = starts[static_cast<std::size_t>(number)].variables;
}

/// Cost and limits (kept when not positive); with their gradients (limits x variables) unless these are null. 0: cannot
/// follow.
int peer_evaluate(const double* x, double exponent, double* cost, double* limits, double* gradient, double* gradients) {
  static excitation::ExcitationProblem::Evaluation at;
  if (!setup->problem.evaluate(asVariables(x), exponent, gradient != nullptr, at)) return 0;
  *cost = at.cost;
  Eigen::Map<Eigen::VectorXd>(limits, at.limits.size()) = at.limits;
  if (gradient != nullptr) {
    Eigen::Map<Eigen::VectorXd>(gradient, at.cost_gradient.size()) = at.cost_gradient;
    Eigen::Map<Eigen::MatrixXd>(gradients, at.limit_gradients.rows(), at.limit_gradients.cols()) = at.limit_gradients;
  }
  return 1;
}

/// k of the series drawn back to the limits; infinity when it cannot be.
double peer_feasible_k(const double* x) {
  const auto scaled = setup->problem.scaledToLimits(asVariables(x), 1.0);
  excitation::ExcitationProblem::Evaluation at;
  if (!scaled || !setup->problem.evaluate(*scaled, 0.0, false, at)) return HUGE_VAL;
  return std::exp(at.cost);
}

/// Our own search from one start. `times` and `ks` (room for `most`) get the seconds of processor time at which the
/// best k became less; returns their number.
int peer_ours(int number, int most, double* times, double* ks) {
  const double begin = cpuSeconds();
  int count = 0;
  const auto take = [&](double k) {
    if (count < most && (count == 0 || k < ks[count - 1])) {
      times[count] = cpuSeconds() - begin;
      ks[count++] = k;
    }
  };
  excitation::ExcitationOptions traced = options;
  traced.progress = [&](const excitation::ExcitationProgress& progress) { take(progress.best); };
  take(std::exp(excitation::improveOne(setup->problem, traced, starts[static_cast<std::size_t>(number)]).cost));
  return count;
}
}
