#include "knee_robot/control/port_values.h"

#include <algorithm>
#include <array>
#include <map>
#include <type_traits>

#include "knee_robot/base/words.h"
#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/machine_state.h"
#include "knee_robot/rt/operation.h"

namespace knee_robot::control {
namespace {

template <typename T>
constexpr bool kIsNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Hands the members of a structure over one by one: to the three visitors below.
struct Pose {};  // an array in the order Xm, Zm, theta, psi

class Names {
 public:
  template <typename T>
  void operator()(const std::string& name, const T& member) {
    if constexpr (kIsNumber<T>) {
      names.push_back(prefix_ + name);
    } else {
      for (std::size_t i = 0; i < member.size(); ++i)
        (*this)(name + "_" + std::to_string(i + 1), member[i]);
    }
  }
  void operator()(const std::string& name, const std::array<double, 4>&, Pose) {
    for (const char* coordinate : {"Xm", "Zm", "theta", "psi"})
      names.push_back(prefix_ + name + "_" + coordinate);
  }
  template <typename T, typename Inner>
  void within(const std::string& name, const T&, Inner&& inner) {
    const std::string before = prefix_;
    prefix_ += name + ".";
    inner(*this);
    prefix_ = before;
  }
  std::vector<std::string> names;

 private:
  std::string prefix_;
};

class Numbers {
 public:
  explicit Numbers(std::vector<double>& numbers) : numbers_(numbers) {}
  template <typename T>
  void operator()(const std::string&, const T& member) {
    if constexpr (kIsNumber<T>) {
      numbers_.push_back(static_cast<double>(member));
    } else {
      for (const auto& one : member)
        numbers_.push_back(static_cast<double>(one));
    }
  }
  void operator()(const std::string& name, const std::array<double, 4>& member, Pose) { (*this)(name, member); }
  template <typename T, typename Inner>
  void within(const std::string&, const T&, Inner&& inner) {
    inner(*this);
  }

 private:
  std::vector<double>& numbers_;
};

class Layout {
 public:
  Layout(const void* begin, PortTypeLayout& layout) : begin_(static_cast<const char*>(begin)), layout_(layout) {}
  template <typename T>
  void operator()(const std::string&, const T& member) {
    const auto offset = static_cast<std::size_t>(reinterpret_cast<const char*>(&member) - begin_);
    layout_.members.push_back({offset, offset + sizeof member, std::max(alignof(T), alignment_)});
    alignment_ = 1;
  }
  void operator()(const std::string& name, const std::array<double, 4>& member, Pose) { (*this)(name, member); }
  template <typename T, typename Inner>
  void within(const std::string&, const T&, Inner&& inner) {
    alignment_ = alignof(T);
    inner(*this);
  }

