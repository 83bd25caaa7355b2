#pragma once

#include <string>

namespace knee_robot::report {

/// The page of one kind of report: pages/page.html with style, scripts and the plotting library inside, which draw what
/// the page embeds: report.json whole, and the series of its plots. The file needs nothing else, and no network.
class Page {
 public:
  /// `command`, as report.json has it, names the script: pages/COMMAND.js. InputError when a file of the page or the
  /// library (Debian's libjs-chart.js) is missing, with how to install it: programs ask before they begin to compute.
  explicit Page(const std::string& command);

  /// The page for `report_json`, the text of report.json, and `series_json`, an object. Neither can end the script
  /// element that it lies in.
  std::string with(const std::string& report_json, const std::string& series_json) const;

 private:
  std::string head_, tail_;  ///< around the data
};

}  // namespace knee_robot::report
