"""Write the members of our messages as C tables, from the .lcm files (see vdna/message.h).

    message_table.py fingerprints.txt           print each .lcm file and the types in it
    message_table.py fingerprints.txt FOLDER    write FOLDER/vdna_messages.h and .c

fingerprints.txt lists our messages; package.NAME_t is in NAME.lcm beside it. Only the part of LCM's
language that these files use is understood: one package, `//` comments, constants of type int32_t,
members of a type in KINDS or of an earlier struct, arrays of one dimension, which is a number or an
earlier int32_t. Anything else is refused with its place, because a wrong table makes every check
wrong. So are names that break the code of subscribers: lcm-gen itself checks none, and writes
Python that cannot be imported and C++ that does not compile.
"""
import re
import sys
from pathlib import Path

KINDS = {"boolean": "BOOLEAN", "byte": "BYTE", "int32_t": "INT32", "int64_t": "INT64",
         "double": "DOUBLE", "string": "STRING"}
TOKEN = re.compile(r"\s+|(?P<comment>//.*)|(?P<token>[A-Za-z_]\w*|\d+|[{}\[\];=])")
# The camera drivers' name, not ours to choose: every language but Go can have it.
GIVEN = {"bot_core.image_t.size"}


class Refusal(Exception):
    """A statement of the files that the tables cannot express."""

    def __init__(self, path, line, sentence):
        super().__init__(f"{path}:{line}: {sentence}")


def spelling(name):
    """What a name is in any language: Go writes marshal_binary as MarshalBinary."""
    return name.replace("_", "").lower()


def read_reserved():
    """The names in reserved.txt: spelling -> what it is."""
    owners = {}
    for line in Path(__file__).with_name("reserved.txt").read_text(encoding="ascii").splitlines():
        if not line.startswith("#"):
            owner, names = line.split(": ")
            for name in names.split():
                owners.setdefault(spelling(name), owner)
    return owners


RESERVED = read_reserved()


class Member:
    def __init__(self, name, kind, struct):
        self.name, self.kind, self.struct = name, kind, struct
        self.lcm_type = ""       # as in the file, if it is not a struct
        self.length = 1          # 0: see `count`
        self.count = None        # index of the member with the length
        self.dimension = None    # as in the file


class Struct:
    def __init__(self, package, name, path, line):
        self.package, self.name, self.path, self.line = package, name, path, line
        self.members = []
        self.names = set()       # of members and constants
        self.short_name = name.removesuffix("_t")
        self.c_name = f"{package}_{name}"
        self.full_name = f"{package}.{name}"


