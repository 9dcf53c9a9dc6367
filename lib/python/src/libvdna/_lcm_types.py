"""LCM's types, from .lcm files at run time: grammar, fingerprint and decoder.

All of lcm-gen's language is understood but `enum`, which lcm-gen itself discourages.
"""

from __future__ import annotations

import pathlib
import re
import struct
from dataclasses import dataclass, field
from math import prod
from typing import Any, Dict, Iterator, List, NoReturn, Optional, Tuple, Union

_TOKEN = re.compile(
    r"\s+|//[^\n]*|/\*.*?\*/|(?P<token>[A-Za-z_][\w.]*|[-+]?(?:0[xX][0-9a-fA-F]+|[\d.][\w.+-]*)|[{}\[\];,=])",
    re.DOTALL | re.ASCII,
)
_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_QUALIFIED = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*", re.ASCII)

# How struct unpacks a primitive type; strings are another matter.
PRIMITIVES = {
    "int8_t": "b",
    "int16_t": "h",
    "int32_t": "i",
    "int64_t": "q",
    "byte": "B",
    "float": "f",
    "double": "d",
    "boolean": "B",
    "string": "",
}
_COUNTS = ("int8_t", "int16_t", "int32_t", "int64_t", "byte")
_DEPTH_MAX = 64  # structs within structs: protobuf itself reads no more than 100
_MASK = 2**64 - 1

FINGERPRINT_SIZE = 8
"""Bytes before the members of a message."""


class DamagedMessage(ValueError):
    """Bytes that are no message of their type."""


class TypeFileError(ValueError):
    """A .lcm file that cannot be understood: says where and why."""


@dataclass(frozen=True)
class Member:
    name: str
    type: str
    """A primitive type, or the full name of a struct."""
    dimensions: Tuple[Union[int, str], ...]
    """Of an array: numbers, and names of earlier members."""
    texts: Tuple[str, ...]
    """The dimensions as the fingerprint has them."""


@dataclass
class Struct:
    package: str
    name: str
    place: str
    """File and line."""
    members: List[Member] = field(default_factory=list)
    structs: Dict[str, Struct] = field(default_factory=dict)
    """Those of its members, by their full names."""

    @property
    def full_name(self) -> str:
        return f"{self.package}.{self.name}" if self.package else self.name

    def with_all_within(self) -> List[Struct]:
        """It and all structs in it, at any depth, each once; itself first."""
        found: Dict[str, Struct] = {}
        waiting = [self]
        while waiting:
            one = waiting.pop()
            if one.full_name not in found:
                found[one.full_name] = one
                waiting.extend(one.structs.values())
        return list(found.values())


class Types:
    """The structs of .lcm files, by fingerprint."""

    def __init__(self, path: pathlib.Path, base: Optional[Types] = None) -> None:
        """path: a file, or a folder with .lcm files in it or below; base: where types are looked up
        that it does not have. Raises TypeFileError, OSError."""
        self._base = base
        self._structs: Dict[str, Struct] = {}
        files = sorted(path.rglob("*.lcm")) if path.is_dir() else [path]
        if not files:
            raise TypeFileError(f"{path}: no .lcm files in this folder or below it")
        for file in files:
            for found in _Parser(file).structs():
                self._add(found)
        for found in self._structs.values():
            self._resolve(found)
        self._by_fingerprint = {fingerprint(one): one for one in self._structs.values()}

    def find(self, fingerprint: int) -> Optional[Struct]:
        """The struct with this fingerprint; None if there is none."""
        found = self._by_fingerprint.get(fingerprint)
        return self._base.find(fingerprint) if found is None and self._base else found

    def named(self, full_name: str) -> Optional[Struct]:
        found = self._structs.get(full_name)
        return self._base.named(full_name) if found is None and self._base else found

    def _add(self, new: Struct) -> None:
        other = self._structs.setdefault(new.full_name, new)
        if other is not new:
            raise TypeFileError(
                f"{new.place}: struct {new.full_name} is in {other.place} too; "
                "give the two versions with a --types of their own"
            )

    def _resolve(self, one: Struct) -> None:
        for member in one.members:
            if member.type in PRIMITIVES:
                continue
            found = self.named(member.type)
            if found is None:
                raise TypeFileError(
                    f"{one.place}: {one.full_name}.{member.name} has type {member.type}, which is "
                    "in no file given; put its .lcm file into the same folder"
                )
            one.structs[member.type] = found


