// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "forecasts.hpp"

#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "draw/method_colours.hpp"
#include "draw/picture_colours.hpp"
#include "posemix/draw/chart.hpp"

/// Is the probability of the mode calibrated?
namespace posemix {
namespace {

/// Sums over the frames of one bin, every object of a recording with weight one.
struct ForecastBin {
  double weight = 0.0;
  double probability = 0.0;
  double right = 0.0;
};

using ForecastBins = std::array<ForecastBin, kForecastBins>;

double number_at(const std::vector<Cell>& row, std::size_t column) {
  return std::get<double>(row[column]);
}

std::string text_at(const std::vector<Cell>& row, std::size_t column) {
  return std::get<std::string>(row[column]);
}

/// Bins by detector and method.
std::map<std::pair<std::string, std::string>, ForecastBins> bins_of(
    std::span<const std::vector<Cell>> forecasts) {
  const auto track = [](const std::vector<Cell>& row) {
    return text_at(row, 0) + "/" + text_at(row, 1) + "/" + text_at(row, 2) + "/" + text_at(row, 3);
  };
  std::map<std::string, double> frames;
  for (const auto& row : forecasts) frames[track(row)] += number_at(row, 5);
  std::map<std::pair<std::string, std::string>, ForecastBins> result;
  for (const auto& row : forecasts) {
    const double weight = 1.0 / frames[track(row)];
    for (const std::string& detector : {text_at(row, 2), std::string("all")}) {
      const auto bin = static_cast<std::size_t>(std::get<std::int64_t>(row[4]));
      ForecastBin& sum = result[{detector, text_at(row, 3)}][bin];
      sum.weight += weight * number_at(row, 5);
      sum.probability += weight * number_at(row, 6);
      sum.right += weight * number_at(row, 7);
    }
  }
  return result;
}

/// Mean distance of probability and share of right answers over the bins.
double calibration_error(const ForecastBins& bins) {
  double error = 0.0;
  double total = 0.0;
  for (const ForecastBin& bin : bins) {
    error += std::abs(bin.probability - bin.right);
    total += bin.weight;
  }
  return total > 0.0 ? error / total : 0.0;
}

}  // namespace

std::vector<StudyFile> report_forecasts(std::span<const std::vector<Cell>> forecasts) {
  if (forecasts.empty()) return {};
  StudyTable table({"detector", "method", "bin", "weight", "mean_probability", "right_share",
                    "calibration_error"});
  Chart chart{.title = "all recordings",
              .x_label = "probability of the mode",
              .y_label = "share on the right mode",
              .x_range = std::pair(0.0, 1.0)};
  ChartSeries diagonal{
      .label = "calibrated", .color = std::string(internal::kTruthColour), .dash = "5 4"};
  diagonal.x = {0.0, 1.0};
  diagonal.y = {0.0, 1.0};
  chart.series.push_back(std::move(diagonal));
  for (const auto& [key, bins] : bins_of(forecasts)) {
    const auto& [detector, method] = key;
    const double error = calibration_error(bins);
    ChartSeries series = internal::method_series(method);
    series.label = fmt::format("{}, {} (error {:.3f})", detector, method, error);
    for (std::size_t bin = 0; bin < kForecastBins; ++bin) {
      const ForecastBin& sum = bins[bin];
      if (sum.weight <= 0.0) continue;
      series.x.push_back(sum.probability / sum.weight);
      series.y.push_back(sum.right / sum.weight);
      table.add({detector, method, static_cast<std::int64_t>(bin), sum.weight, series.x.back(),
                 series.y.back(), error});
    }
    if (detector == "all") chart.series.push_back(std::move(series));
  }
  const std::vector<Chart> charts{std::move(chart)};
  return {{"reliability.csv", table.csv()},
          {"reliability.svg",
           draw_charts("How often the mode is right, against its probability", charts, 1)}};
}

}  // namespace posemix
