"""Reads XML and YAML launch files as tags, which are alike for both."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_KINDS = {bool: "true or false", float: "a number", int: "a whole number", str: "a text"}


@dataclass
class Tag:
    """One tag: its attributes, and the tags within it."""

    name: str
    attributes: dict[str, Any]
    tags: list[Tag]
    is_xml: bool = False  # all attributes are texts, to be read as what is wanted
    _read: set[str] = field(default_factory=set)

    def get(self, name: str, kind: type | None = str, may_be_text: bool = False) -> Any:
        """An attribute, None if it is not there: of that kind, or of any; or else a text. TypeError if it is not."""
        self._read |= {name, f"{name}-sep"}
        value = self.attributes.get(name)
        if value is None:
            return None
        if self.is_xml and kind is not str:
            separator = self.attributes.get(f"{name}-sep")
            value = _guess(value) if separator is None else [_guess(part) for part in value.split(separator)]
        if kind is float and type(value) is int:
            value = float(value)
        if kind is None or type(value) is kind or (may_be_text and isinstance(value, str)):
            return value
        raise TypeError(f"'{name}' of `{self.name}` is {value!r}, not {_KINDS[kind]}")

    def need(self, name: str, kind: type | None = str, may_be_text: bool = False) -> Any:
        """An attribute that has to be there. AttributeError if it is not."""
        value = self.get(name, kind, may_be_text)
        if value is None:
            raise AttributeError(f"`{self.name}` lacks its '{name}'")
        return value

    def within(self, *names: str) -> list[Tag]:
        """The tags within it that have one of these names; all, if none is given."""
        found = [tag for tag in self.tags if not names or tag.name in names]
        self._read |= {tag.name for tag in found}
        return found

    def refuse_unread(self) -> None:
        """Raise ValueError if there is an attribute or a tag that nobody has asked for."""
        for what, names in (("attribute", self.attributes), ("tag", [tag.name for tag in self.tags])):
            if unread := [name for name in names if name not in self._read]:
                raise ValueError(f"`{self.name}` takes no {what} '{unread[0]}'")


def _guess(text: str) -> Any:
    """What YAML takes a text for; the text itself if it is none."""
    import yaml

    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        return text
    return value if isinstance(value, (bool, int, float, str, list)) else text


def xml_tag(text: bytes) -> Tag:
    """The outermost tag of an XML file. ParseError if it is no XML."""
    from xml.etree import ElementTree

    return _of_element(ElementTree.fromstring(text))


def _of_element(element: Element) -> Tag:
    for words in (element.text, *(inner.tail for inner in element)):
        if words and words.strip():
            raise ValueError(f"`{element.tag}` holds tags, not text such as {words.strip()!r}")
    return Tag(element.tag, dict(element.attrib), [_of_element(inner) for inner in element], is_xml=True)


def yaml_tag(text: bytes) -> Tag:
    """The outermost tag of a YAML file. YAMLError if it is no YAML, ValueError if it has no tags."""
    import yaml

    return _only(yaml.safe_load(text))


def _only(data: Any) -> Tag:
    if not isinstance(data, dict) or len(data) != 1 or not isinstance(next(iter(data)), str):
        raise ValueError(f"Expected one tag with a colon behind it, got {data!r:.80}")
    ((name, body),) = data.items()
    return _of_data(name, body)


def _of_data(name: str, body: Any) -> Tag:
    if isinstance(body, list):
        return Tag(name, {}, [_only(inner) for inner in body])
    if not isinstance(body, dict):
        raise ValueError(f"Expected the attributes of `{name}`, got {body!r:.80}")
    tag = Tag(name, {}, [])
    for key, value in body.items():
        if key == "children":
            if not isinstance(value, list):
                raise ValueError(f"'children' of `{name}` is {value!r:.80}, not a list of tags")
            tag.tags += [_only(inner) for inner in value]
        elif isinstance(value, list) and value and all(isinstance(inner, dict) for inner in value):
            tag.tags += [_of_data(key, inner) for inner in value]
        else:
            tag.attributes[key] = value
    return tag
