#pragma once

#include <Eigen/QR>
#include <Eigen/SVD>

// Eigen's decompositions of a MatrixXd are compiled once, in src/mechanism/decompositions.cpp: each costs seconds of
// compilation wherever it is used. Part of the rooms' precompiled header (cmake/precompiled.cmake).
extern template class Eigen::HouseholderQR<Eigen::MatrixXd>;
extern template void Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>>::computeInPlace();
extern template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
extern template class Eigen::JacobiSVD<Eigen::MatrixXd>;
extern template class Eigen::BDCSVD<Eigen::MatrixXd>;
