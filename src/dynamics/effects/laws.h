#pragma once

#include "knee_robot/dynamics/effect_law.h"

namespace knee_robot::dynamics {

using Law = std::unique_ptr<const EffectLaw>;
using Shape = std::vector<double>;

// One file a law: NAME.cpp.
Law asymmetricCoulombLaw(const Shape& shape);
Law asymmetricViscousLaw(const Shape& shape);
Law stribeckLaw(const Shape& shape);
Law preslidingLaw(const Shape& shape);
Law loadDependentFrictionLaw(const Shape& shape);
Law loadDependentViscousLaw(const Shape& shape);
Law powerFlowFrictionLaw(const Shape& shape);
Law positionDependentFrictionLaw(const Shape& shape);
Law screwRippleLaw(const Shape& shape);
Law quadraticDragLaw(const Shape& shape);
/// Null when what warms it up is no number of dynamics::Heat.
Law thermalDriftLaw(const Shape& shape);
Law frictionalAgeingLaw(const Shape& shape);
Law forceGainLaw(const Shape& shape);
Law forceOffsetLaw(const Shape& shape);
Law actuatorSpringLaw(const Shape& shape);
Law delayLaw(const Shape& shape);
Law springLaw(const Shape& shape);
/// Null when its exponent or the way over which a part is lost is not positive.
Law oneSidedSpringLaw(const Shape& shape);
/// Null when it is between no legs, or the way over which friction comes up is not positive.
Law linkBetweenLegsLaw(const Shape& shape);
Law dashpotLaw(const Shape& shape);
Law asymmetricDashpotLaw(const Shape& shape);
/// Null when it does not relax: a time that is not positive.
Law viscoelasticLinkLaw(const Shape& shape);
/// Null when the way over which it builds up is not positive.
Law elastoplasticLinkLaw(const Shape& shape);
Law lineFrictionLaw(const Shape& shape);
Law screwWhirlLaw(const Shape& shape);
/// Null when the way over which it falls off is not positive, or the one over which it rises is negative.
Law reversalFrictionLaw(const Shape& shape);
Law platformJointFrictionLaw(const Shape& shape);
Law baseJointFrictionLaw(const Shape& shape);
Law loadRippleLaw(const Shape& shape);
/// Null when it does not relax: a time that is not positive.
Law viscoelasticElementLaw(const Shape& shape);
/// Null when there is no such signal, or it is no state of the motion: the time in a recording, or since a place was
/// passed in it, or the force that a drive has to give.
Law mapLaw(const std::string& depends_on, const Shape& knots);
/// The same of a force on the platform itself; the knots are in order.
Law platformMapLaw(const std::string& depends_on, const Shape& knots);

/// A matrix over the platform's velocity, or over its way of late (one number: its time).
Law platformMatrixLaw(const std::string& depends_on, const Shape& shape);

}  // namespace knee_robot::dynamics
