// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "study.hpp"
#include "study/recordings/recordings.hpp"

namespace posemix {

enum class YcbvKind { detector, odometry, filter, published_offline };

/// A method of the study, ready to be applied.
struct YcbvMethod {
  std::string name;
  YcbvKind kind = YcbvKind::filter;
  bool published = false;              ///< the sequence file is the profile of that name
  bool paper_noise = false;            ///< on DOPE: the profile's noise model `gaussian`
  std::vector<std::string> overrides;  ///< changes to the profile

  bool fits(const Recording& recording) const;
};

/// @throws InvalidInput for an unknown name
YcbvMethod find_ycbv_method(const std::string& name);

/// The job that runs the method on the recording.
SlamJob read_ycbv_job(const YcbvStudySettings& settings, const Recording& recording,
                      const YcbvMethod& method);

}  // namespace posemix
