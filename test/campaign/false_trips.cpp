// false_trips: how often the stepped controller stops a healthy robot in simulated hours of ordinary use, with friction
// that nobody told it of; with --warnings, what the disturbance observer says of a robot that is as its model says; and
// with --frozen, what becomes of an encoder that dies. scripts/false_trips starts it. Its figures are those of
// docs/results/faults.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <random>
#include <vector>

#include "stepped_rig.h"

namespace knee_robot::control {
namespace {

using namespace stepped;

/// A pose near home, the way to it slow or brisk.
mechanism::Pose somewhere(const mechanism::Pose& home, std::mt19937& random) {
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  mechanism::Pose pose = home;
  pose[0] += 0.02 * one(random);
  pose[1] += 0.04 * (1.0 + one(random));
  pose[2] += 0.06 * one(random);
  pose[3] += 0.06 * one(random);
  return pose;
}

/// Ordinary use for `hours`: paths, pauses, other speeds, rests of up to 20 s, now and then the drives off, in motion or
/// at rest, and on again.
void use(const std::string& robot, const Machine& machine, double hours, unsigned seed,
         std::map<std::string, int>& trips) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  auto rig = std::make_unique<Rig>(robot, machine);
  double done_s = 0.0, began_s = rig->plant.time();
  while (done_s + rig->plant.time() - began_s < 3600.0 * hours) {
    ControlSystem& system = *rig->system;
    bool played = rig->hold() && rig->play(somewhere(rig->home, random), 2.0 + 10.0 * share(random));
    if (played && share(random) < 0.3) {
      system.run(share(random));
      system.pause();
      system.run(4.0 * share(random));
      system.setSpeed(20.0 + 80.0 * share(random));
      system.resume();
    }
    if (played && share(random) < 0.1) {
      system.run(share(random));
      system.stop();
    }
    if (played && share(random) < 0.1) {
      system.run(2.0 * share(random));
      system.disable();
    }
    if (system.state() != MachineState::Disabled) system.waitFor(MachineState::Holding, 120.0);
    system.setSpeed(100.0);
    const double rest = share(random);  // now and then one that lasts
    system.run(rest < 0.01 ? 200.0 : rest < 0.2 ? 20.0 * share(random) : share(random));
    if (share(random) < 0.05) system.disable();
    const ControlStatus status = system.status();
    if (status.state == MachineState::Faulted || status.state == MachineState::SafeStopping) {
      ++trips[status.fault_name];
      std::printf("    %.0f s: %s\n", rig->plant.time(), status.fault_sentence.c_str());
      done_s += rig->plant.time() - began_s;
      for (const auto& [sentence, count] : rig->warnings)
        trips[sentence] += count;
      rig = std::make_unique<Rig>(robot, machine);
      began_s = rig->plant.time();
    }
  }
  for (const auto& [sentence, count] : rig->warnings)
    trips[sentence] += count;
}

int countTrips(const std::string& robot, double hours, unsigned seed) {
  int all = 0;
  std::printf("| machine %s | simulated h | stops of a healthy robot%s |\n| --- | --- | --- |\n", robot.c_str(),
              watch_warnings ? ", and warnings" : "");
  for (const Machine& machine : kMachines) {
    if (watch_warnings && &machine != kMachines) break;
    std::map<std::string, int> trips;
    use(robot, machine, hours, seed, trips);
    std::string text;
    for (const auto& [name, count] : trips) {
      text += (text.empty() ? "" : ", ") + name + " " + std::to_string(count);
      all += count;
    }
    std::printf("| %s | %.2f | %s |\n", machine.name, hours, text.empty() ? "0" : text.c_str());
    std::fflush(stdout);
  }
  return all;
}

/// Where the encoder dies.
enum class When { AtRest, AtRestThenPush, Moving, AtTheTurn, Swinging };

struct Outcome {
  std::string fault;
  double after_s = 0.0, sinks_m = 0.0;
};

Outcome freeze(const std::string& robot, const Machine& machine, std::size_t axis, When when, double push_N,
               double wait_s) {
  Rig rig(robot, machine);
  rig.hold();
  rig.system->run(2.5);
  if (when == When::Moving || when == When::AtTheTurn) {
    mechanism::Pose up = rig.home;
    up[1] += 0.06;
    rig.play(up, 4.0);
    rig.system->run(when == When::Moving ? 2.0 : 3.8 + 0.02 * wait_s);
    if (when == When::AtTheTurn) {
      rig.system->waitFor(MachineState::Holding, 10.0);
      rig.play(rig.home, 4.0);  // down again, and blind from its begin on
      rig.system->run(0.02 * wait_s);
    }
  }
  if (when == When::Swinging) {
    rig.swing();
    rig.system->run(wait_s);
  }
  const double height = rig.plant.state().pose[1], began = rig.plant.time();
  rig.lowest = height;
  rig.image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
  double planned = 0.0;
  if (when == When::AtRestThenPush) {
    rig.system->run(wait_s);
    rig.image.surroundings.pose_force[1].store(-push_N);
  }
  if (when == When::AtTheTurn) planned = -1.0;
  rig.system->waitFor(MachineState::Faulted, 6.0);
  Outcome outcome;
  outcome.fault = rig.system->status().fault_name;
  outcome.after_s = rig.plant.time() - began;
  // On the way down the platform sinks on purpose: what counts is how far it falls below the path.
  outcome.sinks_m = planned < 0.0 ? std::max(0.0, rig.home[1] - rig.lowest) : height - rig.lowest;
  return outcome;
}

void printSinks(const std::vector<std::string>& order, std::map<std::string, std::vector<double>>& sinks_mm,
                std::map<std::string, int>& names) {
  std::printf(
      "\n| encoder dies | runs | named `encoder_frozen` | sinks, median / largest mm | above 5 mm |\n| --- | --- | --- "
      "| "
      "--- | --- |\n");
  for (const std::string& what : order) {
    std::vector<double>& sinks = sinks_mm[what];
    std::sort(sinks.begin(), sinks.end());
    const auto above = std::count_if(sinks.begin(), sinks.end(), [](double mm) { return mm > 5.0; });
    std::printf("| %s | %zu | %d | %.1f / %.1f | %td |\n", what.c_str(), sinks.size(), names[what],
                sinks[sinks.size() / 2], sinks.back(), above);
  }
}

int freezeAll(const std::string& robot) {
  struct Case {
    const char* what;
    When when;
    double push_N, wait_s;
  };
  const Case cases[] = {{"at rest, no push", When::AtRest, 0.0, 0.0},
                        {"at rest, 100 N after 2.5 s", When::AtRestThenPush, 100.0, 2.5},
                        {"at rest, 150 N after 2.5 s", When::AtRestThenPush, 150.0, 2.5},
                        {"at rest, 150 N at once", When::AtRestThenPush, 150.0, 0.0},
                        {"at rest, 150 N after 0.5 s", When::AtRestThenPush, 150.0, 0.5},
                        {"moving up, fast", When::Moving, 0.0, 0.0},
                        {"at the begin of the way down", When::AtTheTurn, 0.0, 0.0},
                        {"just after it", When::AtTheTurn, 0.0, 20.0},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 0.5},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 1.07},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 1.55},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 2.9},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 5.15}};
  int bad = 0, all = 0;
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> sinks_mm;
  std::map<std::string, int> names;
  std::printf(
      "| encoder dies (robot %s) | machine | axis | cause | after ms | sinks mm |\n| --- | --- | --- | --- | --- | --- "
      "|\n",
      robot.c_str());
  for (const Machine& machine : {kMachines[0], kMachines[1], kMachines[2]}) {
    for (const Case& one : cases) {
      for (std::size_t axis = 0; axis < mechanism::kLegs; ++axis) {
        const Outcome o = freeze(robot, machine, axis, one.when, one.push_N, one.wait_s);
        // Without a push nothing has to be found as long as nothing moves.
        const bool named = o.fault == "encoder_frozen" || (one.when == When::AtRest && o.fault.empty());
        const bool good = named && o.sinks_m < 0.005;
        ++all;
        bad += !good;
        if (sinks_mm.count(one.what) == 0) order.emplace_back(one.what);
        sinks_mm[one.what].push_back(1e3 * o.sinks_m);
        names[one.what] += o.fault == "encoder_frozen" ? 1 : 0;
        std::printf("| %s | %s | %zu | %s | %.0f | %s%.1f%s |\n", one.what, machine.name, axis + 1,
                    o.fault.empty() ? "none" : o.fault.c_str(), 1e3 * o.after_s, good ? "" : "**", 1e3 * o.sinks_m,
                    good ? "" : "**");
        std::fflush(stdout);
      }
    }
  }
  printSinks(order, sinks_mm, names);
  std::printf("\n%d of %d with less than 5 mm, named encoder_frozen (or nothing moved and nobody pushed)\n", all - bad,
              all);
  return bad;
}