 private:
  const char* begin_;
  PortTypeLayout& layout_;
  std::size_t alignment_ = 1;  // of a structure that begins with the next member
};

template <typename Visit>
void members(const AxesMeasurement& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("read_at_ns", v.read_at);
  visit("status", v.status);
  visit("position_m", v.position_m);
  visit("velocity_m_per_s", v.velocity_m_per_s);
  visit("counts", v.counts);
  visit("digital_inputs", v.digital_inputs);
  visit("home_number", v.home_number);
  visit("fenced_out", v.fenced_out);
  visit("guardian_carries", v.guardian_carries);
  visit.within("bus_failure", v.bus_failure, [&](Visit& inner) {
    inner("fault", v.bus_failure.fault);
    inner("axis", v.bus_failure.axis);
    inner("code", v.bus_failure.code);
    inner("silent", v.bus_failure.silent);
  });
}

template <typename Visit>
void members(const SetPoint& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("run", v.run);
  visit("phase", v.phase);
  visit("start_ns", v.start);
  visit("duration_ns", v.duration);
  visit("from_m", v.from_m);
  visit("to_m", v.to_m);
  visit("from_velocity_m_per_s", v.from_velocity);
  visit("to_velocity_m_per_s", v.to_velocity);
  visit("path_time_s", v.path_time_s);
  visit("path_duration_s", v.path_duration_s);
  visit("time_scale", v.time_scale);
  visit("refused_run", v.refused_run);
  visit("refusal", v.refusal);
  visit("refused_axis", v.refused_axis);
  visit("refused_distance_m", v.refused_distance_m);
}

template <typename Visit>
void members(const HomeSetting& v, Visit& visit) {
  visit("number", v.number);
  visit("shift_m", v.shift_m);
}

template <typename Visit>
void members(const FeedforwardForce& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("force_N", v.force_N);
  visit("moving_N", v.moving_N);
  visit("switched_N", v.switched_N);
  visit("weight_N", v.weight_N);
  visit("declared_N", v.declared_N);
  visit("per_kg_N", v.per_kg_N);
  visit("loop_N", v.loop_N);
  visit("closes_loop", v.closes_loop);
  visit("payload_kg", v.payload_kg);
  visit("complete", v.complete);
}

template <typename Visit>
void members(const Guidance& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("active", v.active);
  visit("force_N", v.force_N);
  visit("suspicion", v.suspicion);
  visit("doubted", v.doubted);
  visit("stop", v.stop);
}

template <typename Visit>
void members(const AxisCommand& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("axis", v.axis);
  visit("active", v.active);
  visit("loaded", v.loaded);
  visit("at_rest", v.at_rest);
  visit("fault", v.fault);
  visit("volts_V", v.volts);
  visit("force_N", v.force_N);
  visit("feedforward_N", v.feedforward_N);
  visit("moving_N", v.moving_N);
  visit("weight_N", v.weight_N);
  visit("declared_N", v.declared_N);
  visit("per_kg_N", v.per_kg_N);
  visit("reference_m", v.reference_m);
  visit("reference_velocity_m_per_s", v.reference_velocity);
  visit("homed", v.homed);
  visit("pulse_N", v.pulse_N);
  visit("can_be_asked", v.can_be_asked);
  visit("answers", v.answers);
  visit("homing", v.homing);
  visit("home_m", v.home_m);
}

template <typename Visit>
void members(const MonitorVerdict& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("fault", v.fault);
  visit("asks", v.asks);
  visit("heat", v.heat);
}

template <typename Visit>
void members(const Disturbance& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("suspicion", v.suspicion);
  visit("questions", v.questions);
  visit("asked", v.asked);
  visit("felt", v.felt);
  visit("identified", v.identified);
  visit("known", v.known);
  visit("expected_N", v.expected_N);
  visit("residual_N", v.residual_N);
  visit("certain_N", v.certain_N);
  visit("rms_N", v.rms_N);
  visit("band_N", v.band_N);
  visit("wrench", v.wrench, Pose{});
  visit("wrench_band", v.wrench_band, Pose{});
  visit("pose", v.pose, Pose{});
  visit("pushed", v.pushed);
  visit("push", v.push, Pose{});
  visit("carries", v.carries);
  visit("load_kg", v.load_kg);
  visit("load_m", v.load_m);
  visit("friction_changed", v.friction_changed);
  visit("friction_growth", v.friction_growth);
  visit("friction_least", v.friction_least);
  visit("model_holds", v.model_holds);
}

template <typename Visit>
void members(const SupervisorCommand& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("level", v.level);
  visit("immediate", v.immediate);
  visit("safe_stop", v.safe_stop);
  visit("drivers_active", v.drivers_active);
  visit("play", v.play);
  visit("stop_path", v.stop_path);
  visit("pause_path", v.pause_path);
  visit("speed", v.speed);
  visit("brake_test_N", v.brake_test_N);
  visit("transfer", v.transfer);
  visit("homed", v.homed);
  visit("homing", v.homing);
  visit("seeks_home", v.seeks_home);
  visit("guiding", v.guiding);
  visit("slows_down", v.slows_down);
  visit("holds_here", v.holds_here);
}

template <typename Visit>
void members(const AxesWritten& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("time_ns", v.time);
  visit("status", v.status);
  visit("level", v.level);
  visit("safe_stop", v.safe_stop);
  visit("fault", v.fault);
  visit("fault_axis", v.fault_axis);
  visit("safe_stops", v.safe_stops);
  visit("transfer", v.transfer);
  visit("holds_here", v.holds_here);
  visit("unordered", v.unordered);
  visit("digital_outputs", v.digital_outputs);
  visit("volts_V", v.volts);
  visit("force_N", v.force_N);
}

template <typename Visit>
void members(const TrackingRow& v, Visit& visit) {
  visit("sequence", v.sequence);
  visit("recording", v.recording);
  visit("home_number", v.home_number);
  visit("cycle", v.cycle);
  visit("time_s", v.time_s);
  visit("reference_m", v.reference_m);
  visit("position_m", v.position_m);
  visit("velocity_m_per_s", v.velocity_m_per_s);
  visit("command_V", v.command_V);
  visit("force_N", v.force_N);
  visit("feedforward_N", v.feedforward_N);
  visit("residual_N", v.residual_N);
  visit("residual_known", v.residual_known);
  visit("path_time_s", v.path_time_s);
  visit("test_pulse", v.test_pulse);
  visit("digital_inputs", v.digital_inputs);
  visit("digital_outputs", v.digital_outputs);
}

template <typename Visit>
void members(const Request& v, Visit& visit) {
  visit("number", v.number);
  visit("kind", v.kind);
  visit("value", v.value);
  visit("expires_ns", v.expires);
}

template <typename Visit>
void members(const SupervisorStatus& v, Visit& visit) {
  visit("time_ns", v.time);
  visit("state", v.state);
  visit("fault", v.fault);
  visit("fault_axis", v.fault_axis);
  visit("fault_component", v.fault_component);
  visit("fault_code", v.fault_code);
  visit("fault_paused_s", v.fault_paused_s);
  for (std::size_t i = 0; i < v.answers.size(); ++i) {
    const RequestAnswer& answer = v.answers[i];
    visit.within("answers_" + std::to_string(i + 1), answer, [&](Visit& inner) {
      inner("number", answer.number);
      inner("result", answer.result);
      inner("axis", answer.axis);
      inner("distance_m", answer.distance_m);
    });
  }
  visit("path_time_s", v.path_time_s);
  visit("path_duration_s", v.path_duration_s);
  visit("time_scale", v.time_scale);
  visit("speed", v.speed);
  visit("pause_path", v.pause_path);
  visit("homed", v.homed);
  visit("safe_stops", v.safe_stops);
  visit("guide_stop", v.guide_stop);
}

struct Described {
  std::vector<std::string> (*names)();
  void (*numbers)(const void* value, std::vector<double>& numbers);
  PortTypeLayout (*layout)();
};

template <typename T>
std::pair<const std::type_index, Described> described() {
  return {typeid(T),
          {[] {
             Names visit;
             members(T{}, visit);
             return visit.names;
           },
           [](const void* value, std::vector<double>& numbers) {
             Numbers visit(numbers);
             members(*static_cast<const T*>(value), visit);
           },
           [] {
             PortTypeLayout layout;
             layout.type = rt::typeName(typeid(T));
             layout.size = sizeof(T);
             const T value{};
             Layout visit(&value, layout);
             members(value, visit);
             return layout;
           }}};
}

const std::map<std::type_index, Described>& all() {
  static const std::map<std::type_index, Described> types = {
      described<AxesMeasurement>(),  described<SetPoint>(),    described<HomeSetting>(),
      described<FeedforwardForce>(), described<AxisCommand>(), described<Guidance>(),
      described<MonitorVerdict>(),   described<Disturbance>(), described<SupervisorCommand>(),
      described<AxesWritten>(),      described<TrackingRow>(), described<Request>(),
      described<SupervisorStatus>()};
  return types;
}

}  // namespace

std::vector<std::string> portValueNames(std::type_index type) {
  const auto found = all().find(type);
  return found == all().end() ? std::vector<std::string>{} : found->second.names();
}

void portValues(std::type_index type, const void* value, std::vector<double>& numbers) {
  numbers.clear();
  all().at(type).numbers(value, numbers);
}

PortTypeLayout portTypeLayout(std::type_index type) {
  return all().at(type).layout();
}

std::string portValuesTable() {
  std::map<std::string, std::string> rows;
  for (const auto& [type, one] : all()) {
    const std::string name = rt::typeName(type);
    rows[name.substr(name.rfind("::") + 2)] = joined(one.names());
  }
  std::string table = "| carried | values, in this order |\n| --- | --- |\n";
  for (const auto& [name, text] : rows)
    table += "| `" + name + "` | " + text + " |\n";
  return table;
}

}  // namespace knee_robot::control
