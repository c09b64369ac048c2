# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Every task installs the Debian packages it needs (tools/bootstrap), configures and builds, and does no work
# twice. The CMake presets do the same without installing anything.
JOBS ?= $(shell nproc)
PREFIX ?= /usr/local
PROGRAM := build/release/posemix
FORMATTED = $(shell find include src tests bench -name '*.hpp' -o -name '*.cpp')
SCRIPTS := tools/bootstrap .ci/run

export CMAKE_BUILD_PARALLEL_LEVEL = $(JOBS)
export CTEST_PARALLEL_LEVEL = $(JOBS)

.PHONY: help build demo test fuzz bench format lint tidy docs coverage install clean
.DELETE_ON_ERROR:

help:
	@echo 'make build      the program, at $(PROGRAM)'
	@echo 'make demo       simulate a sequence and run three filters on it side by side, into build/demo'
	@echo 'make test       build and run all tests; those that damage files under sanitizers'
	@echo 'make bench      build and run the benchmarks, results into build/bench'
	@echo 'make format     format the sources'
	@echo 'make lint       check format, include directions, scripts, and run clang-tidy; with TIDY_SINCE=COMMIT'
	@echo '                clang-tidy only on the sources that have changed since'
	@echo 'make docs       the reference pages, at build/docs/html/index.html'
	@echo 'make coverage   line coverage of src/ and include/, at build/coverage/report/index.html'
	@echo 'make install    install the program and the library under PREFIX ($(PREFIX))'
	@echo 'make clean      remove build/'

build/.bootstrap-%: tools/bootstrap
	@tools/bootstrap $*
	@mkdir -p build && touch $@

# configured(preset,variable): configures the preset unless its cache already has the variable switched on.
configured = grep -qs '^$(2):BOOL=ON' build/$(1)/CMakeCache.txt && test -f build/$(1)/build.ninja \
  || cmake --preset $(1) -D$(2)=ON

build: build/.bootstrap-build
	@test -f build/release/build.ninja || cmake --preset release -DPOSEMIX_BUILD_TESTS=OFF
	cmake --build --preset release --target posemix

demo: build build/.bootstrap-demo
	tools/demo $(PROGRAM) build/demo

test: build/.bootstrap-test
	@$(call configured,release,POSEMIX_BUILD_TESTS)
	cmake --build --preset release
	ctest --preset release

fuzz: build/.bootstrap-test
	@$(call configured,release,POSEMIX_BUILD_TESTS)
	cmake --build --preset release --target fuzz_tests
	ctest --preset release -L '^fuzz$$'

bench: build/.bootstrap-bench
	@$(call configured,release,POSEMIX_BUILD_BENCH)
	cmake --build --preset release --target benchmarks
	@mkdir -p build/bench
	@for bench in build/release/bench/bench_*; do \
	  "$$bench" --benchmark_out="build/bench/$${bench##*/}.json" --benchmark_out_format=json || exit 1; \
	done

format: build/.bootstrap-lint
	clang-format -i $(FORMATTED)

lint: build/.bootstrap-lint
	tools/check_includes.py
	clang-format --dry-run -Werror $(FORMATTED)
	shellcheck $(SCRIPTS)
	@$(MAKE) --no-print-directory tidy

tidy: build/.bootstrap-lint
	@test -f build/tidy/build.ninja || cmake --preset tidy
	@cmake --build --preset tidy --target rebuild_cache >/dev/null
	@files=$$($(if $(TIDY_SINCE),git diff --name-only --diff-filter=d $(TIDY_SINCE) --,git ls-files) 'src/*.cpp'); \
	if [ -n "$$files" ]; then run-clang-tidy -quiet -j $(JOBS) -p build/tidy $$files; fi

docs: build/.bootstrap-docs
	@mkdir -p build/docs
	doxygen docs/Doxyfile

coverage: build/.bootstrap-coverage
	@$(call configured,coverage,POSEMIX_BUILD_TESTS)
	cmake --build --preset coverage
	@find build/coverage -name '*.gcda' -delete
	ctest --preset coverage
	@mkdir -p build/coverage/report
	gcovr -j $(JOBS) --root . --object-directory build/coverage --filter src/ --filter include/ \
	  --print-summary --fail-under-line 90 --html-details build/coverage/report/index.html

install: build
	cmake --build --preset release
	cmake --install build/release --prefix $(PREFIX)

clean:
	rm -rf build
