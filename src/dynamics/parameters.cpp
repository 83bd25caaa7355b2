#include "knee_robot/dynamics/parameters.h"

namespace knee_robot::dynamics {
namespace {

std::string linkSuffix(int link) {
  return link == kPlatformLink ? "_M" : "_" + std::to_string(link / 2 + 1) + std::to_string(link % 2 + 1);
}

int jointsOfLeg(int leg) {
  return leg == 3 ? 2 : 3;
}

std::vector<std::string> makeInertialNames() {
  std::vector<std::string> names;
  for (int link = 0; link < kLinks; ++link) {
    for (const char* name : {"IXX", "IXY", "IXZ", "IYY", "IYZ", "IZZ", "mX", "mY", "mZ", "m"}) {
      names.push_back(name + linkSuffix(link));
    }
  }
  return names;
}

std::vector<std::string> makeFrictionNames() {
  std::vector<std::string> names;
  for (int leg = 0; leg < mechanism::kLegs; ++leg) {
    for (int joint = jointsOfLeg(leg); joint >= 1; --joint) {
      const std::string suffix = "_" + std::to_string(leg + 1) + std::to_string(joint);
      names.push_back("Fv" + suffix);
      names.push_back("Fc" + suffix);
    }
  }
  return names;
}

std::vector<std::string> makePaperNames() {
  std::vector<std::string> names = inertialParameterNames();
  names.insert(names.end(), frictionParameterNames().begin(), frictionParameterNames().end());
  return names;
}

/// Where each of the 22 friction parameters stands among the extended ones.
std::vector<int> makeFrictionColumns() {
  std::vector<int> columns;
  int passive = extended::kPassiveFriction;
  for (int leg = 0; leg < mechanism::kLegs; ++leg) {
    columns.push_back(extended::kViscous + leg);
    columns.push_back(extended::kCoulomb + leg);
    for (int k = 0; k < 2 * (jointsOfLeg(leg) - 1); ++k)
      columns.push_back(passive++);
  }
  return columns;
}

std::vector<std::string> makeExtendedNames() {
  std::vector<std::string> names(extended::kParameters);
  for (int k = 0; k < kInertialParameters; ++k)
    names[k] = inertialParameterNames()[k];
  const std::vector<int> columns = makeFrictionColumns();
  for (int k = 0; k < kFrictionParameters; ++k)
    names[columns[k]] = frictionParameterNames()[k];
  for (int leg = 0; leg < mechanism::kLegs; ++leg) {
    names[extended::kRotor + leg] = "rotor_" + std::to_string(leg + 1);
    names[extended::kOffset + leg] = "offset_" + std::to_string(leg + 1);
  }
  return names;
}

std::vector<std::string> makeLinkNames() {
  std::vector<std::string> names;
  for (int leg = 1; leg <= mechanism::kLegs; ++leg) {
    names.push_back("leg_" + std::to_string(leg) + "_cylinder");
    names.push_back("leg_" + std::to_string(leg) + "_rod");
  }
  names.emplace_back("platform");
  return names;
}

}  // namespace

const std::vector<std::string>& inertialParameterNames() {
  static const std::vector<std::string> names = makeInertialNames();
  return names;
}

const std::vector<std::string>& frictionParameterNames() {
  static const std::vector<std::string> names = makeFrictionNames();
  return names;
}

const std::vector<std::string>& paperParameterNames() {
  static const std::vector<std::string> names = makePaperNames();
  return names;
}

const std::vector<std::string>& extendedParameterNames() {
  static const std::vector<std::string> names = makeExtendedNames();
  return names;
}

const std::vector<std::string>& linkNames() {
  static const std::vector<std::string> names = makeLinkNames();
  return names;
}

ExtendedParameters toExtended(const PaperParameters& parameters) {
  static const std::vector<int> columns = makeFrictionColumns();
  ExtendedParameters result = ExtendedParameters::Zero();
  result.head<kInertialParameters>() = parameters.head<kInertialParameters>();
  for (int k = 0; k < kFrictionParameters; ++k)
    result[columns[k]] = parameters[kInertialParameters + k];
  return result;
}

}  // namespace knee_robot::dynamics
