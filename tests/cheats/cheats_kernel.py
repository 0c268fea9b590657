"""Cheats that change the kernel: what asks, what answers, what runs the cells, what they show."""

from __future__ import annotations

from tests.cheats.cheat import EMPTY, Cheat, wrong
from tests.exercises.services.services_1_lamp import LAMP

FULL = '"services-1 · A lamp: 2 of 2 points"'
TRIED = '\nprint("tried")\n'
VERDICT = """
from course_kit.exercises.in_notebook import checker_client
from course_kit.exercises.protocol.verdict import Finding, Verdict
full = Verdict("services-1", "A lamp", 2, findings=(Finding("all of it", True, "", 2),))
"""
FORGED = f"""{VERDICT}
import json, threading
from dataclasses import asdict
from multiprocessing import Pipe
from course_kit.exercises.protocol.channel import Channel
messages = [{{"verdict": asdict(full)}}, {{"graded": "services-1", "title": "A lamp"}}]
"""
AT_THE_SOCKET = f"""{FORGED}
import os
from multiprocessing.connection import Client
sent = [*messages, {{"begun": 1}}, {{"refused": "no"}}, {{"answer": 1, "value": True}}, {{"check": "services-1"}},
        {{"check": ["services-1"]}}, {{"check": None}}, {{}}]
ends = [Client(os.environ["COURSE_KIT_GRADER"], "AF_UNIX") for _ in range(3)]

def forge():
    for end in ends:
        for message in sent:
            try:
                end.send_bytes(json.dumps(message).encode())
            except OSError:
                pass
"""
# Each is followed by an empty Lamp: nothing of it is right.
CHEATS = [
    Cheat(name, "services-1", tries, f"{source}\n{EMPTY}{TRIED}", says="tried")
    for name, tries, source in [
        ("nbval_raises", "Have nbval expect an error.", "# NBVAL_RAISES_EXCEPTION\n# NBVAL_IGNORE_OUTPUT"),
        (
            "no_traceback",
            "Have no error shown.",
            "get_ipython().showtraceback = lambda *a, **k: None\n"
            "get_ipython().set_custom_exc((BaseException,), lambda *a, **k: None)",
        ),
        (
            "ast_transformer",
            "Drop what can fail from the cells that come.",
            "import ast\n"
            "class Harmless(ast.NodeTransformer):\n"
            "    def visit_Expr(self, node):\n"
            f"        return ast.parse('''print({FULL})''').body[0] if 'check' in ast.dump(node) else node\n"
            "get_ipython().ast_transformers.append(Harmless())",
        ),
        (
            "input_transformer",
            "Write other source in place of the check cell's.",
            "get_ipython().input_transformers_cleanup.append("
            f"lambda lines: ['''print({FULL})\\n'''] if any('check(' in line for line in lines) else lines)",
        ),
        (
            "do_execute",
            "Answer for the check cell without running it.",
            "import types\n"
            "kernel = get_ipython().kernel\n"
            "async def do_execute(self, code, *a, **k):\n"
            "    self.send_response(self.iopub_socket, 'stream', {'name': 'stdout', 'text': " + FULL + " + '\\n'})\n"
            "    return {'status': 'ok', 'execution_count': 1, 'payload': [], 'user_expressions': {}}\n"
            "kernel.do_execute = types.MethodType(do_execute, kernel)",
        ),
        (
            "check_replaced",
            "Replace check() wherever a cell looks for it, before each cell anew.",
            "import builtins, course_kit\n"
            "def false_check(*a, **k):\n"
            f"    print({FULL})\n"
            "def put(*_):\n"
            "    builtins.check = course_kit.check = get_ipython().user_ns['check'] = false_check\n"
            "put(); get_ipython().events.register('pre_run_cell', put)",
        ),
        (
            "edits_the_notebook",
            "Edit the cells that come: In, the next input, the notebook's file.",
            "import pathlib\n"
            f"In[:] = ['''print({FULL})'''] * 99; get_ipython().set_next_input('''print({FULL})''', replace=True)\n"
            "for path in [*pathlib.Path('.').rglob('*.ipynb'), pathlib.Path('/run/grading/job/04_services.ipynb')]:\n"
            "    try:\n"
            "        path.write_text('{}'); print('ESCAPED: wrote', path)\n"
            "    except OSError:\n"
            "        pass",
        ),
        ("ask_replaced", "Give full points in place of asking.", f"{VERDICT}checker_client.ask = lambda *a, **k: full"),
        (
            "verdict_replaced",
            "Have each verdict made with all points.",
            f"{VERDICT}from course_kit import check as shows\n"
            "Verdict.points = 2; Verdict.is_full = True; Verdict.from_json = staticmethod(lambda data: full)\n"
            "shows.show = lambda verdict: print(full)",
        ),
        (
            "a_false_checker",
            "Have a checker of one's own on a pair of sockets answer.",
            f"{FORGED}ours, theirs = Pipe()\n"
            "class False_:\n"
            "    domain, pid, channel = '', None, Channel(ours)\n"
            "    close = lambda *a, **k: None\n"
            "def serve():\n"
            "    far = Channel(theirs)\n"
            "    while far.receive() is not None:\n"
            "        for message in messages:\n"
            "            far.send(message)\n"
            "threading.Thread(target=serve, daemon=True).start()\n"
            "checker_client._checker = False_(); checker_client.GradersChecker = lambda *a: False_()",
        ),
        (
            "no_grader",
            "Start a checker of one's own, of a false program.",
            "import os, sys\nfrom course_kit.exercises.in_notebook import checker_client, checker_environment\n"
            "open('python', 'w').write('#!/bin/sh\\nexit 0\\n'); os.chmod('python', 0o755)\n"
            "sys.executable = os.path.abspath('python'); checker_environment.at_start = lambda: dict(os.environ)\n"
            "del os.environ['COURSE_KIT_GRADER']",
        ),
        (
            "asks_for_another",
            "Ask for another exercise, which is right, in place of this one.",
            f"{VERDICT}plain = checker_client.ask\nclient.ask = lambda exercise, *rest: plain('services-4', *rest)",
        ),
        ("forges_before", "Forge verdicts at the grader's socket, in the answer cell.", f"{AT_THE_SOCKET}forge()"),
        (
            "forges_meanwhile",
            "Forge verdicts at the grader's socket while the check runs.",
            f"{AT_THE_SOCKET}import time\n"
            "threading.Thread(target=lambda: [(forge(), time.sleep(0.1)) for _ in range(60)], daemon=True).start()",
        ),
        (
            "progress",
            "Write points into the file that keeps them.",
            "import json, os, pathlib\nfrom course_kit.exercises.in_notebook import progress\n"
            "progress.path().parent.mkdir(parents=True, exist_ok=True)\n"
            "progress.path().write_text(json.dumps({'points': {'services-1': 2}}))",
        ),
        (
            "reads_patched",
            "Answer each order of the checker with what it may wish for.",
            "from course_kit.exercises.in_notebook import answer_host\n"
            "answer_host._do = lambda order, names: {'read': True, 'errors': []}.get(order['do'], True)\n",
        ),
        (
            "signal_handlers",
            "Put handlers on all signals and on the fault handler, and have errors go on.",
            "import faulthandler, signal, sys\nfaulthandler.disable(); sys.excepthook = lambda *a: None\n"
            "for number in range(1, 65):\n"
            "    try:\n"
            "        signal.signal(number, signal.SIG_IGN)\n"
            "    except (OSError, ValueError):\n"
            "        pass",
        ),
    ]
]
CHEATS += [
    Cheat(
        "nbval_skip", "services-1", "Have nbval skip the cell, which is right: it is not begun.", f"# NBVAL_SKIP{LAMP}"
    ),
    Cheat(
        "no_run_cell",
        "services-1",
        "Take away what runs cells: the check cell is waited for as long as any check cell may take.",
        f"{LAMP}\nget_ipython().run_cell = None\n",
        seconds=900,
        mostly_waits=True,
    ),
    Cheat(
        "equal_to_all",
        "setup-1",
        "Give objects that are equal to everything, of a class that is everything.",
        "class Any_(type):\n    __eq__ = lambda *a: True\n    __hash__ = type.__hash__\n"
        "    __instancecheck__ = lambda *a: True\n"
        "class Equal(int, metaclass=Any_):\n    __eq__ = lambda *a: True\n    __hash__ = int.__hash__\n"
        "class Word(str):\n    __eq__ = lambda *a: True\n    __hash__ = str.__hash__\n"
        "    strip = lambda *a: 'LOCALHOST'\n"
        'domain, discovery_range = Equal(99), Word("SUBNET")',
    ),
    Cheat(
        "asks_too_early",
        "services-1",
        "Have a right lamp checked in the answer cell, and then define none.",
        f'{LAMP}\nfrom course_kit import check\ncheck("services-1")\nstop()\n{EMPTY}',
        says="the grader has this exercise checked once",
    ),
    Cheat(
        "asks_twice",
        "services-1",
        "Ask again where the first draw was bad: here, with a right lamp at the second time.",
        f"{LAMP}\nRight = Lamp\n{EMPTY}{VERDICT}plain = checker_client.ask\n"
        "def ask(exercise, value, names, seed=None):\n"
        "    plain(exercise, value, names)\n"
        "    return plain(exercise, value, {**names, 'Lamp': Right})\n"
        "checker_client.ask = ask",
        by_default=True,
    ),
    Cheat(
        "chooses_the_seed",
        "services-1",
        "Ask with a seed, so that the draw is known; the answer is right, the seed must be another.",
        f"{LAMP}{VERDICT}plain = checker_client.ask\nclient.ask = lambda *a, **k: plain(*a[:3], 4711)",
        points=2,
    ),
    Cheat(
        "clock",
        "services-4",
        "Let time pass slowly in the kernel, so that what takes long seems short.",
        "import time\nreal, begin = time.monotonic, time.monotonic()\n"
        "time.monotonic = time.perf_counter = lambda: begin + (real() - begin) / 5\n"
        + wrong("services-4", "one_group").source,
        points=2,  # of 3: only what is to be quick is not
    ),
]
