// {name: base_tilt, about_x_deg: 1, about_y_deg: -2}
// The base stands tilted: turned about its X axis, then about its (turned) Y axis; gravity keeps its direction.
#include <Eigen/Geometry>

#include "knee_robot/base/constants.h"
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class BaseTilt : public EffectOf<BaseTilt> {
 public:
  explicit BaseTilt(StrictMap& entry)
      : about_x_(kDegree * entry.numberOr("about_x_deg", 0.0, -45.0, 45.0)),
        about_y_(kDegree * entry.numberOr("about_y_deg", 0.0, -45.0, 45.0)) {}
  void changePlant(PlantModel& model) override {
    const mechanism::Matrix3 base = (Eigen::AngleAxisd(about_x_, mechanism::Vector3::UnitX()) *
                                     Eigen::AngleAxisd(about_y_, mechanism::Vector3::UnitY()))
                                        .toRotationMatrix();
    model.rigid.gravity = base.transpose() * model.rigid.gravity;
  }

 private:
  double about_x_;
  double about_y_;
};

}  // namespace

std::unique_ptr<Effect> makeBaseTilt(StrictMap& entry) {
  return std::make_unique<BaseTilt>(entry);
}

}  // namespace knee_robot::simulation
