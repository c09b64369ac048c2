// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The limits of one core: multiplications and additions of doubles per second in registers, and
// bytes read per second from each cache and from memory. Prints one JSON object.
//
// The peak is measured by chains of multiply-adds in more independent registers than the latency
// times the number of units, in assembly, so that the compiler can neither spill nor drop them. As
// a second method the same chains run with half and with a quarter of the registers: where the peak
// is reached, half of them still reach nearly as much, and a quarter less.
#include <immintrin.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "jobs.hpp"

namespace {

constexpr int kRepetitions = 9;

/// The best of several rates: what the machine can do when nothing disturbs it.
double best_rate(double work, const auto& function) {
  double best = 0.0;
  for (int i = 0; i < kRepetitions; ++i) {
    const double begin = bench::processor_seconds();
    function();
    best = std::max(best, work / (bench::processor_seconds() - begin));
  }
  return best;
}

constexpr long kRounds = 4'000'000;

#define POSEMIX_FMA_512(i) "vfmadd231pd %%zmm30, %%zmm31, %%zmm" #i "\n\t"
#define POSEMIX_FMA_256(i) "vfmadd231pd %%ymm14, %%ymm15, %%ymm" #i "\n\t"
#define POSEMIX_MUL_ADD_128(i) "mulpd %%xmm14, %%xmm" #i "\n\taddpd %%xmm15, %%xmm" #i "\n\t"

#define POSEMIX_FOUR(f) f(0) f(1) f(2) f(3)
#define POSEMIX_EIGHT(f) POSEMIX_FOUR(f) f(4) f(5) f(6) f(7)
#define POSEMIX_TWELVE(f) POSEMIX_EIGHT(f) f(8) f(9) f(10) f(11)
#define POSEMIX_SIXTEEN(f) POSEMIX_TWELVE(f) f(12) f(13) f(14) f(15)
#define POSEMIX_LOOP(body, ...)                                                              \
  {                                                                                          \
    long rounds = kRounds;                                                                   \
    asm volatile("1:\n\t" body "dec %0\n\tjnz 1b\n\t" : "+r"(rounds) : : "cc", __VA_ARGS__); \
  }

#define POSEMIX_LOW                                                                        \
  "xmm0", "xmm1", "xmm2", "xmm3", "xmm4", "xmm5", "xmm6", "xmm7", "xmm8", "xmm9", "xmm10", \
      "xmm11", "xmm12", "xmm13", "xmm14", "xmm15"

__attribute__((target("avx512f"))) double avx512(int chains) {
  const double work = static_cast<double>(kRounds) * chains * 16;
  return best_rate(
      work, [&]() __attribute__((target("avx512f"))) {
        asm volatile(
            "vzeroall\n\tvpxorq %%zmm30, %%zmm30, %%zmm30\n\tvpxorq %%zmm31, %%zmm31, %%zmm31" ::
                : POSEMIX_LOW, "xmm30", "xmm31");
        if (chains == 16) POSEMIX_LOOP(POSEMIX_SIXTEEN(POSEMIX_FMA_512), POSEMIX_LOW)
        if (chains == 8) POSEMIX_LOOP(POSEMIX_EIGHT(POSEMIX_FMA_512), POSEMIX_LOW)
        if (chains == 4) POSEMIX_LOOP(POSEMIX_FOUR(POSEMIX_FMA_512), POSEMIX_LOW)
        asm volatile("vzeroupper" ::: "memory");
      });
}

__attribute__((target("avx2,fma"))) double avx2(int chains) {
  const double work = static_cast<double>(kRounds) * chains * 8;
  return best_rate(
      work, [&]() __attribute__((target("avx2,fma"))) {
        asm volatile("vzeroall" ::: POSEMIX_LOW);
        if (chains == 12) POSEMIX_LOOP(POSEMIX_TWELVE(POSEMIX_FMA_256), POSEMIX_LOW)
        if (chains == 8) POSEMIX_LOOP(POSEMIX_EIGHT(POSEMIX_FMA_256), POSEMIX_LOW)
        if (chains == 4) POSEMIX_LOOP(POSEMIX_FOUR(POSEMIX_FMA_256), POSEMIX_LOW)
        asm volatile("vzeroupper" ::: "memory");
      });
}

double sse2(int chains) {
  const double work = static_cast<double>(kRounds) * chains * 4;
  return best_rate(work, [&] {
    asm volatile("xorpd %%xmm14, %%xmm14\n\txorpd %%xmm15, %%xmm15" ::: "xmm14", "xmm15");
    if (chains == 12) POSEMIX_LOOP(POSEMIX_TWELVE(POSEMIX_MUL_ADD_128), POSEMIX_LOW)
    if (chains == 8) POSEMIX_LOOP(POSEMIX_EIGHT(POSEMIX_MUL_ADD_128), POSEMIX_LOW)
    if (chains == 4) POSEMIX_LOOP(POSEMIX_FOUR(POSEMIX_MUL_ADD_128), POSEMIX_LOW)
  });
}

/// Sums that nothing reads: loads are all that the loop waits for.
__attribute__((target("avx512f"))) void read_512(const double* p, std::size_t n) {
  __m512d sum[8] = {};
  for (std::size_t i = 0; i < n; i += 64) {
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 8; ++k)
      sum[k] = _mm512_add_pd(sum[k], _mm512_load_pd(p + i + 8 * k));
  }
  for (auto& s : sum) asm volatile("" : : "v"(s));
}

