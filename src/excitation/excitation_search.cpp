#include "excitation_search.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <nlopt.hpp>
#include <random>

#include "knee_robot/base/parallel.h"

namespace knee_robot::excitation {
namespace {

constexpr double kExponents[] = {2.0, 8.0, 32.0};  ///< of SpectralCost, one round each
constexpr double kKept = 1e-4;                     ///< a limit counts as kept up to this; scaling mends it
constexpr double kReach = 0.3;                     ///< of one round, in units of the variables
constexpr int kWayRounds = 8;                      ///< of bisection between two series
constexpr int kProjection = 20;        ///< evaluations of the search for the nearest series within the limits
constexpr double kPrice = 3.0;         ///< of going beyond a limit by all of it, in units of the cost
constexpr double kFlat = 1e-4;         ///< a round ends when a step changes the cost by less
constexpr double kCentreSpread = 0.3;  ///< standard deviation of the centre, in units of the variables
constexpr double kLargestScale = 3.0;  ///< of random coefficients

/// What all threads share: the clock, counters, the best cost so far.
class SearchBoard {
 public:
  explicit SearchBoard(const ExcitationOptions& options)
      : options_(options),
        end_(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                    std::chrono::duration<double>(options.seconds_budget))) {}

  bool mustStop() {
    const bool stop =
        std::chrono::steady_clock::now() >= end_ || (options_.interrupted && options_.interrupted->load());
    if (stop) stopped_ = true;
    return stop;
  }
  bool stopped() const { return stopped_; }

  void report(const char* stage, int total, double cost) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stage_ != stage) done_ = 0;
    stage_ = stage;
    ++done_;
    best_cost_ = std::min(best_cost_, cost);
    if (options_.progress) options_.progress({stage, done_, total, std::exp(best_cost_)});
  }

 private:
  const ExcitationOptions& options_;
  std::chrono::steady_clock::time_point end_;
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  const char* stage_ = nullptr;
  int done_ = 0;
  double best_cost_ = HUGE_VAL;
};

double costOf(const ExcitationProblem& problem, const Eigen::VectorXd& variables) {
  ExcitationProblem::Evaluation evaluation;
  return problem.evaluate(variables, 0.0, false, evaluation) ? evaluation.cost
                                                             : std::numeric_limits<double>::infinity();
}

/// Normal coefficients that fall with the harmonic's number (equal velocities).
Eigen::VectorXd randomVariables(const ExcitationProblem& problem, unsigned seed, int number) {
  std::seed_seq sequence{seed, static_cast<unsigned>(number)};
  std::mt19937_64 random(sequence);
  std::normal_distribution<double> normal;
  Eigen::VectorXd variables(problem.variables());
  for (Eigen::Index i = 0; i < variables.size(); ++i) {
    const Eigen::Index harmonic = 1 + (i - 4) / 8;  // sine and cosine of four actuators each
    variables[i] = normal(random) * (i < 4 ? kCentreSpread : 1.0 / static_cast<double>(harmonic));
  }
  return variables;
}

/// Scaled up to the limits.
std::optional<Candidate> randomCandidate(const ExcitationProblem& problem, unsigned seed, int number) {
  const std::optional<Eigen::VectorXd> scaled =
      problem.scaledToLimits(randomVariables(problem, seed, number), kLargestScale);
  if (!scaled) return std::nullopt;
  return Candidate{*scaled, costOf(problem, *scaled)};
}

/// The columns' norms of the first random series that keeps the limits: units for D-optimality.
void fixScale(ExcitationProblem& problem, const ExcitationOptions& options) {
  for (int number = 0; number < options.candidates; ++number) {
    Eigen::VectorXd variables = randomVariables(problem, options.seed, number);
    const std::optional<Eigen::VectorXd> scaled = problem.scaledToLimits(variables, kLargestScale);
    const auto observations = scaled ? problem.observations(problem.series(*scaled)) : std::nullopt;
    if (!observations) continue;
    problem.setFixedScale(columnScales(*observations));
    return;
  }
  problem.setFixedScale(Eigen::VectorXd::Ones(dynamics::kPaperParameters));
}

/// One start: NLopt asks for the criterion and for the limits at the same variables in turn, so the last evaluation is
/// kept.
class Start {
 public:
  Start(const ExcitationProblem& problem, const ExcitationOptions& options, SearchBoard& board, Candidate best)
      : problem_(problem), options_(options), board_(board), best_(std::move(best)) {}

