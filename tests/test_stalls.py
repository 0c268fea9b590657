"""Looks at where a thread is."""

from __future__ import annotations

import subprocess
import sys

BEGINS_THREADS = """
import gc, threading, time
from course_kit.ros.spinning import stalls

def keep_looking():
    while not over.is_set():
        stalls.look(threading.main_thread(), None)

stalls.look(threading.main_thread(), None)  # imports what it needs
gc.callbacks.append(lambda phase, info: time.sleep(0))  # gives Python's lock away, as a callback of the kernel's may
gc.set_threshold(1)
over, looking = threading.Event(), threading.Thread(target=keep_looking, daemon=True)
looking.start()
for _ in range(300):
    thread = threading.Thread(target=int)
    thread.start()
    thread.join()
over.set()
looking.join()
print("300 threads; garbage is collected:", gc.isenabled())
"""


def test_threads_begin_while_one_looks_at_another() -> None:
    done = subprocess.run([sys.executable, "-c", BEGINS_THREADS], capture_output=True, text=True, timeout=60)
    assert done.stdout == "300 threads; garbage is collected: True\n", done.stderr
