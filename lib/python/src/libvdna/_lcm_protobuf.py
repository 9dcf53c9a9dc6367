"""LCM's structs as protobuf messages, described at run time."""

from __future__ import annotations

from typing import Any, Dict, List, Set

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import Message

from ._lcm_types import PRIMITIVES, Struct, TypeFileError

_Field = descriptor_pb2.FieldDescriptorProto
_FIELD_TYPES = {
    "int8_t": _Field.TYPE_INT32,
    "int16_t": _Field.TYPE_INT32,
    "int32_t": _Field.TYPE_INT32,
    "int64_t": _Field.TYPE_INT64,
    "byte": _Field.TYPE_UINT32,
    "float": _Field.TYPE_FLOAT,
    "double": _Field.TYPE_DOUBLE,
    "boolean": _Field.TYPE_BOOL,
    "string": _Field.TYPE_STRING,
}


class ProtobufType:
    """A protobuf message with the members of a struct: names as they are, numbers from 1 in their
    order. All members are written, zeros too, so that readers show a value and no gap."""

    def __init__(self, one: Struct) -> None:
        """Raises TypeFileError if protobuf cannot express it."""
        self._struct = one
        files = descriptor_pb2.FileDescriptorSet(file=_files(one))
        self.schema = files.SerializeToString()
        """As MCAP has it: the files in which it is described."""
        pool = descriptor_pool.DescriptorPool()
        try:
            for file in files.file:
                pool.Add(file)
            descriptor = pool.FindMessageTypeByName(one.full_name)
        except (TypeError, KeyError) as error:
            raise TypeFileError(
                f"{one.place}: protobuf cannot express {one.full_name}: {error}"
            ) from None
        self._class = message_factory.GetMessageClass(descriptor)

    def encode(self, members: Dict[str, Any]) -> bytes:
        """members: as decode() of _lcm_types gives them"""
        message = self._class()
        _fill(message, self._struct, members)
        # A member may be called SerializeToString.
        return bytes(self._class.SerializeToString(message))


def _files(one: Struct) -> List[descriptor_pb2.FileDescriptorProto]:
    """One file for each package, before those that use it."""
    files: Dict[str, descriptor_pb2.FileDescriptorProto] = {}
    uses: Dict[str, Set[str]] = {}
    for inner in one.with_all_within():
        name = f"{inner.package or 'no_package'}.proto"
        file = files.setdefault(
            name,
            descriptor_pb2.FileDescriptorProto(
                name=name, package=inner.package or None, syntax="proto2"
            ),
        )
        _describe(inner, file.message_type.add())
        used = {f"{other.package or 'no_package'}.proto" for other in inner.structs.values()}
        uses.setdefault(name, set()).update(used - {name})
    for name, file in files.items():
        file.dependency.extend(sorted(uses[name]))
    return _in_order(files, uses, one)


def _in_order(
    files: Dict[str, descriptor_pb2.FileDescriptorProto], uses: Dict[str, Set[str]], one: Struct
) -> List[descriptor_pb2.FileDescriptorProto]:
    ordered: List[str] = []
    while len(ordered) < len(files):
        ready = [name for name in files if name not in ordered and uses[name] <= set(ordered)]
        if not ready:
            raise TypeFileError(
                f"{one.place}: packages of {one.full_name} use one another in a circle, which "
                "protobuf does not allow"
            )
        ordered.extend(ready)
    return [files[name] for name in ordered]


def _describe(one: Struct, description: descriptor_pb2.DescriptorProto) -> None:
    description.name = one.name
    for number, member in enumerate(one.members, 1):
        is_bytes = member.type == "byte" and bool(member.dimensions)
        is_list = bool(member.dimensions) and not is_bytes
        field = description.field.add(
            name=member.name,
            json_name=member.name,
            number=number,
            label=_Field.LABEL_REPEATED if is_list else _Field.LABEL_OPTIONAL,
        )
        if member.type not in PRIMITIVES:
            field.type = _Field.TYPE_MESSAGE
            field.type_name = "." + member.type
            continue
        field.type = _Field.TYPE_BYTES if is_bytes else _FIELD_TYPES[member.type]
        if is_list and member.type != "string":
            field.options.packed = True


def _fill(message: Message, one: Struct, members: Dict[str, Any]) -> None:
    for member in one.members:
        value = members[member.name]
        inner = one.structs.get(member.type)
        if inner and member.dimensions:
            for element in value:
                _fill(getattr(message, member.name).add(), inner, element)
        elif inner:
            _fill(getattr(message, member.name), inner, value)
        elif member.dimensions and member.type != "byte":
            getattr(message, member.name).extend(value)
        else:
            setattr(message, member.name, value)
