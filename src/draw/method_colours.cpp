// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "method_colours.hpp"

#include <algorithm>

#include "picture_colours.hpp"

namespace posemix::internal {

ChartSeries method_series(const std::string& method) {
  ChartSeries series{.label = method, .markers = true};
  const auto* const found =
      std::find_if(kMethodLooks.begin(), kMethodLooks.end(),
                   [&](const MethodLook& look) { return look.name == method; });
  if (found == kMethodLooks.end()) return series;
  series.color = found->colour == kReferenceColour
                     ? std::string(kTruthColour)
                     : object_colour(static_cast<std::size_t>(found->colour));
  if (found->dashed) series.dash = "5 3";
  return series;
}

}  // namespace posemix::internal
