#include "excitation_search.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <random>
#include <thread>

namespace knee_robot {
namespace {

constexpr double kPenaltyWeights[] = {3.0, 30.0, 300.0};  ///< one round of L-BFGS each
constexpr double kCentreSpread = 0.3;  ///< standard deviation of the centre, in units of the variables
constexpr double kLargestScale = 3.0;  ///< of random coefficients

/// What all threads share: the clock, counters, the best k so far.
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

  void report(const char* stage, int total, double k) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stage_ != stage) done_ = 0;
    stage_ = stage;
    ++done_;
    if (k > 0.0 && (best_k_ == 0.0 || k < best_k_)) best_k_ = k;
    if (options_.progress) options_.progress({stage, done_, total, best_k_});
  }

 private:
  const ExcitationOptions& options_;
  std::chrono::steady_clock::time_point end_;
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  const char* stage_ = nullptr;
  int done_ = 0;
  double best_k_ = 0.0;
};

/// Calls work(0) .. work(count - 1) from all cores.
template <typename Work>
void inParallel(int count, const Work& work) {
  std::atomic<int> next{0};
  const auto worker = [&] {
    for (int k = next++; k < count; k = next++)
      work(k);
  };
  const unsigned cores = std::max(1u, std::min(std::thread::hardware_concurrency(), static_cast<unsigned>(count)));
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < cores; ++i)
    threads.emplace_back(worker);
  worker();
  for (std::thread& thread : threads)
    thread.join();
}

double conditionOf(const ExcitationProblem& problem, const Eigen::VectorXd& variables) {
  const std::optional<double> log_k = problem.cost(variables, 0.0, nullptr);
  return log_k ? std::exp(*log_k) : std::numeric_limits<double>::infinity();
}

/// Normal coefficients that fall with the harmonic's number (equal velocities), scaled up to the limits.
std::optional<Candidate> randomCandidate(const ExcitationProblem& problem, unsigned seed, int number) {
  std::seed_seq sequence{seed, static_cast<unsigned>(number)};
  std::mt19937_64 random(sequence);
  std::normal_distribution<double> normal;
  Candidate candidate;
  candidate.variables.resize(problem.variables());
  for (Eigen::Index i = 0; i < candidate.variables.size(); ++i) {
    const Eigen::Index harmonic = 1 + (i - 4) / 8;  // sine and cosine of four actuators each
    candidate.variables[i] = normal(random) * (i < 4 ? kCentreSpread : 1.0 / static_cast<double>(harmonic));
  }
  const std::optional<Eigen::VectorXd> scaled = problem.scaledToLimits(candidate.variables, kLargestScale);
  if (!scaled) return std::nullopt;
  candidate.variables = *scaled;
  candidate.k = conditionOf(problem, *scaled);
  return candidate;
}

class PenalisedCost : public ceres::FirstOrderFunction {
 public:
  PenalisedCost(const ExcitationProblem& problem, double weight, int& evaluations)
      : problem_(problem), weight_(weight), evaluations_(evaluations) {}

  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    const Eigen::VectorXd variables = Eigen::Map<const Eigen::VectorXd>(parameters, problem_.variables());
    Eigen::VectorXd slope;
    const std::optional<double> value = problem_.cost(variables, weight_, gradient ? &slope : nullptr);
    ++evaluations_;
    if (!value || !std::isfinite(*value)) return false;
    *cost = *value;
    if (gradient) Eigen::Map<Eigen::VectorXd>(gradient, problem_.variables()) = slope;
    return true;
  }
  int NumParameters() const override { return problem_.variables(); }

 private:
  const ExcitationProblem& problem_;
  double weight_;
  int& evaluations_;
};

class StopWatch : public ceres::IterationCallback {
 public:
  StopWatch(SearchBoard& board, int total, const Candidate& best) : board_(board), total_(total), best_(best) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    board_.report("improving", total_, best_.k);
    return board_.mustStop() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  SearchBoard& board_;
  int total_;
  const Candidate& best_;
};

/// L-BFGS from a feasible candidate; after each round the result is scaled back to the limits and kept if it is better.
Candidate improved(const ExcitationProblem& problem, const ExcitationOptions& options, Candidate best,
                   SearchBoard& board, int& evaluations) {
  Eigen::VectorXd variables = best.variables;
  const int total = options.starts * options.iterations * static_cast<int>(std::size(kPenaltyWeights));
  for (const double weight : kPenaltyWeights) {
    if (board.mustStop()) break;
    ceres::GradientProblem ceres_problem(new PenalisedCost(problem, weight, evaluations));
    StopWatch watch(board, total, best);
    ceres::GradientProblemSolver::Options solver;
    solver.line_search_direction_type = ceres::LBFGS;
    solver.max_num_iterations = options.iterations;
    solver.max_lbfgs_rank = 30;
    solver.logging_type = ceres::SILENT;
    solver.callbacks.push_back(&watch);
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(solver, ceres_problem, variables.data(), &summary);
    const std::optional<Eigen::VectorXd> feasible = problem.scaledToLimits(variables, 1.0);
    if (!feasible) continue;
    const double k = conditionOf(problem, *feasible);
    if (k < best.k) best = {*feasible, k};
  }
  return best;
}

}  // namespace

SearchResult searchExcitation(const ExcitationProblem& problem, const ExcitationOptions& options) {
  SearchBoard board(options);
  SearchResult result;
  std::vector<std::optional<Candidate>> random(static_cast<std::size_t>(options.candidates));
  inParallel(options.candidates, [&](int number) {
    // The first two are always looked at: there must be something to return.
    if (number > 1 && board.mustStop()) return;
    random[static_cast<std::size_t>(number)] = randomCandidate(problem, options.seed, number);
    const std::optional<Candidate>& found = random[static_cast<std::size_t>(number)];
    board.report("random", options.candidates, found ? found->k : 0.0);
  });
  for (std::optional<Candidate>& candidate : random) {
    if (candidate && std::isfinite(candidate->k)) result.found.push_back(std::move(*candidate));
  }
  const auto better = [](const Candidate& a, const Candidate& b) { return a.k < b.k; };
  std::stable_sort(result.found.begin(), result.found.end(), better);
  result.feasible = static_cast<int>(result.found.size());
  if (result.found.empty()) return result;
  result.random_k = result.found.front().k;
  result.found.resize(
      std::min<std::size_t>(result.found.size(), static_cast<std::size_t>(std::max(1, options.starts))));

  std::vector<int> evaluations(result.found.size(), 0);
  inParallel(std::min(options.starts, static_cast<int>(result.found.size())), [&](int start) {
    const std::size_t i = static_cast<std::size_t>(start);
    result.found[i] = improved(problem, options, result.found[i], board, evaluations[i]);
  });
  for (const int count : evaluations)
    result.evaluations += count;
  std::stable_sort(result.found.begin(), result.found.end(), better);
  result.cut_short = board.stopped();
  return result;
}

}  // namespace knee_robot
