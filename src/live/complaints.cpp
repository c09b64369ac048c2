// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "complaints.hpp"

#include <cctype>

namespace posemix::internal {
namespace {

/// The same is not logged again within this time [s].
constexpr double kQuietS = 5.0;
constexpr double kForgottenS = 60.0;
/// Numbers of so many digits are stamps, and those with a point change from image to image, too.
constexpr std::size_t kStampDigits = 6;

std::string without_stamps(const std::string& text) {
  std::string result;
  std::string number;
  const auto end_number = [&] {
    const bool has_point = number.find('.') != std::string::npos && number.size() > 1;
    if (number.size() < kStampDigits && !has_point) result += number;
    number.clear();
  };
  for (const char c : text) {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.') {
      number += c;
    } else {
      end_number();
      result += c;
    }
  }
  end_number();
  return result;
}

}  // namespace

bool Complaints::add(const std::string& why, double now_s, bool lasts) {
  const auto [place, is_new] =
      problems_.try_emplace(without_stamps(why), Problem{why, now_s, now_s, lasts});
  Problem& problem = place->second;
  problem.why = why;
  problem.last_s = now_s;
  if (!is_new && now_s - problem.logged_s < kQuietS) return false;
  problem.logged_s = now_s;
  return true;
}

std::vector<std::string> Complaints::recent(double now_s, double within_s) {
  std::erase_if(problems_, [&](const auto& entry) {
    return !entry.second.lasts && now_s - entry.second.last_s > kForgottenS;
  });
  std::vector<std::string> found;
  for (const auto& [key, problem] : problems_) {
    if (problem.lasts || now_s - problem.last_s <= within_s) found.push_back(problem.why);
  }
  return found;
}

}  // namespace posemix::internal
