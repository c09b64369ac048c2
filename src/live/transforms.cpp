// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "transforms.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace posemix::internal {

std::int64_t nanoseconds(double seconds) {
  return static_cast<std::int64_t>(std::llround(seconds * 1e9));
}

void PoseLine::add(std::int64_t stamp_ns, const SE3d& pose) {
  static_.reset();
  if (!poses_.empty() && stamp_ns < poses_.rbegin()->first - window_ns_) poses_.clear();
  poses_.insert_or_assign(stamp_ns, pose);
  poses_.erase(poses_.begin(), poses_.lower_bound(poses_.rbegin()->first - window_ns_));
}

void PoseLine::set(const SE3d& pose) {
  static_ = pose;
  poses_.clear();
}

std::optional<SE3d> PoseLine::at(std::int64_t stamp_ns, double max_gap_s) const {
  if (static_) return static_;
  const auto after = poses_.lower_bound(stamp_ns);
  if (after == poses_.end()) return std::nullopt;
  if (after->first == stamp_ns) return after->second;
  if (after == poses_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double width = static_cast<double>(after->first - before->first) * 1e-9;
  if (width > max_gap_s) return std::nullopt;
  const double share = static_cast<double>(stamp_ns - before->first) * 1e-9 / width;
  const SE3d& start = before->second;
  return SE3d::exp(share * (after->second * start.inverse()).log()) * start;
}

FrameTree::FrameTree(double window_s) : window_ns_(nanoseconds(window_s)) {}

void FrameTree::add(const std::string& parent, const std::string& child,
                    std::optional<std::int64_t> stamp_ns, const SE3d& pose) {
  auto [place, is_new] = links_.try_emplace(child, Link{parent, PoseLine(window_ns_)});
  Link& link = place->second;
  if (link.parent != parent) link = {parent, PoseLine(window_ns_)};
  if (stamp_ns) {
    link.line.add(*stamp_ns, pose);
  } else {
    link.line.set(pose);
  }
}

void FrameTree::clear() {
  std::erase_if(links_, [](const auto& link) { return !link.second.line.is_static(); });
}

std::string FrameTree::parent(const std::string& frame) const {
  const auto link = links_.find(frame);
  return link == links_.end() ? "" : link->second.parent;
}

std::vector<std::string> FrameTree::ancestors(const std::string& frame) const {
  std::vector<std::string> chain{frame};
  for (auto link = links_.find(frame); link != links_.end(); link = links_.find(chain.back())) {
    if (std::ranges::find(chain, link->second.parent) != chain.end()) return {frame};
    chain.push_back(link->second.parent);
  }
  return chain;
}

std::string FrameTree::root(const std::string& frame) const { return ancestors(frame).back(); }

std::optional<SE3d> FrameTree::at(const std::string& target, const std::string& source,
                                  std::int64_t stamp_ns, double max_gap_s) const {
  if (target == source) return SE3d();
  const std::vector<std::string> up = ancestors(source);
  const std::vector<std::string> down = ancestors(target);
  const auto shared = std::ranges::find_first_of(up, down);
  if (shared == up.end()) return std::nullopt;
  const auto below_shared = [&](const std::vector<std::string>& chain) -> std::optional<SE3d> {
    SE3d total;
    for (const std::string& frame : chain) {
      if (frame == *shared) break;
      const auto pose = links_.at(frame).line.at(stamp_ns, max_gap_s);
      if (!pose) return std::nullopt;
      total = *pose * total;
    }
    return total;
  };
  const auto of_target = below_shared(down);
  const auto of_source = below_shared(up);
  if (!of_target || !of_source) return std::nullopt;
  return of_target->inverse() * *of_source;
}

}  // namespace posemix::internal
