r"""Texts with substitutions in them, as XML and YAML launch files and parameter files have them.

`$(name argument ...)` stands for a substitution; an argument with spaces is put into quotes, and a backslash takes the
meaning from the character behind it.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable

from course_kit.cli.launching import conditions, machine_substitutions, package_substitutions, substitutions
from course_kit.cli.launching.substitutions import Substitution, TextSubstitution
from course_kit.cli.launching.uncovered import not_covered

Texts = list[Substitution]


def _modules(text: Texts) -> list[str]:
    (names,) = text
    assert isinstance(names, TextSubstitution)
    return [name.strip() for name in names.text.split(",")]


# Name -> what makes the substitution, and how many arguments that takes at least and at most.
_KNOWN: dict[str, tuple[Callable[..., Substitution], int, int]] = {
    "all": (conditions.AllSubstitution, 0, 99),
    "and": (conditions.AndSubstitution, 2, 2),
    "anon": (machine_substitutions.AnonName, 1, 1),
    "any": (conditions.AnySubstitution, 0, 99),
    "command": (lambda line, on_stderr="fail": machine_substitutions.Command(line, on_stderr=on_stderr), 1, 2),
    "dirname": (substitutions.ThisLaunchFileDir, 0, 0),
    "env": (lambda name, default=None: substitutions.EnvironmentVariable(name, default_value=default), 1, 2),
    "equals": (conditions.EqualsSubstitution, 2, 2),
    "eval": (
        lambda text, names=None: substitutions.PythonExpression(text, _modules(names) if names else ["math"]),
        1,
        2,
    ),
    "exec-in-pkg": (package_substitutions.ExecutableInPackage, 2, 2),
    "file-content": (machine_substitutions.FileContent, 1, 1),
    "filename": (substitutions.ThisLaunchFile, 0, 0),
    "find-exec": (lambda name: machine_substitutions.FindExecutable(name=name), 1, 1),
    "find-pkg-prefix": (package_substitutions.FindPackagePrefix, 1, 1),
    "find-pkg-share": (package_substitutions.FindPackageShare, 1, 1),
    "if": (conditions.IfElseSubstitution, 2, 3),
    "launch_log_dir": (machine_substitutions.LaunchLogDir, 0, 0),
    "log_dir": (machine_substitutions.LaunchLogDir, 0, 0),
    "not": (conditions.NotSubstitution, 1, 1),
    "not-equals": (conditions.NotEqualsSubstitution, 2, 2),
    "or": (conditions.OrSubstitution, 2, 2),
    "var": (lambda name, default=None: substitutions.LaunchConfiguration(name, default=default), 1, 2),
}
_UNCOVERED = ("for-var", "index", "is-empty", "is_empty", "not-empty", "not_empty", "param", "path-join", "string-join")
_NAME = re.compile(r"\$\(([A-Za-z][\w-]*)")


def parsed(text: str) -> Texts:
    """The parts of a text: substitutions, and what is fixed. ValueError if a bracket or a quote is not closed."""
    parts = _Reader(text).parts(lambda character: False)
    return parts or [TextSubstitution(text="")]


def command_line(text: str) -> list[Texts]:
    """The words of a command, each of parts; what a substitution becomes is not split."""
    parts = parsed(text)
    marked = (part.text if isinstance(part, TextSubstitution) else f"\0{n}\0" for n, part in enumerate(parts))
    return [_unmarked(word, parts) for word in shlex.split("".join(marked))]


def _unmarked(word: str, parts: Texts) -> Texts:
    bits = word.split("\0")  # every second one is the number of a part
    return [parts[int(bit)] if n % 2 else TextSubstitution(text=bit) for n, bit in enumerate(bits) if bit or not word]


class _Reader:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0

    def _next(self) -> str:
        return self.text[self.at : self.at + 1]

    def parts(self, is_end: Callable[[str], bool], quote: str = "") -> Texts:
        """What stands from here to the end, or to a character that ends it."""
        found: Texts = []
        fixed = ""
        while self._next() and not is_end(self._next()):
            if self.text.startswith("$(", self.at):
                found += [TextSubstitution(text=fixed)] * bool(fixed)
                fixed = ""
                found.append(self._substitution(quote))
                continue
            self.at += self._next() == "\\" and self.at + 1 < len(self.text)
            fixed += self._next()
            self.at += 1
        return found + [TextSubstitution(text=fixed)] * bool(fixed)

    def _substitution(self, quote: str) -> Substitution:
        start = self.at
        match = _NAME.match(self.text, self.at)
        if match is None:
            raise ValueError(f"No name of a substitution behind '$(' in {self.text!r}")
        self.at = match.end()
        arguments: list[Texts] = []
        while self._next() != ")":
            if not self._next() or self._next() == quote:
                raise ValueError(f"'{self.text[start:]}' lacks the closing bracket")
            if self._next().isspace():
                self.at += 1
            else:
                arguments.append(self._argument(quote))
        self.at += 1
        return _made(match.group(1), arguments)

    def _argument(self, quote: str) -> Texts:
        if self._next() in ("'", '"') and not quote:
            mark = self._next()
            self.at += 1
            text = self.parts(lambda character: character == mark, mark)
            if not self._next():
                raise ValueError(f"A quote is not closed in {self.text!r}")
            self.at += 1
            return text or [TextSubstitution(text="")]
        return self.parts(lambda character: character.isspace() or character in ")" + quote, quote)


def _made(name: str, arguments: list[Texts]) -> Substitution:
    if name in _UNCOVERED:
        raise not_covered(f"the substitution $({name} ...)")
    if name not in _KNOWN:
        raise ValueError(f"$({name} ...) is no substitution")
    make, fewest, most = _KNOWN[name]
    if not fewest <= len(arguments) <= most:
        wanted = str(fewest) if fewest == most else f"{fewest} to {most}"
        raise ValueError(f"$({name} ...) takes {wanted} arguments, not {len(arguments)}")
    return make(*arguments)
