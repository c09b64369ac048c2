#!/bin/bash -eu
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Builds the fuzz targets as OSS-Fuzz asks for them. The libraries of the distribution are of libstdc++, so the targets are,
# too, and they travel beside the programs.
export CXXFLAGS="${CXXFLAGS//-stdlib=libc++/}"
cmake -S . -B "$WORK/posemix" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-g1" \
  -DPOSEMIX_FUZZ=ON "-DPOSEMIX_FUZZ_ENGINE=$LIB_FUZZING_ENGINE" -DPOSEMIX_BUILD_TESTS=OFF -DPOSEMIX_REPORT=OFF \
  -DPOSEMIX_MPI=OFF -DPOSEMIX_CYCLONE=OFF
cmake --build "$WORK/posemix" --target fuzz_programs
mkdir -p "$OUT/lib"
for program in "$WORK"/posemix/fuzz/fuzz_*; do
  target=$(basename "$program")
  cp "$program" "$OUT/"
  ldd "$program" | awk '$3 ~ /^\// && $1 !~ /^(libc|libm|libpthread|libdl|librt|ld-linux.*)\.so/ {print $3}' | xargs -r cp -n -t "$OUT/lib"
  patchelf --set-rpath "\$ORIGIN/lib" "$OUT/$target"
  zip -q -j -r "$OUT/${target}_seed_corpus.zip" "tests/fuzz/corpus/${target#fuzz_}"
  dictionary="tests/fuzz/${target#fuzz_}.dict"
  if [ -e "$dictionary" ]; then cp "$dictionary" "$OUT/$target.dict"; fi
done
