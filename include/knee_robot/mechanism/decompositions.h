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
// What each solves, for one right side and for several.
extern template void Eigen::HouseholderQR<Eigen::MatrixXd>::_solve_impl(const Eigen::VectorXd&, Eigen::VectorXd&) const;
extern template void Eigen::HouseholderQR<Eigen::MatrixXd>::_solve_impl(const Eigen::MatrixXd&, Eigen::MatrixXd&) const;
extern template void Eigen::ColPivHouseholderQR<Eigen::MatrixXd>::_solve_impl(const Eigen::VectorXd&,
                                                                              Eigen::VectorXd&) const;
extern template void Eigen::ColPivHouseholderQR<Eigen::MatrixXd>::_solve_impl(const Eigen::MatrixXd&,
                                                                              Eigen::MatrixXd&) const;
extern template void Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>::_solve_impl(const Eigen::VectorXd&,
                                                                                          Eigen::VectorXd&) const;
extern template void Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>::_solve_impl(const Eigen::MatrixXd&,
                                                                                          Eigen::MatrixXd&) const;
