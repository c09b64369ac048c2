// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "posemix/base/error.hpp"
#include "posemix/lie/batch_rows.hpp"
#include "posemix/lie/lie.hpp"

/// Conversions between numpy arrays and elements of groups. Poses are rows [tx, ty, tz, qx, qy, qz,
/// qw], rotations rows [qx, qy, qz, qw].
namespace posemix::python {

namespace nb = nanobind;
using namespace nb::literals;  // NOLINT(google-build-using-namespace)

/// Rows of numbers; an array that is not C-contiguous or not of doubles is copied.
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
/// Square matrices, one after the other.
using Matrices = nb::ndarray<const double, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Array = nb::ndarray<nb::numpy, double>;

/// The number of entries of an array.
/// @throws std::bad_alloc when there is no such number
inline std::size_t entries(const std::vector<std::size_t>& shape) {
  std::size_t product = 1;
  for (const std::size_t length : shape) {
    if (length != 0 && product > std::numeric_limits<std::size_t>::max() / length)
      throw std::bad_alloc();
    product *= length;
  }
  return product;
}

/// A new array, which owns its memory. It is made with the interpreter's lock held and filled
/// without.
struct NewArray {
  double* data;
  Array array;

  explicit NewArray(const std::vector<std::size_t>& shape)
      : NewArray(shape, new double[entries(shape)]) {}

 private:
  NewArray(const std::vector<std::size_t>& shape, double* memory)
      : data(memory),
        array(memory, shape.size(), shape.data(),
              nb::capsule(memory, [](void* p) noexcept { delete[] static_cast<double*>(p); })) {}
};

/// The layout of an element of a group in an array.
template <class G>
struct Wire;

template <>
struct Wire<SO3d> {
  static constexpr std::size_t kSize = 4;
  static constexpr std::size_t kDof = 3;
  static constexpr std::size_t kSide = 3;  ///< side of the rotation matrix
  static SO3d read(const double* p) {
    return SO3d::from_stored_quaternion(Eigen::Quaterniond(p[3], p[0], p[1], p[2]));
  }
  static void write(const SO3d& rotation, double* p) {
    const Eigen::Quaterniond& q = rotation.quaternion();
    p[0] = q.x();
    p[1] = q.y();
    p[2] = q.z();
    p[3] = q.w();
  }
};

template <>
struct Wire<SE3d> {
  static constexpr std::size_t kSize = 7;
  static constexpr std::size_t kDof = 6;
  static constexpr std::size_t kSide = 4;
  static SE3d read(const double* p) {
    return {Wire<SO3d>::read(p + 3), Eigen::Vector3d(p[0], p[1], p[2])};
  }
  static void write(const SE3d& pose, double* p) {
    Eigen::Map<Eigen::Vector3d> translation(p);
    translation = pose.translation();
    Wire<SO3d>::write(pose.rotation(), p + 3);
  }
};

inline void require_columns(const Rows& rows, std::size_t columns, const char* name) {
  if (rows.shape(1) != columns) {
    throw InvalidInput(fmt::format("{} has shape ({}, {}); expected ({}, {})", name, rows.shape(0),
                                   rows.shape(1), rows.shape(0), columns));
  }
}

/// Poses in the rows of an array; a single one is used for all.
inline internal::ConstPoseRows pose_rows_in(const Rows& x) {
  return {x.data() + 3, x.data(), x.shape(0) == 1 ? 0U : 7U};
}
inline internal::MutablePoseRows pose_rows_out(const NewArray& x) {
  return {x.data + 3, x.data, 7};
}

/// The elements in the rows of an array.
template <class G>
std::vector<G> elements_of(const Rows& rows, const char* name) {
  require_columns(rows, Wire<G>::kSize, name);
  std::vector<G> elements;
  elements.reserve(rows.shape(0));
  for (std::size_t i = 0; i < rows.shape(0); ++i)
    elements.push_back(Wire<G>::read(rows.data() + i * Wire<G>::kSize));
  return elements;
}

template <class G>
G element_of(const Numbers& row) {
  if (row.shape(0) != Wire<G>::kSize) {
    throw InvalidInput(
        fmt::format("element of {} numbers; expected {}", row.shape(0), Wire<G>::kSize));
  }
  return Wire<G>::read(row.data());
}

template <class G>
Array array_of(const G& element) {
  NewArray result({Wire<G>::kSize});
  Wire<G>::write(element, result.data);
  return std::move(result.array);
}

template <>
inline Array array_of(const PoseStackd& stack) {
  NewArray result({stack.size(), 7});
  for (std::size_t i = 0; i < stack.size(); ++i) Wire<SE3d>::write(stack[i], result.data + 7 * i);
  return std::move(result.array);
}

void bind_random(nb::module_& m);
void bind_lie(nb::module_& m);
void bind_density(nb::module_& m);
void bind_density_batches(nb::module_& m);
void bind_mixture(nb::module_& m);
void bind_reduction(nb::module_& m);
void bind_divergence(nb::module_& m);
void bind_em(nb::module_& m);
void bind_report(nb::module_& m);
void bind_grasp(nb::module_& m);
void bind_tolerance(nb::module_& m);
void bind_errors(nb::module_& m);
void bind_error_fit(nb::module_& m);
void bind_scores(nb::module_& m);
void bind_symmetry(nb::module_& m);
void bind_noise(nb::module_& m);
void bind_noise_fit(nb::module_& m);
void bind_odometry_noise(nb::module_& m);
void bind_existence(nb::module_& m);
void bind_multi_object_settings(nb::module_& m);
void bind_multi_object_filter(nb::module_& m);
void bind_gaussian_sum_filter(nb::module_& m);
void bind_slam_settings(nb::module_& m);
void bind_observation(nb::module_& m);
void bind_sequence(nb::module_& m);
void bind_frame_estimate(nb::module_& m);
void bind_frame_input(nb::module_& m);
void bind_stamped_slam(nb::module_& m);
void bind_slam_state(nb::module_& m);
void bind_relocalise(nb::module_& m);
void bind_slam(nb::module_& m);
void bind_smoother(nb::module_& m);
void bind_association(nb::module_& m);
void bind_consistency(nb::module_& m);
void bind_fuse_views(nb::module_& m);
void bind_slam_run(nb::module_& m);
void bind_evaluation(nb::module_& m);
void bind_simulation(nb::module_& m);
void bind_simulation_motion(nb::module_& m);
void bind_jobs(nb::module_& m);
void bind_fiducials(nb::module_& m);
void bind_files(nb::module_& m);
void bind_mixture_files(nb::module_& m);

}  // namespace posemix::python
