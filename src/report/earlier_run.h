#pragma once

#include <string>
#include <vector>

namespace knee_robot::report {

/// What an earlier run of the same command left in `folder`, by its report.json there: predictions of its validation
/// recordings, and with `physical` what the physically consistent fit wrote. File names; empty without such a report.
std::vector<std::string> filesOfEarlierRun(const std::string& folder, const std::string& command);

/// Removes those of `earlier` that are not among `written`: they belong to a model that is no longer there.
void removeStale(const std::string& folder, const std::vector<std::string>& earlier,
                 const std::vector<std::string>& written);

}  // namespace knee_robot::report
