#include "logger_services.h"

#include <ros/names.h>
#include <ros/service_manager.h>

namespace knee_robot::nodes {

void withdrawLoggerList() {
  ros::ServiceManager::instance()->unadvertiseService(ros::names::resolve("~get_loggers"));
}

}  // namespace knee_robot::nodes
