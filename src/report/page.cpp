#include "knee_robot/report/page.h"

#include <map>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/package_folders.h"

namespace knee_robot::report {
namespace {

constexpr const char* kLibrary = "/usr/share/javascript/chart.js/chart.min.js";
constexpr const char* kShared[] = {"page.js", "tables.js", "plots.js", "force.js"};

std::string partOfPage(const std::string& name) {
  const std::string path = sharedFile("pages/" + name);
  if (path.empty()) {
    throw InputError("the page's file pages/" + name +
                     " of this package was found neither beside this program's folder nor in ROS_PACKAGE_PATH; source "
                     "setup.bash, or let KNEE_ROBOT_PATH name the package's folder");
  }
  return readFile(path);
}

/// Chart.js, which the pages are written for in versions 3 and 4.
std::string library() {
  const std::string how = "; install Debian's package libjs-chart.js (scripts/install_dependencies does)";
  std::string text;
  try {
    text = readFile(kLibrary);
  } catch (const InputError&) {
    throw InputError(std::string("the plotting library of reports, ") + kLibrary + ", cannot be read" + how);
  }
  const std::string head = text.substr(0, 200);
  if (head.find("Chart.js v3.") == std::string::npos && head.find("Chart.js v4.") == std::string::npos)
    throw InputError(std::string(kLibrary) + " is not Chart.js 3 or 4, which the pages of reports are written for" +
                     how);
  return text;
}

/// The template with `parts` in their places, "{{style}}".
std::string filled(const std::string& form, const std::map<std::string, std::string>& parts) {
  std::string out;
  std::size_t from = 0;
  for (std::size_t at = form.find("{{"); at != std::string::npos; at = form.find("{{", from)) {
    const std::size_t end = form.find("}}", at);
    if (end == std::string::npos) break;
    const auto part = parts.find(form.substr(at + 2, end - at - 2));
    if (part == parts.end())
      throw InputError("pages/page.html has a place " + form.substr(at, end + 2 - at) + " that nothing fills");
    out += form.substr(from, at - from) + part->second;
    from = end + 2;
  }
  return out + form.substr(from);
}

}  // namespace

Page::Page(const std::string& command) {
  std::string shared;
  for (const char* name : kShared)
    shared += partOfPage(name);
  const std::string form = partOfPage("page.html");
  const std::string place = "{{data}}";
  const std::size_t data = form.find(place);
  if (data == std::string::npos) throw InputError("pages/page.html has no place {{data}}");
  head_ = filled(form.substr(0, data), {{"style", partOfPage("page.css")}});
  tail_ = filled(form.substr(data + place.size()),
                 {{"library", library()}, {"shared", shared}, {"own", partOfPage(command + ".js")}});
}

std::string Page::with(const std::string& report_json, const std::string& series_json) const {
  std::string data;
  // "<" is only ever inside strings there, where its number means the same: no "</script>", no "<!--".
  for (const char c : "{\"report\":" + report_json + ",\"series\":" + series_json + "}") {
    if (c == '<') {
      data += "\\u003c";
    } else {
      data += c;
    }
  }
  return head_ + data + tail_;
}

}  // namespace knee_robot::report
