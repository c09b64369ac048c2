# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Run the code of the tutorial and tell when its first estimate was there: python first_result.py tutorial.md"""

import re
import sys
import time
from importlib.metadata import version

begin = time.perf_counter()
names = {}
first = None
for block in re.findall(r"```python\n(.*?)```", open(sys.argv[1]).read(), re.DOTALL):
    exec(compile(block, sys.argv[1], "exec"), names)
    if first is None and "estimate" in names:
        first = time.perf_counter() - begin
print(f"first estimate of the tutorial after {first:.1f} s, all of it after {time.perf_counter() - begin:.1f} s; "
      f"Python {sys.version.split()[0]}, NumPy {version('numpy')}, posemix {version('posemix')}")
