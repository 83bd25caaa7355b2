#include "knee_robot/mechanism/decompositions.h"

template class Eigen::HouseholderQR<Eigen::MatrixXd>;
template void Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>>::computeInPlace();
template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
template class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
template class Eigen::JacobiSVD<Eigen::MatrixXd>;
template class Eigen::BDCSVD<Eigen::MatrixXd>;