  /// A round from the best so far. What it ends with may be a little beyond the limits: the nearest series that keeps
  /// them is sought as well.
  void improve(double exponent) {
    exponent_ = exponent;
    target_.resize(0);
    run(best_.variables, options_.iterations);
    if (found_.size() > 0) keep(found_);
    if (nearly_.size() == 0) return;
    keep(nearly_);
    target_ = nearly_;
    run(target_, kProjection);
    if (found_.size() > 0) keep(found_);
  }

  const Candidate& best() const { return best_; }
  int evaluations() const { return evaluations_; }

 private:
  /// SLSQP from `from`; what it finds on the way is kept in found_ and nearly_ (its own result is the best that keeps
  /// the limits exactly, often the start).
  void run(const Eigen::VectorXd& from, int evaluations) {
    have_ = false;
    found_.resize(0);
    if (target_.size() == 0) nearly_.resize(0);
    const std::size_t n = static_cast<std::size_t>(problem_.variables());
    nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(n));
    solver.set_min_objective(&Start::cost, this);
    solver.add_inequality_mconstraint(&Start::limits, this,
                                      std::vector<double>(static_cast<std::size_t>(problem_.limits()), kKept));
    std::vector<double> x(from.data(), from.data() + n), low = x, high = x;
    for (std::size_t i = 0; i < n; ++i) {
      low[i] -= kReach;
      high[i] += kReach;
    }
    solver.set_lower_bounds(low);
    solver.set_upper_bounds(high);
    solver.set_ftol_abs(target_.size() > 0 ? 1e-9 : kFlat);
    solver.set_maxeval(evaluations);
    double value = 0.0;
    try {
      solver.optimize(x, value);
    } catch (const nlopt::forced_stop&) {
    } catch (const nlopt::roundoff_limited&) {
    } catch (const std::runtime_error&) {  // NLOPT_FAILURE: what was found on the way counts
    }
  }

  /// The least cost so far with the limits kept, and with them nearly kept.
  void note(const Eigen::VectorXd& variables) {
    const double beyond = last_.limits.maxCoeff();
    const double cost = target_.size() > 0 ? (variables - target_).squaredNorm() : last_.cost;
    if (beyond <= kKept && (found_.size() == 0 || cost < found_cost_)) {
      found_ = variables;
      found_cost_ = cost;
    }
    const double merit = last_.cost + kPrice * std::max(0.0, beyond);
    if (target_.size() == 0 && (nearly_.size() == 0 || merit < nearly_merit_)) {
      nearly_ = variables;
      nearly_merit_ = merit;
    }
  }

  static double cost(const std::vector<double>& x, std::vector<double>& gradient, void* self) {
    Start& start = *static_cast<Start*>(self);
    if (start.target_.size() > 0) {
      const Eigen::VectorXd away = Eigen::Map<const Eigen::VectorXd>(x.data(), start.target_.size()) - start.target_;
      if (!gradient.empty()) Eigen::Map<Eigen::VectorXd>(gradient.data(), away.size()) = away;
      return 0.5 * away.squaredNorm();
    }
    if (!start.at(x, !gradient.empty())) return HUGE_VAL;
    if (!gradient.empty())
      Eigen::Map<Eigen::VectorXd>(gradient.data(), start.problem_.variables()) = start.last_.cost_gradient;
    return start.last_.cost;
  }

  static void limits(unsigned m, double* result, unsigned n, const double* x, double* gradient, void* self) {
    Start& start = *static_cast<Start*>(self);
    const bool ok = start.at(std::vector<double>(x, x + n), gradient != nullptr);
    Eigen::Map<Eigen::VectorXd>(result, m) =
        ok ? start.last_.limits : Eigen::VectorXd(Eigen::VectorXd::Constant(m, 1e3));
    if (gradient == nullptr) return;
    Eigen::Map<Eigen::MatrixXd> slopes(gradient, n, m);  // NLopt's rows are limits
    if (ok) {
      slopes = start.last_.limit_gradients;
    } else {
      slopes.setZero();
    }
  }

  bool at(const std::vector<double>& x, bool with_slopes) {
    const Eigen::VectorXd variables = Eigen::Map<const Eigen::VectorXd>(x.data(), problem_.variables());
    if (have_ && variables == last_.variables && (last_.has_slopes || !with_slopes)) return true;
    if (board_.mustStop()) throw nlopt::forced_stop();
    have_ = problem_.evaluate(variables, exponent_, with_slopes, last_);
    ++evaluations_;
    if (have_) note(variables);
    board_.report("improving", options_.starts * options_.iterations * static_cast<int>(std::size(kExponents)),
                  best_.cost);
    return have_;
  }

  /// Brings variables that are a little beyond the limits back in two ways, less amplitude and the way back to the best
  /// so far, and keeps what is better than that.
  void keep(const Eigen::VectorXd& variables) {
    const std::optional<Eigen::VectorXd> smaller = problem_.scaledToLimits(variables, 1.0);
    if (smaller) keepIfBetter(*smaller);
    const Eigen::VectorXd from = best_.variables;
    double low = 0.0, high = 1.0;
    for (int round = 0; round < kWayRounds; ++round) {
      const double middle = round == 0 ? 1.0 : 0.5 * (low + high);
      (problem_.worstUse(from + middle * (variables - from), 1.0) <= 1.0 ? low : high) = middle;
      if (low == 1.0) break;
    }
    if (low > 0.0) keepIfBetter(from + low * (variables - from));
  }

  void keepIfBetter(const Eigen::VectorXd& variables) {
    const double cost = costOf(problem_, variables);
    if (cost < best_.cost) best_ = {variables, cost};
  }

  const ExcitationProblem& problem_;
  const ExcitationOptions& options_;
  SearchBoard& board_;
  Candidate best_;
  double exponent_ = 0.0;
  Eigen::VectorXd target_;  ///< not empty: seek the nearest series that keeps the limits
  ExcitationProblem::Evaluation last_;
  bool have_ = false;
  Eigen::VectorXd found_;  ///< feasible, with the least smoothed cost of this round
  double found_cost_ = 0.0;
  Eigen::VectorXd nearly_;  ///< the best compromise of this round between cost and limits
  double nearly_merit_ = 0.0;
  int evaluations_ = 0;
};

