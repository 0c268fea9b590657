"""The actions that tags of XML and YAML launch files stand for, as a Python launch file would make them."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from typing import Any

from course_kit.cli.launching import actions, parameters
from course_kit.cli.launching.conditions import IfCondition, UnlessCondition
from course_kit.cli.launching.entities import Action, LaunchDescription
from course_kit.cli.launching.event_actions import Shutdown, TimerAction
from course_kit.cli.launching.include import AnyLaunchDescriptionSource, IncludeLaunchDescription
from course_kit.cli.launching.node import Node, PushROSNamespace, SetParameter, SetParametersFromFile, SetRemap
from course_kit.cli.launching.process import ExecuteProcess
from course_kit.cli.launching.substitution_texts import Texts, command_line, parsed
from course_kit.cli.launching.substitutions import TextSubstitution
from course_kit.cli.launching.uncovered import not_covered
from course_kit.cli.launching.xml_and_yaml import Tag

Options = dict[str, Any]
_UNCOVERED = (
    "composable_node",
    "for",
    "for_each",
    "lifecycle_node",
    "load_composable_node",
    "node_container",
    "ros_timer",
)
_TYPES = {"bool": bool, "float": float, "int": int, "str": str}
_TYPES |= {f"list_of_{name}s": list[kind] for name, kind in _TYPES.items()}  # type: ignore[valid-type, misc]


def description_of(tag: Tag) -> LaunchDescription:
    """The launch description that the outermost tag of a file stands for."""
    if tag.name != "launch":
        raise ValueError(f"The outermost tag is `{tag.name}`, not `launch`")
    description = LaunchDescription(_actions(tag.within()), deprecated_reason=tag.get("deprecated"))
    tag.refuse_unread()
    return description


def _actions(tags: list[Tag]) -> list[Action]:
    return [_action(tag) for tag in tags]


def _action(tag: Tag) -> Action:
    if tag.name in _UNCOVERED:
        raise not_covered(f"<{tag.name}>", ())
    if tag.name not in _MAKE:
        near = difflib.get_close_matches(tag.name, _MAKE, n=1)
        hint = "".join(f" (did you mean {name}?)" for name in near)
        raise ValueError(f"`{tag.name}` is no tag of a launch file{hint}")
    positive, negative = _text(tag, "if"), _text(tag, "unless")
    if positive and negative:
        raise ValueError(f"`{tag.name}` has both 'if' and 'unless': give one of them")
    condition = IfCondition(positive) if positive else UnlessCondition(negative) if negative else None
    action = _MAKE[tag.name](tag, condition=condition)
    tag.refuse_unread()
    return action


def _text(tag: Tag, name: str) -> Texts | None:
    value = tag.get(name)
    return None if value is None else parsed(value)


def _needed(tag: Tag, name: str) -> Texts:
    return parsed(tag.need(name))


def _given(tag: Tag, **names: str) -> Options:
    """Attributes that are there, by what the action calls them."""
    texts = {ours: _text(tag, theirs) for ours, theirs in names.items()}
    return {name: text for name, text in texts.items() if text is not None}


def _pairs(tags: list[Tag], first: str, second: str) -> list[tuple[tuple[Any, ...], Texts]]:
    pairs = [(tuple(_needed(tag, first)), _needed(tag, second)) for tag in tags]
    for tag in tags:
        tag.refuse_unread()
    return pairs


def _with_texts(make: Callable[..., Action], **names: str) -> Callable[..., Action]:
    """An action whose arguments are attributes, all of which must be there."""
    return lambda tag, **options: make(**{ours: _needed(tag, theirs) for ours, theirs in names.items()}, **options)


def _argument(tag: Tag, **options: Any) -> Action:
    choices = [choice.need("value") for choice in tag.within("choice")] or None
    return actions.DeclareLaunchArgument(
        tag.need("name"),
        **_given(tag, default_value="default"),
        description=tag.get("description"),
        choices=choices,
        **options,
    )


def _append(tag: Tag, **options: Any) -> Action:
    prepend = bool(tag.get("prepend", bool))
    options |= _given(tag, separator="separator")
    return actions.AppendEnvironmentVariable(_needed(tag, "name"), _needed(tag, "value"), prepend=prepend, **options)


def _group(tag: Tag, **options: Any) -> Action:
    scopes = {name: tag.get(name, bool) for name in ("scoped", "forwarding")}
    kept = dict(_pairs(tag.within("keep"), "name", "value"))
    inner = _actions([one for one in tag.within() if one.name != "keep"])
    options |= {name: value for name, value in scopes.items() if value is not None}
    return actions.GroupAction(inner, launch_configurations=kept, **options)


def _include(tag: Tag, **options: Any) -> Action:
    source = AnyLaunchDescriptionSource(_needed(tag, "file"))
    arguments = _pairs(tag.within("arg", "let"), "name", "value")
    return IncludeLaunchDescription(source, launch_arguments=arguments, **options)


def _shutdown(tag: Tag, **options: Any) -> Action:
    reason = tag.get("reason")
    return Shutdown(**({} if reason is None else {"reason": reason}), **options)


def _timer(tag: Tag, **options: Any) -> Action:
    period = tag.need("period", float, may_be_text=True)
    period = parsed(period) if isinstance(period, str) else period
    return TimerAction(period=period, actions=_actions(tag.within()), **options)


def _process(tag: Tag) -> Options:
    """The options of a process, of whichever kind."""
    options = _given(tag, cwd="cwd", output="output", prefix="launch-prefix")
    kinds = {"shell": bool, "emulate_tty": bool, "respawn_delay": float, "respawn_max_retries": int}
    kinds |= {"sigterm_timeout": float, "sigkill_timeout": float}
    options |= {name: value for name, kind in kinds.items() if (value := tag.get(name, kind)) is not None}
    respawn = tag.get("respawn", bool, may_be_text=True)
    if respawn is not None:
        options["respawn"] = parsed(respawn) if isinstance(respawn, str) else respawn
    if (exit_word := tag.get("on_exit")) is not None:
        if exit_word != "shutdown":
            raise ValueError(f"'on_exit' of `{tag.name}` is {exit_word!r}: it can be 'shutdown' only")
        options["on_exit"] = Shutdown()
    if environment := _pairs(tag.within("env"), "name", "value"):
        options["additional_env"] = dict(environment)
    return options


def _executable(tag: Tag, **options: Any) -> Action:
    return ExecuteProcess(cmd=command_line(tag.need("cmd")), **_given(tag, name="name"), **_process(tag), **options)


def _node(tag: Tag, **options: Any) -> Action:
    options |= _process(tag) | _given(tag, package="pkg", name="name", namespace="namespace", exec_name="exec_name")
    for ours, theirs in (("arguments", "args"), ("ros_arguments", "ros_args")):
        if (words := tag.get(theirs)) is not None:
            options[ours] = command_line(words)
    if given := [_parameters(one) for one in tag.within("param")]:
        options["parameters"] = given
    remappings = _pairs(tag.within("remap"), "from", "to")
    return Node(executable=_needed(tag, "exec"), remappings=remappings, **options)


def _parameters(tag: Tag) -> Any:
    """What a node gets by a tag: a file, or a dictionary of one parameter, which may have others in it."""
    file, allow = _text(tag, "from"), tag.get("allow_substs", bool, may_be_text=True)
    if file is None:
        if allow is not None:
            raise ValueError("'allow_substs' is about files: it goes with 'from'")
        return _parameter(tag)
    if tag.get("name") is not None:
        raise ValueError("`param` has both 'name' and 'from': give one of them")
    tag.refuse_unread()
    return parameters.ParameterFile(file, allow_substs=parsed(allow) if isinstance(allow, str) else bool(allow))


def _parameter(tag: Tag) -> Options:
    name = tuple(_needed(tag, "name"))
    inner = tag.within("param")
    given = _value(tag) if inner == [] else {key: value for one in inner for key, value in _parameter(one).items()}
    tag.refuse_unread()
    return {name: given}  # type: ignore[dict-item]


def _value(tag: Tag) -> parameters.ParameterValue:
    kind = tag.get("type")
    if kind is not None and kind not in _TYPES:
        raise ValueError(f"'type' of `{tag.name}` is {kind!r}: it can be {', '.join(_TYPES)}")
    value = tag.need("value", str if kind == "str" else None)
    plain = [_plain(one) for one in value] if isinstance(value, list) else _plain(value)
    return parameters.ParameterValue(plain, value_type=None if kind is None else _TYPES[kind])


def _plain(value: Any) -> Any:
    """A value; a text with substitutions as what it is made of."""
    if not isinstance(value, str):
        return value
    text = parsed(value)
    return text[0].text if len(text) == 1 and isinstance(text[0], TextSubstitution) else text


_NAMESPACE = _with_texts(PushROSNamespace, namespace="namespace")
_MAKE: dict[str, Callable[..., Action]] = {
    "append_env": _append,
    "arg": _argument,
    "executable": _executable,
    "group": _group,
    "include": _include,
    "let": _with_texts(actions.SetLaunchConfiguration, name="name", value="value"),
    "log": _with_texts(actions.LogInfo, msg="message"),
    "node": _node,
    "push-ros-namespace": _NAMESPACE,
    "push_ros_namespace": _NAMESPACE,
    "set_env": _with_texts(actions.SetEnvironmentVariable, name="name", value="value"),
    "set_parameter": lambda tag, **options: SetParameter(_needed(tag, "name"), _value(tag), **options),
    "set_parameters_from_file": _with_texts(SetParametersFromFile, filename="filename"),
    "set_remap": _with_texts(SetRemap, src="from", dst="to"),
    "shutdown": _shutdown,
    "timer": _timer,
    "unset": _with_texts(actions.UnsetLaunchConfiguration, name="name"),
    "unset_env": _with_texts(actions.UnsetEnvironmentVariable, name="name"),
}
