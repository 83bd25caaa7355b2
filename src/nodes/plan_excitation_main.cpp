// plan_excitation --robot R -o FILE: an optimal Fourier excitation as a checked reference file, or a movement near rest.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/output_paths.h"
#include "knee_robot/excitation/excitation.h"
#include "plan_chain_excitation.h"
#include "plan_rest_excitation.h"
#include "program.h"

namespace {

using namespace knee_robot;

std::atomic<bool> interrupted{false};
void onInterrupt(int) {
  interrupted = true;
}

/// A line that is written over on a terminal; elsewhere one line for every tenth of a stage.
void showProgress(const excitation::ExcitationProgress& progress) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const int tenth = std::max(1, progress.total / 10);
  if (!terminal && progress.done % tenth != 0) return;
  std::fprintf(stderr, "%s%-10s %6d of %6d   best %-12.6g%s", terminal ? "\r" : "", progress.stage, progress.done,
               progress.total, progress.best, terminal ? "" : "\n");
}

void printConditions(const excitation::ExcitationPlan& plan) {
  std::printf("%12s %14s %14s %22s %14s\n", "directions r", "k, scaled", "k, raw", "best random: scaled", "raw");
  for (std::size_t i = 0; i < plan.conditions.size(); ++i) {
    std::printf("%12d %14.5g %14.5g %22.5g %14.5g\n", plan.conditions[i].directions, plan.conditions[i].scaled,
                plan.conditions[i].raw, plan.random_conditions[i].scaled, plan.random_conditions[i].raw);
  }
}

void printLimits(const excitation::ExcitationPlan& plan, const mechanism::Robot& robot,
                 const excitation::ExcitationOptions& options) {
  std::printf("limits, looked at every millisecond (closest actuator or joint):\n");
  for (const char* kind : {"length", "velocity", "acceleration", "universal", "revolute", "spherical", "condition",
                           "peak force", "rms force"}) {
    const excitation::LimitUsed* closest = nullptr;
    for (const excitation::LimitUsed& limit : plan.limits) {
      if (limit.name.rfind(kind, 0) == 0 && (closest == nullptr || limit.share > closest->share)) closest = &limit;
    }
    if (closest == nullptr) continue;
    std::printf("  %-28s %10.5g of %-10.5g %6.1f %% used\n", closest->name.c_str(), closest->value, closest->limit,
                100.0 * closest->share);
  }
  if (robot.urdf.empty()) {
    std::printf("  forces are not looked at: %s has no URDF\n", robot.path.c_str());
  } else {
    std::printf("  forces: inertia of %s, friction %g N s/m and %g N expected%s\n", robot.urdf.c_str(),
                options.friction.viscous_N_s_per_m, options.friction.coulomb_N,
                options.force_limits ? "" : "; not limited, as asked");
  }
}

void report(const mechanism::Robot& robot, const excitation::ExcitationOptions& options,
            const excitation::ExcitationPlan& plan, const std::string& output, double seconds) {
  if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "\n");
  std::printf("%d of %d random series keep the limits, the best has k = %.4g at r = %d\n", plan.feasible_candidates,
              options.candidates, plan.random_k, options.directions);
  std::printf("after %d evaluations: k = %.4g, %.2f times less%s\n", plan.evaluations, plan.k, plan.random_k / plan.k,
              plan.cut_short ? " (stopped early: best so far)" : "");
  if (options.criterion == excitation::ExcitationCriterion::Determinant) {
    std::printf("geometric mean of the first %d singular values: %.4g times the best random one's\n",
                options.directions, std::exp(plan.gain));
  }
  printConditions(plan);
  printLimits(plan, robot, options);
  const double cpu = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  std::printf("%.1f s, %.1f s of processor time on %u cores\nwritten to %s\n", seconds, cpu,
              std::thread::hardware_concurrency(), output.c_str());
}

struct Arguments {
  std::string robot_file, output;
  excitation::ExcitationOptions options;
  double condition_max = 0.0;
  std::vector<double> noise;
  std::vector<std::string> recorded;
  nodes::Option margin;
  nodes::Option noise_option;
  bool near_rest = false;
  int places = excitation::RestExcitationOptions().places;
  nodes::Option duration, velocity, place_option;
  std::vector<nodes::Option> only_series, only_platform, only_chain;  ///< near rest, the first are not looked at
};

void declareShared(nodes::CommandLine& app, Arguments& a) {
  app.option("--robot", a.robot_file, "robot file (YAML)").required();
  app.option("-o,--output", a.output, "reference file to write (chains: CSV)").required();
  const auto series = [&](const nodes::Option& option) { a.only_series.push_back(option); };
  a.duration = app.option("--duration", a.options.shape.duration_s,
                          "duration of the whole movement with its ramps, s (near rest: 90)")
                   .showDefault();
  series(app.option("--ramp", a.options.shape.ramp_s, "duration of the smooth ramp at each end, s").showDefault());
  series(
      app.option("--harmonics", a.options.shape.harmonics, "number of harmonics of the Fourier series").showDefault());
  app.option("--seed", a.options.seed, "random seed of the starting series").showDefault();
  series(
      app.option("--candidates", a.options.candidates, "number of random feasible series to start from").showDefault());
  series(app.option("--seconds,--seconds-budget", a.options.seconds_budget,
                    "time limit of planning, s; then, or at Ctrl-C, the best series so far is written")
             .showDefault());
  a.only_chain = {
      app.option("--recorded", a.recorded, "chains: existing recordings; the new movement adds what they lack")};
}

