#include "recordings.h"

#include "knee_robot/base/errors.h"

namespace knee_robot::control {

Answer Recordings::start(const std::string& path) {
  try {
    drain_.start(path);
  } catch (const InputError& error) {
    return {false, error.what()};
  }
  chooseTestPulses();
  return {true, "recording to " + path};
}

Answer Recordings::stop(const std::string& only) {
  const RecordingResult result = drain_.stop(only);
  chooseTestPulses();
  if (result.path.empty() && !only.empty()) return {false, "somebody else has ended the recording " + only};
  if (result.path.empty()) return {true, "nothing was being recorded"};
  const std::string rows = std::to_string(result.rows) + " rows";
  std::string skipped;
  if (result.skipped > 0) {
    skipped = "; the machine skipped " + std::to_string(result.skipped) + " cycles, seen as gaps of time_s";
  }
  // Not "has": what the file has by now is what the error says.
  if (!result.error.empty())
    return {false, "the recording is incomplete: " + result.error + "; " + rows + " were written" + skipped};
  const std::string sentence = result.path + " has " + rows + skipped;
  if (result.dropped == 0) return {true, sentence};
  return {false, "the recording is incomplete: " + std::to_string(result.dropped) + " rows were dropped; " + sentence};
}

void Recordings::setOccupancy(Occupancy occupancy) {
  {
    const std::lock_guard<std::mutex> lock(choosing_);
    occupancy_ = occupancy;
  }
  chooseTestPulses();
}

void Recordings::chooseTestPulses() {
  const std::lock_guard<std::mutex> lock(choosing_);
  const bool allowed = !drain_.isRecording() || occupancy_ != Occupancy::Empty;
  for (Driver* driver : machine_.drivers)
    driver->allowTestPulses(allowed);
}

void Recordings::fill(ControlStatus& status) const {
  const RecordingResult recording = drain_.progress();
  status.recording = recording.path;
  status.recorded_rows = recording.rows;
  status.dropped_rows = recording.dropped;
  status.skipped_cycles = recording.skipped;
}

}  // namespace knee_robot::control