class _Parser:
    """The structs of one file."""

    def __init__(self, path: pathlib.Path) -> None:
        self._path = path
        self._tokens: List[Tuple[str, int]] = []  # and its line
        text = path.read_text(encoding="utf-8", errors="replace")
        at, line = 0, 1
        while at < len(text):
            match = _TOKEN.match(text, at)
            if not match:
                self._refuse(line, f"'{text[at : at + 20]}'", "a statement of LCM's language")
            if match["token"]:
                self._tokens.append((match["token"], line))
            line += match[0].count("\n")
            at = match.end()
        self._end = ("the end of the file", line)
        self._at = 0
        self._package = ""

    def structs(self) -> Iterator[Struct]:
        while self._at < len(self._tokens):
            keyword, line = self._next()
            if keyword == "package":
                self._package = self._expect(_QUALIFIED, "the name of a package")
                self._expect(";", "';'")
            elif keyword == "struct":
                yield self._struct(line)
            else:
                self._refuse(line, f"'{keyword}'", "package or struct; enum is not understood")

    def _refuse(self, line: int, found: str, expected: str) -> NoReturn:
        raise TypeFileError(f"{self._path}:{line}: found {found}, expected {expected}")

    def _peek(self) -> str:
        return self._tokens[self._at][0] if self._at < len(self._tokens) else ""

    def _next(self) -> Tuple[str, int]:
        token = self._tokens[self._at] if self._at < len(self._tokens) else self._end
        self._at += 1
        return token

    def _expect(self, wanted: Union[str, "re.Pattern[str]"], what: str) -> str:
        token, line = self._next()
        fits = token == wanted if isinstance(wanted, str) else bool(wanted.fullmatch(token))
        if not fits:
            self._refuse(line, f"'{token}'", what)
        return token

    def _struct(self, line: int) -> Struct:
        name = self._expect(_NAME, "the name of the struct")
        made = Struct(self._package, name, f"{self._path}:{line}")
        constants: Dict[str, str] = {}
        self._expect("{", "'{'")
        while self._peek() != "}":
            if self._peek() == "const":
                self._constants(constants)
            else:
                self._members(made, constants)
        self._next()
        if self._peek() == ";":
            self._next()
        return made

    def _constants(self, constants: Dict[str, str]) -> None:
        """`const int32_t A = 1, B = 2;`"""
        self._next()
        self._expect(_NAME, "the type of a constant")
        while True:
            name = self._expect(_NAME, "the name of a constant")
            self._expect("=", "'='")
            constants[name], _ = self._next()
            if not self._more():
                return

    def _more(self) -> bool:
        """After one of a list: ',' and another one, or ';'."""
        token, line = self._next()
        if token not in (",", ";"):
            self._refuse(line, f"'{token}'", "',' or ';'")
        return token == ","

    def _members(self, made: Struct, constants: Dict[str, str]) -> None:
        """`int32_t n, values[n];`"""
        type_name = self._expect(_QUALIFIED, "a type or '}'")
        if type_name not in PRIMITIVES and "." not in type_name and self._package:
            type_name = f"{self._package}.{type_name}"
        while True:
            line = self._tokens[min(self._at, len(self._tokens) - 1)][1]
            name = self._expect(_NAME, "the name of a member")
            if any(other.name == name for other in made.members):
                self._refuse(line, f"a second member {name}", "another name")
            dimensions, texts = self._dimensions(made, constants)
            made.members.append(Member(name, type_name, tuple(dimensions), tuple(texts)))
            if not self._more():
                return

    def _dimensions(
        self, made: Struct, constants: Dict[str, str]
    ) -> Tuple[List[Union[int, str]], List[str]]:
        dimensions: List[Union[int, str]] = []
        texts: List[str] = []
        while self._peek() == "[":
            self._next()
            token, line = self._next()
            text = constants.get(token, token)
            texts.append(text)
            if text[:1].isdigit():
                dimensions.append(self._number(text, line))
            elif any(
                (one.name, one.dimensions) == (token, ()) and one.type in _COUNTS
                for one in made.members
            ):
                dimensions.append(token)
            else:
                self._refuse(line, f"'{token}'", "a number, or an integer that is declared above")
            self._expect("]", "']'")
        return dimensions, texts

    def _number(self, text: str, line: int) -> int:
        try:
            return int(text, 0)
        except ValueError:
            self._refuse(line, f"'{text}'", "a whole number")


