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

/// A URDF as XML, for replacing what its links weigh.
class UrdfText {
 public:
  explicit UrdfText(const std::string& path) : path_(path) {
    const std::string text = readFile(path, 64u << 20);
    if (document_.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS)
      robot_ = document_.FirstChildElement("robot");
    if (robot_ == nullptr) throw InputError(path + ": not a URDF (no <robot> element that could be read)");
  }

  void set(const std::string& name, const LinkInertia& body) {
    const std::string reason = inconsistency(body);
    if (!reason.empty()) throw std::invalid_argument("link " + name + ": " + reason);
    setInertial(document_, link(name), body);
  }

  void clear(const std::string& name) {
    XMLElement* const given = link(name);
    while (XMLElement* old = given->FirstChildElement("inertial"))
      given->DeleteChild(old);
  }

  std::string childOf(const std::string& joint_name) const {
    for (XMLElement* j = robot_->FirstChildElement("joint"); j; j = j->NextSiblingElement("joint")) {
      XMLElement* const child = j->FirstChildElement("child");
      if (j->Attribute("name", joint_name.c_str()) && child && child->Attribute("link"))
        return child->Attribute("link");
    }
    throw InputError(path_ + ": joint " + joint_name + " is missing");
  }

  std::string text(const std::string& note) {
    document_.InsertAfterChild(document_.FirstChild(), document_.NewComment((" " + note + " ").c_str()));
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  XMLElement* link(const std::string& name) {
    XMLElement* const found = linkCalled(robot_, name);
    if (found == nullptr) throw InputError(path_ + ": link " + name + " is missing");
    return found;
  }

  std::string path_;
  tinyxml2::XMLDocument document_;
  XMLElement* robot_ = nullptr;
};

}  // namespace

std::string urdfWithInertia(const std::string& path, const RobotInertia& inertia, const std::string& note) {
  UrdfText urdf(path);
  for (int k = 0; k < kLinks; ++k)
    urdf.set(linkNames()[static_cast<std::size_t>(k)], inertia.links[static_cast<std::size_t>(k)]);
  return urdf.text(note);
}

std::string urdfWithChainInertia(const std::string& path, const mechanism::Chain& chain,
                                 const std::vector<LinkInertia>& bodies, const std::string& note) {
  UrdfText urdf(path);
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    for (const mechanism::ChainLink& link : chain.joints[j].links)
      urdf.clear(link.name);
    urdf.set(urdf.childOf(chain.joints[j].name), bodies[j]);
  }
  return urdf.text(note);
}

}  // namespace knee_robot::dynamics
