#include "black_box_writer.h"

#include <unistd.h>

#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::control {
namespace {

__attribute__((format(printf, 2, 3))) void append(std::string& text, const char* format, ...) {
  char piece[128];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(piece, sizeof piece, format, arguments);
  va_end(arguments);
  text += piece;
}

std::string header() {
  std::string text = "time_s";
  for (std::size_t i = 1; i <= hardware::kAxes; ++i) {
    const int n = static_cast<int>(i);
    append(text, ",reference_%d_m,position_%d_m,velocity_%d_m_per_s", n, n, n);
    append(text, ",command_%d_V,force_%d_N,asked_%d_V,feedforward_%d_N,heat_%d,counts_%d,axis_fault_%d", n, n, n, n, n,
           n, n);
  }
  return text +
         ",cycle,lateness_s,path_time_s,time_scale,set_point,state,fault,sync_phase,drive_level,safe_stop,read_status,"
         "write_status,digital_inputs,digital_outputs\n";
}

void appendRow(std::string& text, const BlackBoxRow& row) {
  append(text, "%.9f", row.time_s);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    append(text, ",%.9f,%.9f,%.9f", row.reference_m[i], row.position_m[i], row.velocity_m_per_s[i]);
    append(text, ",%.9f,%.9f,%.9f,%.6f", row.command_V[i], row.force_N[i], row.asked_V[i], row.feedforward_N[i]);
    append(text, ",%.6f,%lld,%d", row.heat[i], static_cast<long long>(row.counts[i]),
           static_cast<int>(row.axis_fault[i]));
  }
  append(text, ",%lld,%.9f,%.6f,%.6f,%llu", static_cast<long long>(row.cycle), row.lateness_s, row.path_time_s,
         row.time_scale, static_cast<unsigned long long>(row.set_point));
  append(text, ",%d,%d,%d,%d,%d", static_cast<int>(row.state), static_cast<int>(row.fault), static_cast<int>(row.phase),
         static_cast<int>(row.level), static_cast<int>(row.safe_stop));
  append(text, ",%d,%d,%d,%d\n", static_cast<int>(row.read_status), static_cast<int>(row.write_status),
         row.digital_inputs, row.digital_outputs);
}

std::string sidecar(const BlackBoxDump& dump) {
  const FaultDescription& description = describe(dump.fault);
  std::string text = "fault: " + std::string(description.name) + "\nsentence: \"" + description.sentence +
                     "\"\nremedy: \"" + description.remedy + "\"\n";
  append(text, "axis: %d            # 0: none in particular\n", dump.axis);
  append(text, "time_s: %.9f   # of the fault, on the scale of the recording\n", dump.fault_time_s);
  text += "states: [";
  for (int state = 0; state < kMachineStates; ++state)
    text += std::string(state == 0 ? "" : ", ") + toString(static_cast<MachineState>(state));
  return text +
         "]\n"
         "faults: see describe() or docs/safety.md; numbers in the columns fault and axis_fault_i\n";
}

/// Throws InputError where less than `leaves` bytes are left. A file system that does not say has room.
void refuseFullDisk(const std::string& folder, std::uintmax_t leaves) {
  std::error_code error;
  const std::uintmax_t left = std::filesystem::space(folder, error).available;
  if (error || left >= leaves) return;
  throw InputError(folder + ": " + std::to_string(left >> 20) + " MB are left on this disk, and faults leave " +
                   std::to_string(leaves >> 20) +
                   " MB to what has to be written: the signals before this fault are lost; "
                   "remove old recordings and fault_* files");
}

std::string freePath(const std::string& folder, const char* fault) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char time[32];
  std::strftime(time, sizeof time, "%Y-%m-%d_%H-%M-%S", &local);
  const std::string stem = folder + "/fault_" + time + "_" + fault;
  std::string path = stem;
  for (int i = 2; ::access((path + ".csv").c_str(), F_OK) == 0; ++i)
    path = stem + "_" + std::to_string(i);
  return path;
}

}  // namespace

std::string formatBlackBox(const BlackBoxDump& dump) {
  std::string text = header();
  text.reserve(text.size() + dump.count * 700);
  for (std::size_t k = 0; k < dump.count; ++k)
    appendRow(text, dump.row(k));
  return text;
}

BlackBoxWriter::BlackBoxWriter(BlackBox& box, std::string folder, bool threaded, std::uintmax_t leaves)
    : box_(box), folder_(std::move(folder)), leaves_(leaves) {
  if (threaded) thread_ = std::thread([this] { loop(); });
}

BlackBoxWriter::~BlackBoxWriter() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  write();
}

void BlackBoxWriter::loop() {
  while (!stop_) {
    write();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void BlackBoxWriter::write() {
  const BlackBoxDump* dump = box_.waiting();
  if (dump == nullptr) return;
  if (!folder_.empty()) {
    std::string path, error;
    try {
      makeFolder(folder_);
      refuseFullDisk(folder_, leaves_);
      path = freePath(folder_, describe(dump->fault).name);
      writeFileAtomically(path + ".yaml", sidecar(*dump));
      writeFileAtomically(path + ".csv", formatBlackBox(*dump));
    } catch (const std::exception& refused) {  // no memory, a folder that is none: this thread must not end the process
      error = refused.what();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error.empty()) newest_ = path + ".csv";
    error_ = error;
  }
  box_.release(dump);
}

std::string BlackBoxWriter::newest() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return newest_;
}

std::string BlackBoxWriter::error() const {
  const std::uint64_t lost = folder_.empty() ? 0 : box_.lost();
  const std::string missing =
      lost == 0 ? "" : "signals of " + std::to_string(lost) + " faults were lost: the disk was too slow";
  const std::lock_guard<std::mutex> lock(mutex_);
  return error_ + (error_.empty() || missing.empty() ? "" : "; ") + missing;
}

}  // namespace knee_robot::control