class Parser:
    """The structs of one file."""

    def __init__(self, path):
        self.path, self.tokens, self.at = path, [], 0
        for number, text in enumerate(path.read_text(encoding="utf-8").split("\n"), 1):
            self.line = number
            self._split(text)
        self.tokens.append(("the end of the file", self.line))

    def _split(self, text):
        at = 0
        while at < len(text):
            match = TOKEN.match(text, at)
            if not match:
                self.refuse(f"'{text[at:]}' is not in the part of LCM's language that our files "
                            "use; write it with what they use")
            if match["token"]:
                self.tokens.append((match["token"], self.line))
            if match["comment"] and text[:at].strip():
                self.refuse(f"'{match['comment']}' stands behind a statement, where lcm-gen takes "
                            "it for a comment on the next one; put it above")
            at = match.end()

    def refuse(self, sentence):
        raise Refusal(self.path, self.line, sentence)

    def next(self):
        token, self.line = self.tokens[self.at]
        self.at = min(self.at + 1, len(self.tokens) - 1)
        return token

    def expect(self, pattern, what):
        token = self.next()
        if not re.fullmatch(pattern, token):
            self.refuse(f"found '{token}', expected {what}; other forms are not understood")
        return token

    def skip(self, token):
        """Skip this token, if it is the next one."""
        is_next = self.tokens[self.at][0] == token
        if is_next:
            self.next()
        return is_next

    def name(self, what):
        return self.expect(r"[A-Za-z_]\w*", what)

    def new_name(self, struct, what):
        """A name for something in the struct, with which subscribers can compile it."""
        name = self.name(f"the name of a {what}")
        full_name = f"{struct.full_name}.{name}"
        owner = RESERVED.get(spelling(name))
        if name in struct.names:
            self.refuse(f"{what} {name} is there twice; rename one")
        if name.startswith("_") or name == struct.name:
            self.refuse(f"{what} {name} has the name of the struct or begins with '_', as names of "
                        "generated code do; rename it")
        if owner and full_name not in GIVEN:
            self.refuse(f"{what} {name} is under '{owner}' in reserved.txt: in that language the "
                        "type does not compile; rename it")
        struct.names.add(name)
        return name

    def structs(self):
        self.expect("package", "package")
        package = self.name("the name of the package")
        self.expect(";", "';'")
        known = {}
        while self.at < len(self.tokens) - 1:
            self.expect("struct", "struct")
            struct = Struct(package, self.name("the name of the struct"), self.path, self.line)
            if struct.name in known:
                self.refuse(f"struct {struct.name} is there twice; rename one")
            self.read_members(struct, known)
            known[struct.name] = struct
        return list(known.values())

    def read_members(self, struct, known):
        self.expect("{", "'{'")
        while not self.skip("}"):
            if self.skip("const"):
                self.read_constant(struct)
            else:
                self.read_member(struct, known)
        if not struct.members:
            self.refuse(f"struct {struct.name} has no members, expected one or more; "
                        "add one or remove it")

    def read_constant(self, struct):
        """Skip constants, which are no part of a message."""
        self.expect("int32_t", "int32_t, the type of our constants")
        self.new_name(struct, "constant")
        self.expect("=", "'='")
        self.expect(r"\d+", "a number")
        self.expect(";", "';'")

    def read_member(self, struct, known):
        lcm_type = self.name("a type or '}'")
        if lcm_type not in KINDS and lcm_type not in known:
            self.refuse(f"type {lcm_type}, expected one of {', '.join(KINDS)} or a struct that is "
                        "declared above; use one of them, or teach message_table.py")
        name = self.new_name(struct, "member")
        member = Member(name, KINDS.get(lcm_type, "STRUCT"), known.get(lcm_type))
        member.lcm_type = "" if member.struct else lcm_type
        if self.skip("["):
            self.read_dimension(struct, member)
        self.expect(";", "';' or one dimension")
        struct.members.append(member)

    def read_dimension(self, struct, member):
        member.dimension = self.expect(r"[1-9]\d*|[A-Za-z_]\w*",
                                       "a number of 1 or more, or an earlier int32_t")
        self.expect(r"\]", "']'")
        if member.dimension.isdecimal():
            member.length = int(member.dimension)
            return
        member.length = 0
        for index, count in enumerate(struct.members):
            if (count.name, count.lcm_type, count.dimension) == (member.dimension, "int32_t", None):
                count.kind = "COUNT"
                member.count = index
                return
        self.refuse(f"'{member.dimension}' counts the elements of {member.name}, expected a "
                    f"member of type int32_t before it; declare it there")


def signed(value):
    """The low 64 bits, as in LCM's hash."""
    return (value + (1 << 63)) % (1 << 64) - (1 << 63)


def fingerprint(struct):
    """LCM's hash of the names, primitive types and dimensions of the members and of the structs in
    them."""
    value = 0x12345678

    def add(*numbers):
        nonlocal value
        for number in numbers:
            value = signed((value << 8 ^ value >> 55) + number)

    def add_text(text):
        add(len(text), *text.encode("ascii"))

    for member in struct.members:
        add_text(member.name)
        if not member.struct:
            add_text(member.lcm_type)
        add(0 if member.dimension is None else 1)
        if member.dimension is not None:
            add(0 if member.dimension.isdecimal() else 1)
            add_text(member.dimension)
    value += sum(fingerprint(member.struct) for member in struct.members if member.struct)
    value %= 1 << 64
    return (value << 1 | value >> 63) % (1 << 64)


def pinned(fingerprints):
    """The lines of fingerprints.txt: line number, package, name of the file, name, fingerprint."""
    for line, text in enumerate(fingerprints.read_text(encoding="ascii").splitlines(), 1):
        match = re.fullmatch(r"(\w+)\.((\w+)_t) ([0-9a-f]{16})", text)
        if not match:
            raise Refusal(fingerprints, line, f"found '{text}', expected package.NAME_t and 16 "
                          "hexadecimal digits; correct it")
        package, name, stem, digits = match.groups()
        yield line, f"{package}.{name}", fingerprints.with_name(f"{stem}.lcm"), int(digits, 16)


