#include "pose_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>

#include "knee_robot/base/numbers.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kPoseBlock_s = 5.0;
constexpr double kPoseLowered = 0.9;  ///< some coordinate's rms must fall below this share
constexpr double kLargestPoseP = 0.005;
constexpr double kAbsorbedPose = 1e-4;  ///< share of a column's square that must survive the model's columns
constexpr double kLeastPoseSpread = 1e-9;

bool isPlay(const PoseHypothesis& h) {
  return h.cause == PoseCause::TravelClearance || h.cause == PoseCause::LoadClearance;
}

/// Beyond this size (m or rad) it would have been seen besides a camera.
double largestSize(const PoseHypothesis& h) {
  constexpr double kOffset_m = 0.03, kDimension_m = 0.015, kAngle_rad = 0.06, kHalfPlay_m = 0.003;
  if (h.cause == PoseCause::HomeOffset) return kOffset_m;
  if (isPlay(h)) return kHalfPlay_m;
  return parameterOf(h).find("_rad") != std::string::npos ? kAngle_rad : kDimension_m;
}

void weigh(Eigen::MatrixXd& rows, const mechanism::Vector4& sigma) {
  for (Eigen::Index k = 0; k < rows.rows(); ++k)
    rows.row(k) /= sigma[k % 4];
}

/// Equations of the present model, weighed; columns of hypotheses are change of the residual per unit, so a solution is
/// minus them.
struct Weighed {
  Eigen::VectorXd residual;
  Eigen::MatrixXd model;  ///< frame and accepted causes
  Eigen::MatrixXd tried;  ///< all hypotheses
};

Weighed equationsOf(const PoseSearch& s) {
  PoseEquations e = poseEquations(*s.robot, *s.views, s.stack, s.model, s.hypotheses);
  Eigen::MatrixXd residual = e.residual;
  weigh(residual, s.sigma);
  weigh(e.frame, s.sigma);
  weigh(e.hypotheses, s.sigma);
  Weighed w{residual, Eigen::MatrixXd(e.frame.rows(), 4 + static_cast<Eigen::Index>(s.model.causes.size())),
            e.hypotheses};
  w.model.leftCols(4) = e.frame;
  for (std::size_t k = 0; k < s.model.causes.size(); ++k) {
    const auto at = std::find(s.hypotheses.begin(), s.hypotheses.end(), s.model.causes[k]) - s.hypotheses.begin();
    w.model.col(4 + static_cast<Eigen::Index>(k)) = w.tried.col(at);
  }
  return w;
}

Eigen::MatrixXd poseBasis(const Eigen::MatrixXd& columns) {
  const Eigen::VectorXd norms = columns.colwise().norm().cwiseMax(1e-300).transpose();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns * norms.cwiseInverse().asDiagonal());
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

Eigen::MatrixXd besides(const Eigen::MatrixXd& q, const Eigen::MatrixXd& columns) {
  return columns - q * (q.transpose() * columns);
}

/// Square that a column explains of a residual, both orthogonal to the model; zero when the sign is not physical.
double squareExplained(const Eigen::VectorXd& column, const Eigen::VectorXd& residual, bool one_sign) {
  const double square = column.squaredNorm(), along = column.dot(residual);
  if (!(square > 0.0) || (one_sign && along > 0.0)) return 0.0;  // columns are minus the pose's change
  return along * along / square;
}

/// Blocks of what nothing explains, all coordinates together, at random places with random signs.
Eigen::VectorXd resampled(const PoseSearch& s, std::mt19937_64& random) {
  const Eigen::Index n = s.noise.size() / 4;
  const Eigen::Index block = std::clamp<Eigen::Index>(std::lround(kPoseBlock_s * s.rate_hz), 2, n);
  Eigen::VectorXd out(4 * n);
  for (Eigen::Index at = 0; at < n; at += block) {
    const auto from = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(n));
    const double sign = random() % 2 ? 1.0 : -1.0;
    for (Eigen::Index k = 0; k < std::min(block, n - at); ++k)
      out.segment<4>(4 * (at + k)) = sign * s.noise.segment<4>(4 * ((from + k) % n));
  }
  return out;
}

/// What surrogates explain by chance, and the largest square by any hypothesis on any of them.
struct PoseNull {
  MaxNull roots;
  double largest_square = 0.0;
};

PoseNull nullOf(const PoseSearch& s, const Eigen::MatrixXd& q, const Eigen::MatrixXd& columns) {
  std::mt19937_64 random(s.options->seed * 7919u + s.model.causes.size());
  Eigen::MatrixXd roots(columns.cols(), s.options->draws);
  for (int d = 0; d < s.options->draws; ++d) {
    const Eigen::VectorXd surrogate = besides(q, resampled(s, random));
    for (Eigen::Index h = 0; h < columns.cols(); ++h)
      roots(h, d) =
          std::sqrt(squareExplained(columns.col(h), surrogate, isPlay(s.hypotheses[static_cast<std::size_t>(h)])));
  }
  PoseNull null{maxNull(roots, 0.0, kLeastPoseSpread), std::pow(roots.maxCoeff(), 2)};
  return null;
}

