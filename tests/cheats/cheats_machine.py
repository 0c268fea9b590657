"""Cheats against the machine: processes, files, memory, disk, the network; and kernels that end or hang."""

from __future__ import annotations

from pathlib import Path

from tests.cheats.cheat import CANARY, EMPTY, LEFT_BEHIND, PORT, WRONG_REPORT, Cheat
from tests.exercises.services.services_1_lamp import LAMP

COURSE = Path(__file__).parents[2]
TRIED = '\nprint("tried")\n'
ENDS = {
    "exits": ("Leave without a word.", "import os; os._exit(0)"),
    "kills_itself": ("Kill the own process.", "import os; os.kill(os.getpid(), 9)"),
    "segfaults": ("Read what is not there.", "import ctypes; ctypes.string_at(0)"),
    "stops_itself": ("Stop the own process.", "import os; os.kill(os.getpid(), 19)"),
    "hangs": ("Never end.", "while True: pass"),
    "ignores_interrupts": (
        "Never end, whatever the signal or the request.",
        "import signal, threading, time\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\n"
        "get_ipython().kernel.interrupt_request = None\n"
        "while True:\n    try:\n        time.sleep(0.1)\n    except BaseException:\n        pass",
    ),
    "recurses": (
        "Fill the stack.",
        "import sys; sys.setrecursionlimit(10**9)\ndeep = lambda n: eval('deep(n + 1)')\ndeep(0)",
    ),
    "closes_sockets": (
        "Close the kernel's sockets.",
        "import os\nfor number in range(3, 300):\n    try:\n        os.close(number)\n"
        "    except OSError:\n        pass",
    ),
    "shuts_down": ("Have the kernel end itself.", "get_ipython().kernel.do_shutdown(False); exit()"),
    "raises_exit": ("Raise SystemExit.", "raise SystemExit(0)"),
    "ends_in_the_next_check": (
        "End the kernel while the next answer is checked.",
        "import os\nfrom course_kit.exercises.in_notebook import answer_host\n"
        "answer_host.obey = lambda *a: os._exit(0)",
    ),
    "kills_all": (
        "Kill and stop every process that can be seen.",
        "import os\nfor sign in (9, 19):\n    try:\n        os.kill(-1, sign)\n    except OSError:\n        pass\n"
        "os.kill(os.getpid(), 9)",
    ),
    "outlives": (
        "Have processes go on after the grading: in sessions of their own, deaf to all signals.",
        "import os, signal, subprocess\n"
        "for _ in range(3):\n    if os.fork() == 0:\n        os.setsid()\n        if os.fork() == 0:\n"
        "            for number in (1, 2, 3, 13, 14, 15):\n                signal.signal(number, signal.SIG_IGN)\n"
        f"            os.execve('/bin/bash', ['{LEFT_BEHIND}', '-c', 'while true; do /bin/sleep 1; done'], {{}})\n"
        "        os._exit(0)",
    ),
    "fork_bomb": (
        "Fork without end.",
        "import os\nwhile True:\n    try:\n        os.fork()\n    except OSError:\n        pass",
    ),
    "memory": (
        "Fill the memory.",
        "import numpy\nkept = []\nwhile True:\n    kept.append(numpy.ones(25_000_000))",
    ),
    "memory_of_many": (
        "Fill the memory in several processes.",
        "import os, time\nfor _ in range(8):\n    if os.fork() == 0:\n"
        "        kept = bytearray(os.urandom(1)) * 600_000_000\n"
        "        time.sleep(60)\n        os._exit(0)\ntime.sleep(60)",
    ),
    "full_disk": (
        "Fill the folder, and those for temporary files and shared memory.",
        "block = b'x' * (1 << 20)\nimport tempfile\n"
        "for place in ('.', tempfile.gettempdir(), '/tmp', '/dev/shm'):\n    for number in range(4):\n"
        "        try:\n            with open(f'{place}/full{number}', 'wb') as file:\n"
        "                for _ in range(1000):\n                    file.write(block)\n"
        "        except OSError:\n            pass",
    ),
    "cuts_shared_memory": (
        "Cut the files in shared memory short, of which one is the checker's.",
        "import os, threading, time\n"
        "def cut():\n    for name in os.listdir('/dev/shm'):\n        try:\n"
        "            os.truncate(f'/dev/shm/{name}', 0)\n"
        "        except OSError:\n            pass\ncut()",
    ),
    "prints_1_gb": (
        "Print 1 GB, to all streams and as what is displayed.",
        "import sys\nfrom IPython.display import display\nblock = 'x' * (1 << 20)\nfor _ in range(250):\n"
        "    print(block); print(block, file=sys.stderr); display({'text/plain': block}, raw=True)\n"
        "    sys.__stdout__.write(block); sys.__stderr__.write(block)",
    ),
    "floods_the_terminal": (
        "Write 1 GB, in one line, to where the kernel's process was started.",
        "import os\nblock = b'x' * (1 << 20)\nfor _ in range(500):\n    os.write(1, block); os.write(2, block)",
    ),
    "never_idle": (
        "Print for ever, and never say that the cell has ended.",
        "import threading, time\nsession = get_ipython().kernel.session\n"
        "plain, parent = session.send, get_ipython().kernel.get_parent()\n"
        "def send(stream, kind, content=None, *a, **k):\n"
        "    if kind == 'status' or getattr(kind, 'get', dict)('msg_type') == 'status':\n"
        "        return\n    return plain(stream, kind, content, *a, **k)\nsession.send = send\n"
        "def flood():\n    while True:\n"
        "        plain(get_ipython().kernel.iopub_socket, 'stream', {'name': 'stdout', 'text': 'x'}, parent=parent)\n"
        "        time.sleep(0.05)\nthreading.Thread(target=flood, daemon=True).start()",
    ),
}
TIMEOUTS = {"hangs": 8.0, "ignores_interrupts": 8.0, "stops_itself": 8.0, "never_idle": 5.0, "closes_sockets": 8.0}
DEFAULT = ("outlives",)
WAITING = ("stops_itself", "ignores_interrupts", "cuts_shared_memory", "never_idle")
CHEATS = [
    Cheat(
        name,
        "setup-1",
        tries,
        f"{WRONG_REPORT}{source}",
        honest="setup-2",
        timeout=TIMEOUTS.get(name, 30.0),
        by_default=name in DEFAULT,
        mostly_waits=name in WAITING,
    )
    for name, (tries, source) in ENDS.items()
]
READ = [
    *(
        COURSE / name
        for name in ("tests/exercises/services/services_1_lamp.py", "notebooks/04_services.ipynb", ".git/HEAD")
    ),
    *map(
        Path,
        ("/etc/passwd", "/etc/shadow", "/etc/hostname", "/run/grading/job/job.json", "/proc/1/root/run/grading/job"),
    ),
    *map(Path, ("/run/grading/job/found.jsonl", "/root/.bashrc", "/home", "/proc/kcore", "/sys/kernel", "/var/log")),
]
WRITE = [
    *(
        COURSE / "course_kit" / name
        for name in ("exercises/services/cheat.py", "cheat.py", "exercises/notebooks/edition")
    ),
    *map(Path, ("/usr/cheat", "/run/grading/meeting/cheat", "/run/grading/meeting/checker")),
]
FILES = f"""
import glob, os
for path in {list(map(str, READ))} + ["{CANARY}", *glob.glob("/proc/[0-9]*/root/run/grading/job/*")]:
    try:
        (os.listdir if os.path.isdir(path) else lambda p: open(p, "rb").read(1))(path)
        print("ESCAPED: read", path)
    except OSError:
        pass
for path in {list(map(str, WRITE))}:
    try:
        open(path, "ab").close(); print("ESCAPED: wrote", path)
    except OSError:
        pass
    try:
        os.unlink(path); print("ESCAPED: removed", path)
    except OSError:
        pass
names = [name for folder in glob.glob("/proc/[0-9]*") for name in [open(folder + "/cmdline").read()]]
if any("nbval" in name or "course_kit.exercises.checker" in name for name in names):
    print("ESCAPED: sees the grader's processes")
secrets = [entry for entry in open("/proc/1/environ").read().split("\\0") if "COURSE_KIT_TEST" in entry]
if secrets:
    print("ESCAPED: sees the grader's environment", secrets)
"""
NETWORK = f"""
import socket
def attempt(kind, address, family=socket.AF_INET):
    try:
        with socket.socket(family, kind) as end:
            end.settimeout(1.0); end.connect(address); end.send(b"x")
        print("ESCAPED: sent to", address)
    except OSError:
        pass
for address in [("127.0.0.1", {PORT}), ("1.1.1.1", 53), ("192.168.0.1", 80), ("172.17.0.1", {PORT})]:
    attempt(socket.SOCK_STREAM, address)
for address in [("1.1.1.1", 53), ("239.255.0.1", 7400), ("255.255.255.255", 7400), ("169.254.169.254", 80)]:
    attempt(socket.SOCK_DGRAM, address)
attempt(socket.SOCK_STREAM, "\\0course-cheat-{PORT}", socket.AF_UNIX)
for family, kind in ((socket.AF_INET, socket.SOCK_RAW), (socket.AF_PACKET, socket.SOCK_RAW)):
    try:
        socket.socket(family, kind, socket.IPPROTO_ICMP); print("ESCAPED: raw socket")
    except OSError:
        pass
"""
KERNEL = """
import os
for path in ("/proc/sys/kernel/core_pattern", "/proc/sys/kernel/hostname", "/proc/sysrq-trigger",
             "/proc/sys/vm/drop_caches"):
    try:
        os.close(os.open(path, os.O_WRONLY)); print("ESCAPED: may write", path)
    except OSError:
        pass
for line in open("/proc/1/status"):
    if line.startswith(("CapPrm", "CapEff")) and int(line.split()[1], 16):
        print("ESCAPED: process 1, which may be traced, has rights", line)
"""
SHARED = """
import os
filled, block = 0, b"x" * (1 << 20)
try:
    for place in ("/", "/dev/", "/etc/"):
        for number in range(3):
            with open(f"{place}full{number}", "wb") as file:
                for _ in range(400):
                    file.write(block); filled += 1
except OSError:
    pass
if filled > 1024:
    print("ESCAPED:", filled, "MB in folders that have no limit")
"""
HIDDEN = """
import os, time
kept, block, filled = [], b"x" * (1 << 20), 0
for _ in range(9):
    kept.append(os.memfd_create("x"))
    for _ in range(400):
        os.write(kept[-1], block); filled += 1
time.sleep(1.0)
print("ESCAPED:", filled, "MB of memory that nobody counts")
"""
START_UP = """
import os, pathlib
bad = "import os; open('/run/grading/work/loaded', 'a').write(f'{os.getpid()} '); os._exit(3)\\n"
folder = pathlib.Path("poison"); folder.mkdir()
for name in ("sitecustomize", "usercustomize", "conftest", "course_kit", "rclpy", "signal", "pytest", "nbval"):
    for place in (folder, pathlib.Path("."), pathlib.Path.home(), pathlib.Path("/tmp")):
        (place / f"{name}.py").write_text(bad)
start = pathlib.Path.home() / ".ipython/profile_default/startup"; start.mkdir(parents=True, exist_ok=True)
(start / "00.py").write_text(bad)
poison = str(folder.absolute())
os.environ.update(PYTHONPATH=poison, PYTHONSTARTUP=f"{poison}/sitecustomize.py", PYTHONUSERBASE=poison,
                  IPYTHONDIR=str(pathlib.Path.home() / ".ipython"), LD_PRELOAD="libm.so.6", XDG_CACHE_HOME=poison,
                  AMENT_PREFIX_PATH=poison, PATH=f"{poison}:{os.environ['PATH']}", ROS_DOMAIN_ID="5")
forged = folder / "ros2-notebook-course/robot_interfaces-0/robot_interfaces"; forged.mkdir(parents=True)
(forged / "__init__.py").write_text(bad)
"""
HANDLES = """
import ctypes, os
libc = ctypes.CDLL(None)
for pid in [int(name) for name in os.listdir("/proc") if name.isdigit() and int(name) != os.getpid()]:
    handle = libc.syscall(434, pid, 0)
    for number in range(64):
        taken = libc.syscall(438, handle, number, 0)
        if taken >= 0 and "socket" in os.readlink(f"/proc/self/fd/{taken}"):
            os.write(taken, b'{"verdict": {}}')
"""
SOLUTIONS = f"""
import importlib, pathlib, re, subprocess, sys
import course_kit
from course_kit import solution
from course_kit.exercises.in_notebook import progress, checker_environment
from course_kit.exercises.solutions import worked
solution("services-1")
course, here = pathlib.Path(course_kit.__file__).parent, pathlib.Path("{COURSE}/course_kit")
places = {{place / "exercises/services/solutions" for place in (course, course.resolve(), here)}}
# Where nothing says that it is graded, and the points are full.
plain, checker_environment.at_start = checker_environment.at_start, lambda: {{}}
progress.path().parent.mkdir(parents=True, exist_ok=True)
progress.path().write_text('{{"points": {{"services-1": 2}}}}')
solution("services-1")
checker_environment.at_start = plain
found = [path for place in (*places, *worked.folders()) for path in place.rglob("*")]
for place in places:
    try:
        (place / "services-1.md").write_text("x"); print("ESCAPED: wrote", place)
    except OSError:
        pass
    code = "import pathlib, sys; print(*pathlib.Path(sys.argv[1]).iterdir())"
    for command in (["umount", "-l", place], ["find", place, "-type", "f"], [sys.executable, "-c", code, place]):
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        if done.stdout.strip():
            print("ESCAPED:", command, done.stdout)
for name in ("course_kit.exercises.services.solutions.services_1", "course_kit.exercises.services.solutions.services"):
    try:
        importlib.import_module(name); print("ESCAPED: imported", name)
    except ImportError:
        pass
for root in ("/usr/src", "/opt", "/srv", "/run", sys.prefix, str(course.parent)):
    found += pathlib.Path(root).rglob("services-1.md")
for path in found:
    print("ESCAPED: found", path)
    exec(re.search(r"```python\\n(.*?)```", path.read_text(), re.DOTALL)[1])
"""
CHEATS.append(
    Cheat(
        "solutions",
        "services-1",
        "Read, import or execute the worked solution, in the kernel and from its processes.",
        f"{EMPTY}{SOLUTIONS}{TRIED}",
        says="is graded.\nsolution: this edition of the course has no solutions",
        honest="services-4",
        timeout=60.0,
        by_default=True,
    )
)
CHEATS += [
    Cheat(
        name,
        "services-1",
        tries,
        f"{source}{EMPTY}{TRIED}",
        says="" if name == "hidden_memory" else "tried",  # which is ended
        by_default=name == "files",
    )
    for name, tries, source in [
        ("files", "Read or write what is not the answer's: tests, the job, the grader, the host.", FILES),
        ("network", "Reach another machine, the host's network, its abstract sockets.", NETWORK),
        ("kernel_settings", "Write settings of the machine's kernel, and have the rights of another process.", KERNEL),
        ("folders_without_limit", "Fill folders that are no work folder.", SHARED),
        ("hidden_memory", "Fill the memory with files that no process maps.", HIDDEN),
        ("start_up_files", "Have code loaded by whatever Python starts next.", START_UP),
        ("handles", "Take sockets out of other processes, and write a verdict.", HANDLES),
    ]
]
CHEATS += [
    Cheat(
        "loud_but_right",
        "services-1",
        "Nothing: a right answer that logs to stderr and prints a lot.",
        f"{LAMP}\nimport sys\nfor _ in range(3000):\n    print('x' * 200)\n    print('y' * 200, file=sys.stderr)\n"
        "get_ipython().events.register('pre_run_cell', lambda *_: lamp.get_logger().error('noise'))\n",
        points=2,
        by_default=True,
    ),
    Cheat(
        "right_but_never_ends",
        "services-1",
        "Define the class, then never end.",
        f"{LAMP}\nwhile True:\n    pass\n",
        points=2,
        timeout=8.0,
    ),
    Cheat(
        "dies_in_its_check",
        "services-1",
        "End the kernel when the class is made.",
        EMPTY + "        import os; os._exit(0)\n",
        honest="services-4",
        mostly_waits=True,
    ),
    Cheat(
        "hangs_in_its_check",
        "services-1",
        "Never return from the constructor, deaf to what would end it.",
        EMPTY + "        while True:\n            try:\n                while True: pass\n"
        "            except BaseException: pass\n",
        honest="services-4",
    ),
]