def read_file(fingerprints, line, full_name, path, pin):
    """The structs in the file of a message; its fingerprint must be the pinned one."""
    if not path.exists():
        raise Refusal(fingerprints, line, f"{full_name} is expected in {path.name}, which is not "
                      "there; write it, or remove the line")
    structs = Parser(path).structs()
    for struct in structs:
        if struct.full_name == full_name and fingerprint(struct) == pin:
            return structs
    found = [f"{struct.full_name} {fingerprint(struct):016x}" for struct in structs]
    raise Refusal(fingerprints, line, f"{full_name} is pinned as {pin:016x}, {path.name} has "
                  f"{', '.join(found)}; a change is a new version of the interface: if it is "
                  "meant, pin the new fingerprint and tell it in docs/reference/SPEC-lcm.md")


def read(fingerprints):
    """The structs of all files, in the order of fingerprints.txt."""
    structs = [struct for message in pinned(fingerprints)
               for struct in read_file(fingerprints, *message)]
    owners = {}
    for struct in structs:
        other = owners.setdefault(struct.short_name, struct)
        if other is not struct:
            raise Refusal(struct.path, struct.line, f"{struct.full_name} and {other.full_name} "
                          f"would both be vdna_message_{struct.short_name}; rename one")
    return structs


HEADER = """\
/* Written by lcmtypes/message_table.py: the table of each of our messages. */
#ifndef VDNA_MESSAGES_H
#define VDNA_MESSAGES_H

#include <vdna/message.h>

#ifdef __cplusplus
extern "C" {{
#endif

{declarations}

/* All of them. */
#define VDNA_MESSAGE_TYPES {count}
extern const vdna_message_type *const vdna_message_types[VDNA_MESSAGE_TYPES];

#ifdef __cplusplus
}}
#endif

#endif
"""

SOURCE = """\
/* Written by lcmtypes/message_table.py. */
#include "vdna_messages.h"
#include <stddef.h>
{includes}
{tables}
const vdna_message_type *const vdna_message_types[VDNA_MESSAGE_TYPES] = {{
{references}
}};
"""

TABLE = """
#if {count} > VDNA_MESSAGE_MEMBERS_MAX
#error "{place}: {full_name} has {count} members; see VDNA_MESSAGE_MEMBERS_MAX"
#endif
static int32_t {short}_encoded_size(const void *message)
{{
    return {c_name}_encoded_size(message);
}}
static int32_t {short}_encode(const void *message, void *out_data, int32_t size)
{{
    return {c_name}_encode(out_data, 0, size, message);
}}
static int32_t {short}_decode(const void *data, int32_t size, void *out_message)
{{
    return {c_name}_decode(data, 0, size, out_message);
}}
static void {short}_cleanup(void *message)
{{
    {c_name}_decode_cleanup(message);
}}
static const vdna_message_member {short}_members[] = {{
{members}
}};
const vdna_message_type vdna_message_{short} = {{
    "{full_name}", UINT64_C(0x{fingerprint:016x}), sizeof({c_name}), {count}, {short}_members,
    {short}_encoded_size, {short}_encode, {short}_decode, {short}_cleanup,
}};
"""


def row(struct, member):
    nested = f"&vdna_message_{member.struct.short_name}" if member.struct else "NULL"
    return (f'    {{"{member.name}", VDNA_MESSAGE_{member.kind}, '
            f"offsetof({struct.c_name}, {member.name}), {member.length}, {member.count or 0}, "
            f"{nested}}},")


def table(struct):
    return TABLE.format(short=struct.short_name, c_name=struct.c_name, full_name=struct.full_name,
                        fingerprint=fingerprint(struct), count=len(struct.members),
                        place=f"{struct.path.name}:{struct.line}",
                        members="\n".join(row(struct, member) for member in struct.members))


def write(structs, folder):
    names = [f"vdna_message_{struct.short_name}" for struct in structs]
    declarations = "\n".join(f"extern const vdna_message_type {name};" for name in names)
    (folder / "vdna_messages.h").write_text(
        HEADER.format(declarations=declarations, count=len(names)), encoding="ascii")
    (folder / "vdna_messages.c").write_text(
        SOURCE.format(includes="\n".join(f"#include <{struct.c_name}.h>" for struct in structs),
                      tables="".join(map(table, structs)),
                      references="\n".join(f"    &{name}," for name in names)), encoding="ascii")


def main():
    structs = read(Path(sys.argv[1]))
    if len(sys.argv) > 2:
        write(structs, Path(sys.argv[2]))
        return
    for path in dict.fromkeys(struct.path for struct in structs):
        print(path.name, *(struct.c_name for struct in structs if struct.path == path))


if __name__ == "__main__":
    try:
        main()
    except Refusal as refusal:
        sys.exit(str(refusal))
