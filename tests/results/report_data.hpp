// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <zlib.h>
#include <nlohmann/json.hpp>

/// Unpacks the trace of a report, as docs/formats.md describes it.
namespace posemix::testing {

inline std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFFU);
  }
  return bytes;
}

/// Values by frame, then by component, of every column.
class ReportTrace {
 public:
  explicit ReportTrace(const nlohmann::json& trace) : trace_(trace) {
    const auto frames = trace["frames"].get<std::size_t>();
    std::size_t size = 0;
    for (const auto& column : trace["columns"]) size += frames * width(column) * bytes_of(column);
    const std::string stream = from_base64(trace["data"]);
    std::string data(size + 1, '\0');  // one more than there should be
    uLongf got = data.size();
    if (uncompress(reinterpret_cast<Bytef*>(data.data()), &got,
                   reinterpret_cast<const Bytef*>(stream.data()), stream.size()) != Z_OK ||
        got != size) {
      throw std::runtime_error("the data has another size than its columns");
    }
    const char* at = data.data();
    for (const auto& column : trace["columns"]) {
      if (!columns_.try_emplace(column["name"], values(column, frames, at)).second) {
        throw std::runtime_error("a column twice");
      }
    }
  }

  using Column = std::vector<std::vector<double>>;

  const std::map<std::string, Column>& columns() const { return columns_; }
  bool has(const std::string& name) const { return columns_.contains(name); }
  const Column& operator[](const std::string& name) const { return columns_.at(name); }
  bool masked(const std::string& name, std::size_t frame, unsigned bit) const {
    return (static_cast<unsigned>(columns_.at(name)[frame][0]) >> bit & 1U) != 0;
  }
  const nlohmann::json& header(const std::string& name) const {
    for (const auto& column : trace_["columns"]) {
      if (column["name"] == name) return column;
    }
    throw std::runtime_error("no column " + name);
  }

 private:
  static std::size_t width(const nlohmann::json& column) { return column["width"]; }
  static std::size_t bytes_of(const nlohmann::json& column) {
    return column["type"] == "uint8" ? 1 : column["type"] == "int32" ? 4 : 2;
  }

  static double value(const nlohmann::json& column, std::uint32_t integer) {
    if (!column["fold"]) throw std::runtime_error("a column that is not folded");
    const double scale = column["scale"];
    double q = integer;
    if (column["type"] == "int16") q = static_cast<std::int16_t>(integer);
    if (column["type"] == "int32") q = static_cast<std::int32_t>(integer);
    if (column["type"] == "uint16") q = static_cast<std::uint16_t>(integer);
    if (column["type"] == "uint8") q = static_cast<std::uint8_t>(integer);
    return column["map"] == "exp" ? std::exp(scale * q) : scale * q;
  }

  static Column values(const nlohmann::json& column, std::size_t frames, const char*& at) {
    Column result(frames, std::vector<double>(width(column)));
    for (std::size_t i = 0; i < width(column); ++i) {
      std::uint32_t integer = 0;
      for (std::size_t k = 0; k < frames; ++k) {
        std::uint32_t folded = 0;
        for (std::size_t byte = 0; byte < bytes_of(column); ++byte) {
          folded |= static_cast<std::uint32_t>(static_cast<unsigned char>(at[byte * frames + k]))
                    << 8 * byte;
        }
        integer += folded % 2 == 0 ? folded / 2 : ~(folded / 2);
        result[k][i] = value(column, integer);
      }
      at += frames * bytes_of(column);
    }
    return result;
  }

  nlohmann::json trace_;
  std::map<std::string, Column> columns_;
};

}  // namespace posemix::testing