void declarePlatform(nodes::CommandLine& app, Arguments& a) {
  const auto both = [&](const nodes::Option& option) { return a.only_platform.emplace_back(option); };
  const auto only = [&](const nodes::Option& option) { return a.only_series.emplace_back(both(option)); };
  both(app.flag("--near-rest", a.near_rest,
                "in place of a Fourier series: small, slow strokes of every actuator by itself, with stops, at several "
                "places; they show how friction acts near rest"));
  a.place_option = both(app.option("--places", a.places, "near rest: the number of places").showDefault());
  a.velocity =
      both(app.option("--velocity", a.options.velocity_max, "velocity limit of every actuator, m/s (near rest: 0.015)")
               .showDefault());
  only(app.option("--acceleration", a.options.acceleration_max, "acceleration limit of every actuator, m/s2")
           .showDefault());
  a.margin = both(app.option("--condition-max", a.condition_max,
                             "largest condition number of the Jacobian on the way (default: the robot file's margin, "
                             "at most 60)"));
  only(app.option("--directions", a.options.directions,
                  "r: the number of parameter directions for which k = s_1 / s_r is minimised")
           .showDefault());
  only(app.option("--starts", a.options.starts, "number of the best of them that are optimised").showDefault());
  only(app.option("--iterations", a.options.iterations, "largest number of evaluations per start and round")
           .showDefault());
  only(app.choice("--criterion", a.options.criterion,
                  "what is optimised: condition (condition number k) or determinant (D-optimality)",
                  {{"condition", excitation::ExcitationCriterion::Condition},
                   {"determinant", excitation::ExcitationCriterion::Determinant}}));
  a.noise_option = only(app.option("--noise", a.noise,
                                   "standard deviation of the noise of the four actuator forces, N (default: in "
                                   "proportion to force_per_volt_N)")
                            .values(4));
  only(app.option("--viscous", a.options.friction.viscous_N_s_per_m,
                  "viscous friction assumed in every actuator for the force limits, N s/m")
           .showDefault());
  only(app.option("--coulomb", a.options.friction.coulomb_N,
                  "Coulomb friction assumed in every actuator for the force limits, N")
           .showDefault());
  only(app.flag("!--no-force-limits", a.options.force_limits, "do not limit the expected forces"));
  only(app.flag("--twin-legs", a.options.twin_legs, "move q23 and q33 identically, as in the paper's verification"));
}

/// An option that is not looked at would be taken for kept.
void refuseOthers(const std::vector<nodes::Option>& options, const std::string& sentence) {
  for (const nodes::Option& option : options) {
    if (option.given()) throw InputError(option.name() + " " + sentence);
  }
}

int planChain(const mechanism::Robot& robot, const Arguments& a) {
  refuseOthers(a.only_platform, "is for the parallel robot, but " + a.robot_file +
                                    " describes a chain, whose limits stand in the robot file; leave it out");
  excitation::ChainExcitationOptions chain;
  chain.shape = a.options.shape;
  chain.seed = a.options.seed;
  chain.candidates = a.options.candidates;
  chain.seconds_budget = a.options.seconds_budget;
  return nodes::planChainExcitation(robot, a.recorded, chain, a.output);
}

int planNearRest(const mechanism::Robot& robot, const Arguments& a) {
  refuseOthers(a.only_series, "is for the Fourier series, not for a movement near rest; leave it out");
  excitation::RestExcitationOptions rest;
  rest.seed = a.options.seed;
  rest.places = a.places;
  if (a.duration.given()) rest.duration_s = a.options.shape.duration_s;
  if (a.velocity.given()) rest.velocity_max = a.options.velocity_max;
  if (a.margin.given()) rest.condition_max = a.condition_max;
  return nodes::planRestExcitation(robot, rest, a.output);
}

/// Planning takes minutes: whether its result has a place is asked before.
void requireOutput(const Arguments& a, const mechanism::Robot& robot) {
  requireWritable(a.output);
  std::vector<std::string> read = a.recorded;
  read.insert(read.end(), {a.robot_file, robot.urdf});
  requireNoneOverwritten(read, {a.output});
}

int run(const Arguments& a) {
  const mechanism::Robot any = mechanism::loadAnyRobot(a.robot_file);
  requireOutput(a, any);
  if (any.chain) return planChain(any, a);
  refuseOthers(a.only_chain, "is for chains, but " + a.robot_file + " describes none; leave it out");
  if (a.near_rest) return planNearRest(any, a);
  refuseOthers({a.place_option}, "is for --near-rest; leave it out");
  const mechanism::Robot robot = mechanism::loadRobot(a.robot_file);
  excitation::ExcitationOptions options = a.options;
  if (a.margin.given()) options.condition_max = a.condition_max;
  if (a.noise_option.given()) options.noise_N = Eigen::Map<const mechanism::Vector4>(a.noise.data());
  options.progress = showProgress;
  options.interrupted = &interrupted;
  std::signal(SIGINT, onInterrupt);
  const auto start = std::chrono::steady_clock::now();
  const excitation::ExcitationPlan plan = excitation::planExcitation(robot, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  trajectory::writeReference(a.output, plan.reference,
                             {"excitation for " + a.robot_file + ", seed " + std::to_string(options.seed) + ", " +
                                  std::to_string(options.shape.harmonics) + " harmonics",
                              "k = " + shortNumber(plan.k, 4) + " at r = " + std::to_string(options.directions)});
  report(robot, options, plan, a.output, seconds);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "Plans an excitation for identification: a finite Fourier series per actuator within all limits that minimises "
      "the condition number k of the column-scaled, noise-weighted observation matrix at a stated number of "
      "directions. With --near-rest: a slow movement with stops.",
      "plan_excitation");
  Arguments arguments;
  declareShared(app, arguments);
  declarePlatform(app, arguments);
  return nodes::runProgram(app, argc, argv, [&] { return run(arguments); });
}
