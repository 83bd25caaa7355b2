#!/usr/bin/python3
"""No source names something of its own like what a header of its namespace, or of one around it, declares.

Inside an anonymous namespace the own name is found first, without a word from the compiler; and a room's sources are compiled several at a
time, so it is found in those of its neighbours, too: ten blocks once became eight that way."""
import pathlib
import re
import sys

CONSTANT = re.compile(r"(?:inline |static )*(?:constexpr|const) [^;(]*")
NAME = re.compile(r"\b(k[A-Z]\w*)(?:\[\w*\])?\s*[={]")
FUNCTION = re.compile(r"(?!return |else |using |typedef )(?:inline |static |constexpr )*(?:const )?[A-Za-z_][\w:]*(?:<[^=;]*?>)?[ &*]+(\w+)\(")


def names_of(text):
    """Pairs of namespace and name that begin a line; "" ends the name of an anonymous namespace."""
    around = []
    for statement in re.split(r"\n(?=[^\s}])|(?<=\n)(?=})", text):
        if opened := re.match(r"(?:inline )?namespace ?([\w:]*) ?\{", statement):
            around.append(opened[1])
        elif re.match(r"\}  // namespace", statement):
            around.pop()
        elif constant := CONSTANT.match(statement):
            yield from ((tuple(around), name) for name in NAME.findall(constant[0]))
        if found := FUNCTION.match(statement):
            yield tuple(around), found[1]


def flat(around):
    return "::".join(name for name in around if name)


def main(root):
    declared = {}
    for base in (root / "include", root / "src", root / "test"):
        for path in sorted(base.rglob("*.h")):
            for around, name in names_of(path.read_text()):
                declared.setdefault((flat(around), name), path)
    faults, looked_at = [], 0
    for path in sorted([*(root / "src").rglob("*.cpp"), *(root / "test").rglob("*.cpp")]):
        for around, name in sorted(set(names_of(path.read_text()))):
            if "" not in around:
                continue
            looked_at += 1
            scopes = flat(around).split("::")
            for depth in range(len(scopes), 0, -1):
                if header := declared.get(("::".join(scopes[:depth]), name)):
                    faults.append(f"{path.relative_to(root)}: {name} hides the one of {header.relative_to(root)}: give it a name of its own")
    print("\n".join(faults) or f"{looked_at} names of sources' own: none hides a header's")
    return 1 if faults or not looked_at else 0


sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)))
