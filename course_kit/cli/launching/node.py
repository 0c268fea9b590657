"""launch_ros' actions: Node, and what sets values for the nodes that come after it."""

from __future__ import annotations

import importlib
import os
import re
from collections.abc import Iterable
from typing import Any

from course_kit.cli.launching import output, parameters
from course_kit.cli.launching.actions import TextAction
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.package_substitutions import ExecutableInPackage
from course_kit.cli.launching.parameters import parameter_list
from course_kit.cli.launching.process import ExecuteProcess
from course_kit.cli.launching.substitutions import (
    LocalSubstitution,
    SomeSubstitutions,
    SubstitutionFailure,
    normalize,
    perform,
)
from course_kit.cli.launching.uncovered import not_covered

NO_NAME = "<node_name_unspecified>"
_VALID = {"node_name": r"[A-Za-z_][A-Za-z0-9_]*", "namespace": r"/|(?!.*__)(/[A-Za-z_][A-Za-z0-9_]*)+"}


def joined_namespace(base: str | None, namespace: str | None) -> str | None:
    """A namespace within another one, absolute; None if neither is given."""
    if base is None and namespace is None:
        return None
    return os.path.join("/", base or "", namespace or "").rstrip("/") or "/"


def validate(kind: str, text: str) -> None:
    """Raise rclpy's error for what is no `kind`, node_name or namespace; rclpy is loaded for that only."""
    if not re.fullmatch(_VALID[kind], text):
        getattr(importlib.import_module(f"rclpy.validate_{kind}"), f"validate_{kind}")(text)


class PushROSNamespace(TextAction):
    """Puts the nodes after it into a namespace, to the end of the group."""

    def __init__(self, namespace: SomeSubstitutions, **options: Any) -> None:
        super().__init__({"namespace": namespace}, **options)

    def _act(self, context: LaunchContext, pushed: str) -> None:
        before = context.launch_configurations.get("ros_namespace")
        namespace = joined_namespace(before, pushed)
        assert namespace is not None
        try:
            validate("namespace", namespace)
        except Exception:
            raise SubstitutionFailure(f"'{pushed}', below the namespace '{before}', is no namespace") from None
        context.launch_configurations["ros_namespace"] = namespace


class SetParameter(TextAction):
    """Gives all nodes after it a parameter, to the end of the group."""

    def __init__(self, name: SomeSubstitutions, value: Any, **options: Any) -> None:
        super().__init__({"name": name}, **options)
        self.value = value

    def _act(self, context: LaunchContext, name: str) -> None:
        before = context.launch_configurations.get("global_params", ())
        given = (name, parameters.evaluated(context, self.value))
        context.launch_configurations["global_params"] = [*before, given]


class SetParametersFromFile(TextAction):
    """Gives all nodes after it the parameters of a file, to the end of the group."""

    def __init__(
        self, filename: SomeSubstitutions, *, node_name: SomeSubstitutions | None = None, **options: Any
    ) -> None:
        if node_name is not None:
            raise not_covered("SetParametersFromFile(node_name=...)")
        super().__init__({"filename": filename}, **options)

    def _act(self, context: LaunchContext, path: str) -> None:
        if not os.path.isfile(path):
            raise SubstitutionFailure(f"SetParametersFromFile: there is no file '{path}'")
        before = context.launch_configurations.get("global_params", ())
        context.launch_configurations["global_params"] = [*before, os.path.abspath(path)]


class SetRemap(TextAction):
    """Gives all nodes after it a remapping, to the end of the group."""

    def __init__(self, src: SomeSubstitutions, dst: SomeSubstitutions, **options: Any) -> None:
        super().__init__({"src": src, "dst": dst}, **options)

    def _act(self, context: LaunchContext, src: str, dst: str) -> None:
        before = context.launch_configurations.get("ros_remaps", ())
        context.launch_configurations["ros_remaps"] = [*before, (src, dst)]


