// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Writes the numbers that all programs read: inputs FOLDER. Drawn by a Mersenne twister, whose bits
// are the same everywhere; distances of poses are as in tracking, a fraction of a radian and of a
// metre.
#include <cmath>
#include <fstream>
#include <iostream>
#include <numbers>
#include <random>
#include <string>

#include "dense_lie.hpp"

namespace {

using dense::RowMajor;
using Matrix3 = dense::Matrix3<double>;
using Matrix6 = dense::Matrix6<double>;
using Pose = dense::Pose<double>;
using Vector3 = dense::Vector3<double>;
using Vector6 = dense::Vector6<double>;
using Numbers = std::vector<double>;

constexpr double kDegree = std::numbers::pi / 180.0;

class Writer {
 public:
  explicit Writer(std::string folder) : folder_(std::move(folder)) {}

  void write(const std::string& name, const Numbers& numbers) const {
    std::ofstream file(folder_ + "/" + name + ".f64", std::ios::binary);
    file.write(reinterpret_cast<const char*>(numbers.data()),
               static_cast<std::streamsize>(numbers.size() * sizeof(double)));
    if (!file) throw std::runtime_error("cannot write " + folder_ + "/" + name + ".f64");
  }

 private:
  std::string folder_;
};

/// Normal deviates by Box and Muller's formula: std::normal_distribution is not the same in all
/// libraries.
class Normal {
 public:
  double operator()() {
    const double u = (static_cast<double>(twister_() >> 11U) + 0.5) * 0x1p-53;
    const double v = static_cast<double>(twister_() >> 11U) * 0x1p-53;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }
  Vector6 tangent(double sd) {
    Vector6 xi;
    for (double& x : xi) x = sd * (*this)();
    return xi;
  }
  /// Full rank, with all correlations.
  Eigen::MatrixXd covariance(Eigen::Index n, double sd) {
    Eigen::MatrixXd root(n, n);
    for (double& x : root.reshaped()) x = (*this)();
    const double variance = sd * sd;
    return variance / static_cast<double>(n) * root * root.transpose() +
           0.1 * variance * Eigen::MatrixXd::Identity(n, n);
  }

