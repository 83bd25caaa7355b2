#include "knee_robot/identification/reduction.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "knee_robot/base/parallel.h"

namespace knee_robot::identification {
namespace {

constexpr double kSilent = 1e-2;   ///< singular value: square root of the least information
constexpr int kMostChanges = 100;  ///< of the active set; a cycle ends here with a feasible solution

Eigen::MatrixXd pickColumns(const Eigen::MatrixXd& m, const std::vector<int>& columns) {
  Eigen::MatrixXd out(m.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    out.col(static_cast<Eigen::Index>(i)) = m.col(columns[i]);
  return out;
}

std::vector<std::vector<int>> rowsOfBlocks(const Equations& e) {
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(e.blocks));
  for (int row = 0; row < e.rows(); ++row)
    rows[static_cast<std::size_t>(e.block[static_cast<std::size_t>(row)])].push_back(row);
  return rows;
}

Eigen::MatrixXd triangleOf(Eigen::MatrixXd joined) {
  if (joined.rows() <= joined.cols()) return joined;
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(joined);
  return joined.topRows(joined.cols()).triangularView<Eigen::Upper>();
}

}  // namespace

Eigen::MatrixXd compress(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::MatrixXd joined(a.rows(), a.cols() + 1);
  joined << a, b;
  return triangleOf(std::move(joined));
}

std::vector<Eigen::MatrixXd> compressBlocks(const Equations& e) {
  const std::vector<std::vector<int>> rows = rowsOfBlocks(e);
  std::vector<Eigen::MatrixXd> blocks(rows.size());
  inParallel(blocks.size(), [&](std::size_t block) {
    const std::vector<int>& own = rows[block];
    Eigen::MatrixXd joined(static_cast<Eigen::Index>(own.size()), e.a.cols() + 1);
    joined.leftCols(e.a.cols()) = e.a(own, Eigen::all);
    joined.rightCols<1>() = e.b(own);
    blocks[block] = triangleOf(std::move(joined));
  });
  return blocks;
}

Eigen::MatrixXd joinBlocks(const std::vector<Eigen::MatrixXd>& blocks, int left_out) {
  Eigen::Index rows = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    rows += static_cast<int>(i) == left_out ? 0 : blocks[i].rows();
  Eigen::MatrixXd joined(rows, blocks.front().cols());
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (static_cast<int>(i) == left_out) continue;
    joined.middleRows(at, blocks[i].rows()) = blocks[i];
    at += blocks[i].rows();
  }
  return compress(joined.leftCols(joined.cols() - 1), joined.col(joined.cols() - 1));
}

std::vector<Eigen::MatrixXd> joinOthers(const std::vector<Eigen::MatrixXd>& blocks) {
  const std::size_t count = blocks.size();
  std::vector<Eigen::MatrixXd> before(count), after(count), others(count);
  before[0] = after[count - 1] = Eigen::MatrixXd(0, blocks.front().cols());
  for (std::size_t k = 1; k < count; ++k) {
    before[k] = joinBlocks({before[k - 1], blocks[k - 1]}, -1);
    after[count - 1 - k] = joinBlocks({after[count - k], blocks[count - k]}, -1);
  }
  inParallel(count, [&](std::size_t k) { others[k] = joinBlocks({before[k], after[k]}, -1); });
  return others;
}

Reduction reduce(const Eigen::MatrixXd& triangle, const std::vector<Column>& columns, const std::vector<char>& use,
                 const Prior& prior) {
  Reduction r;
  const Eigen::Index p = triangle.cols() - 1;
  r.start = prior.mean;
  r.scale = Eigen::VectorXd::Ones(p);
  r.target = triangle.col(p) - triangle.leftCols(p) * prior.mean;
  Eigen::MatrixXd scaled = triangle.leftCols(p);
  const double largest = scaled.colwise().norm().maxCoeff();
  for (int c = 0; c < static_cast<int>(p); ++c) {
    if (!columns[static_cast<std::size_t>(c)].isNonNegative()) {
      r.others.push_back(c);
      continue;
    }
    const double size = scaled.col(c).norm();
    if (size <= 1e-12 * largest || !use[static_cast<std::size_t>(c)]) {
      r.scale[c] = 0.0;
      continue;
    }
    r.scale[c] = size;
    scaled.col(c) /= size;
    r.kept.push_back(c);
  }
  const Eigen::MatrixXd kept = pickColumns(scaled, r.kept);
  const Eigen::MatrixXd units = triangle.leftCols(p) * prior.transform;
  Eigen::MatrixXd free = units;
  if (kept.cols() > 0) free -= kept * kept.householderQr().solve(units);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(free, Eigen::ComputeThinV);
  Eigen::Index count = 0;
  while (count < svd.singularValues().size() && svd.singularValues()[count] > kSilent)
    ++count;
  r.information = svd.singularValues().head(count).cwiseAbs2();
  r.singular =
      count > 0 ? Eigen::VectorXd(svd.singularValues().head(count) / svd.singularValues()[0]) : Eigen::VectorXd();
  const Eigen::MatrixXd in_columns = prior.transform * svd.matrixV().leftCols(count);
  r.directions.resize(static_cast<Eigen::Index>(r.others.size()), count);
  for (std::size_t k = 0; k < r.others.size(); ++k)
    r.directions.row(static_cast<Eigen::Index>(k)) = in_columns.row(r.others[k]);
  r.design.resize(triangle.rows(), kept.cols() + count);
  r.design.leftCols(kept.cols()) = kept;
  r.design.rightCols(count) = units * svd.matrixV().leftCols(count);
  return r;
}

Eigen::VectorXd solveWithPrior(const Reduction& r, int rank, double strength) {
  const Eigen::Index kept = r.minimalRank(), pulled = rank - kept;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(r.design.rows() + pulled, rank);
  x.topRows(r.design.rows()) = r.design.leftCols(rank);
  x.bottomRightCorner(pulled, pulled).diagonal().setConstant(std::sqrt(strength));
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.rows());
  y.head(r.design.rows()) = r.target;
  const Eigen::VectorXd z = x.householderQr().solve(y);
  if (z.allFinite() && (kept == 0 || z.head(kept).minCoeff() >= 0.0)) return z;
  return boundedLeastSquares(x, y, static_cast<int>(kept));
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

Eigen::VectorXd toParameters(const Reduction& r, const Eigen::VectorXd& z) {
  Eigen::VectorXd parameters = r.start;
  const Eigen::Index kept = static_cast<Eigen::Index>(r.kept.size());
  for (Eigen::Index i = 0; i < kept; ++i) {
    const int c = r.kept[static_cast<std::size_t>(i)];
    parameters[c] += z[i] / r.scale[c];
  }
  const Eigen::Index count = z.size() - kept;
  if (count == 0) return parameters;
  const Eigen::VectorXd others = r.directions.leftCols(count) * z.tail(count);
  for (std::size_t i = 0; i < r.others.size(); ++i) {
    parameters[r.others[i]] += others[static_cast<Eigen::Index>(i)] / r.scale[r.others[i]];
  }
  return parameters;
}

}  // namespace knee_robot::identification
