"""A compiler launcher: runs a compiler, and appends the processor time that it took [s] and the object that it made to a file.

    python3 timed.py times.txt c++ -o object.o -c source.cpp

`python3 dev.py times` prints such a file.
"""

import os
import subprocess
import sys

times, *command = sys.argv[1:]
status = subprocess.run(command).returncode
if status == 0:
    used = os.times()  # on Windows those of children are 0
    with open(times, "a") as file:
        file.write(f"{used.children_user + used.children_system:.2f}\t{command[command.index('-o') + 1]}\n")
sys.exit(status if status >= 0 else 128 - status)  # as a shell reports a signal