Candidate improved(const ExcitationProblem& problem, const ExcitationOptions& options, SearchBoard& board,
                   const Candidate& from, int& evaluations) {
  Start start(problem, options, board, from);
  for (const double exponent : kExponents) {
    if (board.mustStop()) break;
    start.improve(exponent);
  }
  evaluations = start.evaluations();
  return start.best();
}

bool cheaper(const Candidate& a, const Candidate& b) {
  return a.cost < b.cost;
}

/// The best of the random candidates, best first; as many as will be improved.
SearchResult randomSearch(ExcitationProblem& problem, const ExcitationOptions& options, SearchBoard& board) {
  SearchResult result;
  if (options.criterion == ExcitationCriterion::Determinant) fixScale(problem, options);
  std::vector<std::optional<Candidate>> random(static_cast<std::size_t>(options.candidates));
  inParallel(random.size(), [&](std::size_t own) {
    const int number = static_cast<int>(own);
    // The first two are always looked at: there must be something to return.
    if (number > 1 && board.mustStop()) return;
    std::optional<Candidate>& found = random[own];
    found = randomCandidate(problem, options.seed, number);
    board.report("random", options.candidates, found ? found->cost : HUGE_VAL);
  });
  for (std::optional<Candidate>& candidate : random) {
    if (candidate && std::isfinite(candidate->cost)) result.found.push_back(std::move(*candidate));
  }
  std::stable_sort(result.found.begin(), result.found.end(), cheaper);
  result.feasible = static_cast<int>(result.found.size());
  if (result.found.empty()) return result;
  result.random = result.found.front();
  result.found.resize(
      std::min<std::size_t>(result.found.size(), static_cast<std::size_t>(std::max(1, options.starts))));
  return result;
}

}  // namespace

Candidate improveOne(const ExcitationProblem& problem, const ExcitationOptions& options, const Candidate& from) {
  SearchBoard board(options);
  int evaluations = 0;
  return improved(problem, options, board, from, evaluations);
}

std::vector<Candidate> randomStarts(ExcitationProblem& problem, const ExcitationOptions& options) {
  SearchBoard board(options);
  return randomSearch(problem, options, board).found;
}

SearchResult searchExcitation(ExcitationProblem& problem, const ExcitationOptions& options) {
  SearchBoard board(options);
  SearchResult result = randomSearch(problem, options, board);
  if (result.found.empty()) return result;
  std::vector<int> evaluations(result.found.size(), 0);
  inParallel(std::min(result.found.size(), static_cast<std::size_t>(std::max(0, options.starts))), [&](std::size_t i) {
    result.found[i] = improved(problem, options, board, result.found[i], evaluations[i]);
  });
  for (const int count : evaluations)
    result.evaluations += count;
  std::stable_sort(result.found.begin(), result.found.end(), cheaper);
  result.cut_short = board.stopped();
  return result;
}

}  // namespace knee_robot::excitation