/// Squares that are left on each piece when the columns are fitted to the other pieces; the last column's values as
/// well.
struct HeldBack {
  Eigen::VectorXd square, last;
};

HeldBack heldBack(const PoseSearch& s, const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual) {
  HeldBack out{Eigen::VectorXd::Zero(s.stack.pieces), Eigen::VectorXd::Zero(s.stack.pieces)};
  const Eigen::VectorXd scale = columns.colwise().norm().cwiseMax(1e-300).transpose();
  const Eigen::MatrixXd a = columns * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd gram = a.transpose() * a;
  const Eigen::VectorXd right = a.transpose() * residual;
  for (int piece = 0; piece < s.stack.pieces; ++piece) {
    Eigen::MatrixXd part_gram = gram;
    Eigen::VectorXd part_right = right;
    std::vector<Eigen::Index> rows;
    for (std::size_t k = 0; k < s.stack.picks.size(); ++k) {
      if (s.stack.picks[k].piece != piece) continue;
      const auto at = 4 * static_cast<Eigen::Index>(k);
      part_gram -= a.middleRows<4>(at).transpose() * a.middleRows<4>(at);
      part_right -= a.middleRows<4>(at).transpose() * residual.segment<4>(at);
      rows.push_back(at);
    }
    const Eigen::VectorXd x = part_gram.colPivHouseholderQr().solve(part_right);
    for (const Eigen::Index at : rows)
      out.square[piece] += (residual.segment<4>(at) - a.middleRows<4>(at) * x).squaredNorm();
    out.last[piece] = -x[x.size() - 1] / scale[scale.size() - 1];
  }
  return out;
}

struct PoseTrial {
  Eigen::Index at = 0;
  double square = 0.0;
  HeldBack held;
  Eigen::VectorXd gain;
  HeldBackGain worth;
  mechanism::Vector4 rms = mechanism::Vector4::Zero();  ///< of the linear fit
};

mechanism::Vector4 rmsOfPose(const PoseSearch& s, const Eigen::VectorXd& weighed) {
  mechanism::Vector4 rms = mechanism::Vector4::Zero();
  for (Eigen::Index k = 0; k < weighed.size(); ++k)
    rms[k % 4] += std::pow(weighed[k] * s.sigma[k % 4], 2);
  return (rms / (static_cast<double>(weighed.size()) / 4.0)).cwiseSqrt();
}

PoseTrial tryOne(const PoseSearch& s, const Weighed& w, const Eigen::VectorXd& left, const Eigen::MatrixXd& columns,
                 Eigen::Index at, const HeldBack& base) {
  PoseTrial t;
  t.at = at;
  t.square = squareExplained(columns.col(at), left, isPlay(s.hypotheses[static_cast<std::size_t>(at)]));
  Eigen::MatrixXd all(w.model.rows(), w.model.cols() + 1);
  all << w.model, w.tried.col(at);
  t.held = heldBack(s, all, w.residual);
  t.gain = base.square - t.held.square;
  t.worth = heldBackGain(t.gain);
  const Eigen::VectorXd direction = columns.col(at).normalized();
  t.rms = rmsOfPose(s, left - direction * direction.dot(left));
  return t;
}

/// Empty when the trial may be accepted (but for the null); otherwise why not.
std::string objectionTo(const PoseSearch& s, const PoseTrial& t, const mechanism::Vector4& before) {
  if (t.square == 0.0) return "the sign that fits is not physical";
  const PoseHypothesis& h = s.hypotheses[static_cast<std::size_t>(t.at)];
  if (std::abs(t.held.last.mean()) > largestSize(h)) return "the size that fits is not plausible";
  if (!((t.rms.array() < kPoseLowered * before.array()).any())) return "lowers no coordinate's error by a tenth";
  if ((t.held.last.array() > 0.0).any() && (t.held.last.array() < 0.0).any())
    return "its sign changes when a part of the training data is left out";
  if (isPlay(h) && t.held.last.minCoeff() < 0.0) return "a part of the training data wants a sign that is not physical";
  if (t.worth.mean <= t.worth.error) return "does not help on held-back parts of the training data";
  return {};
}

/// A hypothesis fitted together with the model, on the whole forward kinematics.
struct Refitted {
  Eigen::Index at = 0;
  double value = 0.0;
  Eigen::VectorXd squares;  ///< left on every piece
};

