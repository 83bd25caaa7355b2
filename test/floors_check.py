#!/usr/bin/python3
"""A room includes rooms on lower floors only, ROS headers stay in nodes/, files stay short, a class has one source, and a header is public
only where somebody outside its room needs it."""
import collections
import pathlib
import re
import sys

FLOORS = {"base": 0, "mechanism": 1, "rt": 1, "hardware": 1, "recording": 1, "dynamics": 2, "trajectory": 2, "excitation": 3, "simulation": 3,
          "identification": 3, "control": 4, "tracing": 4, "report": 5, "tuning": 6, "nodes": 7}
LONGEST = 400
TESTS_OF = {"campaign": "control"}  # folders of tests that are named otherwise than the room into which they look
# A member function's definition, at the beginning of a line: what it returns, the class (with those around it), the function.
MEMBER = re.compile(r"(?:[\w:<>,&*\[\]]+[\s&*]+)*?((?:[a-z]\w*::)*)((?:[A-Z]\w*(?:<[^>]*>)?::)+)(?:~?\w+|operator\S+)\(")


def faults_of(path, room):
    lines = path.read_text().splitlines()
    if len(lines) > LONGEST:
        yield f"{path}: {len(lines)} lines, more than {LONGEST}: split it, one idea a file"
    for number, line in enumerate(lines, 1):
        included = re.match(r'\s*#\s*include\s+"knee_robot/(\w+)/', line)
        if included and included[1] not in FLOORS:
            yield f"{path}:{number}: includes room {included[1]}, which no floor has"
        elif included and included[1] != room and FLOORS[included[1]] >= FLOORS[room]:
            yield f"{path}:{number}: {room} (floor {FLOORS[room]}) includes {included[1]} (floor {FLOORS[included[1]]})"
        if room != "nodes" and re.match(r'\s*#\s*include\s+[<"](ros|tf2_ros|sensor_msgs|std_msgs|geometry_msgs)/', line):
            yield f"{path}:{number}: ROS header outside nodes/"


def classes_of(path):
    """The classes whose member functions this source defines; a nested one is a class of its own."""
    for line in path.read_text().splitlines():
        if found := MEMBER.match(line):
            yield found[2].rstrip(":")


def scattered_classes(sources):
    homes = collections.defaultdict(set)
    for path, room in sources:
        for name in classes_of(path):
            homes[room, name].add(path.name)
    for (room, name), names in sorted(homes.items()):
        if len(names) > 1:
            yield f"{room}: class {name} is defined in {', '.join(sorted(names))}: one class is one header and one source"


def includes_of(path):
    return re.findall(r'^\s*#\s*include\s+"(knee_robot/[^"]+)"', path.read_text(), re.MULTILINE)


def needless_public_headers(root):
    """Headers in include/ that no other room, no test of another room and no header that those need includes."""
    public = {str(path.relative_to(root / "include")): path for path in (root / "include" / "knee_robot").rglob("*.h")}
    needed = set(re.findall(r"knee_robot/[\w/]+\.h", "".join(path.read_text() for path in (root / "cmake").glob("*.cmake"))))
    for base in (root / "include" / "knee_robot", root / "src", root / "test"):
        for path in base.rglob("*"):
            if path.suffix in (".h", ".cpp"):
                folder = path.relative_to(base).parts[0]
                needed |= {name for name in includes_of(path) if name.split("/")[1] != TESTS_OF.get(folder, folder)}
    left = [name for name in needed if name in public]
    while left:
        more = [name for name in includes_of(public[left.pop()]) if name in public and name not in needed]
        needed.update(more)
        left += more
    for name in sorted(set(public) - needed):
        yield f"include/{name}: nobody outside its room needs it: it belongs in src/{name.split('/', 1)[1].rsplit('/', 1)[0]}"


def main(root):
    faults, files, sources = [], 0, []
    for base in (root / "include" / "knee_robot", root / "src"):
        for path in sorted(base.rglob("*")):
            if path.suffix in (".h", ".cpp"):
                files += 1
                room = path.relative_to(base).parts[0]
                faults += faults_of(path, room) if room in FLOORS else [f"{path}: room {room} is on no floor"]
                if path.suffix == ".cpp":
                    sources.append((path, room))
    faults += scattered_classes(sources)
    faults += needless_public_headers(root)
    print("\n".join(faults) or f"{files} files: every include goes down the floors, every class has one source, public headers are needed")
    return 1 if faults or not files else 0


sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)))