class Node(ExecuteProcess):
    """Runs a node: an executable of a package, with its name, namespace, parameters and remappings."""

    def __init__(
        self,
        *,
        executable: SomeSubstitutions,
        package: SomeSubstitutions | None = None,
        name: SomeSubstitutions | None = None,
        namespace: SomeSubstitutions | None = None,
        exec_name: SomeSubstitutions | None = None,
        parameters: Iterable[Any] | None = None,
        remappings: Iterable[tuple[SomeSubstitutions, SomeSubstitutions]] | None = None,
        ros_arguments: Iterable[SomeSubstitutions] | None = None,
        arguments: Iterable[SomeSubstitutions] | None = None,
        **options: Any,
    ) -> None:
        cmd: list[Any] = [executable if package is None else ExecutableInPackage(executable, package)]
        cmd += _list(arguments)
        cmd += ["--ros-args", *_list(ros_arguments)] if ros_arguments is not None else []
        cmd += ["--ros-args"]
        if name is not None:
            cmd += ["-r", LocalSubstitution("ros_specific_arguments['name']", "node name")]
        super().__init__(cmd=cmd, name=exec_name, **options)
        self._given = f"package={package}, executable={executable}, name={name}, namespace={namespace}"
        self._node_name = None if name is None else normalize(name)
        self._namespace = None if namespace is None else normalize(namespace)
        self._parameters = [] if parameters is None else parameter_list(parameters)
        self._remappings = [] if remappings is None else _pairs(remappings)
        self.node_name = NO_NAME

    def execute(self, context: LaunchContext) -> None:
        """Work out its names, parameters and remappings, and start it."""
        base_name, namespace = self._names(context)
        is_known = base_name is not None and namespace is not None
        self.node_name = f"{(namespace or '<node_namespace_unspecified>').rstrip('/')}/{base_name or NO_NAME}"
        words = [] if namespace is None else ["-r", f"__ns:={namespace}"]
        words += self._parameter_words(context, self.node_name if is_known else "/**")
        remaps = list(context.launch_configurations.get("ros_remaps", ()))
        remaps += [(perform(context, a), perform(context, b)) for a, b in self._remappings]
        words += [word for a, b in remaps for word in ("-r", f"{a}:={b}")]
        self.cmd += [normalize(word) for word in words]
        context.extend_locals({"ros_specific_arguments": {"name": f"__node:={base_name}"}})
        super().execute(context)
        if is_known:
            context.node_names[self.node_name] += 1
            count = context.node_names[self.node_name]
            if count > 1:
                output.get_logger(self.name).warning(
                    f"there are now at least {count} nodes with the name {self.node_name} created within this "
                    "launch context"
                )

    def _names(self, context: LaunchContext) -> tuple[str | None, str | None]:
        try:
            name = None if self._node_name is None else perform(context, self._node_name)
            if name is not None:
                validate("node_name", name)
            own = None if self._namespace is None else perform(context, self._namespace)
            namespace = joined_namespace(context.launch_configurations.get("ros_namespace"), own)
            if namespace is not None:
                validate("namespace", namespace)
        except Exception:
            output.get_logger("launch_ros.actions.node").error(f"the node '{self._given}' cannot be called so:")
            raise
        return name, namespace

    def _parameter_words(self, context: LaunchContext, node: str) -> list[str]:
        words: list[str] = []
        for given in context.launch_configurations.get("global_params", ()):
            if isinstance(given, str):
                words += ["--params-file", given]
            else:
                words += ["-p", f"{given[0]}:={parameters.yaml_text(given[1], in_one_line=True).strip()}"]
        for given in self._parameters:
            if isinstance(given, parameters.ParameterFile):
                path = given.evaluate(context)
            else:
                values = {node: {"ros__parameters": parameters.flat(context, given)}}
                path = parameters.temporary_file(context, parameters.yaml_text(values, in_one_line=False))
            if os.path.isfile(path):
                words += ["--params-file", path]
            else:
                output.get_logger("launch_ros.actions.node").warning(f"Parameter file path is not a file: {path}")
        return words


def _list(given: Any) -> list[Any]:
    return [] if given is None else [given] if isinstance(given, str) else list(given)


def _pairs(remappings: Any) -> list[tuple[Any, Any]]:
    pairs = []
    for pair in remappings:
        if isinstance(pair, str) or len(pair) != 2:
            raise TypeError(f"Expecting remap rules to be pairs such as ('/from', '/to'), got {pair!r}")
        pairs.append((normalize(pair[0]), normalize(pair[1])))
    return pairs
