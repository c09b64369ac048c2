// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "draw/method_colours.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/draw/chart.hpp"
#include "study/engine/table.hpp"
#include "trial.hpp"

namespace posemix {
namespace {

constexpr std::size_t kStateDof = 12;
constexpr std::size_t kRelativeDof = 6;

struct Quantity {
  std::string_view name;
  std::string_view axis;
  std::size_t dof;  ///< degrees of freedom of a normalised squared error; 0: an error in degrees
};

/// The quantities in the order of an item's numbers, which end with the processor time.
constexpr std::array<Quantity, 4> kQuantities{
    {{"robot_rotation_rmse_deg", "robot, rotation [deg]", 0},
     {"object_rotation_rmse_deg", "object, rotation [deg]", 0},
     {"anees", "ANEES", kStateDof},
     {"relative_nees", "NEES of the relative pose", kRelativeDof}}};
constexpr std::size_t kSeconds = kQuantities.size();

/// values(level, method, quantity): one number per run.
class Values {
 public:
  Values(const MonteCarloStudySettings& settings, std::span<const std::string> results)
      : methods_(settings.methods.size()),
        values_(settings.noise_exponents.size() * methods_ * (kSeconds + 1)) {
    for (std::size_t item = 0; item < results.size(); ++item) {
      const std::size_t level = item / settings.runs;
      const auto rows = nlohmann::json::parse(results[item]);
      for (std::size_t method = 0; method < methods_; ++method) {
        for (std::size_t q = 0; q <= kSeconds; ++q) {
          values_[index(level, method, q)].push_back(rows.at(method).at(q).get<double>());
        }
      }
    }
  }

  const std::vector<double>& operator()(std::size_t level, std::size_t method,
                                        std::size_t quantity) const {
    return values_[index(level, method, quantity)];
  }

 private:
  std::size_t index(std::size_t level, std::size_t method, std::size_t quantity) const {
    return (level * methods_ + method) * (kSeconds + 1) + quantity;
  }