/// How far the platform has gone, the farther of mm and mrad.
double wayOf(const mechanism::Pose& from, const mechanism::Pose& to) {
  return 1e3 * (to - from).cwiseAbs().maxCoeff();
}

/// Robots that nobody touches hold for `hours`; then the encoders' common supply is lost. Stops of healthy ones, and
/// losses that are not found.
int stand(const std::string& robot, double hours) {
  int bad = 0;
  std::printf(
      "| machine %s | h at rest | questions | stops | away at the end, mm or mrad | supply lost: found after s | sinks "
      "mm | with a push of "
      "150 N: found after s | sinks mm |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
      robot.c_str());
  for (const Machine& machine : kMachines) {
    std::printf("| %s | %.2f |", machine.name, hours);
    for (const double push_N : {0.0, 150.0}) {
      Rig rig(robot, machine);
      rig.hold();
      rig.system->run(5.0);
      const mechanism::Pose from = rig.plant.state().pose;
      if (push_N == 0.0) {
        rig.system->run(3600.0 * hours);
        const bool stopped = rig.system->state() != MachineState::Holding;
        bad += stopped;
        const std::optional<Disturbance> now = rig.system->disturbance();
        std::printf(" %u | %s | %.2f |", now ? now->questions : 0,
                    stopped ? rig.system->status().fault_name.c_str() : "0", wayOf(from, rig.plant.state().pose));
      }
      const double height = rig.lowest = rig.plant.state().pose[1], began = rig.plant.time();
      for (auto& encoder : rig.image.faults.encoder)
        encoder.store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
      rig.image.surroundings.pose_force[1].store(-push_N);
      const bool found = rig.system->waitFor(MachineState::Faulted, 60.0);
      bad += !found;
      std::printf(found ? " %.1f | %.1f |" : " never (%.0f) | %.1f |", rig.plant.time() - began,
                  1e3 * (height - rig.lowest));
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  return bad;
}

}  // namespace
}  // namespace knee_robot::control

