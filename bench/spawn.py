"""Runs a program once and prints: wall seconds, CPU seconds, peak MiB, exit status.

A process of its own, because Linux counts the memory of the process that starts a program into the
program's peak: started from here, the least figure that can be seen is this small interpreter's own
(about 8 MiB with `python3 -I -S`). Arguments: OUTPUT-FILE PROGRAM ARGUMENTS...
"""

import os
import sys
from time import perf_counter

output = os.open(sys.argv[1], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
actions = [(os.POSIX_SPAWN_DUP2, output, 1), (os.POSIX_SPAWN_DUP2, output, 2)]
start = perf_counter()
pid = os.posix_spawn(sys.argv[2], sys.argv[2:], os.environ, file_actions=actions)
_, status, usage = os.wait4(pid, 0)
wall = perf_counter() - start
print(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, os.waitstatus_to_exitcode(status))
