#include "knee_robot/excitation/excitation.h"

#include <algorithm>
#include <cmath>

#include "excitation_search.h"
#include "excitation_setup.h"
#include "knee_robot/base/errors.h"

namespace knee_robot::excitation {
namespace {

constexpr double kShrink = 0.97;  ///< of the amplitude, when the full check finds something between the instants
constexpr int kShrinkRounds = 20;
const std::vector<int> kReportedDirections = {20, 30, 40, 51, 56, 73};

/// Draws the series' amplitude in until every limit holds at every millisecond and at every point that is streamed.
/// Returns what is still beyond its limit when that does not help, empty when all is well.
std::string checkPlan(const mechanism::Robot& limited, const ExcitationOptions& options, ExcitationPlan& plan) {
  for (int round = 0;; ++round) {
    plan.reference = sampledReference(plan.series);
    plan.check = trajectory::checkReference(plan.reference, limited);
    const auto used = limitsUsed(limited, plan.series, options.friction);
    const auto beyond = [&](const LimitUsed& limit) {
      return limit.share > 1.0 && (options.force_limits || limit.name.find("force") == std::string::npos);
    };
    if (used) plan.limits = *used;
    const auto worst = std::find_if(plan.limits.begin(), plan.limits.end(), beyond);
    if (plan.check.ok() && used && worst == plan.limits.end()) return {};
    if (round == kShrinkRounds) {
      if (!plan.check.ok()) return plan.check.violation->sentence;
      return used ? worst->name + " is beyond its limit" : "the mechanism cannot follow it";
    }
    plan.series.coefficients *= kShrink;
  }
}

/// The best series that stands the full check.
ExcitationPlan bestThatHolds(const ExcitationSetup& setup, const ExcitationOptions& options,
                             const SearchResult& result) {
  std::vector<Candidate> candidates = result.found;
  candidates.push_back(result.random);
  std::string reason;
  for (const Candidate& candidate : candidates) {
    ExcitationPlan plan;
    plan.series = setup.problem.series(candidate.variables);
    plan.gain = result.random.cost - candidate.cost;
    const std::string beyond = checkPlan(setup.limited, options, plan);
    if (beyond.empty()) return plan;
    if (reason.empty()) reason = beyond;
  }
  throw Refusal("the planned excitation: " + reason);
}

std::vector<ConditionAt> conditionsAsPlayed(const ExcitationProblem& problem, const FourierSeries& series,
                                            int directions, double& k) {
  const auto observations = problem.observationsAsPlayed(series);
  if (!observations) throw Refusal("the planned excitation cannot be followed by forward kinematics");
  std::vector<int> all = kReportedDirections;
  all.push_back(directions);
  std::vector<ConditionAt> conditions = conditionsOf(*observations, all);
  k = conditions.back().scaled;
  conditions.pop_back();
  return conditions;
}

}  // namespace

ExcitationPlan planExcitation(const mechanism::Robot& robot, const ExcitationOptions& options) {
  const ExcitationSetup setup = setUpExcitation(robot, options);
  ExcitationProblem problem = setup.problem;
  const SearchResult result = searchExcitation(problem, options);
  if (result.found.empty()) {
    throw Refusal("none of " + std::to_string(options.candidates) + " random series keeps the limits of " + robot.path +
                  "; plan with more candidates or a wider singularity margin");
  }
  ExcitationPlan plan = bestThatHolds(setup, options, result);
  plan.feasible_candidates = result.feasible;
  plan.evaluations = result.evaluations;
  plan.cut_short = result.cut_short;
  plan.check = trajectory::requirePlayable(plan.reference, robot);
  plan.conditions = conditionsAsPlayed(problem, plan.series, options.directions, plan.k);
  plan.random_conditions =
      conditionsAsPlayed(problem, problem.series(result.random.variables), options.directions, plan.random_k);
  return plan;
}

}  // namespace knee_robot::excitation