def _signed(value: int) -> int:
    return (value + 2**63) % 2**64 - 2**63


def _own_hash(one: Struct) -> int:
    """Of the names, primitive types and dimensions of the members."""
    value = 0x12345678

    def add(number: int) -> None:
        nonlocal value
        value = _signed((value << 8 ^ value >> 55) + number)

    def add_text(text: str) -> None:
        for number in (len(text), *text.encode()):
            add(number)

    for member in one.members:
        add_text(member.name)
        if member.type in PRIMITIVES:
            add_text(member.type)
        add(len(member.dimensions))
        for dimension, text in zip(member.dimensions, member.texts):
            add(1 if isinstance(dimension, str) else 0)
            add_text(text)
    return value


def fingerprint(one: Struct, parents: Tuple[str, ...] = ()) -> int:
    """LCM's hash, which the messages of a type begin with."""
    if one.full_name in parents:
        return 0
    value = _own_hash(one)
    for member in one.members:
        if member.type in one.structs:
            value += fingerprint(one.structs[member.type], (*parents, one.full_name))
    value &= _MASK
    return (value << 1 | value >> 63) & _MASK


def fingerprint_of(message: bytes) -> Optional[int]:
    """Of a message; None if it is too short to have one."""
    if len(message) < FINGERPRINT_SIZE:
        return None
    return int.from_bytes(message[:FINGERPRINT_SIZE], "big")


def text_of(raw: bytes) -> str:
    """A text of a message or log; bytes that are no UTF-8 become \\xff."""
    return raw.decode("utf-8", "backslashreplace")


def decode(one: Struct, message: bytes) -> Dict[str, Any]:
    """The members of a message by name. Arrays of several dimensions are one list, the last
    dimension running fastest; arrays of bytes are bytes. Raises DamagedMessage."""
    cursor = _Cursor(message, FINGERPRINT_SIZE)
    members = cursor.struct(one, 1)
    if cursor.rest():
        raise DamagedMessage(f"{cursor.rest()} bytes too many")
    return members


class _Cursor:
    def __init__(self, message: bytes, at: int) -> None:
        self._message, self._at = message, at

    def rest(self) -> int:
        return len(self._message) - self._at

    def _take(self, size: int) -> bytes:
        if not 0 <= size <= self.rest():
            raise DamagedMessage(f"has {self.rest()} bytes where {size} are expected")
        self._at += size
        return self._message[self._at - size : self._at]

    def struct(self, one: Struct, depth: int) -> Dict[str, Any]:
        if depth > _DEPTH_MAX:
            raise DamagedMessage(f"its structs are nested more than {_DEPTH_MAX} deep")
        members: Dict[str, Any] = {}
        for member in one.members:
            values = self._values(one, member, _count(member, members), depth)
            members[member.name] = values if member.dimensions else values[0]
        return members

    def _values(self, one: Struct, member: Member, count: int, depth: int) -> Any:
        code = PRIMITIVES.get(member.type)
        if code:
            return self._numbers(member, code, count)
        # Each string or struct has at least a byte, so that a count cannot keep us busy.
        if count > self.rest() and count > 1:
            raise DamagedMessage(f"{member.name} claims {count} elements")
        if member.type == "string":
            return [self._string() for _ in range(count)]
        inner = one.structs[member.type]
        return [self.struct(inner, depth + 1) for _ in range(count)]

    def _numbers(self, member: Member, code: str, count: int) -> Any:
        raw = self._take(count * struct.calcsize(code))
        if member.type == "byte" and member.dimensions:
            return raw
        numbers = list(struct.unpack(f">{count}{code}", raw))
        return [number != 0 for number in numbers] if member.type == "boolean" else numbers

    def _string(self) -> str:
        (size,) = struct.unpack(">i", self._take(4))
        raw = self._take(size)
        if not raw.endswith(b"\0"):
            raise DamagedMessage("a string does not end in NUL")
        return text_of(raw[:-1])


def _count(member: Member, before: Dict[str, Any]) -> int:
    """How many values a member has; `before`: the members before it."""
    counts = [before[one] if isinstance(one, str) else one for one in member.dimensions]
    if any(count < 0 for count in counts):
        raise DamagedMessage(f"{member.name} has a negative number of elements")
    return prod(counts)
