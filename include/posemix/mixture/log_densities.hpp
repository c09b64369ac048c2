// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "posemix/mixture/density_kernel.hpp"
#include "posemix/mixture/em_rows.hpp"
#include "posemix/mixture/mixture.hpp"

/// Log densities at many elements at once, by the widest vector instructions of the machine.
/// `Evaluator`, which takes one element at a time, is the reference. The two differ by the rounding
/// of both: relative to xi^T P^-1 xi, a few units in the last place times the condition number of
/// the correlations of P and times |t| over a standard deviation. The bits of a value depend on its
/// element alone, not on the others; NaN in, NaN out, but -inf of projected Gaussians, as by it.
namespace posemix {
namespace internal {

/// Several densities at the elements of one block after the other.
template <class D>
requires HasKernel<D>
class DensityBlocks {
 public:
  using Group = typename D::Group;

  void add(const D& density) {
    kernels_.push_back(kernel_of(density));
    terms_.emplace_back();
  }

  /// Calls `block(begin, count, terms)` for every block of elements, with a row of log densities of
  /// each density.
  template <class Block>
  void for_each(std::span<const Group> elements, Block&& block) {
    for (std::size_t begin = 0; begin < elements.size(); begin += kEmBlock) {
      const std::size_t count = std::min(kEmBlock, elements.size() - begin);
      const EmCoordinates samples(elements.subspan(begin, count));
      for (std::size_t k = 0; k < kernels_.size(); ++k)
        log_density_of(kernels_[k], samples.block(0), count, scratch_.data(), terms_[k]);
      block(begin, count, std::span<const EmRow>(terms_));
    }
  }

 private:
  std::vector<decltype(kernel_of(std::declval<const D&>()))> kernels_;
  std::vector<EmRow> terms_;
  std::vector<EmRow> scratch_ = std::vector<EmRow>(kPoseRows);
};

template <LieGroup G>
void check_dimensions(std::span<const G> elements, Eigen::Index dof) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i].dof() == dof) continue;
    throw InvalidInput(fmt::format("element {} has {} degrees of freedom, the density has {}", i,
                                   elements[i].dof(), dof));
  }
}

}  // namespace internal

/// Evaluates the log densities of a mixture at many elements; every component is factorised once.
/// It has memory of its own to work in, so that every thread needs one.
template <class D>
requires internal::HasKernel<D>
class BatchEvaluator {
 public:
  using Group = typename D::Group;

  explicit BatchEvaluator(const Mixture<D>& mixture) : dof_(mixture.dof()) {
    for (const auto& component : mixture.components()) {
      if (std::isinf(component.log_weight)) continue;
      log_weights_.push_back(component.log_weight);
      densities_.add(component.density);
    }
  }

  /// The log density at every element with respect to the Haar measure [nats]; -inf where there is
  /// none. There are as many results as elements.
  /// @throws InvalidInput when sizes differ, or an element of R^n has another dimension
  void log_densities(std::span<const Group> elements, std::span<double> result) {
    if (elements.size() != result.size()) {
      throw InvalidInput(fmt::format("log_densities: room for {} results of {} elements",
                                     result.size(), elements.size()));
    }
    internal::check_dimensions(elements, dof_);
    densities_.for_each(
        elements, [&](std::size_t begin, std::size_t count, std::span<const EmRow> terms) {
          internal::log_sums(log_weights_, count, terms, sums_);
          std::copy_n(sums_.data(), count, result.begin() + static_cast<std::ptrdiff_t>(begin));
        });
  }

 private:
  Eigen::Index dof_;
  std::vector<double> log_weights_;
  internal::DensityBlocks<D> densities_;
  EmRow sums_;
};

/// The log density at every element with respect to the Haar measure [nats]; -inf where there is
/// none.
/// @throws InvalidInput when an element of R^n has another dimension
template <class D>
requires internal::HasKernel<D> std::vector<double> log_densities(
    const Mixture<D>& mixture, std::span<const typename D::Group> elements) {
  std::vector<double> result(elements.size());
  BatchEvaluator<D>(mixture).log_densities(elements, result);
  return result;
}

/// The same for one density.
/// @throws InvalidInput when an element of R^n has another dimension
template <class D>
requires internal::HasKernel<D> std::vector<double> log_densities(
    const D& density, std::span<const typename D::Group> elements) {
  internal::check_dimensions(elements, density.dof());
  internal::DensityBlocks<D> densities;
  densities.add(density);
  std::vector<double> result(elements.size());
  densities.for_each(
      elements, [&](std::size_t begin, std::size_t count, std::span<const EmRow> terms) {
        std::copy_n(terms[0].data(), count, result.begin() + static_cast<std::ptrdiff_t>(begin));
      });
  return result;
}

/// The log density of every component at every element, without the weights: element after
/// element, size() values each [nats].
/// @throws InvalidInput when an element of R^n has another dimension
template <class D>
requires internal::HasKernel<D> std::vector<double> component_log_densities(
    const Mixture<D>& mixture, std::span<const typename D::Group> elements) {
  internal::check_dimensions(elements, mixture.dof());
  internal::DensityBlocks<D> densities;
  for (const auto& component : mixture.components()) densities.add(component.density);
  const std::size_t size = mixture.size();
  std::vector<double> result(elements.size() * size);
  densities.for_each(elements,
                     [&](std::size_t begin, std::size_t count, std::span<const EmRow> terms) {
                       for (std::size_t i = 0; i < count; ++i) {
                         for (std::size_t k = 0; k < size; ++k)
                           result[(begin + i) * size + k] = terms[k][i];
                       }
                     });
  return result;
}

}  // namespace posemix
