// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "eigen_instances.hpp"

POSEMIX_EIGEN_DECOMPOSITIONS(, Eigen::Matrix3d);
POSEMIX_EIGEN_DECOMPOSITIONS(, posemix::Matrix6d);
POSEMIX_EIGEN_DECOMPOSITIONS(, Eigen::MatrixXd);

POSEMIX_EIGEN_PRODUCT_KERNEL();
