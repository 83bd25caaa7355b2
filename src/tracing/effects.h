#pragma once

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

// One file an effect: effect_NAME.cpp.
std::unique_ptr<Candidate> makeAsymmetricCoulomb();
std::unique_ptr<Candidate> makeAsymmetricViscous();
std::unique_ptr<Candidate> makeStribeck();
std::unique_ptr<Candidate> makePresliding();
std::unique_ptr<Candidate> makeLoadDependentFriction();
std::unique_ptr<Candidate> makeScrewRipple();
std::unique_ptr<Candidate> makePositionDependentFriction();
std::unique_ptr<Candidate> makeQuadraticDrag();
std::unique_ptr<Candidate> makeThermalDrift();
std::unique_ptr<Candidate> makeForceGain();
std::unique_ptr<Candidate> makeForceOffset();
std::unique_ptr<Candidate> makeDelay();
std::unique_ptr<Candidate> makeDriveLag();
std::unique_ptr<Candidate> makeBacklash();
std::unique_ptr<Candidate> makeFlexibleCoupling();
std::unique_ptr<Candidate> makeSpring();
std::unique_ptr<Candidate> makeNonlinearSpring();
std::unique_ptr<Candidate> makeExternalForce();
std::unique_ptr<Candidate> makePowerFlowFriction();
std::unique_ptr<Candidate> makeLoadDependentViscous();
std::unique_ptr<Candidate> makeDashpot();
std::unique_ptr<Candidate> makeAsymmetricDashpot();
std::unique_ptr<Candidate> makeGainDrift();
// Of chains only.
std::unique_ptr<Candidate> makeTorsionalHysteresis();
std::unique_ptr<Candidate> makeGearRipple();
std::unique_ptr<Candidate> makeTemperatureFriction();
std::unique_ptr<Candidate> makeJointElasticity();
std::unique_ptr<Candidate> makePushAtTip();

}  // namespace knee_robot::tracing
