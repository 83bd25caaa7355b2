#!/usr/bin/python3
"""Docs that are true: docs/files.md has exactly the keys that the readers accept and the reports write, each with its meaning, every
relative link leads somewhere, no page names a file of the repository that is gone, docs/tracing.md names every effect, and rosrun finds the
programs of the pages.

Usage: docs_check.py [ROOT]     exit status 1 when anything is wrong, one line each
"""
import os
import pathlib
import re
import subprocess
import sys

# map.number("key", ...) and the like; helpers that take the map first: degrees(map, "key"), readSign(map, "key"), bit("key", ...).
ASKED = re.compile(r'(?:\.|->)(?:text|textOr|number|numberOr|integer|integerOr|flagOr|numbers|texts|choice|choiceOr|map|mapIfAny|maps)'
                   r'\(\s*"(\w+)"|\b(?:degrees|readSign|unsignedNumber|readVector3|readEffects|readFriction|findPort|bit)\((?:\s*\w+\s*,)?\s*"(\w+)"'
                   r'|\{"(\w+_(?:m|deg))", "')
WRITTEN = re.compile(r'\{"(\w+)",|\["(\w+)"\]')
TABLE_KEY = re.compile(r"^\| `([\w]+)` \|")
# Folders whose files pages may name; "NAME" and "*" in a path stand for any name.
NAMED = re.compile(r"`((?:config|docs|include|launch|pages|scripts|src|test|urdf|cmake|msg|srv|action|cfg)/[\w./*-]+)")
ROOMS = re.compile(r"`((?:base|mechanism|rt|hardware|recording|dynamics|trajectory|excitation|simulation|identification|control|tracing"
                   r"|report|tuning|nodes)/[\w./*-]+)")


def sources(root, names):
    for name in names.split():
        path = root / name
        if not path.exists():
            yield name, None
        for file in sorted(path.rglob("*.cpp")) if path.is_dir() else [path]:
            if file.exists():  # lists of names are no keys
                yield name, "\n".join(line for line in file.read_text().splitlines() if "const char*" not in line)


def sections(text):
    """(line, kind, files, keys of the table that follows) of every <!-- readers: ... --> or <!-- writers: ... -->."""
    found = None
    for number, line in enumerate(text.splitlines(), 1):
        mark = re.match(r"<!-- (readers|writers): (.*) -->", line)
        if mark or line.startswith("#"):
            if found:
                yield found
            found = (number, mark[1], mark[2], set()) if mark else None
        key = TABLE_KEY.match(line)
        if found and key:
            found[3].add(key[1])
    if found:
        yield found


def wrong_keys(root):
    page = root / "docs" / "files.md"
    checked = 0
    for number, kind, files, on_page in sections(page.read_text()):
        in_code, pattern = set(), ASKED if kind == "readers" else WRITTEN
        for name, text in sources(root, files):
            if text is None:
                yield f"{page}:{number}: {name} is gone"
                continue
            for match in pattern.finditer(text):
                in_code |= {group for group in match.groups() if group}
        checked += len(in_code)
        for key in sorted(in_code - on_page):
            yield f"{page}:{number}: {kind} know `{key}`, the table does not"
        for key in sorted(on_page - in_code):
            yield f"{page}:{number}: the table has `{key}`, which no {kind[:-1]} knows"
    if checked < 200:
        yield f"{page}: only {checked} keys were found in the sources; has their style changed?"


def without_meaning(root):
    page = root / "docs" / "files.md"
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if re.search(r"\|\s*\|$", line):
            yield f"{page}:{number}: the meaning is empty"


def exists(root, name, bases):
    name = name.rstrip(".:,")
    pattern = name.replace("NAME", "*").replace("<name>", "*")
    for base in bases:
        if "*" in pattern:
            if any((root / base).glob(pattern)):
                return True
        elif (root / base / name).exists() or any((root / base).glob(name + ".*")):
            return True
    return False


def wrong_names(root):
    for page in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        for number, line in enumerate(page.read_text().splitlines(), 1):
            for target in re.findall(r"\]\(([^)#\s]+)(?:#[\w-]*)?\)", line):
                if "://" not in target and not (page.parent / target).exists():
                    yield f"{page}:{number}: links to {target}, which is not there"
            for name in NAMED.findall(line):
                if not exists(root, name, ["."]):
                    yield f"{page}:{number}: names {name}, which is not there"
            for name in ROOMS.findall(line):
                if not exists(root, name, ["src", "include/knee_robot", "test"]):
                    yield f"{page}:{number}: names {name}, which is in neither src, include nor test"


def unlisted(root):
    index = (root / "docs" / "README.md").read_text()
    for page in sorted((root / "docs").rglob("*.md")):
        name = page.relative_to(root / "docs").as_posix()
        if name != "README.md" and f"({name})" not in index:
            yield f"{root / 'docs' / 'README.md'}: does not list {name}"


def unnamed_effects(root):
    """Effects of trace that its manual does not name."""
    manual = (root / "docs" / "tracing.md").read_text()
    for file in sorted((root / "src" / "tracing" / "effects").rglob("*.cpp")):
        for name in re.findall(r'name\(\) const override \{\s*return "(\w+)"', file.read_text()):
            if f"`{name}`" not in manual:
                yield f"{file}: {name} is not among the effects of docs/tracing.md"


def never_run(root):
    """Scripts of README.md that scripts/check_everything would leave out."""
    listed = subprocess.run([root / "scripts" / "check_everything", "--list"], capture_output=True, text=True, check=False)
    yield from listed.stderr.splitlines()


def ambiguous_commands(root):
    """`rosrun knee_robot NAME` of a page, where the source tree has an executable of that name as well: rosrun asks which of them."""
    executable = {}
    for folder in ["scripts", "src", "test", "python", "operator"]:
        for file in (root / folder).rglob("*"):
            if file.is_file() and os.access(file, os.X_OK):
                executable[file.name] = file
    for page in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        for number, line in enumerate(page.read_text().splitlines(), 1):
            for name in re.findall(r"rosrun knee_robot (\w+)", line):
                if name in executable:
                    yield f"{page}:{number}: rosrun finds {executable[name]} beside the program {name}"


def main(root):
    faults = [*wrong_keys(root), *without_meaning(root), *wrong_names(root), *unlisted(root), *unnamed_effects(root), *never_run(root),
              *ambiguous_commands(root)]
    print("\n".join(faults) or "the docs name what is there")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)))