int main(int argc, char** argv) {
  CLI::App app(
      "Stops of a healthy simulated robot in hours of ordinary use; with --frozen, what becomes of dead encoders.",
      "false_trips");
  std::string robot = "A";
  double hours = 0.25;
  unsigned seed = 1;
  bool frozen = false, standing = false;
  app.add_option("--robot", robot, "of config/robots")->capture_default_str();
  app.add_option("--hours", hours, "simulated, of each machine")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 1000.0));
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--probe-s", knee_robot::control::probe_period, "property of the Drivers; 0: no test pulses at all")
      ->capture_default_str();
  app.add_option("--rest-question-s", knee_robot::control::stepped::rest_question,
                 "property of the DisturbanceObserver; 0: nobody is asked in turn")
      ->capture_default_str();
  app.add_flag("--warnings", knee_robot::control::watch_warnings,
               "the first machine alone, with a model that is true: its stops and everything that is said");
  app.add_flag("--frozen", frozen, "encoders die at rest and in motion instead; slow");
  app.add_flag("--standing", standing,
               "robots that nobody touches hold for the hours; then the encoders' common supply is lost");
  CLI11_PARSE(app, argc, argv);
  try {
    using namespace knee_robot::control;
    const int bad = frozen ? freezeAll(robot) : standing ? stand(robot, hours) : countTrips(robot, hours, seed);
    return bad == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "false_trips: %s\n", error.what());
    return 2;
  }
}
