// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/wasserstein.hpp"

#include <cstdint>

#include <fmt/format.h>
#include <Eigen/SVD>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/successive_shortest_path_nonnegative_weights.hpp>

#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

/// With integers the reduced costs of the shortest-path algorithm cannot become negative by
/// rounding.
using Whole = std::int64_t;
constexpr double kUnit = 0x1p40;
/// Beyond it the unit of costs is no normal number.
constexpr double kLargestCost = 1e300;

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using EdgeProperties =
    boost::property<boost::edge_capacity_t, Whole,
                    boost::property<boost::edge_residual_capacity_t, Whole,
                                    boost::property<boost::edge_reverse_t, Traits::edge_descriptor,
                                                    boost::property<boost::edge_weight_t, Whole>>>>;
using Network = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS,
                                      boost::no_property, EdgeProperties>;

Traits::edge_descriptor add_pipe(Network& network, std::size_t from, std::size_t to, Whole capacity,
                                 Whole cost) {
  const auto pipe = boost::add_edge(from, to, network).first;
  const auto back = boost::add_edge(to, from, network).first;
  boost::put(boost::edge_capacity, network, pipe, capacity);
  boost::put(boost::edge_capacity, network, back, 0);
  boost::put(boost::edge_weight, network, pipe, cost);
  boost::put(boost::edge_weight, network, back, -cost);
  boost::put(boost::edge_reverse, network, pipe, back);
  boost::put(boost::edge_reverse, network, back, pipe);
  return pipe;
}

/// The weights in units of 2^-40 of their sum; the largest absorbs the rounding errors.
std::vector<Whole> whole_weights(const Eigen::VectorXd& weights) {
  std::vector<Whole> whole(static_cast<std::size_t>(weights.size()));
  const double total = weights.sum();
  auto left = static_cast<Whole>(kUnit);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    whole[i] = std::llround(kUnit * weights[static_cast<Eigen::Index>(i)] / total);
    left -= whole[i];
  }
  *std::ranges::max_element(whole) += left;
  return whole;
}

}  // namespace

double squared_wasserstein(const Eigen::VectorXd& d, const Eigen::MatrixXd& p,
                           const Eigen::MatrixXd& q) {
  // The trace is the least |A - B U|^2 over orthogonal U, with P = A A^T and Q = B B^T; in this
  // form no digits cancel if P and Q are close.
  const Eigen::MatrixXd a = Eigen::LLT<Eigen::MatrixXd>(p).matrixL();
  const Eigen::MatrixXd b = Eigen::LLT<Eigen::MatrixXd>(q).matrixL();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(b.transpose() * a,
                                           Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::MatrixXd turn = svd.matrixU() * svd.matrixV().transpose();
  return d.squaredNorm() + (a - b * turn).squaredNorm();
}

double transport_cost(const Eigen::VectorXd& rows, const Eigen::VectorXd& columns,
                      const Eigen::MatrixXd& cost) {
  const std::vector<Whole> supply = whole_weights(rows);
  const std::vector<Whole> demand = whole_weights(columns);
  const double largest = cost.maxCoeff();
  if (!cost.allFinite() || !(largest < kLargestCost)) {
    throw InvalidInput(fmt::format(
        "mixture_wasserstein: components are {:g} apart, squared, expected less than {:g}: nearer "
        "positions, or a smaller length scale",
        largest, kLargestCost));
  }
  const double cost_unit = largest > 0.0 ? kUnit / largest : 0.0;
  const std::size_t source = supply.size() + demand.size();
  const std::size_t sink = source + 1;
  Network network(sink + 1);
  for (std::size_t i = 0; i < supply.size(); ++i) add_pipe(network, source, i, supply[i], 0);
  for (std::size_t j = 0; j < demand.size(); ++j) {
    add_pipe(network, supply.size() + j, sink, demand[j], 0);
  }
  std::vector<Traits::edge_descriptor> pipes;
  for (std::size_t i = 0; i < supply.size(); ++i) {
    for (std::size_t j = 0; j < demand.size(); ++j) {
      const double c = cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      pipes.push_back(add_pipe(network, i, supply.size() + j, std::min(supply[i], demand[j]),
                               std::llround(cost_unit * c)));
    }
  }
  boost::successive_shortest_path_nonnegative_weights(network, source, sink);
  double sum = 0.0;
  for (std::size_t k = 0; k < pipes.size(); ++k) {
    const Whole moved = boost::get(boost::edge_capacity, network, pipes[k]) -
                        boost::get(boost::edge_residual_capacity, network, pipes[k]);
    sum += static_cast<double>(moved) / kUnit *
           cost(static_cast<Eigen::Index>(k / demand.size()),
                static_cast<Eigen::Index>(k % demand.size()));
  }
  return sum;
}

}  // namespace posemix::internal

namespace posemix {

POSEMIX_WASSERSTEIN(, SO3d);
POSEMIX_WASSERSTEIN(, SE3d);
POSEMIX_WASSERSTEIN(, PoseStackd);
POSEMIX_WASSERSTEIN(, Rnd<3>);

}  // namespace posemix
