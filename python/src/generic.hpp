// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "density.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/reduction/reduce.hpp"

/// Results that are templates in C++ and generic classes in Python: their densities and mixtures
/// are objects of the package's classes.
namespace posemix::python {

struct AnyProductMode {
  nb::object density;
  double log_overlap = 0.0;
};

struct AnyFusion {
  nb::object density;
  double log_overlap = 0.0;
  bool converged = false;
  std::optional<int> iterations;
  std::optional<AnyProductMode> second;
};

struct AnyMoments {
  nb::object density;
  bool converged = false;
  int iterations = 0;
  double residual = 0.0;
};

struct AnyMerge {
  nb::object density;
  double log_weight = 0.0;
  bool converged = false;
};

struct AnyReduction {
  nb::object mixture;
  ReductionReport report;
};

struct AnyConversion {
  nb::object mixture;
  double kl_lost = 0.0;
  double kl_error = 0.0;
  double largest_component_kl = 0.0;
  std::size_t components_split = 0;
  bool converged = false;
  bool within_limit = false;
};

struct AnyEmResult {
  nb::object mixture;
  double log_likelihood = 0.0;
  std::vector<double> history;
  EmStatus status = EmStatus::converged;
  std::size_t parameters = 0;
  double bic = 0.0;
  int starts = 0;
};

struct AnyBicSelection {
  std::vector<AnyEmResult> fits;
  std::size_t best = 0;
};

}  // namespace posemix::python