Refitted refitted(const PoseSearch& s, Eigen::Index at) {
  PoseModel model = s.model;
  model.causes.push_back(s.hypotheses[static_cast<std::size_t>(at)]);
  model.values.conservativeResize(model.values.size() + 1);
  model.values[model.values.size() - 1] = 0.0;
  fitPose(*s.robot, *s.views, s.stack, s.sigma, {}, model);
  Refitted out{at, model.values[model.values.size() - 1], Eigen::VectorXd::Zero(s.stack.pieces)};
  Eigen::MatrixXd residual = poseEquations(*s.robot, *s.views, s.stack, model, {}).residual;
  weigh(residual, s.sigma);
  for (std::size_t k = 0; k < s.stack.picks.size(); ++k)
    out.squares[s.stack.picks[k].piece] += residual.middleRows<4>(4 * static_cast<Eigen::Index>(k)).squaredNorm();
  return out;
}

/// The best trial and those much like it, fitted to the end: straight columns are too crude to rank near relations.
/// Best first; what follows leaves no more than the best does, but for one standard error over pieces.
std::vector<Refitted> closestRivals(const PoseSearch& s, const std::vector<PoseTrial>& trials, const PoseTrial& best,
                                    const Eigen::MatrixXd& columns, const mechanism::Vector4& before) {
  constexpr double kAlike = 0.6;  // cosine of the columns, or share of the square that is explained
  std::vector<Refitted> all = {refitted(s, best.at)};
  for (const PoseTrial& t : trials) {
    if (t.at == best.at || !objectionTo(s, t, before).empty()) continue;
    const double cosine = std::abs(columns.col(t.at).normalized().dot(columns.col(best.at).normalized()));
    if (cosine < kAlike && t.square < kAlike * best.square) continue;
    const Refitted other = refitted(s, t.at);
    if (std::abs(other.value) <= largestSize(s.hypotheses[static_cast<std::size_t>(t.at)]) && other.value != 0.0)
      all.push_back(other);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Refitted& a, const Refitted& b) { return a.squares.sum() < b.squares.sum(); });
  std::vector<Refitted> close = {all.front()};
  for (std::size_t k = 1; k < all.size(); ++k) {
    const HeldBackGain more = heldBackGain(all[k].squares - all.front().squares);
    if (more.mean <= more.error) close.push_back(all[k]);
  }
  return close;
}

void refitPose(PoseSearch& s) {
  fitPose(*s.robot, *s.views, s.stack, s.sigma, {}, s.model);
  for (std::size_t k = 0; k < s.findings.size(); ++k)
    s.findings[k].value = s.model.values[static_cast<Eigen::Index>(k)];
}

void add(PoseSearch& s, PoseFinding finding) {
  s.model.causes.push_back(finding.hypothesis);
  s.model.values.conservativeResize(s.model.values.size() + 1);
  s.model.values[s.model.values.size() - 1] = 0.0;
  s.findings.push_back(std::move(finding));
  refitPose(s);
}

void erase(PoseSearch& s, std::size_t k) {
  s.model.causes.erase(s.model.causes.begin() + static_cast<std::ptrdiff_t>(k));
  s.findings.erase(s.findings.begin() + static_cast<std::ptrdiff_t>(k));
  Eigen::VectorXd rest(s.model.values.size() - 1);
  rest << s.model.values.head(static_cast<Eigen::Index>(k)),
      s.model.values.tail(s.model.values.size() - static_cast<Eigen::Index>(k) - 1);
  s.model.values = rest;
  refitPose(s);
}

/// Held-back gain of every cause in the model beside the others; takes out those that the others have made superfluous.
/// Sets the standard errors by the jackknife over pieces.
void dropSuperfluous(PoseSearch& s) {
  for (std::size_t k = 0; k < s.findings.size();) {
    const Weighed w = equationsOf(s);
    const Eigen::Index count = w.model.cols(), at = 4 + static_cast<Eigen::Index>(k);
    Eigen::MatrixXd fewer(w.model.rows(), count - 1), last(w.model.rows(), count);
    fewer << w.model.leftCols(at), w.model.rightCols(count - at - 1);
    last << fewer, w.model.col(at);
    // Around zero of this cause: what it explains now is put back into the residual.
    const Eigen::VectorXd residual = w.residual - w.model.col(at) * s.findings[k].value;
    const HeldBack with = heldBack(s, last, residual), out = heldBack(s, fewer, residual);
    const HeldBackGain worth = heldBackGain(out.square - with.square);
    const auto n = static_cast<double>(s.stack.pieces);
    s.findings[k].std = std::sqrt((n - 1.0) / n * (with.last.array() - with.last.mean()).square().sum());
    if (worth.mean > worth.error || s.findings.size() == 1) {
      ++k;
      continue;
    }
    s.rejected.push_back(textOf(s.findings[k].hypothesis) + ": superfluous beside the others");
    s.banned.push_back(s.findings[k].hypothesis);
    erase(s, k);
    k = 0;
  }
}

