// Files of robot, hardware and deployment that are well formed and say something absurd: refused in a sentence, or safe.
#include <filesystem>
#include <regex>

#include "holding_robot.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

struct Files {
  std::string robot = holding::file("config/robots/A.yaml");
  std::string hardware = holding::file("config/hardware/simulated.yaml");
  std::string deployment = holding::file("config/deployment/simulation.yaml");
};

struct Outcome {
  std::string refusal;   // of the files
  double leg_m = 0.0;    // the farthest that a leg goes
  bool ends_off = true;  // drives and brakes, in the end
};

/// A path of 10 mm of each leg, up and down again, from where they are held.
void lifts(ControlSystem& system) {
  trajectory::Reference reference;
  reference.name = "lift";
  const mechanism::Lengths stands(system.snapshot()->reference_m.data());
  reference.points.resize(201, 4);
  for (int k = 0; k <= 200; ++k)
    reference.points.row(k) = stands.transpose().array() + 0.005 * (1.0 - std::cos(2.0 * M_PI * k / 200));
  try {
    if (system.loadReference(reference).ok) system.play();
  } catch (const InputError&) {
    // The absurd limits do not allow it.
  }
}

/// The true robot A under a controller with these files: enabled, lifted, held, disabled.
Outcome outcomeOf(const Files& files) {
  Outcome outcome;
  simulation::RobotImage image;
  const mechanism::Robot truth = mechanism::loadRobot(Files().robot);
  simulation::RobotSimulation plant(truth, dynamics::loadRobotInertia(truth),
                                    simulation::loadSimulationParameters(holding::file("config/simulation/A.yaml")),
                                    image);
  const std::unique_ptr<hardware::AxisBus> bus = simulation::openImageCards(image);
  const mechanism::Lengths home = plant.lengths();
  ControlSystem::Options options;
  options.empty = true;
  options.execution = rt::Execution::Stepped;
  std::unique_ptr<ControlSystem> system;
  try {
    system = std::make_unique<ControlSystem>(mechanism::loadRobot(files.robot), loadHardwareFile(files.hardware),
                                             files.deployment, *bus, options);
  } catch (const InputError& error) {
    outcome.refusal = error.what();
    return outcome;
  }
  system->setPlant([&](rt::Nanoseconds time) {
    while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time)) {
      plant.step(0.001);
      outcome.leg_m = std::max(outcome.leg_m, (plant.lengths() - home).cwiseAbs().maxCoeff());
    }
  });
  if (system->start().ok && system->enable().ok) {
    system->run(1.0);
    lifts(*system);
    system->run(2.5);
    system->disable();
  }
  system->run(0.5);
  outcome.ends_off = (image.counter.outputs.load() & 3) == 0;
  return outcome;
}

/// Each number of `text` (of actuators those of axes 1 and 4 only) in turn, in the place of which `put` stands.
template <typename Check>
void withEachNumber(const std::string& text, const std::function<std::string(double)>& put, Check&& check) {
  const std::regex number("([:\\[,] +|\\[)(-?[0-9]+\\.?[0-9]*(e[0-9]+)?)(?=[,}\\]\\n])");
  int line = 1;
  std::size_t counted = 0;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), number); it != std::sregex_iterator(); ++it) {
    const auto at = static_cast<std::size_t>(it->position(2));
    line += static_cast<int>(
        std::count(text.begin() + static_cast<long>(counted), text.begin() + static_cast<long>(at), '\n'));
    counted = at;
    const std::size_t begin = text.rfind('\n', at) + 1;
    // Of the singularity margin "no limit" is allowed.
    if (text[begin] == '#' || text.compare(begin, 19, "singularity_margin:") == 0) continue;
    std::string changed = text;
    const std::string instead = put(std::stod((*it)[2].str()));
    changed.replace(at, static_cast<std::size_t>((*it)[2].length()), instead);
    check(changed, std::to_string(line) + ": " + (*it)[2].str() + " -> " + instead);
  }
}

/// As a file in a folder of its own.
class ExtremeFile : public ::testing::TestWithParam<std::string> {
 protected:
  ExtremeFile() {
    text = readFile(target());
    const std::string urdf = std::filesystem::absolute(holding::file("urdf/A.urdf")).string();
    text = std::regex_replace(text, std::regex("urdf: \\S+"), "urdf: " + urdf);
    target() = folder + "/" + GetParam() + ".yaml";
  }
  std::string& target() {
    return GetParam() == "robot" ? files.robot : GetParam() == "hardware" ? files.hardware : files.deployment;
  }
  Outcome outcome(const std::string& changed) {
    writeFileAtomically(target(), changed);
    return outcomeOf(files);
  }

  const TemporaryFolder folder;
  Files files;
  std::string text;
};

TEST_P(ExtremeFile, WithANumberThatIsNoneOrTooLargeIsRefusedWithItsName) {
  for (const char* instead : {".nan", ".inf", "-.inf", "1e308", "-1e308", "1e400"}) {
    withEachNumber(
        text, [&](double) { return instead; },
        [&](const std::string& changed, const std::string& where) {
          const Outcome now = outcome(changed);
          EXPECT_EQ(now.refusal.rfind(target() + ":", 0), 0u) << where << ": " << now.refusal;
        });
  }
}

TEST_P(ExtremeFile, InOtherUnitsIsRefusedOrStopsBeforeALegHasGoneFar) {
  double farthest = 0.0;
  for (const double factor : {1000.0, 0.001, -1.0, 0.0}) {
    const auto times = [&](double was) {
      std::array<char, 32> number{};
      std::snprintf(number.data(), number.size(), "%.10g", factor * was);
      return std::string(number.data());
    };
    withEachNumber(text, times, [&](const std::string& changed, const std::string& where) {
      const Outcome now = outcome(changed);
      // Once 397 mm, with a screw's lead in another unit. A wrong sign takes a leg along by up to 17 mm.
      EXPECT_LT(now.leg_m, 0.025) << GetParam() << ", line " << where;
      EXPECT_TRUE(now.ends_off) << GetParam() << ", line " << where;
      farthest = std::max(farthest, now.leg_m);
    });
  }
  std::printf("a leg goes %.1f mm at most\n", 1e3 * farthest);
}

TEST_P(ExtremeFile, SavedByOtherProgramsIsReadOrRefusedInOneLine) {
  const std::string first_key = GetParam() == "robot"      ? "mechanism"
                                : GetParam() == "hardware" ? "backend"
                                                           : "components";
  const std::vector<std::string> texts = {"\xEF\xBB\xBF" + text,
                                          std::regex_replace(text, std::regex("\n"), "\r\n"),
                                          "\t" + text,
                                          text + "\n\t\n",
                                          text + "\n" + first_key + ": 1\n",
                                          text + "\n---\n" + text,
                                          text + std::string(1, '\0'),
                                          text.substr(0, 400),
                                          "",
                                          "[]",
                                          "&a [*a]",
                                          std::regex_replace(text, std::regex(" \\{"), " {{")};
  for (const std::string& one : texts) {
    const Outcome now = outcome(one);
    EXPECT_EQ(now.refusal.find('\n'), std::string::npos) << now.refusal;
    EXPECT_LT(now.leg_m, 0.025);
    EXPECT_TRUE(now.refusal.empty() || now.refusal.rfind(target() + ":", 0) == 0) << now.refusal;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, ExtremeFile, ::testing::Values("robot", "hardware", "deployment"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace knee_robot::control
