#pragma once

#include <string>
#include <vector>

#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/rt/deployer.h"
#include "knee_robot/rt/port.h"

namespace knee_robot::rt {

/// Fills a Deployment from its file, section by section. Throws InputError.
class DeploymentReader {
 public:
  DeploymentReader(Deployment& target, const TypeFactory& factory);

  void read();

 private:
  void readActivity(StrictMap& entry, bool require_real_time);
  void readComponent(StrictMap& entry);
  void readConnection(StrictMap& entry);
  void readStartOrder();
  PortBase& findPort(StrictMap& entry, const std::string& key);
  std::vector<PortBase*> outputsFor(const TaskContext& receiver, const PortBase& input);
  void connectByName();
  void requireConnections();

  Deployment& target_;
  const TypeFactory& factory_;
  StrictMap file_;
};

}  // namespace knee_robot::rt
