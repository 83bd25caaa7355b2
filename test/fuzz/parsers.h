#pragma once

#include <linux/can.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/control/component_types.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/control/patient_limits.h"
#include "knee_robot/dynamics/model.h"
#include "knee_robot/hardware/can/can_socket.h"
#include "knee_robot/hardware/can/drive_node.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/import.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/recording/text_table.h"
#include "knee_robot/rt/deployer.h"
#include "knee_robot/simulation/drive_model.h"
#include "knee_robot/simulation/shared_image.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "knee_robot/simulation/simulation_parameters.h"
#include "knee_robot/trajectory/reference_file.h"
#include "src/hardware/can/bus_errors.h"

/// Every reader of files that somebody else may have written: what the fuzzers and the random-bytes test feed.
namespace knee_robot::fuzz {

struct Parser {
  const char* name;
  std::vector<std::string> seeds;  ///< files below the repository's root, or whole texts when they hold a line end
  std::function<void(const std::string& text)> read;
};

/// A file of this process alone for readers that take a path; rewritten for each input.
inline std::string fileWith(const std::string& text) {
  static const std::string path = [] {
    const char* memory = "/dev/shm/knee_fuzz_XXXXXX";
    std::string name = memory;
    const int file = ::mkstemp(name.data());
    if (file >= 0) ::close(file);
    static const std::string kept = name;
    std::atexit([] { ::unlink(kept.c_str()); });
    return name;
  }();
  std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "wb"), &std::fclose);
  std::fwrite(text.data(), 1, text.size(), file.get());
  return path;
}

inline void readDeployment(const std::string& text) {
  static const mechanism::Robot robot = mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/A.yaml");
  static const control::HardwareFile hardware =
      control::loadHardwareFile(KNEE_SOURCE_DIR "/config/hardware/simulated.yaml");
  static const auto image = std::make_unique<simulation::RobotImage>();
  static const auto bus = simulation::openImageCards(*image);
  const std::string path = fileWith(text);
  rt::Deployment deployment(path, control::componentTypes(robot, hardware, *bus, control::AxisValues{}),
                            rt::Execution::Stepped);
}

inline void readPatient(const std::string& text) {
  static const mechanism::Robot robot = mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/A.yaml");
  control::loadPatientLimits(fileWith(text), robot);
}

inline void readTable(const std::string& text) {
  const recording::TextTable table(text, "table");
  for (int column = 0; column < table.columns(); ++column)
    table.numbers(column, true);
}

inline void readMapped(const std::string& text) {
  const std::size_t end = text.find('\n');
  recording::parseMapping(text.substr(0, end));
  if (end != std::string::npos) recording::parseColumnMap(text.substr(end + 1), "map");
}

/// Bytes as they could come over a socket, 16 a CAN frame: through every parser of frames and into a simulated drive.
inline void takeFrames(const std::string& text) {
  namespace can = hardware::can;
  struct NoBus : can::FramePort {
    can::PortStatus send(const can::Frame&) noexcept override { return can::PortStatus::Ok; }
    can::PortStatus receive(can::Frame&) noexcept override { return can::PortStatus::Empty; }
    std::int64_t now() noexcept override { return 0; }
    void pause(std::int64_t) override {}
  };
  static const can::ObjectDictionary table =
      can::ObjectDictionary::load(KNEE_SOURCE_DIR "/config/hardware/can_objects.yaml");
  NoBus bus;
  simulation::DriveModel drive(1, table, bus);
  can::DriveNode node(1, {});
  drive.powerUp();
  for (std::size_t at = 0; at + sizeof(::can_frame) <= text.size(); at += sizeof(::can_frame)) {
    ::can_frame raw{};
    std::memcpy(&raw, text.data() + at, sizeof raw);
    can::Frame frame;
    if (!can::fromKernel(raw, frame)) continue;
    can::toText(can::busErrors(frame));
    can::parseAnswer(frame, 1);
    node.take(frame);
    drive.take(frame);
    drive.step(static_cast<std::int64_t>(at) * 1000000);
    node.endCycle();
    node.failure(static_cast<std::int64_t>(at) * 1000000);
  }
}

