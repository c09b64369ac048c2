// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <span>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/lie/batch.hpp"
#include "posemix/mixture/mixture.hpp"

/// Many draws at once. Covariances are factorised once, and on SO(3) and SE(3) draws are moved by
/// vector instructions. They take the same numbers of the stream as the calls of `sample` in their
/// place, which is the reference: elements agree to 1e-13 of their size.
namespace posemix {
namespace internal {

/// Draws of one density after another.
template <class D>
class Draws {
 public:
  using Group = typename D::Group;

  explicit Draws(const D& density) : density_(&density) {}
  Group next(RandomStream& stream) const { return density_->sample(stream); }

 private:
  const D* density_;
};

template <LieGroup G>
class Draws<ConcentratedGaussian<G>> {
 public:
  explicit Draws(const ConcentratedGaussian<G>& density)
      : mean_(&density.mean()),
        root_(Eigen::LLT<typename G::TangentMatrix>(density.covariance()).matrixL()),
        white_(density.dof()) {}

  const G& mean() const { return *mean_; }
  /// L z with P = L L^T and z standard normal.
  typename G::Tangent next_tangent(RandomStream& stream) {
    stream.fill_normal(white_);
    return root_.template triangularView<Eigen::Lower>() * white_;
  }
  G next(RandomStream& stream) { return G::exp(next_tangent(stream)) * mean(); }

 private:
  const G* mean_;
  typename G::TangentMatrix root_;
  Eigen::VectorXd white_;
};

template <class D>
inline constexpr bool is_drawn_in_blocks =
    std::same_as<D, ConcentratedGaussian<SO3d>> || std::same_as<D, ConcentratedGaussian<SE3d>>;

/// `next()` gives the index of the density of the next draw.
template <class D, class Next>
std::vector<typename D::Group> samples_of(std::vector<Draws<D>>& of, std::size_t count,
                                          RandomStream& stream, const Next& next) {
  using G = typename D::Group;
  check_count(count, "count");
  std::vector<G> result;
  if constexpr (is_drawn_in_blocks<D>) {
    constexpr std::size_t kBlock = 256;
    std::array<typename G::Tangent, kBlock> tangents;
    std::array<G, kBlock> means;
    result.resize(count);
    for (std::size_t begin = 0; begin < count; begin += kBlock) {
      const std::size_t size = std::min(kBlock, count - begin);
      for (std::size_t i = 0; i < size; ++i) {
        Draws<D>& one = of[next()];
        means[i] = one.mean();
        tangents[i] = one.next_tangent(stream);
      }
      const std::span<G> block = std::span(result).subspan(begin, size);
      batch::exp(std::span<const typename G::Tangent>(tangents).first(size), block);
      batch::compose(block, std::span<const G>(means).first(size), block);
    }
  } else {
    result.reserve(count);
    for (std::size_t i = 0; i < count; ++i) result.push_back(of[next()].next(stream));
  }
  return result;
}

}  // namespace internal

/// `count` independent draws of a mixture.
template <class D>
std::vector<typename D::Group> samples(const Mixture<D>& mixture, std::size_t count,
                                       RandomStream& stream) {
  std::vector<internal::Draws<D>> of;
  of.reserve(mixture.size());
  for (const auto& component : mixture.components()) of.emplace_back(component.density);
  return internal::samples_of<D>(of, count, stream, [&] { return mixture.draw_index(stream); });
}

/// `count` independent draws of one density.
template <class D>
std::vector<typename D::Group> samples(const D& density, std::size_t count, RandomStream& stream) {
  std::vector<internal::Draws<D>> of;
  of.emplace_back(density);
  return internal::samples_of<D>(of, count, stream, [] { return std::size_t{0}; });
}

}  // namespace posemix