 private:
  std::mt19937_64 twister_{19};
};

void write_hypotheses(const Writer& writer, Normal& normal, const std::string& name, int count,
                      int poses, double distance, double sd) {
  std::vector<Pose> centre;
  for (int i = 0; i < poses; ++i) centre.push_back(dense::exp(normal.tangent(0.5)));
  Numbers weights;
  Numbers means;
  Numbers covariances;
  for (int k = 0; k < count; ++k) {
    weights.push_back((k + 1.0) / (0.5 * count * (count + 1.0)));
    for (const Pose& pose : centre)
      dense::append(means, dense::exp(normal.tangent(distance)) * pose);
    dense::append(covariances, normal.covariance(6 * poses, sd));
  }
  writer.write(name + "_weights", weights);
  writer.write(name + "_poses", means);
  writer.write(name + "_covariances", covariances);
  if (name != "frame") return;
  Numbers detections;
  Numbers with_outlier;
  for (int j = 1; j < poses; ++j) {
    const Pose seen = centre[0].inverse() * centre[static_cast<std::size_t>(j)];
    dense::append(detections, seen * dense::exp(normal.tangent(0.02)));
    dense::append(with_outlier, seen * dense::exp(normal.tangent(j == 3 ? 0.5 : 0.02)));
  }
  writer.write("frame_detections", detections);
  writer.write("robust_detections", with_outlier);
}

/// The noise of the published filter: 4 degrees, or 8 about one axis, and 5 mm; a step of the
/// camera.
void write_noise(const Writer& writer) {
  const double turn = std::pow(4 * kDegree, 2);
  const double move = 25e-6;
  writer.write("frame_noise_weights", {0.7, 0.3});
  writer.write("frame_noise",
               {turn, turn, turn, move, move, move, turn, turn, 4 * turn, move, move, move});
  const double step_turn = std::pow(0.5196 * kDegree, 2);
  const double step_move = std::pow(8.66e-3, 2);
  writer.write("frame_step", {step_turn, step_turn, step_turn, step_move, step_move, step_move});
}

void write_lie(const Writer& writer, Normal& normal) {
  Numbers tangents;
  Numbers poses;
  Numbers covariances;
  Numbers angles;
  Numbers others;
  for (int i = 0; i < 1024; ++i) {
    // Turned further, MRPT agrees on most products of uncertain poses, but not on all.
    Vector6 xi = normal.tangent(0.5);
    while (xi.head<3>().norm() > 1.5) xi = normal.tangent(0.5);
    const Pose pose = dense::exp(xi);
    const Matrix6 p = normal.covariance(6, 0.03);
    const Matrix6 to_angles = dense::angles_to_tangent(pose).inverse();
    tangents.insert(tangents.end(), xi.begin(), xi.end());
    dense::append(poses, pose);
    dense::append(covariances, p);
    dense::append(others, dense::exp(normal.tangent(0.03)) * pose);
    dense::append(angles, RowMajor(to_angles * p * to_angles.transpose()));
  }
  writer.write("tangents", tangents);
  writer.write("poses", poses);
  writer.write("other_poses", others);
  writer.write("covariances", covariances);
  writer.write("covariances_xyz_ypr", angles);
}

/// Section V of the midway-merge paper at 30 degrees per axis: two Gaussians of 5 and 10 degrees,
/// and their merge.
void write_divergence(const Writer& writer, const std::string& name, const Matrix3& shape,
                      double merged_sd) {
  const Vector3 far = 30 * kDegree * Vector3(1, -1, 1);
  const Vector3 middle = 0.5 * far;
  Numbers means(3, 0.0);
  for (const Vector3& mean : {far, middle}) means.insert(means.end(), mean.begin(), mean.end());
  Numbers covariances;
  for (const double sd : {5 * kDegree, 10 * kDegree})
    dense::append(covariances, RowMajor(sd * sd * shape));
  dense::append(covariances, RowMajor(merged_sd * merged_sd * shape + middle * middle.transpose()));
  writer.write(name + "_means", means);
  writer.write(name + "_covariances", covariances);
}

/// A Gaussian prior on R^6 and a measurement whose noise has two modes.
void write_hybrid(const Writer& writer, Normal& normal) {
  const auto write = [&](const std::string& name, const auto& matrix) {
    Numbers numbers;
    dense::append(numbers, matrix);
    writer.write("hybrid_" + name, numbers);
  };
  const Vector6 prior = normal.tangent(0.3);
  write("prior", prior);
  write("prior_covariance", normal.covariance(6, 0.1));
  write("measured", Vector6(prior + normal.tangent(0.3)));
  Eigen::MatrixXd noise(12, 6);
  noise << normal.covariance(6, 0.2), normal.covariance(6, 0.6);
  write("noise", noise);
}

/// A thousand densities about ten places on SE(3), to be reduced to ten.
void write_reduction(const Writer& writer, Normal& normal) {
  std::vector<Pose> places;
  for (int i = 0; i < 10; ++i) places.push_back(dense::exp(normal.tangent(0.8)));
  Numbers weights;
  Numbers means;
  Numbers covariances;
  for (std::size_t i = 0; i < 1000; ++i) {
    weights.push_back(std::exp(normal()));
    dense::append(means, dense::exp(normal.tangent(0.2)) * places[i % places.size()]);
    dense::append(covariances, normal.covariance(6, 0.07));
  }
  writer.write("reduce_weights", weights);
  writer.write("reduce_poses", means);
  writer.write("reduce_covariances", covariances);
  Numbers others;
  for (std::size_t i = 0; i < 1024; ++i)
    dense::append(others, dense::exp(normal.tangent(0.2)) * places[i % places.size()]);
  writer.write("reduce_others", others);
}

/// Ten objects in front of a camera, each seen in one of three modes by turns, in a hundred images.
void write_objects(const Writer& writer, Normal& normal) {
  Vector6 sd;
  sd << 0.05, 0.05, 0.015, 0.0025, 0.0025, 0.015;
  Numbers detections;
  for (int image = 0; image < 100; ++image) {
    for (int j = 0; j < 10; ++j) {
      Vector6 mode = Vector6::Zero();
      mode(2) = 2 * std::numbers::pi / 3 * (image % 3 - 1);
      const Pose object{Matrix3::Identity(), Vector3(0.1 * j, 0.05, 0.9)};
      dense::append(detections, object * dense::exp(mode) *
                                    dense::exp<double>(sd.cwiseProduct(normal.tangent(1))));
    }
  }
  writer.write("objects_detections", detections);
}

/// A hundred thousand vectors of seven Gaussians that overlap, and where EM starts.
void write_samples(const Writer& writer, Normal& normal) {
  std::vector<Vector6> centres;
  for (int k = 0; k < 7; ++k) centres.push_back(normal.tangent(0.3));
  Numbers samples;
  samples.reserve(600'000);
  for (std::size_t i = 0; i < 100'000; ++i) {
    const std::size_t k = i % centres.size();
    const Vector6 x = centres[k] + normal.tangent(0.1 + 0.02 * static_cast<double>(k));
    samples.insert(samples.end(), x.begin(), x.end());
  }
  Numbers means;
  for (const Vector6& centre : centres) {
    const Vector6 start = centre + normal.tangent(0.05);
    means.insert(means.end(), start.begin(), start.end());
  }
  Numbers covariances;
  for (int k = 0; k < 7; ++k) dense::append(covariances, normal.covariance(6, 0.2));
  writer.write("em_samples", samples);
  writer.write("em_means", means);
  writer.write("em_covariances", covariances);
}

}  // namespace

int main(int count, char** arguments) {
  try {
    if (count != 2) throw std::invalid_argument("usage: inputs FOLDER");
    const Writer writer(arguments[1]);
    Normal normal;
    for (const int n : {12, 36, 66, 126})
      write_hypotheses(writer, normal, "merge_" + std::to_string(n), 2, n / 6, 0.2, 0.1);
    write_hypotheses(writer, normal, "frame", 12, 6, 0.02, 0.02);
    write_noise(writer);
    write_lie(writer, normal);
    write_divergence(writer, "kl_axisymmetric", Matrix3::Identity(), 8 * kDegree);
    Matrix3 shape;
    shape << 1.0, 0.4, -0.2, 0.4, 0.6, 0.1, -0.2, 0.1, 1.3;
    write_divergence(writer, "kl_general", shape, 8 * kDegree);
    write_samples(writer, normal);
    write_reduction(writer, normal);
    write_objects(writer, normal);
    write_hybrid(writer, normal);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
