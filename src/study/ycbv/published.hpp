// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "study/recordings/recordings.hpp"

namespace posemix {

/// A published result of an offline method on one recording.
struct PublishedPixels {
  std::string method;  ///< "published: ACT"
  double pixels;       ///< the median of the pixel metric [px]
};

/// The published results for a recording, from derived/slam6d_published_table1.csv of the data
/// folder. Empty where the file is missing or lacks the recording, and for detectors other than
/// DOPE.
/// @throws InvalidInput for a file that is not valid
std::vector<PublishedPixels> published_pixels(const Recording& recording);

/// Whether rows of this method are published results.
bool is_published_offline(std::string_view method);

}  // namespace posemix
