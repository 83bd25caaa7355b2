#include "knee_robot/dynamics/urdf_inertia.h"

#include <tinyxml2.h>

#include <stdexcept>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::dynamics {
namespace {

using tinyxml2::XMLElement;

XMLElement* linkCalled(XMLElement* robot, const std::string& name) {
  for (XMLElement* link = robot->FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    if (link->Attribute("name", name.c_str())) return link;
  }
  return nullptr;
}

void setInertial(tinyxml2::XMLDocument& document, XMLElement* link, const LinkInertia& body) {
  while (XMLElement* old = link->FirstChildElement("inertial"))
    link->DeleteChild(old);
  XMLElement* inertial = document.NewElement("inertial");
  link->InsertFirstChild(inertial);
  XMLElement* origin = inertial->InsertNewChildElement("origin");
  const std::string xyz =
      exactNumber(body.center.x()) + " " + exactNumber(body.center.y()) + " " + exactNumber(body.center.z());
  origin->SetAttribute("xyz", xyz.c_str());
  origin->SetAttribute("rpy", "0 0 0");
  inertial->InsertNewChildElement("mass")->SetAttribute("value", exactNumber(body.mass).c_str());
  XMLElement* tensor = inertial->InsertNewChildElement("inertia");
  const mechanism::Matrix3& i = body.inertia;
  const std::pair<const char*, double> entries[] = {{"ixx", i(0, 0)}, {"ixy", i(0, 1)}, {"ixz", i(0, 2)},
                                                    {"iyy", i(1, 1)}, {"iyz", i(1, 2)}, {"izz", i(2, 2)}};
  for (const auto& [name, value] : entries)
    tensor->SetAttribute(name, exactNumber(value).c_str());
}

}  // namespace

std::string urdfWithInertia(const std::string& path, const RobotInertia& inertia, const std::string& note) {
  const std::string text = readFile(path, 64u << 20);
  tinyxml2::XMLDocument document;
  XMLElement* robot = nullptr;
  if (document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) robot = document.FirstChildElement("robot");
  if (robot == nullptr) throw InputError(path + ": not a URDF (no <robot> element that could be read)");
  for (int k = 0; k < kLinks; ++k) {
    const LinkInertia& body = inertia.links[static_cast<std::size_t>(k)];
    const std::string& name = linkNames()[static_cast<std::size_t>(k)];
    const std::string reason = inconsistency(body);
    if (!reason.empty()) throw std::invalid_argument("link " + name + ": " + reason);
    XMLElement* link = linkCalled(robot, name);
    if (link == nullptr) throw InputError(path + ": link " + name + " is missing");
    setInertial(document, link, body);
  }
  document.InsertAfterChild(document.FirstChild(), document.NewComment((" " + note + " ").c_str()));
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace knee_robot::dynamics
