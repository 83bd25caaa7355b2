#include "knee_robot/identification/reduction.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace knee_robot::identification {
namespace {

constexpr double kWeakest = 1e-9;
constexpr int kMostChanges = 100;  ///< of the active set; a cycle ends here with a feasible solution

Eigen::MatrixXd pickColumns(const Eigen::MatrixXd& m, const std::vector<int>& columns) {
  Eigen::MatrixXd out(m.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    out.col(static_cast<Eigen::Index>(i)) = m.col(columns[i]);
  return out;
}

}  // namespace

Eigen::MatrixXd compress(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::MatrixXd joined(a.rows(), a.cols() + 1);
  joined << a, b;
  if (joined.rows() <= joined.cols()) return joined;
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(joined);
  return joined.topRows(joined.cols()).triangularView<Eigen::Upper>();
}

Reduction reduce(const Eigen::MatrixXd& triangle, int rows, const std::vector<Column>& columns,
                 const std::vector<char>& use) {
  Reduction r;
  const Eigen::Index p = triangle.cols() - 1;
  Eigen::MatrixXd scaled = triangle.leftCols(p);
  r.scale = scaled.colwise().norm().transpose() / std::sqrt(static_cast<double>(rows));
  const double tiny = 1e-12 * r.scale.maxCoeff();
  for (int c = 0; c < static_cast<int>(p); ++c) {
    if (r.scale[c] <= tiny || !use[static_cast<std::size_t>(c)]) {
      r.scale[c] = 0.0;
      continue;
    }
    scaled.col(c) /= r.scale[c];
    (columns[static_cast<std::size_t>(c)].isNonNegative() ? r.kept : r.others).push_back(c);
  }
  const Eigen::MatrixXd kept = pickColumns(scaled, r.kept);
  const Eigen::MatrixXd others = pickColumns(scaled, r.others);
  Eigen::MatrixXd free = others;
  if (kept.cols() > 0) free -= kept * kept.completeOrthogonalDecomposition().solve(others);
  r.target = triangle.col(p);
  Eigen::Index count = 0;
  if (others.cols() > 0) {
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(free, Eigen::ComputeThinV);
    const Eigen::VectorXd& s = svd.singularValues();
    while (count < s.size() && s[count] > kWeakest * s[0])
      ++count;
    r.directions = svd.matrixV().leftCols(count);
    r.singular = count > 0 ? Eigen::VectorXd(s.head(count) / s[0]) : Eigen::VectorXd();
  }
  r.design.resize(triangle.rows(), kept.cols() + count);
  r.design.leftCols(kept.cols()) = kept;
  if (count > 0) r.design.rightCols(count) = others * r.directions;
  return r;
}

Eigen::VectorXd boundedLeastSquares(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, int bounded) {
  std::vector<char> at_bound(static_cast<std::size_t>(x.cols()), 0);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(x.cols());
  for (int change = 0; change < kMostChanges; ++change) {
    std::vector<int> free;
    for (int i = 0; i < x.cols(); ++i) {
      if (!at_bound[static_cast<std::size_t>(i)]) free.push_back(i);
    }
    Eigen::VectorXd solution;  // a factorization without columns is not defined
    if (!free.empty()) solution = pickColumns(x, free).colPivHouseholderQr().solve(y);
    z.setZero();
    int worst = -1;
    for (std::size_t k = 0; k < free.size(); ++k) {
      z[free[k]] = solution[static_cast<Eigen::Index>(k)];
      if (free[k] < bounded && z[free[k]] < 0.0 && (worst < 0 || z[free[k]] < z[worst])) worst = free[k];
    }
    if (worst >= 0) {  // most negative one goes to its bound
      at_bound[static_cast<std::size_t>(worst)] = 1;
      continue;
    }
    const Eigen::VectorXd pull = x.transpose() * (y - x * z);  // positive: a bound that would rather be left
    int best = -1;
    for (int i = 0; i < bounded; ++i) {
      if (at_bound[static_cast<std::size_t>(i)] && pull[i] > 1e-9 * y.norm() * x.col(i).norm() &&
          (best < 0 || pull[i] > pull[best]))
        best = i;
    }
    if (best < 0) return z;
    at_bound[static_cast<std::size_t>(best)] = 0;
  }
  z.head(bounded) = z.head(bounded).cwiseMax(0.0);
  return z;
}

Eigen::VectorXd solveReduced(const Reduction& r, int rank) {
  return boundedLeastSquares(r.design.leftCols(rank), r.target, r.minimalRank());
}

std::vector<Eigen::VectorXd> solveEveryRank(const Reduction& r) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(r.design);
  const Eigen::VectorXd right = qr.householderQ().adjoint() * r.target;
  const bool full = r.design.rows() >= r.design.cols();
  std::vector<Eigen::VectorXd> all;
  for (int rank = r.minimalRank(); rank <= r.maximalRank(); ++rank) {
    Eigen::VectorXd z;
    if (full) {
      z = qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(right.head(rank));
    }
    const bool bad = !full || !z.allFinite() || (r.minimalRank() > 0 && z.head(r.minimalRank()).minCoeff() < 0.0);
    all.push_back(bad ? solveReduced(r, rank) : z);
  }
  return all;
}

Eigen::VectorXd toParameters(const Reduction& r, const Eigen::VectorXd& z) {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(r.scale.size());
  const Eigen::Index kept = static_cast<Eigen::Index>(r.kept.size());
  for (Eigen::Index i = 0; i < kept; ++i) {
    const int c = r.kept[static_cast<std::size_t>(i)];
    parameters[c] = z[i] / r.scale[c];
  }
  const Eigen::Index count = z.size() - kept;
  if (count == 0) return parameters;
  const Eigen::VectorXd others = r.directions.leftCols(count) * z.tail(count);
  for (std::size_t i = 0; i < r.others.size(); ++i) {
    parameters[r.others[i]] = others[static_cast<Eigen::Index>(i)] / r.scale[r.others[i]];
  }
  return parameters;
}

}  // namespace knee_robot::identification