void noteAbsorbed(PoseSearch& s, const Weighed& w, const Eigen::MatrixXd& columns) {
  for (std::size_t h = 0; h < s.hypotheses.size(); ++h) {
    const auto at = static_cast<Eigen::Index>(h);
    if (columns.col(at).squaredNorm() < kAbsorbedPose * w.tried.col(at).squaredNorm())
      s.absorbed.push_back(textOf(s.hypotheses[h]) + ": the fixed camera transform takes it up");
  }
}

}  // namespace

void startPoseSearch(PoseSearch& s) {
  s.model.values.resize(0);
  s.sigma << 1e-3, 1e-3, 1e-3 / kRadianLength_m, 1e-3 / kRadianLength_m;
  for (int round = 0; round < 3; ++round) {
    fitPose(*s.robot, *s.views, s.stack, s.sigma, {}, s.model);
    const Weighed w = equationsOf(s);
    Eigen::MatrixXd all(w.model.rows(), w.model.cols() + w.tried.cols());
    all << w.model, w.tried;
    s.noise = besides(poseBasis(all), w.residual);
    const mechanism::Vector4 rms = rmsOfPose(s, s.noise);
    for (Eigen::Index k = 0; k < s.noise.size(); ++k)
      s.noise[k] *= s.sigma[k % 4] / rms[k % 4];
    s.sigma = rms.cwiseMax(1e-9);
  }
  const Weighed w = equationsOf(s);
  noteAbsorbed(s, w, besides(poseBasis(w.model), w.tried));
}

void searchPose(PoseSearch& s) {
  while (static_cast<int>(s.findings.size()) < s.options->most) {
    const Weighed w = equationsOf(s);
    const Eigen::MatrixXd q = poseBasis(w.model);
    const Eigen::VectorXd left = besides(q, w.residual);
    Eigen::MatrixXd columns = besides(q, w.tried);
    for (Eigen::Index h = 0; h < columns.cols(); ++h) {
      const bool banned =
          std::find(s.banned.begin(), s.banned.end(), s.hypotheses[static_cast<std::size_t>(h)]) != s.banned.end();
      if (banned || columns.col(h).squaredNorm() < kAbsorbedPose * w.tried.col(h).squaredNorm())
        columns.col(h).setZero();
    }
    const PoseNull null = nullOf(s, q, columns);
    const HeldBack base = heldBack(s, w.model, w.residual);
    const mechanism::Vector4 before = rmsOfPose(s, left);
    std::vector<PoseTrial> trials;
    for (Eigen::Index h = 0; h < columns.cols(); ++h) {
      if (columns.col(h).squaredNorm() > 0.0) trials.push_back(tryOne(s, w, left, columns, h, base));
    }
    std::sort(trials.begin(), trials.end(), [](const PoseTrial& a, const PoseTrial& b) { return a.square > b.square; });
    const PoseTrial* best = nullptr;
    std::string why;
    double p = 1.0;
    for (const PoseTrial& t : trials) {
      const PoseHypothesis& h = s.hypotheses[static_cast<std::size_t>(t.at)];
      p = null.roots.p(t.at, std::sqrt(t.square));
      why = p > kLargestPoseP ? "explains no more than chance does on surrogates (p = " + shortNumber(p, 2) + ")"
                              : objectionTo(s, t, before);
      if (why.empty()) {
        best = &t;
        break;
      }
      if (&t == &trials.front()) s.rejected.push_back(textOf(h) + ": " + why);
    }
    if (best == nullptr) return;
    const std::vector<Refitted> rivals = closestRivals(s, trials, *best, columns, before);
    for (const PoseTrial& t : trials) {
      if (t.at == rivals.front().at) best = &t;
    }
    PoseFinding f;
    f.hypothesis = s.hypotheses[static_cast<std::size_t>(best->at)];
    f.p = p;
    f.explained = (before.cwiseAbs2() - best->rms.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    f.share = best->square / left.squaredNorm();
    f.null_share = null.largest_square / left.squaredNorm();
    f.gain = best->gain.sum() / base.square.sum();
    f.gain_error = best->worth.error * static_cast<double>(best->gain.size()) / base.square.sum();
    for (std::size_t k = 1; k < rivals.size(); ++k)
      f.confusable.push_back(s.hypotheses[static_cast<std::size_t>(rivals[k].at)]);
    add(s, std::move(f));
    dropSuperfluous(s);
    s.options->progress("pose: added " + textOf(s.findings.back().hypothesis));
  }
}

}  // namespace knee_robot::tracing
