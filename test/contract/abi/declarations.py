"""What the headers of libvdna declare, read from their text.

They are our own and plain: no macro makes a declaration, no struct is declared within another, and
a declarator is a name with stars before it or brackets behind it, or a pointer to a function.
"""

import re


def _without_comments(header):
    return re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.DOTALL)


def functions(headers):
    """Names of all functions marked VDNA_API."""
    return [name for header in headers
            for name in re.findall(r"^VDNA_API\b[^;(]*?(\w+)\(", _without_comments(header), re.M)]


def structs(headers):
    """{name of a struct: names of its fields}, of all that are defined."""
    found = {}
    for header in headers:
        text = _without_comments(header)
        seen = len(found)
        for name, body in re.findall(r"^typedef struct (\w+) \{(.*?)^\} \1;", text, re.M | re.S):
            body = re.sub(r"\(\*(\w+)\)\([^()]*\)", r"\1", body)
            found[name] = [re.search(r"(\w+)\s*(?:\[\w+\]\s*)*$", declarator)[1]
                           for declaration in body.split(";") if declaration.strip()
                           for declarator in declaration.split(",")]
        if len(re.findall(r"\b(?:struct|union)\b[^;{()]*\{", text)) != len(found) - seen:
            raise ValueError(f"{header} defines a struct in a way that is not understood here")
    return found


def enumerators(headers):
    """Names of all constants of enums."""
    return [re.match(r"\w+", constant.strip())[0] for header in headers
            for body in re.findall(r"^enum \{(.*?)^\};", _without_comments(header), re.M | re.S)
            for constant in body.split(",") if constant.strip()]