__attribute__((target("avx2"))) void read_256(const double* p, std::size_t n) {
  __m256d sum[8] = {};
  for (std::size_t i = 0; i < n; i += 32) {
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 8; ++k)
      sum[k] = _mm256_add_pd(sum[k], _mm256_load_pd(p + i + 4 * k));
  }
  for (auto& s : sum) asm volatile("" : : "x"(s));
}

void read_128(const double* p, std::size_t n) {
  __m128d sum[8] = {};
  for (std::size_t i = 0; i < n; i += 16) {
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 8; ++k) sum[k] = _mm_add_pd(sum[k], _mm_load_pd(p + i + 2 * k));
  }
  for (auto& s : sum) asm volatile("" : : "x"(s));
}

/// Bytes per second read from an array of `bytes`.
double bandwidth(std::size_t bytes) {
  const std::size_t n = bytes / sizeof(double);
  auto* p = static_cast<double*>(std::aligned_alloc(64, bytes));
  std::fill(p, p + n, 1.0);
  const std::size_t passes = std::max<std::size_t>(1, 400'000'000 / bytes);
  void (*const read)(const double*, std::size_t) = __builtin_cpu_supports("avx512f") ? read_512
                                                   : __builtin_cpu_supports("avx2")  ? read_256
                                                                                     : read_128;
  const double rate = best_rate(static_cast<double>(bytes * passes), [&] {
    for (std::size_t i = 0; i < passes; ++i) read(p, n);
  });
  std::free(p);
  return rate;
}

}  // namespace

int main() {
  std::printf("{\"flops\": {");
  if (__builtin_cpu_supports("avx512f")) {
    std::printf("\"avx512\": %.4g, \"avx512_8_chains\": %.4g, \"avx512_4_chains\": %.4g, ",
                avx512(16), avx512(8), avx512(4));
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    std::printf("\"avx2\": %.4g, \"avx2_8_chains\": %.4g, \"avx2_4_chains\": %.4g, ", avx2(12),
                avx2(8), avx2(4));
  }
  std::printf("\"sse2\": %.4g, \"sse2_8_chains\": %.4g, \"sse2_4_chains\": %.4g}, ", sse2(12),
              sse2(8), sse2(4));
  constexpr std::size_t kKiB = 1024;
  std::printf("\"bytes\": {\"l1\": %.4g, \"l2\": %.4g, \"memory\": %.4g}}\n", bandwidth(16 * kKiB),
              bandwidth(512 * kKiB), bandwidth(512 * kKiB * kKiB));
  return 0;
}
