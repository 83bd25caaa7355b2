// plan_excitation --robot R -o FILE: an optimal Fourier excitation as a checked reference file.

#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/trajectory/excitation.h"
#include "program.h"

namespace {

using namespace knee_robot;

std::atomic<bool> interrupted{false};
void onInterrupt(int) {
  interrupted = true;
}

void showProgress(const ExcitationProgress& progress) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(stderr, "\r%-10s %6d of %6d   best k %-12.6g", progress.stage, progress.done, progress.total,
               progress.best_k);
}

void report(const ExcitationOptions& options, const ExcitationPlan& plan, const std::string& output) {
  if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "\n");
  std::printf("%d of %d random series keep the limits, the best has k = %.4g at r = %d\n", plan.feasible_candidates,
              options.candidates, plan.random_k, options.directions);
  std::printf("after %d evaluations of the gradient: k = %.4g, %.2f times less%s\n", plan.evaluations, plan.k,
              plan.random_k / plan.k, plan.cut_short ? " (stopped early: best so far)" : "");
  std::printf("%12s %14s %14s\n", "directions r", "k, scaled", "k, raw");
  for (const ConditionAt& at : plan.conditions)
    std::printf("%12d %14.5g %14.5g\n", at.directions, at.scaled, at.raw);
  for (const Margin& margin : plan.check.margins) {
    std::printf("  %-24s %12.5g of %-10.5g %5.1f %% left\n", nameOf(margin.quantity), margin.value, margin.limit,
                100.0 * margin.left);
  }
  std::printf("written to %s\n", output.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Plans an excitation for identification: a finite Fourier series per actuator within all limits that minimises "
      "the "
      "condition number k of the column-scaled observation matrix at a stated number of directions.",
      "plan_excitation");
  std::string robot_file, output;
  ExcitationOptions options;
  double condition_max = 0.0;
  app.add_option("--robot", robot_file, "robot file (YAML)")->required();
  app.add_option("-o,--output", output, "reference file to write")->required();
  app.add_option("--duration", options.shape.duration_s, "s, ramps included")->capture_default_str();
  app.add_option("--ramp", options.shape.ramp_s, "s of the smooth ramp at each end")->capture_default_str();
  app.add_option("--harmonics", options.shape.harmonics, "of the series")->capture_default_str();
  app.add_option("--seed", options.seed, "another seed gives another excitation")->capture_default_str();
  app.add_option("--velocity", options.velocity_max, "limit of every actuator, m/s")->capture_default_str();
  app.add_option("--acceleration", options.acceleration_max, "limit of every actuator, m/s2")->capture_default_str();
  const CLI::Option* margin = app.add_option(
      "--condition-max", condition_max, "singularity margin (default: the robot file's, at most 60 when that is open)");
  app.add_option("--directions", options.directions, "r at which k is minimised")->capture_default_str();
  app.add_option("--candidates", options.candidates, "random feasible series to start with")->capture_default_str();
  app.add_option("--starts", options.starts, "how many of them are improved")->capture_default_str();
  app.add_option("--iterations", options.iterations, "of each start and round")->capture_default_str();
  app.add_option("--seconds-budget", options.seconds_budget, "then the best so far is written, as on Ctrl-C")
      ->capture_default_str();
  app.add_flag("--twin-legs", options.twin_legs, "q23 and q33 identical, as in the paper's verification");
  return runProgram(app, argc, argv, [&]() -> int {
    const Robot robot = loadRobot(robot_file);
    if (margin->count() > 0) options.condition_max = condition_max;
    options.progress = showProgress;
    options.interrupted = &interrupted;
    std::signal(SIGINT, onInterrupt);
    const ExcitationPlan plan = planExcitation(robot, options);
    writeReference(output, plan.reference,
                   {"excitation for " + robot_file + ", seed " + std::to_string(options.seed) + ", " +
                        std::to_string(options.shape.harmonics) + " harmonics",
                    "k = " + shortNumber(plan.k, 4) + " at r = " + std::to_string(options.directions)});
    report(options, plan, output);
    return kExitDone;
  });
}