  std::size_t methods_;
  std::vector<std::vector<double>> values_;
};

StudyTable main_table(const MonteCarloStudySettings& settings, const Values& values) {
  std::vector<std::string> columns{"method", "noise_exponent"};
  for (const Quantity& quantity : kQuantities) {
    columns.emplace_back(quantity.name);
    columns.push_back(fmt::format("{}_standard_error", quantity.name));
    if (quantity.dof == 0) continue;
    columns.push_back(fmt::format("{}_band_low", quantity.name));
    columns.push_back(fmt::format("{}_band_high", quantity.name));
  }
  columns.emplace_back("runs");
  StudyTable table(columns);
  for (std::size_t method = 0; method < settings.methods.size(); ++method) {
    for (std::size_t level = 0; level < settings.noise_exponents.size(); ++level) {
      std::vector<Cell> row{settings.methods[method], settings.noise_exponents[level]};
      for (std::size_t q = 0; q < kQuantities.size(); ++q) {
        const MeanWithError mean = mean_with_error(values(level, method, q));
        row.insert(row.end(), {mean.mean, mean.standard_error});
        if (kQuantities[q].dof == 0) continue;
        const auto band = chi_square_band(settings.runs, kQuantities[q].dof);
        row.insert(row.end(), {band.first, band.second});
      }
      row.emplace_back(static_cast<std::int64_t>(settings.runs));
      table.add(std::move(row));
    }
  }
  return table;
}

/// Every pair of methods, on the same runs.
StudyTable paired_table(const MonteCarloStudySettings& settings, const Values& values) {
  StudyTable table({"method", "against", "noise_exponent", "quantity", "mean_difference",
                    "standard_error", "p_value", "runs"});
  for (std::size_t a = 0; a < settings.methods.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      for (std::size_t level = 0; level < settings.noise_exponents.size(); ++level) {
        for (std::size_t q = 0; q < kQuantities.size(); ++q) {
          const PairedTest test = paired_test(values(level, a, q), values(level, b, q));
          table.add({settings.methods[a], settings.methods[b], settings.noise_exponents[level],
                     std::string(kQuantities[q].name), test.mean_difference, test.standard_error,
                     test.p_value, static_cast<std::int64_t>(settings.runs)});
        }
      }
    }
  }
  return table;
}

StudyTable timing_table(const MonteCarloStudySettings& settings, const Values& values) {
  StudyTable table({"method", "noise_exponent", "median_ms_per_run", "median_us_per_detection"});
  const auto detections = static_cast<double>(settings.path.detections);
  for (std::size_t method = 0; method < settings.methods.size(); ++method) {
    for (std::size_t level = 0; level < settings.noise_exponents.size(); ++level) {
      const double seconds = median(values(level, method, kSeconds));
      table.add({settings.methods[method], settings.noise_exponents[level], 1e3 * seconds,
                 1e6 * seconds / detections});
    }
  }
  return table;
}

/// A chart over the levels of noise.
Chart level_chart(const MonteCarloStudySettings& settings, std::string_view y_label) {
  return {.x_label = "odometry noise, power of ten of Q",
          .y_label = std::string(y_label),
          .log_y = true,
          .x_ticks = settings.noise_exponents};
}

/// The series of a method, a little to the side of those of others, which it may cover.
ChartSeries level_series(const MonteCarloStudySettings& settings, std::size_t method) {
  constexpr double kBetween = 0.07;
  ChartSeries series = internal::method_series(settings.methods[method]);
  const double middle = 0.5 * static_cast<double>(settings.methods.size() - 1);
  for (const double exponent : settings.noise_exponents)
    series.x.push_back(exponent + kBetween * (static_cast<double>(method) - middle));
  return series;
}

std::string quantity_figure(const MonteCarloStudySettings& settings, const Values& values) {
  std::vector<Chart> charts;
  for (std::size_t q = 0; q < kQuantities.size(); ++q) {
    const Quantity& quantity = kQuantities[q];
    Chart& chart = charts.emplace_back(level_chart(settings, quantity.axis));
    for (std::size_t method = 0; method < settings.methods.size(); ++method) {
      ChartSeries& series = chart.series.emplace_back(level_series(settings, method));
      series.bars = true;
      for (std::size_t level = 0; level < settings.noise_exponents.size(); ++level) {
        const MeanWithError mean = mean_with_error(values(level, method, q));
        series.y.push_back(mean.mean);
        series.lower.push_back(mean.mean - mean.standard_error);
        series.upper.push_back(mean.mean + mean.standard_error);
      }
    }
    if (quantity.dof == 0) continue;
    const auto band = chi_square_band(settings.runs, quantity.dof);
    chart.marks = {{band.first, "95 %"}, {band.second, "95 %"}};
  }
  return draw_charts(fmt::format("Monte-Carlo study, {} runs (simulated)", settings.runs), charts,
                     2, "Bars: one standard error of the mean over the runs; dashed: 95 % band.");
}

std::string trajectory_figure(const MonteCarloStudySettings& settings) {
  ChartSeries path{.label = "camera"};
  ChartSeries first{.label = "first camera", .markers = true};
  const MonteCarloTrial trial = simulate_trial(settings, settings.noise_exponents.front(), 0);
  const SE3d object_world = trial.true_object.inverse();
  for (const MonteCarloStep& step : trial.steps) {
    const Eigen::Vector3d at = (object_world * step.true_camera).translation();
    path.x.push_back(at.x());
    path.y.push_back(at.y());
  }
  first.x = {object_world.translation().x()};
  first.y = {object_world.translation().y()};
  return draw_chart({.title = "Simulated trajectory from above",
                     .x_label = "x [m]",
                     .y_label = "y [m]",
                     .series = {path, first, {.label = "object", .x = {0}, .y = {0}}},
                     .equal_axes = true});
}

std::string timing_figure(const MonteCarloStudySettings& settings, const Values& values) {
  Chart chart = level_chart(settings, "median [ms]");
  chart.title = "Processor time of one run";
  for (std::size_t method = 0; method < settings.methods.size(); ++method) {
    ChartSeries& series = chart.series.emplace_back(level_series(settings, method));
    for (std::size_t level = 0; level < settings.noise_exponents.size(); ++level) {
      series.y.push_back(1e3 * median(values(level, method, kSeconds)));
    }
  }
  return draw_chart(chart);
}

std::string summary_text(const MonteCarloStudySettings& settings, const Values& values) {
  StudyTable table(
      {"method", "10^", "robot deg", "object deg", "ANEES", "relative NEES", "ms/run"});
  for (std::size_t method = 0; method < settings.methods.size(); ++method) {
    for (std::size_t level = 0; level < settings.noise_exponents.size(); ++level) {
      std::vector<Cell> row{settings.methods[method], settings.noise_exponents[level]};
      for (std::size_t q = 0; q < kQuantities.size(); ++q) {
        row.emplace_back(mean_with_error(values(level, method, q)).mean);
      }
      row.emplace_back(1e3 * median(values(level, method, kSeconds)));
      table.add(std::move(row));
    }
  }
  return table.text(4);
}

constexpr std::string_view kMonteCarloQuestion =
    "Which filter stays accurate and consistent when the noise of the odometry grows?";

/// The bands of the consistency, and the errors where the odometry is worst.
std::vector<std::string> monte_carlo_notes(const MonteCarloStudySettings& settings,
                                           const Values& values) {
  const auto band = chi_square_band(settings.runs, kStateDof);
  const auto relative = chi_square_band(settings.runs, kRelativeDof);
  std::vector<std::string> notes{
      fmt::format("95 % bands of one time: ANEES {:.3f} to {:.3f}, relative NEES {:.3f} to {:.3f}.",
                  band.first, band.second, relative.first, relative.second)};
  const std::size_t last = settings.noise_exponents.size() - 1;
  std::string errors =
      fmt::format("Rotation error of the object at 10^{:g} [deg]:", settings.noise_exponents[last]);
  for (std::size_t method = 0; method < settings.methods.size(); ++method) {
    const MeanWithError mean = mean_with_error(values(last, method, 1));
    errors +=
        fmt::format("{} {} {:.3g}", method == 0 ? "" : ",", settings.methods[method], mean.mean);
    if (std::isfinite(mean.standard_error))
      errors += fmt::format(" +- {:.1g}", mean.standard_error);
  }
  notes.push_back(errors + ".");
  return notes;
}

}  // namespace

StudyReport report_monte_carlo(const MonteCarloStudySettings& settings,
                               std::span<const std::string> results) {
  const Values values(settings, results);
  const StudyTable table = main_table(settings, values);
  const std::vector<std::string> notes = monte_carlo_notes(settings, values);
  return {{{"study.json", format_study({"monte-carlo", kMonteCarloQuestion, notes}, table)},
           {"monte-carlo.csv", table.csv()},
           {"paired.csv", paired_table(settings, values).csv()},
           {"timing.csv", timing_table(settings, values).csv()},
           {"errors.svg", quantity_figure(settings, values)},
           {"trajectory.svg", trajectory_figure(settings)},
           {"timing.svg", timing_figure(settings, values)}},
          summary_text(settings, values),
          notes};
}

}  // namespace posemix
