// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "mat_file.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string_view>

#include <matio.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kMatHeader = 128;

struct CloseMat {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

/// Checked here because matio also accepts other formats, even HDF5, and files that are not MATLAB
/// files.
void check_mat_header(const std::filesystem::path& path) {
  std::array<char, kMatHeader> header{};
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InvalidInput(path.string() + ": cannot be read");
  file.read(header.data(), header.size());
  const std::string_view version(header.data() + 124, 2);
  const std::string_view order(header.data() + 126, 2);
  using std::string_view_literals::operator""sv;
  const bool little = version == "\0\1"sv && order == "IM";
  const bool big = version == "\1\0"sv && order == "MI";
  if (file.gcount() == std::streamsize{kMatHeader} && (little || big)) return;
  throw InvalidInput(
      fmt::format("{}: got no MATLAB file of version 5, expected one", path.string()));
}

template <typename Number>
std::vector<double> numbers_of(const matvar_t& variable, std::size_t count) {
  const auto* first = static_cast<const Number*>(variable.data);
  std::vector<double> numbers;
  numbers.reserve(count);
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(static_cast<double>(first[i]));
  return numbers;
}

/// The numbers of a variable; empty if it is not an array of numbers.
std::optional<std::vector<double>> numbers_of_class(const matvar_t& variable, std::size_t count) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return numbers_of<double>(variable, count);
    case MAT_C_SINGLE:
      return numbers_of<float>(variable, count);
    case MAT_C_INT8:
      return numbers_of<std::int8_t>(variable, count);
    case MAT_C_UINT8:
      return numbers_of<std::uint8_t>(variable, count);
    case MAT_C_INT16:
      return numbers_of<std::int16_t>(variable, count);
    case MAT_C_UINT16:
      return numbers_of<std::uint16_t>(variable, count);
    case MAT_C_INT32:
      return numbers_of<std::int32_t>(variable, count);
    case MAT_C_UINT32:
      return numbers_of<std::uint32_t>(variable, count);
    default:
      return std::nullopt;
  }
}

}  // namespace

struct MatFile::Handle {
  std::unique_ptr<mat_t, CloseMat> file;
};

MatFile::MatFile(const std::filesystem::path& path) : name_(path.string()) {
  check_mat_header(path);
  handle_ = std::make_unique<Handle>();
  handle_->file.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!handle_->file)
    throw InvalidInput(fmt::format("{}: got a damaged file, expected a MATLAB file", name_));
}

MatFile::~MatFile() = default;

void MatFile::fail(const std::string& name, const std::string& got,
                   const std::string& expected) const {
  throw InvalidInput(
      fmt::format("{}: variable '{}': got {}, expected {}", name_, name, got, expected));
}

bool MatFile::has(const std::string& name) const {
  return Variable(Mat_VarReadInfo(handle_->file.get(), name.c_str())) != nullptr;
}

MatArray MatFile::array(const std::string& name, std::size_t most) const {
  const Variable variable(Mat_VarReadInfo(handle_->file.get(), name.c_str()));
  if (!variable) fail(name, "none", "an array of numbers");
  if (variable->rank < 1 || variable->dims == nullptr) fail(name, "no size", "an array");
  MatArray result;
  result.dims.assign(variable->dims, variable->dims + variable->rank);
  std::size_t count = 1;
  for (const std::size_t dim : result.dims) {
    if (dim > most || (count *= dim) > most)
      fail(name, describe_dims(result.dims) + " numbers", fmt::format("at most {}", most));
  }
  if (variable->isComplex != 0) fail(name, "complex numbers", "real ones");
  const int status = Mat_VarReadDataAll(handle_->file.get(), variable.get());
  const bool fits = variable->data != nullptr && variable->data_size > 0 &&
                    variable->nbytes >= count * static_cast<std::size_t>(variable->data_size);
  if (count > 0 && (status != 0 || !fits)) fail(name, "damaged data", "numbers");
  auto numbers = count == 0 ? std::vector<double>() : numbers_of_class(*variable, count);
  if (!numbers) fail(name, "something else", "an array of numbers");
  result.values = std::move(*numbers);
  for (const double number : result.values)
    if (!std::isfinite(number)) fail(name, fmt::format("the number {}", number), "finite ones");
  return result;
}

std::string describe_dims(const std::vector<std::size_t>& dims) {
  return fmt::format("{}", fmt::join(dims, "x"));
}

}  // namespace posemix::internal
