// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "picture_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace posemix::internal {
namespace {

constexpr double kBoldCharacter = 0.62;  ///< width in shares of the font's size
constexpr double kPointLabelHeight = 15.0;
constexpr double kPointRoom = 5.0;
constexpr double kShortLeader = 9.0;

/// Area that two boxes share.
double overlap(const SvgBox& a, const SvgBox& b) {
  const double width = std::min(a.right(), b.right()) - std::max(a.left, b.left);
  const double height = std::min(a.bottom(), b.bottom()) - std::max(a.top, b.top);
  return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

SvgBox around(const Eigen::Vector2d& point, double room) {
  return {point.x() - room, point.y() - room, 2.0 * room, 2.0 * room};
}

/// Length of a segment within a box, by samples.
double length_within(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SvgBox& box) {
  constexpr int kSamples = 12;
  int inside = 0;
  for (int i = 1; i < kSamples; ++i) {
    const Eigen::Vector2d p = from + (to - from) * (static_cast<double>(i) / kSamples);
    const bool within =
        p.x() > box.left && p.x() < box.right() && p.y() > box.top && p.y() < box.bottom();
    inside += within ? 1 : 0;
  }
  return (to - from).norm() * inside / kSamples;
}

PlacedLabel label_at(const PointLabel& label, const Eigen::Vector2d& direction, double distance) {
  const double width =
      kBoldCharacter * kPointLabelSize * static_cast<double>(label.text.size()) + 6.0;
  const Eigen::Vector2d end = label.at + distance * direction;
  // To the side that the direction points to; in between where it points up or down.
  const double part = 0.5 * (1.0 - std::clamp(2.0 * direction.x(), -1.0, 1.0));
  const double rise = 0.5 * (1.0 - std::clamp(direction.y(), -1.0, 1.0));
  return {{end.x() - part * width, end.y() - rise * kPointLabelHeight, width, kPointLabelHeight},
          end};
}

/// What labels keep clear of, and where they are so far.
struct LabelScene {
  std::span<const PointLabel> labels;
  const SvgBox& area;
  std::span<const SvgBox> marks;
  std::vector<PlacedLabel> placed;
};

/// What is wrong with a place of a label, in pixels.
double cost_of(const LabelScene& scene, const PlacedLabel& place, std::size_t own) {
  constexpr double kOutside = 1e4;
  constexpr double kOverlap = 20.0;
  constexpr double kCrossing = 20.0;
  const Eigen::Vector2d& at = scene.labels[own].at;
  double cost = (place.leader_end - at).norm();
  const double size = place.box.width * place.box.height;
  if (overlap(place.box, scene.area) < 0.999 * size) cost += kOutside;
  for (std::size_t i = 0; i < scene.placed.size(); ++i) {
    if (i == own) continue;
    const PlacedLabel& other = scene.placed[i];
    cost += kOverlap * overlap(place.box, other.box);
    cost += kCrossing * length_within(at, place.leader_end, other.box);
    cost += kCrossing * length_within(scene.labels[i].at, other.leader_end, place.box);
  }
  for (std::size_t i = 0; i < scene.labels.size(); ++i) {
    const SvgBox point = around(scene.labels[i].at, kPointRoom);
    cost += (i == own ? 1.0 : kOverlap) * overlap(place.box, point);
    if (i != own) cost += length_within(at, place.leader_end, point);
  }
  for (const SvgBox& mark : scene.marks) cost += overlap(place.box, mark);
  return cost;
}

PlacedLabel best_place(const LabelScene& scene, std::size_t own) {
  constexpr int kDirections = 16;
  constexpr std::array kDistances{8.0, 14.0, 22.0, 32.0, 44.0, 58.0, 74.0, 92.0, 112.0, 140.0};
  PlacedLabel best{};
  double least = std::numeric_limits<double>::infinity();
  for (const double distance : kDistances) {
    for (int turn = 0; turn < kDirections; ++turn) {
      // The first is to the upper right.
      const double angle = (2.0 * std::numbers::pi / kDirections) * turn - 0.25 * std::numbers::pi;
      const PlacedLabel place =
          label_at(scene.labels[own], {std::cos(angle), std::sin(angle)}, distance);
      const double cost = cost_of(scene, place, own);
      if (cost >= least) continue;
      least = cost;
      best = place;
    }
  }
  return best;
}

}  // namespace

std::vector<PlacedLabel> place_labels(std::span<const PointLabel> labels, const SvgBox& area,
                                      std::span<const SvgBox> marks) {
  constexpr int kRounds = 3;  // the first labels do not know where the last ones are going to be
  LabelScene scene{labels, area, marks, {}};
  scene.placed.reserve(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) scene.placed.push_back(best_place(scene, i));
  for (int round = 1; round < kRounds; ++round) {
    for (std::size_t i = 0; i < labels.size(); ++i) scene.placed[i] = best_place(scene, i);
  }
  return scene.placed;
}

void draw_point_labels(SvgDocument& svg, std::span<const PointLabel> labels, const SvgBox& area,
                       std::span<const SvgBox> marks) {
  const std::vector<PlacedLabel> placed = place_labels(labels, area, marks);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool is_beside = (placed[i].leader_end - labels[i].at).norm() < kShortLeader;
    if (is_beside) continue;
    svg.line(labels[i].at, placed[i].leader_end, {.stroke = labels[i].colour, .width = 0.9});
  }
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const SvgBox& box = placed[i].box;
    svg.text({box.left + 3.0, box.bottom() - 3.5}, labels[i].text,
             {.size = kPointLabelSize, .fill = labels[i].colour, .bold = true, .halo = true});
  }
}

}  // namespace posemix::internal
