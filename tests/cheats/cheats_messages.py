"""Cheats by what is said to the grader: floods, what is no message, what is too long, outputs that no notebook has."""

from __future__ import annotations

from tests.cheats.cheat import EMPTY, WRONG_REPORT, Cheat

TRIED = '\nprint("tried")\n'
DEEP = "'[' * 100_000 + ']' * 100_000"
CHEATS = [
    Cheat(
        "flood_at_the_socket",
        "setup-1",
        "Send 100 messages of 10 MB at 100 connections to the grader's socket.",
        "import json, os, threading\nfrom multiprocessing.connection import Client\n"
        "def flood(end):\n    try:\n        end.send_bytes(json.dumps({'check': 'x' * 9_900_000}).encode())\n"
        "    except OSError:\n        pass\n"
        "ends = [Client(os.environ['COURSE_KIT_GRADER'], 'AF_UNIX') for _ in range(100)]\n"
        "for end in ends:\n    threading.Thread(target=flood, args=(end,), daemon=True).start()\n" + WRONG_REPORT,
        honest="setup-2",
    ),
    Cheat(
        "many_connections",
        "setup-1",
        "Open 2000 connections to the grader's socket, in two processes that go on.",
        "import os, socket, time\n"
        "for _ in range(2):\n    if os.fork() == 0:\n        ends = []\n        try:\n"
        "            for _ in range(1000):\n                ends.append(socket.socket(socket.AF_UNIX))\n"
        "                ends[-1].connect(os.environ['COURSE_KIT_GRADER'])\n"
        "        except OSError:\n            pass\n        time.sleep(60)\n        os._exit(0)\n"
        "time.sleep(5)\n" + WRONG_REPORT + TRIED,
        honest="setup-2",
        says="tried",
    ),
    Cheat(
        "odd_messages",
        "setup-1",
        "Send what is no message to the grader's socket: too deep, too long, no text, half of one.",
        "import os, socket, struct, threading\nfrom multiprocessing.connection import Client\n"
        f"odd = [({DEEP}).encode(), b'\\xff' * 99, b'', b'1' * 9999, b'[]',"
        f" b'NaN', b'{{\"check\": NaN}}', b'x' * 11_000_000]\n"
        "def send(data):\n    try:\n        Client(os.environ['COURSE_KIT_GRADER'], 'AF_UNIX').send_bytes(data)\n"
        "    except OSError:\n        pass\n"
        "for data in odd:\n    threading.Thread(target=send, args=(data,), daemon=True).start()\n"
        "half = socket.socket(socket.AF_UNIX); half.connect(os.environ['COURSE_KIT_GRADER'])\n"
        "half.send(struct.pack('!i', 1000) + b'{')\n" + WRONG_REPORT + TRIED,
        honest="setup-2",
        says="tried",
    ),
    Cheat(
        "long_value",
        "setup-1",
        "Give a value as long as a message may be, so that the verdict on it is longer.",
        'domain, discovery_range = "x" * 9_999_800, None',
        honest="setup-2",
    ),
    Cheat(
        "long_error",
        "services-1",
        "Answer an order with an error as long as a message may be, so that the verdict is longer.",
        "from course_kit.exercises.in_notebook import answer_host\n"
        "long, plain = {'error': 'E', 'trace': 'x' * 9_999_900}, answer_host.obey\n"
        "def obey(order, *rest):\n"
        "    is_it = order['do'] == 'start' and order['node_class'] == 'Lamp'\n"
        "    return long if is_it else plain(order, *rest)\n"
        f"answer_host.obey = obey\n{EMPTY}",
        honest="services-4",
    ),
    Cheat(
        "odd_error",
        "services-1",
        "Answer an order with an error that is a page, a formula and half a letter.",
        "from course_kit.exercises.in_notebook import answer_host\n"
        "odd = {'error': 'E', 'trace': '=1+1<script>alert(1)</script>\\ud800'}\n"
        f"answer_host.obey = lambda order, *a: {{'value': True}} if order['do'] == 'has' else odd\n{EMPTY}",
    ),
    Cheat(
        "deep_answer",
        "services-1",
        "Answer an order with lists in lists in lists, as deep as can be sent.",
        "from course_kit.exercises.in_notebook import answer_host\n"
        "deep, plain = [], answer_host.obey\nfor _ in range(900):\n    deep = [deep]\n"
        "def obey(order, *rest):\n"
        "    return {'value': deep, 'error': deep} if order.get('node_class') == 'Lamp' else plain(order, *rest)\n"
        f"answer_host.obey = obey\n{EMPTY}",
        honest="services-4",
        mostly_waits=True,
    ),
    Cheat(
        "odd_outputs",
        "setup-2",
        "Send outputs that no notebook has: fields that are missing, half letters, a message that is signed wrongly.",
        "import json\nkernel = get_ipython().kernel\nsend, pub, parent = kernel.session.send, kernel.iopub_socket, "
        "kernel.get_parent()\n"
        "kernel.session.pack = lambda o: json.dumps(o, default=str).encode()\n"
        "print('<script>alert(1)</script> half a letter: \\ud800')\n"
        "send(pub, 'stream', {'name': 'stdout', 'text': '=1+1 \\udfff'}, parent=parent)\n"
        "for kind in ('stream', 'display_data', 'error', 'execute_result', 'status', 'odd'):\n"
        "    send(pub, kind, {}, parent=parent)\n"
        "send(pub, 'display_data', {'data': 3, 'metadata': None}, parent=parent)\n"
        "pub.send_multipart([b'odd', b'<IDS|MSG>', b'0' * 64, b'{}', b'{}', b'{}', b'{}'])\n",
        honest="setup-1",
    ),
]
