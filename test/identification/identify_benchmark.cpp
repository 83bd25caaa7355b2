// Times identification stage by stage, and leaves its compressed problem for other solvers
// (scripts/benchmark_identification).
//
// identify_benchmark ROBOT TRAIN.csv VALIDATE.csv CUTOFF_HZ FOLDER
//
// Prints one JSON object: seconds of CPU time per stage, peak memory, errors on the validation recording. Leaves in
// FOLDER, as plain text matrices: data.txt target.txt (compressed weighted equations in prior coordinates), pull.txt
// mean.txt (prior residuals), validation.txt validation_target.txt (the validation recording's equations in the same
// coordinates), nonnegative.txt.
#include <sys/resource.h>

#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/physical_fit.h"
#include "knee_robot/identification/physical_problem.h"

using namespace knee_robot;

namespace {

/// CPU time of this process: other work on the machine does not count.
class Stopwatch {
 public:
  double lap() {
    const double now = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    const double seconds = now - last_;
    last_ = now;
    return seconds;
  }

 private:
  double last_ = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
};

void write(const std::string& path, const Eigen::MatrixXd& matrix) {
  std::ofstream file(path);
  file.precision(17);
  file << matrix << "\n";
}

std::vector<identification::Observation> read(const mechanism::Robot& robot, const std::string& path,
                                              const identification::ObservationOptions& options) {
  std::vector<identification::Observation> list;
  list.push_back(
      identification::observe(robot, identification::columnsOf(robot), recording::loadRecording(path), options));
  return list;
}

void printArray(const char* name, const Eigen::VectorXd& values) {
  std::cout << ",\n \"" << name << "\": [";
  for (Eigen::Index i = 0; i < values.size(); ++i)
    std::cout << (i ? ", " : "") << values[i];
  std::cout << "]";
}

/// Least CPU time of five fits at one strength, the one that was chosen: what another solver is asked to do.
double timeOneFit(const identification::PhysicalProblem& problem, const identification::PriorPull& pull,
                  identification::PhysicalSolution& solution) {
  Stopwatch watch;
  double least_s = 1e9;
  for (int run = 0; run < 5; ++run) {
    watch.lap();
    solution = identification::solvePhysical(problem, pull);
    least_s = std::min(least_s, watch.lap());
  }
  return least_s;
}

void writeProblem(const std::string& folder, const identification::PhysicalProblem& problem,
                  const identification::PriorPull& pull) {
  write(folder + "data.txt", problem.data);
  write(folder + "target.txt", problem.target);
  write(folder + "pull.txt", pull.root);
  write(folder + "mean.txt", pull.mean);
  Eigen::VectorXd bounded(problem.free_size.size());
  for (Eigen::Index i = 0; i < bounded.size(); ++i)
    bounded[i] = problem.nonnegative[static_cast<std::size_t>(i)];
  write(folder + "nonnegative.txt", bounded);
}

/// The equations of recordings that were not fitted, compressed.
identification::PhysicalProblem heldOutProblem(const std::vector<identification::Observation>& validation,
                                               const identification::ObservationOptions& options,
                                               const identification::Identification& id,
                                               const identification::PhysicalCoordinates& coordinates) {
  identification::Equations rows = identification::stackEquations(validation, options);
  identification::weightRows(rows, id.noise_N);
  return identification::physicalProblem(identification::compress(rows.a, rows.b) / std::sqrt(rows.rows()), id.columns,
                                         coordinates, id.force_rms_N);
}

double peakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::cerr << "identify_benchmark ROBOT TRAIN.csv VALIDATE.csv CUTOFF_HZ FOLDER\n";
    return 2;
  }
  const std::string folder = std::string(argv[5]) + "/";
  const mechanism::Robot robot = mechanism::loadRobot(argv[1]);
  identification::IdentifyOptions options;
  options.observation.setCutoff(std::stod(argv[4]));
  options.observation.fold_margin_m = 0.0;
  options.narrowest_counts = 1e-4;  // the plant's friction is the sign of the velocity

  Stopwatch watch;
  std::vector<identification::Observation> training = read(robot, argv[2], options.observation);
  const double read_s = watch.lap();
  const identification::Identification id = identification::identify(robot, training, options);
  const double identify_s = watch.lap();
  const dynamics::RobotInertia prior = dynamics::loadRobotInertia(robot);
  watch.lap();
  const identification::PhysicalFit fit = identification::fitPhysical(robot, id, prior);
  const double physical_s = watch.lap();

  const identification::PhysicalCoordinates coordinates = identification::physicalCoordinates(prior);
  const Eigen::MatrixXd triangle = identification::joinBlocks(id.compressed, -1);
  const identification::PhysicalProblem problem =
      identification::physicalProblem(triangle, id.columns, coordinates, 0.1 * id.force_rms_N);
  const identification::PriorPull pull = identification::priorPull(problem, fit.strength);
  identification::PhysicalSolution solution;
  const double single_s = timeOneFit(problem, pull, solution);
  writeProblem(folder, problem, pull);

  std::vector<identification::Observation> validation = read(robot, argv[3], options.observation);
  for (identification::Observation& o : validation)
    identification::setFriction(o, id.columns, id.model.friction);
  const identification::PhysicalProblem held = heldOutProblem(validation, options.observation, id, coordinates);
  write(folder + "validation.txt", held.data);
  write(folder + "validation_target.txt", held.target);
  Eigen::VectorXd z(solution.inertial.size() + solution.free.size());
  z << solution.inertial, solution.free;

  std::cout << "{\"rows\": " << training.front().row_time_s.size() << ", \"read_s\": " << read_s
            << ", \"identify_s\": " << identify_s << ", \"physical_with_choice_s\": " << physical_s
            << ", \"physical_once_s\": " << single_s << ",\n \"physical_cost\": " << solution.cost
            << ", \"physical_held_out\": " << (held.data * z - held.target).norm()
            << ", \"peak_MB\": " << peakMegabytes() << ", \"rank\": " << id.model.rank
            << ", \"strength\": " << fit.strength;
  const double cutoff_hz = options.observation.cutoff_hz;
  printArray("base_moving_N", identification::applyModel(id.model, robot, validation, cutoff_hz).accuracy.rms_moving_N);
  printArray("physical_moving_N",
             identification::applyModel(fit.model, robot, validation, cutoff_hz).accuracy.rms_moving_N);
  std::cout << "}\n";
  return 0;
}