inline const std::vector<Parser>& parsers() {
  static const std::vector<Parser> all = {
      {"reference",
       {"# space: actuator\n# period_s: 0.01\n0.6 0.65 0.66 0.62\n0.6001\t0.65 0.66 0.62\r\n",
        "# space: platform\n0 0.6 0 0\n0.001 0.6 0 0"},
       [](const std::string& text) { trajectory::parseReference(text, "reference"); }},
      {"recording",
       {"time_s,position_1_m,force_1_N\n0,0.6,1\n0.001,0.6,1.5\n0.002,0.6,nan\n",
        "time_s,reference_1_m,position_1_m,command_1_V,force_1_N,mocap_x_m\n0.1,0.6,0.6,-0.00488,1e2,nan\n0.2,0,0,0,0,"
        "1\n"},
       [](const std::string& text) { recording::parseRecording(text, "recording"); }},
      {"robot",
       {"config/robots/A.yaml", "config/robots/bench.yaml", "config/robots/final.yaml"},
       [](const std::string& text) { mechanism::loadRobot(fileWith(text)); }},
      {"simulation",
       {"config/simulation/A.yaml", "config/simulation/final.yaml",
        "axes:\n  - {viscous_N_s_per_m: 1, coulomb_N: 1}\npayload: {mass_kg: 15, center_m: [0, 0, 0.1]}\neffects:\n  - "
        "{name: stribeck, "
        "actuators: [2], excess_N: 10, velocity_m_per_s: 0.005}\n"},
       [](const std::string& text) { simulation::parseSimulationParameters(text, "simulation"); }},
      {"hardware",
       {"config/hardware/simulated.yaml", "config/hardware/can_simulated.yaml"},
       [](const std::string& text) { control::loadHardwareFile(fileWith(text)); }},
      {"patient",
       {"patient: \"ab\"\npose: {X_m: [-0.05, 0.05], Z_m: [0.58, 0.65], theta_deg: [-5, 20], psi_deg: [-10, "
        "10]}\nspeed: {linear_mm_per_s: 20, "
        "angular_deg_per_s: 2}\n"},
       [](const std::string& text) { readPatient(text); }},
      {"deployment", {"config/deployment/simulation.yaml"}, [](const std::string& text) { readDeployment(text); }},
      {"model",
       {"format_version: 1\nmechanism: 3UPS+1RPU\naxes: 4\nrobot: abc\ndata: []\ncutoff_hz: 3\nmoving_m_per_s: "
        "0.001\nrank: 2\n"},
       [](const std::string& text) { dynamics::parseModel(text, "model"); }},
      {"can_frames",
       {std::string("\x01\x06\0\0\x08\0\0\0\x2B\x40\x60\0\x0F\0\0\0\n", 17)},
       [](const std::string& text) { takeFrames(text); }},
      {"can_objects",
       {"objects:\n  - {object: \"6041:00\", type: u16, access: ro, value: 0x0240, mappable: true, name: status}\n"},
       [](const std::string& text) { hardware::can::ObjectDictionary::load(fileWith(text)); }},
      {"table", {"a;b\n1;2\n3;4\n", "t x\n0 1\n1 2\n", "1,5;2\n"}, [](const std::string& text) { readTable(text); }},
      {"column_map",
       {"enc1=position_1_m,counts,5e-6,0.6\nseparator: tab\ndecimal: comma\ncolumns:\n  - {from: \"t [ms]\", to: "
        "time_s, unit: ms}\n"},
       [](const std::string& text) { readMapped(text); }},
  };
  return all;
}

inline std::string seedText(const std::string& seed) {
  return seed.find('\n') != std::string::npos ? seed : readFile(std::string(KNEE_SOURCE_DIR "/") + seed);
}

/// Bad input is refused with an InputError or a Refusal; whatever else comes out of a reader is its fault.
inline void feed(const Parser& parser, const std::string& text) {
  try {
    parser.read(text);
  } catch (const InputError&) {
  } catch (const Refusal&) {
  }
}

}  // namespace knee_robot::fuzz
